//! Why a turntable cannot be known.

use crate::geom::{Point3, Vector3};
use crate::progress::Cancelled;
use crate::register::icp::IcpError;

/// Why a turntable cannot be known.
#[derive(Debug, thiserror::Error)]
pub enum TurntableError {
    /// A number that means nothing.
    #[error("{option} is {value}; it must be {must}")]
    Option {
        /// The flag.
        option: &'static str,
        /// What was given.
        value: f64,
        /// What would do.
        must: &'static str,
    },
    /// An axis that is none.
    #[error(
        "the axis {} {} {} through {} {} {} with {step} rad a step is no turntable: its direction must not be 0, and \
         every number finite", .axis.x, .axis.y, .axis.z, .through.x, .through.y, .through.z
    )]
    Numbers {
        /// The direction.
        axis: Vector3,
        /// A point of it.
        through: Point3,
        /// The turn.
        step: f64,
    },
    /// Too little to go by.
    #[error(
        "a turntable is found from neighbouring views, and there are {n_pairs} pairs of them: it takes \
         {least}; give its axis in a file instead"
    )]
    TooFewViews {
        /// Neighbouring views that could be laid over each other.
        n_pairs: usize,
        /// How many it takes.
        least: usize,
    },
    /// Neighbours do not turn.
    #[error(
        "from view to view the part turns by {step_deg:.3} deg: too little to have an axis; does it look alike from all \
         sides, is there a background that stands still (--max-depth leaves it out), or is it no turntable?"
    )]
    Still {
        /// The turn found [deg].
        step_deg: f64,
    },
    /// Views cannot be laid over each other at all.
    #[error(transparent)]
    Icp(IcpError),
    /// The caller asked to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl From<IcpError> for TurntableError {
    fn from(error: IcpError) -> Self {
        match error {
            IcpError::Cancelled(cancelled) => Self::Cancelled(cancelled),
            other => Self::Icp(other),
        }
    }
}
