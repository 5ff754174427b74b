//! How a turntable is found, as flags.

use super::TurntableError;

/// How [`calibrate`](super::calibrate) goes about it.
#[derive(Debug, Clone, Default, PartialEq, clap::Args, serde::Serialize, serde::Deserialize)]
#[serde(default, rename_all = "kebab-case", deny_unknown_fields)]
pub struct TurntableOptions {
    /// The turn from view to view, if it is known [deg; default: found from the views].
    #[arg(long, value_name = "DEG")]
    pub turntable_step: Option<f64>,
    /// Voxels in which views are laid over each other [mm; default: 1/150 of the first view's diagonal].
    #[arg(long, value_name = "MM")]
    pub turntable_voxel: Option<f64>,
}

impl TurntableOptions {
    /// Refuses numbers that mean nothing.
    pub fn check(&self) -> Result<(), TurntableError> {
        let refuse = |option, value, must| Err(TurntableError::Option { option, value, must });
        match (self.turntable_step, self.turntable_voxel) {
            (Some(value), _) if !(value > 0.0 && value < 180.0) => {
                refuse("--turntable-step", value, "above 0 and below 180 degrees")
            }
            (_, Some(value)) if !(value > 0.0 && value.is_finite()) => {
                refuse("--turntable-voxel", value, "a length above 0")
            }
            _ => Ok(()),
        }
    }
}
