//! Registration: what moves one view onto another, and how far off it is.

mod align;
mod odometry_error;
mod statistics;

pub use align::align;
pub use odometry_error::{
    AbsoluteError, Delta, OdometryError, OdometryErrorOptions, RelativeError, RelativeErrors,
    TruthAt, Unmatched, odometry_error,
};
pub use statistics::Statistics;
