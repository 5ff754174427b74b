//! Files in and out.

mod output;
pub mod report;

pub use output::{Overwrite, WriteError, write_file};
