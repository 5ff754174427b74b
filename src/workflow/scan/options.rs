//! How a scan is made.

use crate::geom::VoxelError;
use crate::register::odometry::{OdometryError, OdometryOptions};
use serde::{Deserialize, Serialize};

/// How a scan is made.
#[derive(Debug, Clone, Default, PartialEq, clap::Args, Serialize, Deserialize)]
#[serde(default, rename_all = "kebab-case")]
pub struct ScanOptions {
    /// Side of the cells of the cloud that become one point each [mm; default: 1/300 of the first
    /// frame's median depth].
    #[arg(long, value_name = "MM")]
    pub voxel: Option<f64>,
    /// How the camera is followed.
    #[command(flatten)]
    #[serde(flatten)]
    pub odometry: OdometryOptions,
}

impl ScanOptions {
    /// Voxels from the camera to what it sees in the median.
    pub(super) const VOXELS_DEEP: f64 = 300.0;

    /// Refuses numbers that mean nothing.
    pub fn check(&self) -> Result<(), OdometryError> {
        self.odometry.check()?;
        match self.voxel {
            Some(value) if !(value > 0.0 && value.is_finite()) => {
                Err(OdometryError::Option { option: "--voxel", value, must: "a number above 0" })
            }
            _ => Ok(()),
        }
    }

    /// The side of a voxel, or why it is none.
    pub(super) fn side(voxel: f64) -> Result<f64, VoxelError> {
        let is_length = voxel > 0.0 && voxel.is_finite();
        if is_length { Ok(voxel) } else { Err(VoxelError::Side { side: voxel }) }
    }
}
