//! Files in and out.

mod output;
mod program;

pub use output::{Overwrite, WriteError, write_file};
pub use program::{ReadProgramError, read_program, write_program};
