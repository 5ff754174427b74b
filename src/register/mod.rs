//! Registration: the motion that lays one view of a part over another, and how far a trajectory is
//! off.
//!
//! [`coarse`] finds a pose from nothing, [`icp`] refines a pose that is roughly known, [`dense`] follows
//! a camera by all that its frames show, [`odometry`] from frame to frame by one method or another;
//! [`turntable`] by how its part turns. [`loops`] finds where it came back to, and [`pose_graph`] what
//! that says of all its way; [`views`] lays many scans over each other at once, [`tsdf`] makes many frames
//! one surface, and [`pose_delay`] tells how late their stamps are. [`align`] is the closed form for paired points.

mod align;
pub mod coarse;
pub mod dense;
pub mod features;
mod free_space;
pub mod icp;
pub mod loops;
pub mod odometry;
mod odometry_error;
pub mod pose_delay;
pub mod pose_graph;
pub mod ransac;
mod small_motion;
mod statistics;
pub mod tsdf;
pub mod turntable;
pub mod views;

pub use align::align;
pub use free_space::{FreeSpace, Seen, align_seen, heed_free_space};
pub use odometry_error::{
    AbsoluteError, Delta, OdometryError, OdometryErrorOptions, RelativeError, RelativeErrors,
    TruthAt, Unmatched, odometry_error,
};
pub use statistics::Statistics;
