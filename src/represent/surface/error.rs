//! Why a network has no surface.

use crate::geom::DelaunayError;
use crate::progress::Cancelled;

/// Why a network has no surface.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SurfaceError {
    /// A neuron is nowhere.
    #[error(
        "neuron {number} of the network is at ({x}, {y}, {z}): no place; repair or grow it again"
    )]
    NotFinite {
        /// Which neuron, counted from 1.
        number: usize,
        /// Its coordinates.
        x: f64,
        /// Its coordinates.
        y: f64,
        /// Its coordinates.
        z: f64,
    },
    /// An edge joins neurons that are not there.
    #[error("edge {number} of the network joins neurons {a} and {b}, but there are {n_neurons}")]
    Edge {
        /// Which edge, counted from 1.
        number: usize,
        /// An end, counted from 0.
        a: u32,
        /// The other.
        b: u32,
        /// Neurons there are.
        n_neurons: usize,
    },
    /// The neurons span no body.
    #[error(
        "the network has no surface: {n_neurons} neurons in one plane span no body; ask for more, or scan more than a plane"
    )]
    Flat {
        /// Neurons there are.
        n_neurons: usize,
    },
    /// Nothing hangs together.
    #[error(
        "the network has no surface: nowhere do three neurons lie side by side; give the cloud it stands for, or grow it over a cloud of a surface"
    )]
    Nothing,
    /// An option that means nothing.
    #[error("--close is {value}; give a length of 0 or above")]
    Close {
        /// What was given.
        value: f64,
    },
    /// The caller asked to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl From<DelaunayError> for SurfaceError {
    fn from(error: DelaunayError) -> Self {
        match error {
            DelaunayError::Flat { n_points } => Self::Flat { n_neurons: n_points },
            DelaunayError::Cancelled(cancelled) => Self::Cancelled(cancelled),
        }
    }
}
