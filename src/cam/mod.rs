//! From a part on a machine to a toolpath.

mod toolpath;

pub use toolpath::{Move, Pace, Toolpath};
