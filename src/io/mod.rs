//! Files in and out.

mod output;

pub use output::{Overwrite, WriteError, write_file};
