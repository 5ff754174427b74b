//! The flags of turntables, and how one is come by.

use clap::Args;
use horma::io::rgbd::{Sequence, read_turntable};
use horma::progress::Progress;
use horma::register::turntable::{Calibration, TurntableOptions};
use horma::workflow::turntable::calibrate_turntable;
use std::path::{Path, PathBuf};

/// What `--turntable` is if no file.
const CALIBRATE: &str = "calibrate";

/// What says that a part stood on a turntable.
#[derive(Debug, Clone, Args)]
pub(super) struct TurntableArgs {
    /// The part stood on a turntable, one even step from frame to frame: find its axis and step from the
    /// views (calibrate), or take those of a file (axis, through, step-deg).
    #[arg(long, value_name = "calibrate|FILE")]
    turntable: Option<PathBuf>,
    /// Write the turntable's axis and step, to be given to the next scan.
    #[arg(long, value_name = "FILE", requires = "turntable")]
    pub(super) write_turntable: Option<PathBuf>,
    #[command(flatten)]
    options: TurntableOptions,
}

impl TurntableArgs {
    /// Whether there is one.
    pub(super) fn is_asked(&self) -> bool {
        self.turntable.is_some()
    }

    /// The turntable on which `sequence` was taken, if one is asked for; depths beyond `max_depth` are
    /// left out.
    pub(super) fn find(
        &self,
        sequence: &Sequence,
        max_depth: f64,
        progress: &dyn Progress,
    ) -> anyhow::Result<Option<Calibration>> {
        let Some(path) = &self.turntable else { return Ok(None) };
        self.options.check()?;
        if path != Path::new(CALIBRATE) {
            let mut turntable = read_turntable(path)?;
            if let Some(step_deg) = self.options.turntable_step {
                turntable.step = step_deg.to_radians();
            }
            return Ok(Some(Calibration::given(turntable)));
        }
        let (frames, camera) = (sequence.frames(), &sequence.camera.camera);
        Ok(Some(calibrate_turntable(frames, camera, max_depth, &self.options, progress)?))
    }
}
