//! Files in and out.

mod output;
mod program;

pub use output::{Overwrite, WriteError, write_file};
pub use program::{ReadProgramError, read_program, write_program};

/// The machine called `name`. A stand-in until machine files are read: it knows none.
pub fn read_machine(name: &str) -> Result<crate::machine::Machine, UnknownMachine> {
    Err(UnknownMachine(name.to_owned()))
}

/// No machine has that name.
#[derive(Debug, thiserror::Error)]
#[error("no machine is called {0:?}")]
pub struct UnknownMachine(String);
