//! Files in and out.

mod machine;
mod output;

pub use machine::{DescriptionError, read_machine, read_machine_text, read_tools};
pub use output::{Overwrite, WriteError, write_file};
