//! A folder of many files that appears whole or not at all.

use super::output::{Overwrite, WriteError};
use super::target::folder_of;
use super::unfinished::UnfinishedFolder;
use std::fs::{self, File};
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

/// A folder written under a temporary name until [`OutputFolder::commit`] gives it its own. Dropped
/// without a commit, it leaves nothing behind and an older folder as it was.
#[derive(Debug)]
pub(super) struct OutputFolder {
    path: PathBuf,
    overwrite: Overwrite,
    content: &'static [&'static str],
    unfinished: UnfinishedFolder,
}

impl OutputFolder {
    /// Begins a folder called `path`. An older one is replaced if that is allowed, and only if it holds
    /// nothing but entries named in `content`: a slip of the hand must not cost a home folder.
    pub(super) fn begin(
        path: &Path,
        overwrite: Overwrite,
        content: &'static [&'static str],
    ) -> Result<Self, WriteError> {
        may_be_replaced(path, overwrite, content)?;
        let parent = folder_of(path);
        if !parent.is_dir() {
            return Err(WriteError::NoFolder { path: path.into(), folder: parent.into() });
        }
        let system = |source| WriteError::from_system(path, source);
        let unfinished = UnfinishedFolder::beside(path).map_err(system)?;
        Ok(Self { path: path.into(), overwrite, content, unfinished })
    }

    /// Makes a folder in it.
    pub(super) fn create_folder(&self, name: &str) -> Result<(), WriteError> {
        let system = |source| WriteError::from_system(&self.path.join(name), source);
        fs::create_dir(self.unfinished.path().join(name)).map_err(system)
    }

    /// Writes a file in it through `fill`.
    pub(super) fn write(
        &self,
        name: &str,
        fill: impl FnOnce(&mut dyn Write) -> std::io::Result<()>,
    ) -> Result<(), WriteError> {
        let write = || {
            let mut out = BufWriter::new(File::create_new(self.unfinished.path().join(name))?);
            fill(&mut out)?;
            out.flush()
        };
        write().map_err(|source| WriteError::from_system(&self.path.join(name), source))
    }

    /// Gives the folder its name; what an older one held goes.
    pub(super) fn commit(self) -> Result<(), WriteError> {
        // Someone may have put something there meanwhile.
        may_be_replaced(&self.path, self.overwrite, self.content)?;
        let system = |source| WriteError::from_system(&self.path, source);
        self.unfinished.finish(&self.path).map_err(system)
    }
}

fn may_be_replaced(path: &Path, overwrite: Overwrite, content: &[&str]) -> Result<(), WriteError> {
    let Ok(found) = fs::symlink_metadata(path) else { return Ok(()) };
    if overwrite == Overwrite::Refuse {
        return Err(WriteError::Exists { path: path.into() });
    }
    if !found.is_dir() {
        return Err(WriteError::IsNoFolder { path: path.into() });
    }
    let system = |source| WriteError::from_system(path, source);
    for entry in fs::read_dir(path).map_err(system)? {
        let name = entry.map_err(system)?.file_name();
        if !content.iter().any(|known| name == **known) {
            return Err(WriteError::IsElses { path: path.into(), entry: name.into() });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    const CONTENT: [&str; 2] = ["a.txt", "b"];

    fn written(path: &Path, overwrite: Overwrite, text: &str) -> Result<(), WriteError> {
        let folder = OutputFolder::begin(path, overwrite, &CONTENT)?;
        folder.create_folder("b")?;
        folder.write("a.txt", |out| out.write_all(text.as_bytes()))?;
        folder.write("b/c.txt", |out| out.write_all(text.as_bytes()))?;
        folder.commit()
    }

    fn names_in(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name());
        let mut names: Vec<_> = entries.map(|name| name.into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn a_folder_is_there_whole_or_not_at_all() {
        let around = tempfile::tempdir().unwrap();
        let path = around.path().join("scan");
        let folder = OutputFolder::begin(&path, Overwrite::Refuse, &CONTENT).unwrap();
        folder.write("a.txt", |out| out.write_all(b"half")).unwrap();
        assert!(!path.exists());
        drop(folder);
        assert_eq!(names_in(around.path()), [""; 0]);
        written(&path, Overwrite::Refuse, "one").unwrap();
        assert_eq!(names_in(around.path()), ["scan"]);
        assert_eq!(names_in(&path), ["a.txt", "b"]);
        assert_eq!(fs::read(path.join("b/c.txt")).unwrap(), b"one");
    }

    #[test]
    fn an_older_folder_is_replaced_only_if_that_is_allowed_and_it_holds_nothing_else() {
        let around = tempfile::tempdir().unwrap();
        let path = around.path().join("scan");
        written(&path, Overwrite::Refuse, "one").unwrap();
        let told = written(&path, Overwrite::Refuse, "two").unwrap_err().to_string();
        assert!(told.contains("exists already") && told.contains("--force"), "{told}");
        written(&path, Overwrite::Replace, "two").unwrap();
        assert_eq!(fs::read(path.join("a.txt")).unwrap(), b"two");
        fs::write(path.join("letter.txt"), "dear").unwrap();
        let told = written(&path, Overwrite::Replace, "three").unwrap_err().to_string();
        assert!(told.contains("it holds \"letter.txt\""), "{told}");
        assert_eq!(fs::read(path.join("a.txt")).unwrap(), b"two");
        assert_eq!(names_in(around.path()), ["scan"]);
    }

    #[test]
    fn a_file_is_not_replaced_by_a_folder_and_a_missing_parent_is_named() {
        let around = tempfile::tempdir().unwrap();
        let path = around.path().join("scan");
        fs::write(&path, "x").unwrap();
        let told = written(&path, Overwrite::Replace, "one").unwrap_err().to_string();
        assert!(told.contains("it is no folder"), "{told}");
        let told = written(&around.path().join("no/scan"), Overwrite::Refuse, "").unwrap_err();
        assert!(told.to_string().contains("does not exist"), "{told}");
    }

    #[cfg(unix)]
    #[test]
    fn a_new_folder_has_the_mode_of_any_new_folder() {
        use std::os::unix::fs::PermissionsExt;
        let around = tempfile::tempdir().unwrap();
        let (ours, plain) = (around.path().join("ours"), around.path().join("plain"));
        written(&ours, Overwrite::Refuse, "one").unwrap();
        fs::create_dir(&plain).unwrap();
        let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode();
        assert_eq!(mode(&ours), mode(&plain));
    }
}
