//! Programs as files.

use super::{Overwrite, WriteError, write_file};
use crate::gcode::{self, Dialect, Program};
use crate::machine::Machine;
use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};

/// Why a file is no program.
#[derive(Debug, thiserror::Error)]
pub enum ReadProgramError {
    /// The file cannot be opened.
    #[error("cannot open {path:?}: {source}")]
    Open {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// What it holds is no program for the machine.
    #[error("{}: {source}", path.display())]
    Content {
        /// The file.
        path: PathBuf,
        /// What is wrong, and where.
        source: gcode::ReadError,
    },
}

/// Reads the program in `path` for `machine`.
pub fn read_program(path: &Path, machine: &Machine) -> Result<Program, ReadProgramError> {
    let file =
        File::open(path).map_err(|source| ReadProgramError::Open { path: path.into(), source })?;
    gcode::read(&mut BufReader::new(file), machine)
        .map_err(|source| ReadProgramError::Content { path: path.into(), source })
}

/// Writes `program` to `path` as `dialect` wants it: whole, or not at all.
pub fn write_program(
    path: &Path,
    overwrite: Overwrite,
    program: &Program,
    dialect: &Dialect,
) -> Result<(), WriteError> {
    write_file(path, overwrite, |out| gcode::write(program, dialect, out))
}
