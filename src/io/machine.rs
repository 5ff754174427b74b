//! Machine files, dialects and tool libraries from disk, or those that come with horma.

use crate::gcode::{Dialect, DialectError};
use crate::machine::{Machine, MachineError};
use crate::tool::{ToolError, ToolLibrary};
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

/// No description is longer; what is, is another file [bytes].
const LARGEST: u64 = 1 << 20;

/// Why a machine or a tool library could not be read.
#[derive(Debug, thiserror::Error)]
pub enum DescriptionError {
    /// The system refused.
    #[error(
        "cannot read {path:?}: {problem}; check the path (`horma machine list`, `horma dialect list` \
         and `horma tool list` name what needs none)"
    )]
    System {
        /// The file.
        path: PathBuf,
        /// What the system said.
        problem: std::io::Error,
    },
    /// The file is no description of anything.
    #[error("{path:?} is larger than 1 MiB: that is no machine, no dialect and no tool library")]
    TooLarge {
        /// The file.
        path: PathBuf,
    },
    /// The file is not text.
    #[error("{path:?} is no text file (byte {offset} is not UTF-8); descriptions are TOML")]
    NotText {
        /// The file.
        path: PathBuf,
        /// The first byte that is not text.
        offset: usize,
    },
    /// What it says makes no machine.
    #[error(transparent)]
    Machine(#[from] MachineError),
    /// What it says makes no tool library.
    #[error(transparent)]
    Tool(#[from] ToolError),
    /// What it says makes no dialect.
    #[error(transparent)]
    Dialect(#[from] DialectError),
}

/// The machine called `name_or_path`: one that comes with horma, or a file.
///
/// It is a file if it ends in `.toml`, has a path separator in it, or is there.
pub fn read_machine(name_or_path: &str) -> Result<Machine, DescriptionError> {
    if !is_path(name_or_path) {
        return Ok(Machine::builtin(name_or_path)?);
    }
    Ok(Machine::parse(&read_text(Path::new(name_or_path))?, name_or_path)?)
}

/// The text that describes the machine [`read_machine`] reads.
pub fn read_machine_text(name_or_path: &str) -> Result<String, DescriptionError> {
    if !is_path(name_or_path) {
        return Ok(Machine::builtin_text(name_or_path)?.to_owned());
    }
    read_text(Path::new(name_or_path))
}

/// The dialect called `name_or_path`: one that comes with horma, or a file, as for
/// [`read_machine`].
pub fn read_dialect(name_or_path: &str) -> Result<Dialect, DescriptionError> {
    Ok(Dialect::parse(&read_dialect_text(name_or_path)?, name_or_path)?)
}

/// The text that describes the dialect [`read_dialect`] reads.
pub fn read_dialect_text(name_or_path: &str) -> Result<String, DescriptionError> {
    if !is_path(name_or_path) {
        return Ok(Dialect::text_named(name_or_path)?.to_owned());
    }
    read_text(Path::new(name_or_path))
}

/// The tool library in the file `path`, or the one that comes with horma.
pub fn read_tools(path: Option<&Path>) -> Result<ToolLibrary, DescriptionError> {
    match path {
        None => Ok(ToolLibrary::builtin()),
        Some(path) => Ok(ToolLibrary::parse(&read_text(path)?, &path.display().to_string())?),
    }
}

fn is_path(name: &str) -> bool {
    let path = Path::new(name);
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("toml"))
        || name.contains(std::path::is_separator)
        || path.is_file()
}

fn read_text(path: &Path) -> Result<String, DescriptionError> {
    let system = |problem| DescriptionError::System { path: path.into(), problem };
    let mut bytes = Vec::new();
    // A device or pipe has no size to ask for: read, but not for ever.
    let mut file = File::open(path).map_err(system)?.take(LARGEST + 1);
    file.read_to_end(&mut bytes).map_err(system)?;
    if LARGEST < bytes.len() as u64 {
        return Err(DescriptionError::TooLarge { path: path.into() });
    }
    String::from_utf8(bytes).map_err(|error| DescriptionError::NotText {
        path: path.into(),
        offset: error.utf8_error().valid_up_to(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_machine_is_read_by_name_or_from_a_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("mine.toml");
        let text = read_machine_text("last-lathe").unwrap();
        std::fs::write(&path, text.replace("\"last-lathe\"", "\"mine\"")).unwrap();
        let mine = read_machine(path.to_str().unwrap()).unwrap();
        assert_eq!(mine.name, "mine");
        assert_eq!(
            Machine { name: "last-lathe".into(), ..mine },
            read_machine("last-lathe").unwrap()
        );
    }

    #[test]
    fn a_dialect_is_read_by_name_or_from_a_file_and_mistakes_have_a_place() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("mine.toml");
        let text = read_dialect_text("fanuc").unwrap();
        std::fs::write(&path, text.replace("\"fanuc\"", "\"mine\"")).unwrap();
        let mine = read_dialect(path.to_str().unwrap()).unwrap();
        assert_eq!(Dialect { name: "fanuc".into(), ..mine }, read_dialect("fanuc").unwrap());
        std::fs::write(&path, "nam = 1\n").unwrap();
        let message = read_dialect(path.to_str().unwrap()).unwrap_err().to_string();
        let place = format!("{}:1:1: unknown field `nam`", path.display());
        assert!(message.starts_with(&place), "{message}");
    }

    #[test]
    fn an_unknown_machine_is_answered_with_the_nearest_and_all_names() {
        assert_eq!(
            read_machine("last-lath").unwrap_err().to_string(),
            "no machine is called \"last-lath\" (did you mean \"last-lathe\"?); there are: \
             last-lathe, last-lathe-cone, last-lathe-pair, mill-rotary, mill-3axis, mill-5axis; \
             or give the path of a machine file"
        );
    }

    #[test]
    fn a_missing_file_is_named_with_what_to_do() {
        let message = read_machine("nowhere/lathe.toml").unwrap_err().to_string();
        assert!(message.starts_with("cannot read \"nowhere/lathe.toml\": "), "{message}");
        assert!(message.contains("; check the path (`horma machine list`,"), "{message}");
    }

    #[test]
    fn a_file_that_cannot_be_a_description_is_refused_before_it_is_understood() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("part.toml");
        std::fs::write(&path, b"name = \"\xff\"").unwrap();
        let message = read_tools(Some(&path)).unwrap_err().to_string();
        assert!(
            message.ends_with("is no text file (byte 8 is not UTF-8); descriptions are TOML"),
            "{message}"
        );
        std::fs::write(&path, vec![b' '; LARGEST as usize + 1]).unwrap();
        let message = read_tools(Some(&path)).unwrap_err().to_string();
        assert!(message.contains("is larger than 1 MiB"), "{message}");
    }

    #[test]
    fn an_error_in_a_file_names_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("shop.toml");
        std::fs::write(&path, "[[tool]]\nnumbr = 1\n").unwrap();
        let message = read_tools(Some(&path)).unwrap_err().to_string();
        let place = format!("{}:2:1: unknown field `numbr`", path.display());
        assert!(message.starts_with(&place), "{message}");
    }
}
