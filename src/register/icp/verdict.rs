//! Whether a pose may be believed, and the words for why not.

use super::freedom::FreeMotion;
use serde::Serialize;
use std::fmt;

/// Below this overlap no pose is believed.
pub(super) const LITTLE_OVERLAP: f64 = 0.1;

/// Whether a pose may be believed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// Nothing speaks against it.
    Ok,
    /// Something does; look at it.
    Doubtful,
    /// It is not to be used.
    Failed,
}

/// What speaks against a pose.
#[derive(Debug, Clone, PartialEq)]
pub enum Reason {
    /// No point of the source lies near the target where it starts.
    OutOfReach {
        /// The greatest distance of a pair [mm].
        within: f64,
    },
    /// Rejection and shrinking distances left hardly a pair.
    Starved,
    /// The clouds hardly lie on each other.
    LittleOverlap {
        /// Of the source and of the target.
        overlap: [f64; 2],
    },
    /// The surfaces let these motions pass.
    Free(Vec<FreeMotion>),
    /// Surfaces that are off by as much as they are leave these motions open by more than a voxel.
    Weak {
        /// The motions.
        motions: Vec<FreeMotion>,
        /// How far the least held of them is left open [mm].
        open: f64,
    },
    /// The last step was not small.
    NotConverged {
        /// Its turn [deg].
        turn_deg: f64,
        /// Its shift [mm].
        shift: f64,
    },
    /// The surfaces are apart.
    Misfit {
        /// Median distance of the surfaces [mm].
        distance: f64,
        /// Their roughness [mm].
        roughness: f64,
    },
    /// The source went far from where it started.
    WentFar {
        /// Root mean square of its points' ways [mm].
        moved: f64,
        /// The first distance [mm].
        within: f64,
    },
    /// One camera has looked through what the other one sees.
    SeenThrough {
        /// The share of readings that hang in free space.
        share: f64,
    },
    /// No method proposed a start.
    NoStart,
    /// A quite different pose is as good.
    Ambiguous {
        /// What turns one into the other [deg].
        turn_deg: f64,
        /// The share of both clouds that lies on each other, at this pose and at the other.
        fits: [f64; 2],
    },
    /// What looks alike agrees with the pose no better than chance.
    Unsupported {
        /// Pairs of places that look alike.
        n_matches: usize,
        /// Those that the pose lays on each other.
        n_agreeing: usize,
        /// How many it would if partners were drawn at random.
        by_chance: f64,
    },
    /// Too few planes to lay on each other.
    NoPlanes {
        /// Of the source and of the target.
        n_planes: [usize; 2],
    },
    /// Planes agree with the pose no better than chance, but for those that made it.
    UnsupportedPlanes {
        /// Planes of the source and of the target.
        n_planes: [usize; 2],
        /// Those that the pose lays on each other.
        n_agreeing: usize,
        /// How many it would at any shift.
        by_chance: f64,
    },
}

impl Reason {
    /// How much it speaks against the pose.
    pub fn verdict(&self) -> Verdict {
        match self {
            Self::OutOfReach { .. }
            | Self::Starved
            | Self::Free(_)
            | Self::NoStart
            | Self::NoPlanes { .. } => Verdict::Failed,
            Self::LittleOverlap { overlap: [source, target] }
                if source.max(*target) < LITTLE_OVERLAP =>
            {
                Verdict::Failed
            }
            _ => Verdict::Doubtful,
        }
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Ok => "ok",
            Self::Doubtful => "doubtful",
            Self::Failed => "failed",
        })
    }
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let listed = |motions: &[FreeMotion]| {
            motions.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")
        };
        match self {
            Self::OutOfReach { within } => write!(
                f,
                "start beyond reach: hardly a point of the source lies within {within:.1} mm of the \
                 target; start nearer (--init) or look farther (--max-distance)"
            ),
            Self::Starved => f.write_str(
                "too little overlap: hardly a pair was left on the way; start nearer (--init), reject \
                 less or end with a greater --final-distance",
            ),
            Self::LittleOverlap { overlap: [source, target] } => write!(
                f,
                "too little overlap: {:.0} % of the source and {:.0} % of the target lie on each other",
                100.0 * source,
                100.0 * target
            ),
            Self::Free(motions) => {
                write!(f, "degenerate: the surfaces allow {}", listed(motions))
            }
            Self::Weak { motions, open } => write!(
                f,
                "nearly degenerate: with surfaces that far apart, {} is only held to {open:.2} mm",
                listed(motions)
            ),
            Self::NotConverged { turn_deg, shift } => write!(
                f,
                "not converged: the last step turned {turn_deg:.4} deg and shifted {shift:.4} mm; \
                 allow more --iterations"
            ),
            Self::Misfit { distance, roughness } => write!(
                f,
                "the surfaces do not coincide: they are {distance:.3} mm apart in the median, with a \
                 roughness of {roughness:.3} mm"
            ),
            Self::WentFar { moved, within } => write!(
                f,
                "start beyond reach: the source moved {moved:.1} mm, but pairs are at most \
                 {within:.1} mm long; start nearer (--init)"
            ),
            Self::SeenThrough { share } => write!(
                f,
                "free space: {:.1} % of what one camera sees hangs where the other one looked through",
                100.0 * share
            ),
            Self::NoStart => f.write_str(
                "no start was found: no three places of both clouds look alike and lie alike; choose \
                 another --feature-voxel, or say where to begin (--init)",
            ),
            Self::Ambiguous { turn_deg, fits: [this, other] } => write!(
                f,
                "ambiguous: a pose turned by {turn_deg:.1} deg lays {:.0} % of both on each other, this \
                 one {:.0} %; is the part symmetric? Say where to begin (--init)",
                100.0 * other,
                100.0 * this
            ),
            Self::Unsupported { n_matches, n_agreeing, by_chance } => write!(
                f,
                "chance explains it: of {n_matches} pairs of places that look alike it lays {n_agreeing} \
                 on each other, where {by_chance:.0} would be by chance"
            ),
            Self::NoPlanes { n_planes: [source, target] } => write!(
                f,
                "no start was found: it takes two planes of either cloud that are not parallel, and the \
                 source has {source} planes, the target {target}; scan more walls, choose a smaller \
                 --voxel or another --coarse, or say where to begin (--init)"
            ),
            Self::UnsupportedPlanes { n_planes: [source, target], n_agreeing, by_chance } => write!(
                f,
                "chance explains it: of {source} and {target} planes it lays {n_agreeing} on each other; \
                 three can always be, and {by_chance:.1} would be by chance"
            ),
        }
    }
}
