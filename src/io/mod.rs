//! Files in and out.

mod machine;
mod output;
mod output_set;
pub mod report;
mod target;
mod unfinished;

pub use machine::{DescriptionError, read_machine, read_machine_text, read_tools};
pub use output::{Overwrite, WriteError, write_file};
pub use output_set::OutputSet;
pub use target::is_standard_output;
pub use unfinished::abandon_unfinished;
