//! Why a strategy cannot run on a machine.

use super::Strategy;
use crate::cam::tilt::TiltError;

/// Why a strategy cannot run on a machine.
#[derive(Debug, thiserror::Error)]
pub enum TrajectoryError {
    /// The machine lacks an axis the strategy drives.
    #[error("{machine} cannot run {strategy:?}: it has no {axis}; choose another strategy")]
    NoAxis {
        /// The machine.
        machine: String,
        /// The strategy.
        strategy: Strategy,
        /// What is missing.
        axis: &'static str,
    },
    /// The table does not turn the part under the tool.
    #[error("{strategy:?} runs around the part, and {source}")]
    Tilt {
        /// The strategy.
        strategy: Strategy,
        /// Why not.
        source: TiltError,
    },
    /// A spacing is not a positive number.
    #[error("the {what} is {value}; it must be a number above 0")]
    NotPositive {
        /// Which one.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// More positions than memory should be asked for.
    #[error(
        "the trajectory would have {positions:.3e} positions, more than {most:.0e}; \
         choose a larger pitch or fewer points"
    )]
    TooMany {
        /// How many it would have.
        positions: f64,
        /// How many are allowed.
        most: f64,
    },
}
