//! The motion between two frames, and what speaks against it.

use super::agreement::agreement;
use super::{Look, OdometryOptions};
use crate::geom::Pose;
use crate::register::dense::DenseReason;
use crate::register::icp;
use crate::register::icp::Verdict;
use crate::register::small_motion::surety;
use nalgebra::Matrix6;
use std::fmt;

/// The share of a picture that a camera may seem to have looked through: edges, and noise.
const MOST_SEEN_THROUGH: f64 = 0.1;
/// Fewer features that agree are chance.
pub(super) const FEW: usize = 12;

/// The motion between two frames.
#[derive(Debug, Clone, PartialEq)]
pub struct Motion {
    /// Takes points of the next camera's frame into the previous one's.
    pub previous_from_next: Pose,
    /// Whether it may be believed.
    pub verdict: Verdict,
    /// What speaks against it.
    pub reasons: Vec<Doubt>,
    /// Information of a small motion, turn [rad] before shift [mm], taken from the left about the
    /// previous camera.
    pub information: Matrix6<f64>,
    /// The share of what the previous frame shows that the next one shows too.
    pub overlap: f64,
}

/// What speaks against a motion.
#[derive(Debug, Clone, PartialEq)]
pub enum Doubt {
    /// A frame holds nothing to go by.
    Unusable(String),
    /// The surfaces say so.
    Surface(icp::Reason),
    /// The pictures say so.
    Dense(DenseReason),
    /// Hardly a feature agrees.
    FewInliers {
        /// Those that agree.
        n: usize,
        /// All that matched.
        of: usize,
        /// How many must.
        least: usize,
    },
    /// What agrees leaves too much open.
    Open {
        /// Of where the camera is, three standard deviations [mm].
        moved: f64,
        /// Of how it is turned, three standard deviations [deg].
        turned_deg: f64,
    },
    /// One half of the features says something else than the other.
    Unsteady {
        /// By a way [mm].
        moved: f64,
        /// And a turn [deg].
        turned_deg: f64,
    },
    /// Features say something else than what was found.
    Contradicted {
        /// By a way [mm].
        moved: f64,
        /// And a turn [deg].
        turned_deg: f64,
    },
    /// Laid over each other, the frames have hardly a point in common.
    Apart,
    /// One camera would have looked through what the other saw.
    SeenThrough {
        /// This share of what is in both pictures.
        share: f64,
    },
    /// The camera went farther than it can have.
    WentFar {
        /// Way from where it was expected [mm].
        moved: f64,
        /// Turn from where it was expected [deg].
        turned_deg: f64,
        /// What is allowed.
        most: [f64; 2],
    },
}

impl Motion {
    /// A motion with what was found against it.
    pub fn new(
        previous_from_next: Pose,
        reasons: Vec<Doubt>,
        information: Matrix6<f64>,
        overlap: f64,
    ) -> Self {
        let verdict = reasons.iter().map(Doubt::verdict).max().unwrap_or(Verdict::Ok);
        Self { previous_from_next, verdict, reasons, information, overlap }
    }

    /// No motion that could be found.
    pub fn failed(guess: &Pose, doubt: Doubt) -> Self {
        let verdict = Verdict::Failed;
        let information = Matrix6::zeros();
        Self {
            previous_from_next: *guess,
            verdict,
            reasons: vec![doubt],
            information,
            overlap: 0.0,
        }
    }

    /// The same, with what else speaks against it.
    #[must_use]
    pub(in crate::register) fn doubted(mut self, doubt: Doubt) -> Self {
        self.reasons.push(doubt);
        Self::new(self.previous_from_next, self.reasons, self.information, self.overlap)
    }

    /// How surely it is known: minus its differential entropy, but for a constant.
    pub fn surety(&self) -> f64 {
        surety(&self.information)
    }

    /// The same, failed if it leads farther from `guess` than a camera is moved between two frames.
    #[must_use]
    pub(super) fn within_bounds(mut self, guess: &Pose, options: &OdometryOptions) -> Self {
        let off = guess.inverse() * self.previous_from_next;
        let (moved, turned_deg) =
            (off.translation.vector.norm(), off.rotation.angle().to_degrees());
        let most = [options.most_moved, options.most_turned_deg];
        // A comparison that NaN fails.
        let is_within = moved <= most[0] && turned_deg <= most[1];
        if !is_within {
            self.reasons.push(Doubt::WentFar { moved, turned_deg, most });
            self.verdict = Verdict::Failed;
        }
        self
    }
}

impl Motion {
    /// The same, with what laying the frames over each other says.
    #[must_use]
    pub(super) fn seen_in(mut self, previous: &Look, next: &Look) -> Self {
        if self.verdict == Verdict::Failed {
            return self;
        }
        match agreement(previous, next, &self.previous_from_next) {
            None => self.reasons.push(Doubt::Apart),
            Some(seen) => {
                self.overlap = seen.overlap[0];
                if seen.seen_through > MOST_SEEN_THROUGH {
                    self.reasons.push(Doubt::SeenThrough { share: seen.seen_through });
                }
            }
        }
        Self::new(self.previous_from_next, self.reasons, self.information, self.overlap)
    }
}

impl Doubt {
    /// How much it speaks against the motion.
    pub fn verdict(&self) -> Verdict {
        match self {
            Self::Unusable(_) | Self::WentFar { .. } | Self::Apart => Verdict::Failed,
            Self::FewInliers { n, .. } if *n < FEW => Verdict::Failed,
            Self::FewInliers { .. }
            | Self::Open { .. }
            | Self::Unsteady { .. }
            | Self::Contradicted { .. }
            | Self::SeenThrough { .. } => Verdict::Doubtful,
            Self::Surface(reason) => reason.verdict(),
            Self::Dense(reason) => reason.verdict(),
        }
    }
}

impl Doubt {
    /// True if it says no more than that the motion is weakly held, which its information says too.
    pub fn is_weakness(&self) -> bool {
        matches!(
            self,
            Self::Open { .. }
                | Self::Surface(icp::Reason::Weak { .. })
                | Self::Dense(DenseReason::Weak { .. })
        )
    }
}

impl fmt::Display for Doubt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unusable(why) => f.write_str(why),
            Self::Surface(reason) => reason.fmt(f),
            Self::Dense(reason) => reason.fmt(f),
            Self::FewInliers { n, of, least } => {
                write!(f, "{n} of {of} matched features agree; {least} must")
            }
            Self::Open { moved, turned_deg } => {
                write!(f, "what agrees leaves {moved:.0} mm and {turned_deg:.2} deg open")
            }
            Self::Unsteady { moved, turned_deg } => write!(
                f,
                "half of the features differ from the other half by {moved:.0} mm and {turned_deg:.2} deg"
            ),
            Self::Contradicted { moved, turned_deg } => {
                write!(f, "features say something else, by {moved:.0} mm and {turned_deg:.2} deg")
            }
            Self::Apart => {
                f.write_str("laid over each other, the frames have hardly a point in common")
            }
            Self::SeenThrough { share } => write!(
                f,
                "one camera would have looked through {:.0} % of what the other saw",
                100.0 * share
            ),
            Self::WentFar { moved, turned_deg, most: [way, turn] } => write!(
                f,
                "went too far: {moved:.0} mm and {turned_deg:.1} deg from where the camera was expected, \
                 where {way:.0} mm and {turn:.0} deg are allowed"
            ),
        }
    }
}
