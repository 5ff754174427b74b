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
    #[error("cannot open {path:?}: {problem}")]
    Open {
        /// The file.
        path: PathBuf,
        /// What the system said.
        problem: std::io::Error,
    },
    /// What it holds is no program for the machine.
    #[error("{}: {problem}", path.display())]
    Content {
        /// The file.
        path: PathBuf,
        /// What is wrong, and where.
        problem: gcode::ReadError,
    },
}

/// Reads the program in `path` for `machine`, written in `dialect`.
pub fn read_program(
    path: &Path,
    machine: &Machine,
    dialect: &Dialect,
) -> Result<Program, ReadProgramError> {
    let file = File::open(path)
        .map_err(|problem| ReadProgramError::Open { path: path.into(), problem })?;
    gcode::read(&mut BufReader::new(file), machine, dialect)
        .map_err(|problem| ReadProgramError::Content { path: path.into(), problem })
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::machine::{Clamping, Mount, ToolChanges};

    /// A machine without axes: enough for programs that move nothing.
    fn still_machine() -> Machine {
        Machine {
            name: "still".into(),
            title: "without axes".into(),
            axes: Vec::new(),
            attack: 0,
            spindle: None,
            mount: Mount::Along,
            clamping: Clamping::Table,
            dialect: "linuxcnc".into(),
            default_tool: "none".into(),
            clearance: 0.0,
            blocks_per_second: 1000.0,
            tool_changes: ToolChanges::default(),
            look_ahead_blocks: None,
            obstacles: crate::machine::Obstacles::default(),
        }
    }

    #[test]
    fn a_program_is_written_and_read_again() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("still.ngc");
        let dialect = Dialect::named("linuxcnc").unwrap();
        let mut program = Program::for_machine(&still_machine(), &dialect);
        program.push(gcode::BlockKind::ToolChange(3));
        program.push(gcode::BlockKind::End);
        write_program(&path, Overwrite::Refuse, &program, &dialect).unwrap();
        let back = read_program(&path, &still_machine(), &dialect).unwrap();
        assert_eq!(back.blocks, program.blocks);
        let refusal = write_program(&path, Overwrite::Refuse, &program, &dialect).unwrap_err();
        assert!(matches!(refusal, WriteError::Exists { .. }), "{refusal}");
    }

    #[test]
    fn an_error_names_file_line_and_column() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("arc.ngc");
        std::fs::write(&path, "T1 M6\nG3 I5\n").unwrap();
        let dialect = Dialect::named("linuxcnc").unwrap();
        let message = read_program(&path, &still_machine(), &dialect).unwrap_err().to_string();
        let place = format!("{}: line 2, column 1: G3 arcs are not read yet", path.display());
        assert!(message.starts_with(&place), "{message}");
        let missing = read_program(&folder.path().join("none.ngc"), &still_machine(), &dialect);
        let message = missing.unwrap_err().to_string();
        assert!(message.starts_with("cannot open ") && message.contains("none.ngc"), "{message}");
    }
}
