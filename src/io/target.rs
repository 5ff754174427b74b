//! Where the bytes of an output go: a file, standard output, or a pipe or device.

use super::output::{Overwrite, WriteError};
use std::fs::{self, Permissions};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// Where the bytes of an output go.
pub(super) enum Target {
    /// The standard output of this process.
    StandardOutput,
    /// A pipe or a device: opened by its own name, never replaced.
    Stream,
    /// A file, there already or not.
    File {
        /// Its path once all links are followed.
        place: PathBuf,
        /// Those of the file that is there.
        permissions: Option<Permissions>,
    },
}

/// True if `path` is the standard output of this process, by any of its usual names: then nothing
/// else may be printed there.
pub fn is_standard_output(path: &Path) -> bool {
    ["-", "/dev/stdout", "/dev/fd/1", "/proc/self/fd/1"].iter().any(|name| path == Path::new(name))
}

/// The folder a path lies in.
pub(super) fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if parent != Path::new("") => parent,
        _ => Path::new("."),
    }
}

impl Target {
    /// What `path` leads to, or why it cannot be written.
    pub(super) fn of(path: &Path, overwrite: Overwrite) -> Result<Self, WriteError> {
        // A redirected standard output is a regular file by metadata; renaming over it would lose
        // what was printed there before and after.
        if is_standard_output(path) {
            return Ok(Self::StandardOutput);
        }
        match fs::metadata(path) {
            Ok(found) if found.is_dir() => Err(WriteError::IsFolder { path: path.into() }),
            Ok(found) if !found.is_file() => Ok(Self::Stream),
            Ok(_) if overwrite == Overwrite::Refuse => {
                Err(WriteError::Exists { path: path.into() })
            }
            Ok(found) => {
                Ok(Self::File { place: end_of_links(path), permissions: Some(found.permissions()) })
            }
            Err(error)
                if matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) =>
            {
                let place = end_of_links(path);
                let folder = folder_of(&place);
                if !folder.is_dir() {
                    return Err(WriteError::NoFolder { path: path.into(), folder: folder.into() });
                }
                Ok(Self::File { place, permissions: None })
            }
            Err(source) => Err(WriteError::System { path: path.into(), source }),
        }
    }
}

/// Follows links, also those whose target is not there yet. Loops never come here: the system has
/// refused them by then.
fn end_of_links(path: &Path) -> PathBuf {
    let mut place = path.to_owned();
    while let Ok(link) = fs::read_link(&place) {
        place = folder_of(&place).join(link);
    }
    place
}
