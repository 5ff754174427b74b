//! Registration: the motion that lays one view of a part over another.
//!
//! [`icp`] refines a pose that is roughly known.

pub mod icp;
