//! What speaks against a motion, in words.

use crate::register::icp::{FreeMotion, Verdict};
use std::fmt;

/// What speaks against a motion.
#[derive(Debug, Clone, PartialEq)]
pub enum DenseReason {
    /// The reference has hardly a pixel with a depth.
    NoPoints {
        /// How many.
        n_points: usize,
    },
    /// What the reference shows is hardly in the next picture.
    LittleOverlap {
        /// The share that is.
        overlap: f64,
    },
    /// What both show lets these motions pass.
    Free(Vec<FreeMotion>),
    /// These motions are held so weakly that residuals as large as these leave them open.
    Weak {
        /// The motions.
        motions: Vec<FreeMotion>,
        /// The standard deviation of the least held [mm].
        open: f64,
    },
    /// The last step was not small.
    NotConverged {
        /// What it moved the picture by [px].
        step: f64,
    },
    /// Bright is not bright, and dark is not dark.
    Unlike {
        /// The correlation.
        correlation: f64,
    },
    /// The next frame sees through what the reference saw.
    SeenThrough {
        /// The share of the points.
        share: f64,
    },
    /// Back from the next frame to the reference it is another motion.
    NotBack {
        /// Turn between them [deg].
        turn_deg: f64,
        /// Shift between them [mm].
        shift: f64,
    },
}

/// Below this overlap no motion is believed; below the second it is doubted.
pub(super) const OVERLAP: [f64; 2] = [0.08, 0.25];
/// Pictures of the same, correctly laid over each other, correlate better than this even if blurred;
/// below the first it is chance.
pub(super) const LIKE: [f64; 2] = [0.6, 0.9];
/// Points that are seen through: edges of depth are off by pixels, so some always are.
pub(super) const THROUGH: [f64; 2] = [0.25, 0.1];
/// Standard deviation of the least held motion that is free, and that is weak [share of depth].
pub(super) const OPEN: [f64; 2] = [0.03, 0.004];
/// There and back again may lead this far off: turn [rad], and shift [share of depth].
pub(super) const BACK: [f64; 2] = [0.0035, 0.004];

impl DenseReason {
    /// How much it speaks against the motion.
    pub fn verdict(&self) -> Verdict {
        let is_bad = match self {
            Self::NoPoints { .. } | Self::Free(_) => true,
            Self::LittleOverlap { overlap } => *overlap < OVERLAP[0],
            Self::Unlike { correlation } => *correlation < LIKE[0],
            Self::SeenThrough { share } => *share > THROUGH[0],
            Self::Weak { .. } | Self::NotConverged { .. } | Self::NotBack { .. } => false,
        };
        if is_bad { Verdict::Failed } else { Verdict::Doubtful }
    }

    /// True if another start may lead elsewhere.
    pub(super) fn is_lost(&self) -> bool {
        !matches!(self, Self::NoPoints { .. } | Self::Weak { .. } | Self::NotBack { .. })
    }
}

impl fmt::Display for DenseReason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let listed = |motions: &[FreeMotion]| {
            motions.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")
        };
        match self {
            Self::NoPoints { n_points } => {
                write!(
                    f,
                    "nothing to follow: {n_points} pixels have a depth and depths around them"
                )
            }
            Self::LittleOverlap { overlap } => write!(
                f,
                "too little overlap: {:.0} % of what one frame shows is in the other; take more frames \
                 on the way",
                100.0 * overlap
            ),
            Self::Free(motions) => write!(
                f,
                "what both frames show lets the camera pass: {}; let it see something with pattern or \
                 shape",
                listed(motions)
            ),
            Self::Weak { motions, open } => {
                write!(f, "weakly held, to {open:.1} mm: {}", listed(motions))
            }
            Self::NotConverged { step } => {
                write!(f, "not converged: the last step moved the picture by {step:.2} px")
            }
            Self::Unlike { correlation } => write!(
                f,
                "the pictures differ: where one is bright the other is not (correlation {correlation:.2})"
            ),
            Self::SeenThrough { share } => write!(
                f,
                "surfaces are seen through: {:.0} % of the points should hide what is seen behind them",
                100.0 * share
            ),
            Self::NotBack { turn_deg, shift } => write!(
                f,
                "there and back again leads {turn_deg:.2} deg and {shift:.1} mm off: the frames are \
                 distorted differently, as by turning fast"
            ),
        }
    }
}
