//! Why frames could not even be tried.

use crate::rgbd::RgbdError;

/// Why frames could not even be tried.
#[derive(Debug, thiserror::Error)]
pub enum DenseError {
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
    /// There is no brightness to compare.
    #[error(
        "the frame has no colour picture, which dense odometry compares; choose the method that goes by \
         depth alone (--method icp)"
    )]
    NoColour,
    /// Too small to be halved so often.
    #[error(
        "pictures of {width} x {height} cannot be halved to {levels} levels: the coarsest would have \
         less than 12 pixels a side; ask for fewer (--dense-levels)"
    )]
    TooSmall {
        /// Pixels per row.
        width: usize,
        /// Rows.
        height: usize,
        /// Levels asked for.
        levels: usize,
    },
    /// Two frames of different cameras.
    #[error("the frames were taken by different cameras, or halved to different levels")]
    Cameras,
    /// The start is no number.
    #[error("the start is not finite; give a pose of numbers")]
    Start,
    /// A frame or a camera that is none.
    #[error(transparent)]
    Rgbd(#[from] RgbdError),
}
