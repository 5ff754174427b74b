//! Output files appear whole or not at all: written beside their place, then renamed into it.
//!
//! A link is followed and its target replaced; `-` is standard output; a pipe or a device gets the
//! bytes as they come, since nothing can take them back. Several files that belong together go
//! through an [`OutputSet`](super::OutputSet).

use super::{Format, OutputSet};
use crate::progress::Cancelled;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

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
    /// The name of a folder was given where a file is written.
    #[error("cannot write {path:?}: it is a folder; name a file in it")]
    IsFolder {
        /// The folder.
        path: PathBuf,
    },
    /// Something else than a folder stands where a folder is written.
    #[error("cannot write the folder {path:?}: it is no folder; choose another name")]
    IsNoFolder {
        /// What stands there.
        path: PathBuf,
    },
    /// A folder of something else stands where one is written.
    #[error(
        "cannot replace the folder {path:?}: it holds {entry:?}, which horma did not write; choose another \
         name, or empty it yourself"
    )]
    IsElses {
        /// The folder.
        path: PathBuf,
        /// What it holds.
        entry: PathBuf,
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
    #[error("cannot write {path:?}: {source}{}", remedy(source))]
    System {
        /// The file that was to be written.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The caller asked to stop while the bytes were being made.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// Writes `path` through `fill`: whole, or not at all.
///
/// A `fill` that is asked to stop returns `std::io::Error::other(Cancelled)`; that comes back as
/// [`WriteError::Cancelled`].
pub fn write_file(
    path: &Path,
    overwrite: Overwrite,
    fill: impl FnOnce(&mut dyn Write) -> std::io::Result<()>,
) -> Result<(), WriteError> {
    let mut files = OutputSet::new(overwrite);
    files.add(path, fill)?;
    files.commit()
}

impl WriteError {
    /// What the system said about `path`, or the request to stop that is wrapped in it.
    pub(super) fn from_system(path: &Path, source: std::io::Error) -> Self {
        match source.get_ref().and_then(|inner| inner.downcast_ref::<Cancelled>()) {
            Some(&cancelled) => Self::Cancelled(cancelled),
            None => Self::System { path: path.into(), source },
        }
    }
}

fn remedy(source: &std::io::Error) -> &'static str {
    match source.kind() {
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded | ErrorKind::FileTooLarge => {
            "; make room or write somewhere else"
        }
        ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem => {
            "; choose a folder you may write in"
        }
        _ => "",
    }
}
