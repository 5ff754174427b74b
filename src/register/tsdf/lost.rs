//! Why a frame could not be placed.

use super::TsdfError;
use crate::register::icp::FreeMotion;

/// Why a frame could not be placed. The model is as it was.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Lost {
    /// Nothing to hold on to.
    #[error("the frame has {n_pixels} pixels with a surface around them: it takes {least}")]
    NoSurface {
        /// Pixels with a normal.
        n_pixels: usize,
        /// How many it takes.
        least: usize,
    },
    /// The model and the frame do not show the same.
    #[error(
        "too few pairs: {:.0} % of the frame lies on the model, at least {:.0} % must (--least-overlap)",
        100.0 * share, 100.0 * least
    )]
    TooFewPairs {
        /// Of the frame's pixels, those on the model.
        share: f64,
        /// How many it takes.
        least: f64,
    },
    /// No camera moves so fast.
    #[error(
        "a jump: it would have moved {shift:.0} mm and turned {turn_deg:.1} deg in {n_frames} frames; \
         allow more with --most-moved and --most-turned-deg"
    )]
    Jump {
        /// From the last frame placed [mm].
        shift: f64,
        /// From the last frame placed [deg].
        turn_deg: f64,
        /// Frames since then.
        n_frames: usize,
    },
    /// The surfaces let these motions pass.
    #[error("degenerate: what is seen allows {}", listed(motions))]
    Free {
        /// The motions, in the camera's frame.
        motions: Vec<FreeMotion>,
    },
}

/// Why there is no place for a frame.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Unplaced {
    /// It does not tell where it was taken.
    #[error(transparent)]
    Lost(#[from] Lost),
    /// The model cannot be looked at: its device cannot.
    #[error(transparent)]
    Model(#[from] TsdfError),
}

fn listed(motions: &[FreeMotion]) -> String {
    motions.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")
}
