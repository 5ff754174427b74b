//! Folders to write into.

use super::WriteError;
use std::path::Path;

/// Makes `folder` if it is not there; the folder it stands in must be.
pub fn create_folder(folder: &Path) -> Result<(), WriteError> {
    if folder.is_dir() {
        return Ok(());
    }
    if let Some(parent) = folder.parent().filter(|parent| *parent != Path::new(""))
        && !parent.is_dir()
    {
        return Err(WriteError::NoFolder { path: folder.into(), folder: parent.into() });
    }
    std::fs::create_dir(folder).map_err(|source| WriteError::from_system(folder, source))
}
