//! Why nobody can tell how late stamps are.

use crate::progress::Cancelled;

/// Why nobody can tell how late stamps are.
#[derive(Debug, thiserror::Error)]
pub enum PoseDelayError {
    /// Hardly a frame can be placed.
    #[error(
        "the delay of stamps is told by frames with poses from 0.1 s before to 0.1 s after them, and there are \
         {n_frames}: it takes {least}; give it with --pose-delay"
    )]
    TooFewFrames {
        /// How many there are.
        n_frames: usize,
        /// How many it takes.
        least: usize,
    },
    /// Frames do not show the same.
    #[error(
        "the delay of stamps is told by frames that show the same, and there are {n_pairs} pairs of them: it \
         takes {least}; give it with --pose-delay"
    )]
    TooFewPairs {
        /// How many there are.
        n_pairs: usize,
        /// How many it takes.
        least: usize,
    },
    /// The camera stood, or moved evenly.
    #[error(
        "the camera moved too evenly to tell how late its stamps are: 0.02 s beside the best delay frames lie \
         {:.1} % farther apart, which should be {:.0} %; give it with --pose-delay, or leave it out",
        100.0 * .rise, 100.0 * .least
    )]
    Even {
        /// How much farther apart frames lie beside the best delay.
        rise: f64,
        /// How much it takes.
        least: f64,
    },
    /// The best delay is the longest.
    #[error(
        "the frames lie on each other best more than {longest} s beside their stamps: poses and frames are not of \
         one clock, or not of one camera"
    )]
    Beyond {
        /// The longest delay that is believed [s].
        longest: f64,
    },
    /// Frames do not agree.
    #[error(
        "one half of the frames says that stamps are {:.4} s late, the other {:.4} s; give the delay with \
         --pose-delay", .halves[0], .halves[1]
    )]
    Unsteady {
        /// What the halves say [s].
        halves: [f64; 2],
    },
    /// The caller asked to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}
