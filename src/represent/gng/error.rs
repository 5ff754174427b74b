//! Why a network could not grow.

use super::options::OptionError;
use crate::compute::GpuError;
use crate::geom::PartError;
use crate::progress::Cancelled;

/// Why a network could not grow.
#[derive(Debug, thiserror::Error)]
pub enum GngError {
    /// There is nothing to learn from.
    #[error("the cloud has no points: there is nothing to learn")]
    Empty,
    /// Nothing says when to stop.
    #[error(
        "nothing says when to stop growing; give --count, --max-signals, --max-seconds or --target-error"
    )]
    Endless,
    /// More neurons than points.
    #[error(
        "{n_neurons} neurons were asked for, but the cloud has only {n_points} points; ask for fewer"
    )]
    TooMany {
        /// Neurons asked for.
        n_neurons: usize,
        /// Points there are.
        n_points: u64,
    },
    /// A network of less than two neurons was asked for.
    #[error("{n_neurons} neurons were asked for; a network has at least 2")]
    TooFew {
        /// Neurons asked for.
        n_neurons: usize,
    },
    /// A network to go on from that does not hang together.
    #[error(
        "the network cannot grow on: {problem}; give one that `horma reduce --method gng` wrote"
    )]
    Graph {
        /// What is wrong with it.
        problem: String,
    },
    /// A number among the options.
    #[error(transparent)]
    Option(#[from] OptionError),
    /// The cloud could not be gone through.
    #[error(transparent)]
    Part(#[from] PartError),
    /// The device.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// A driver ends loops before their time.
    #[error("{adapter} ends a loop over {n_neurons} neurons before its time; take --compute cpu")]
    CutShort {
        /// What the device is called.
        adapter: String,
        /// How many neurons there were.
        n_neurons: usize,
    },
    /// The caller asked to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}
