//! Output files appear whole or not at all: written beside their place, then renamed into it.

use super::Format;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// What to do with a file that is already there.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Overwrite {
    /// Leave it alone and fail.
    Refuse,
    /// Replace it.
    Replace,
}

/// Why an output could not be written.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// The folder to write into is not there.
    #[error(
        "cannot write {path:?}: the folder {folder:?} does not exist; create it or choose another"
    )]
    NoFolder {
        /// The file that was to be written.
        path: PathBuf,
        /// The missing folder.
        folder: PathBuf,
    },
    /// Something is already there.
    #[error("{path:?} exists already; choose another name or overwrite it with --force")]
    Exists {
        /// The file that was to be written.
        path: PathBuf,
    },
    /// The name does not tell a format.
    #[error(
        "cannot write {path:?}: its extension is none of those horma writes ({}); choose one",
        Format::WRITTEN_EXTENSIONS
    )]
    UnknownExtension {
        /// The file that was to be written.
        path: PathBuf,
    },
    /// The format has no place for such a surface.
    #[error("cannot write {path:?}: {format} cannot hold a {kind}; choose {remedy}")]
    CannotHold {
        /// The file that was to be written.
        path: PathBuf,
        /// The format.
        format: Format,
        /// What was to be written.
        kind: &'static str,
        /// The extensions that can.
        remedy: &'static str,
    },
    /// The system refused: disk full, no permission.
    #[error("cannot write {path:?}: {source}; nothing was left behind")]
    System {
        /// The file that was to be written.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
}

/// Writes `path` through `fill`: whole, or not at all.
pub fn write_file(
    path: &Path,
    overwrite: Overwrite,
    fill: impl FnOnce(&mut dyn Write) -> std::io::Result<()>,
) -> Result<(), WriteError> {
    let folder = match path.parent() {
        Some(parent) if parent != Path::new("") => parent,
        _ => Path::new("."),
    };
    if !folder.is_dir() {
        return Err(WriteError::NoFolder { path: path.into(), folder: folder.into() });
    }
    if overwrite == Overwrite::Refuse && path.exists() {
        return Err(WriteError::Exists { path: path.into() });
    }
    let system = |source| WriteError::System { path: path.into(), source };
    let temporary = NamedTempFile::new_in(folder).map_err(system)?;
    let mut writer = BufWriter::new(temporary);
    fill(&mut writer).and_then(|()| writer.flush()).map_err(system)?;
    let temporary = writer.into_inner().map_err(|error| system(error.into_error()))?;
    temporary.as_file().sync_all().map_err(system)?;
    temporary.persist(path).map_err(|error| system(error.error))?;
    Ok(())
}
