//! Registration: the motion that lays one view of a part over another, and how far a trajectory is
//! off.
//!
//! [`icp`] refines a pose that is roughly known; [`align`] is the closed form for paired points.
//! [`odometry`] follows a camera from frame to frame.

mod align;
pub mod features;
pub mod icp;
pub mod odometry;
mod odometry_error;
pub mod ransac;
mod statistics;

pub use align::align;
pub use odometry_error::{
    AbsoluteError, Delta, OdometryError, OdometryErrorOptions, RelativeError, RelativeErrors,
    TruthAt, Unmatched, odometry_error,
};
pub use statistics::Statistics;
