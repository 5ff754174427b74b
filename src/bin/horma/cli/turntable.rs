//! The flags of turntables, and how one is come by.

use anyhow::bail;
use clap::Args;
use horma::io::rgbd::{FrameFiles, Sequence, read_turntable};
use horma::progress::Progress;
use horma::register::turntable::{Calibration, Turntable, TurntableOptions};
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
    /// How many turns each INPUT holds, one after the other, of as many frames each. Between turns the part
    /// may be laid otherwise, or the camera moved: each is calibrated by itself and laid on the others.
    #[arg(long, value_name = "N", requires = "turntable", default_value_t = 1)]
    pub(super) turns: usize,
    /// Write the turntable's axis and step, to be given to the next scan.
    #[arg(long, value_name = "FILE", requires = "turntable")]
    pub(super) write_turntable: Option<PathBuf>,
    #[command(flatten)]
    pub(super) options: TurntableOptions,
}

impl TurntableArgs {
    /// Whether there is one.
    pub(super) fn is_asked(&self) -> bool {
        self.turntable.is_some()
    }

    /// The turns in `sequence`, each a sequence of its own.
    pub(super) fn turns_of(&self, sequence: &Sequence) -> anyhow::Result<Vec<Sequence>> {
        let (n_frames, n_turns) = (sequence.files.len(), self.turns);
        if n_turns == 0 || !n_frames.is_multiple_of(n_turns) {
            bail!(
                "{n_frames} frames are not {n_turns} turns of as many each (--turns); give each turn in a folder \
                 of its own"
            );
        }
        let turn = |files: &[FrameFiles]| Sequence { files: files.to_vec(), ..sequence.clone() };
        Ok(sequence.files.chunks(n_frames / n_turns).map(turn).collect())
    }

    /// The turntable, if a file says what it is.
    pub(super) fn given(&self) -> anyhow::Result<Option<Turntable>> {
        self.options.check()?;
        let Some(path) = self.turntable.as_deref().filter(|path| *path != Path::new(CALIBRATE))
        else {
            return Ok(None);
        };
        let mut turntable = read_turntable(path)?;
        if let Some(step_deg) = self.options.turntable_step {
            turntable.step = step_deg.to_radians();
        }
        Ok(Some(turntable))
    }

    /// The turntable on which `sequence` was taken, if one is asked for; depths beyond `max_depth` are
    /// left out.
    pub(super) fn find(
        &self,
        sequence: &Sequence,
        max_depth: f64,
        progress: &dyn Progress,
    ) -> anyhow::Result<Option<Calibration>> {
        if !self.is_asked() {
            return Ok(None);
        }
        if let Some(turntable) = self.given()? {
            return Ok(Some(Calibration::given(turntable)));
        }
        let (frames, camera) = (sequence.frames(), &sequence.camera.camera);
        Ok(Some(calibrate_turntable(frames, camera, max_depth, &self.options, progress)?))
    }
}
