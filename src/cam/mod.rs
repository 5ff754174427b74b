//! From a part on a machine to a toolpath.

mod digitize;
mod toolpath;

pub use digitize::{Contact, ContactKind, Digitizer, Method, Part};
pub use toolpath::{Move, Pace, Toolpath};
