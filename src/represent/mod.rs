//! Fewer points that say the same: voxel grid, octree, growing neural gas, and its [`surface`].
//!
//! Each takes a cloud part by part ([`CloudParts`](crate::geom::CloudParts)), in memory or not, and gives
//! representatives; [`mean_error()`] says how far the cloud is from them, [`polish()`] brings them to the middle of
//! what they stand for.
//!
//! Morell (2014), chapter 3.

mod assign;
pub mod gng;
mod mean_error;
pub mod octree;
mod polish;
pub mod surface;
pub mod voxel;

pub use mean_error::{MeanError, MeanErrorError, mean_error};
pub use polish::{Middle, PolishOptions, polish};
