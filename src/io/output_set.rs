//! Files that belong together: a program and its reports appear all at once, or none of them does.

use super::output::{Overwrite, WriteError};
use super::target::Target;
use super::unfinished::{self, Unfinished};
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

/// Output files written under temporary names until [`OutputSet::commit`] gives them their own.
///
/// Dropped without a commit, it leaves nothing behind and every older file as it was. A pipe or a
/// device is the exception: it got its bytes when it was added.
#[derive(Debug)]
pub struct OutputSet {
    overwrite: Overwrite,
    files: Vec<(PathBuf, Unfinished)>,
}

impl OutputSet {
    /// An empty set; `overwrite` holds for every file added to it.
    pub fn new(overwrite: Overwrite) -> Self {
        Self { overwrite, files: Vec::new() }
    }

    /// Writes the bytes of `path` through `fill`, under a temporary name in the same folder.
    pub fn add(
        &mut self,
        path: &Path,
        fill: impl FnOnce(&mut dyn Write) -> std::io::Result<()>,
    ) -> Result<(), WriteError> {
        let system = |source| WriteError::from_system(path, source);
        match Target::of(path, self.overwrite)? {
            Target::StandardOutput => {
                let mut out = std::io::stdout().lock();
                fill(&mut out).and_then(|()| out.flush()).map_err(system)
            }
            Target::Stream => {
                let stream = File::options().write(true).open(path).map_err(system)?;
                filled(stream, fill).map(drop).map_err(system)
            }
            Target::File { place, permissions } => {
                let (unfinished, file) = Unfinished::beside(&place).map_err(system)?;
                let file = filled(file, fill).map_err(system)?;
                if let Some(permissions) = permissions {
                    file.set_permissions(permissions).map_err(system)?;
                }
                file.sync_all().map_err(system)?;
                self.files.push((path.into(), unfinished));
                Ok(())
            }
        }
    }

    /// Gives every file its own name. If one of them cannot have it, the others are taken back
    /// and what stood there before stands there again.
    pub fn commit(self) -> Result<(), WriteError> {
        let (paths, files): (Vec<_>, Vec<_>) = self.files.into_iter().unzip();
        unfinished::finish(files, self.overwrite).map_err(|(i_file, source)| {
            let path = &paths[i_file];
            match source.kind() {
                std::io::ErrorKind::AlreadyExists => WriteError::Exists { path: path.clone() },
                _ => WriteError::from_system(path, source),
            }
        })
    }
}

fn filled(
    file: File,
    fill: impl FnOnce(&mut dyn Write) -> std::io::Result<()>,
) -> std::io::Result<File> {
    let mut writer = BufWriter::with_capacity(1 << 16, file);
    fill(&mut writer)?;
    writer.into_inner().map_err(std::io::IntoInnerError::into_error)
}
