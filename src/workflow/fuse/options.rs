//! How frames become a surface, as flags and file keys.

use super::Placing;
use crate::compute::ComputeChoice;
use crate::register::tsdf::{TrackOptions, TsdfError, TsdfOptions};

/// How [`fuse`](super::fuse) goes about it.
#[derive(Debug, Clone, Default, PartialEq, clap::Args, serde::Serialize, serde::Deserialize)]
#[serde(default, rename_all = "kebab-case", deny_unknown_fields)]
pub struct FuseOptions {
    /// The model.
    #[command(flatten)]
    pub volume: TsdfOptions,
    /// How frames are placed where no trajectory does.
    #[command(flatten)]
    pub track: TrackOptions,
    /// Keep every Nth frame out, and measure how far its points lie from the surface; it takes given
    /// poses.
    #[arg(long, value_name = "N")]
    pub keep_out: Option<usize>,
    /// Drop pieces of the surface that are smaller across: noise in the air [mm; default: the
    /// truncation; 0 keeps all].
    #[arg(long, value_name = "MM")]
    pub least_piece: Option<f64>,
    /// How long before its stamp a frame was really taken, by the clock of the given poses [s]. Drivers
    /// stamp late: those of the freiburg1 sequences by about 0.025.
    #[arg(long, value_name = "S", default_value_t = 0.0, allow_negative_numbers = true)]
    pub pose_delay: f64,
    /// What fuses, and casts the model for tracking. auto times the first frame on the processor and on
    /// a device and takes the faster; the report says which.
    #[arg(long, value_name = "WHAT", value_enum, default_value_t = ComputeChoice::Cpu)]
    pub compute: ComputeChoice,
    /// The device to compute on, by its name or a part of it (`horma devices`) [default: the first of
    /// the fastest kind there is].
    #[arg(long, value_name = "NAME")]
    pub adapter: Option<String>,
}

/// A longer delay is a mistake, most likely of its unit [s].
const LONGEST_DELAY: f64 = 1.0;

impl FuseOptions {
    /// Refuses numbers that mean nothing.
    pub fn check(&self, placing: &Placing) -> Result<(), TsdfError> {
        self.volume.check()?;
        self.track.check()?;
        let refuse = |option, value, must| Err(TsdfError::Option { option, value, must });
        let least = self.least_piece();
        if !(least >= 0.0 && least.is_finite()) {
            return refuse("--least-piece", least, "a length, or 0");
        }
        // A comparison that NaN fails.
        let is_delay = self.pose_delay.abs() <= LONGEST_DELAY;
        if !is_delay {
            return refuse("--pose-delay", self.pose_delay, "from -1 to 1 seconds");
        }
        let keep_out = self.keep_out.map(|n| n as f64);
        match (keep_out, placing) {
            (Some(n), _) if n < 2.0 => refuse("--keep-out", n, "2 or more: the others are fused"),
            // Placed by the model they are to judge, frames lie on it whatever it is.
            (Some(n), Placing::Tracked) => refuse(
                "--keep-out",
                n,
                "left out, or the poses be given: --truth-poses, --poses or --turntable",
            ),
            _ => Ok(()),
        }
    }

    /// Smaller pieces are dropped [mm].
    pub(super) fn least_piece(&self) -> f64 {
        self.least_piece.unwrap_or(self.volume.truncation())
    }
}
