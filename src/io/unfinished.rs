//! Files under temporary names, known to the whole process so that none outlives it.

use super::output::Overwrite;
use super::target::folder_of;
use std::collections::BTreeSet;
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use tempfile::{NamedTempFile, TempDir, TempPath};

/// A file under a temporary name beside the place it is meant for; removed when dropped.
#[derive(Debug)]
pub(super) struct Unfinished {
    temporary: TempPath,
    place: PathBuf,
    _listed: Listed,
}

/// How often a folder that is still being filled is removed.
const N_TRIES: usize = 10;

/// Removes every unfinished output of this process, then calls `end` while nobody can begin or
/// finish another: for a process that is about to leave without unwinding.
pub fn abandon_unfinished(end: impl FnOnce()) {
    let _finishing = lock(&FINISHING);
    let unfinished = lock(&UNFINISHED);
    for path in unfinished.iter() {
        // Someone may have been quicker; there is nobody left to tell of anything else.
        let _ = if path.is_dir() { remove_folder(path) } else { fs::remove_file(path) };
    }
    end();
}

impl Unfinished {
    /// Begins a file for `place`, in the same folder so that a rename moves it there. It gets the
    /// permissions of any new file.
    pub(super) fn beside(place: &Path) -> io::Result<(Self, File)> {
        let made =
            tempfile::Builder::new().prefix(".horma-").make_in(folder_of(place), |path| {
                let mut unfinished = lock(&UNFINISHED);
                let file = File::create_new(path)?;
                unfinished.insert(path.to_owned());
                Ok(file)
            })?;
        let (file, temporary) = made.into_parts();
        let listed = Listed(temporary.to_path_buf());
        Ok((Self { temporary, place: place.to_owned(), _listed: listed }, file))
    }
}

/// Removes a folder that others may still be writing files into.
fn remove_folder(path: &Path) -> io::Result<()> {
    let mut removed = Ok(());
    for _ in 0..N_TRIES {
        removed = fs::remove_dir_all(path);
        if removed.is_ok() {
            break;
        }
    }
    removed
}

/// A folder under a temporary name beside the place it is meant for; removed when dropped.
#[derive(Debug)]
pub(super) struct UnfinishedFolder {
    /// Holds the folder itself, which has the permissions of any new one (the temporary one has not),
    /// and later what stood in its place before.
    around: TempDir,
    _listed: Listed,
}

impl UnfinishedFolder {
    const NEW: &str = "new";
    const OLD: &str = "old";

    /// Begins a folder for `place`, on the same file system so that a rename moves it there.
    pub(super) fn beside(place: &Path) -> io::Result<Self> {
        let mut unfinished = lock(&UNFINISHED);
        let around = tempfile::Builder::new().prefix(".horma-").tempdir_in(folder_of(place))?;
        unfinished.insert(around.path().to_owned());
        drop(unfinished);
        let listed = Listed(around.path().to_owned());
        fs::create_dir(around.path().join(Self::NEW))?;
        Ok(Self { around, _listed: listed })
    }

    /// Where it lies for now.
    pub(super) fn path(&self) -> PathBuf {
        self.around.path().join(Self::NEW)
    }

    /// Renames it to `place`; a folder that stands there goes, or comes back if the rename fails.
    pub(super) fn finish(self, place: &Path) -> io::Result<()> {
        let _finishing = lock(&FINISHING);
        let older = self.around.path().join(Self::OLD);
        let had_older = place.is_dir();
        if had_older {
            fs::rename(place, &older)?;
        }
        fs::rename(self.path(), place).inspect_err(|_| {
            if had_older {
                // The failure that led here is the one to tell.
                let _ = fs::rename(&older, place);
            }
        })
    }
}

/// Renames all `files` to their places, or none: on failure says which one the system refused.
pub(super) fn finish(
    files: Vec<Unfinished>,
    overwrite: Overwrite,
) -> Result<(), (usize, io::Error)> {
    // A second Ctrl-C waits for this; else it could end the process between two renames.
    let _finishing = lock(&FINISHING);
    let alone = files.len() == 1;
    let mut done = Vec::with_capacity(files.len());
    for (i_file, Unfinished { temporary, place, _listed }) in files.into_iter().enumerate() {
        let renamed = match overwrite {
            Overwrite::Refuse => rename_new(temporary, &place).map(|()| None),
            // A rename alone is atomic; only several need a way back.
            Overwrite::Replace if alone => {
                temporary.persist(&place).map(|()| None).map_err(|error| error.error)
            }
            Overwrite::Replace => older_copy(&place).and_then(|older| {
                temporary.persist(&place).map(|()| older).map_err(|error| error.error)
            }),
        };
        match renamed {
            Ok(older) => done.push((place, older)),
            Err(error) => {
                take_back(done);
                return Err((i_file, error));
            }
        }
    }
    Ok(())
}

/// Renames to a place where nothing is yet.
fn rename_new(temporary: TempPath, place: &Path) -> io::Result<()> {
    match temporary.persist_noclobber(place) {
        // Some sticks and network folders cannot refuse and rename in one step.
        Err(refused) if refused.error.kind() != io::ErrorKind::AlreadyExists && !place.exists() => {
            refused.path.persist(place).map_err(|error| error.error)
        }
        renamed => renamed.map_err(|error| error.error),
    }
}

/// A second name for the file at `place`, removed when dropped; `None` if there is no file.
fn older_copy(place: &Path) -> io::Result<Option<NamedTempFile<()>>> {
    if !place.is_file() {
        return Ok(None);
    }
    // Memory sticks, on which programs travel to machines, know no second names.
    let again = |copy: &Path| match fs::hard_link(place, copy) {
        Err(error) if error.kind() != io::ErrorKind::AlreadyExists => {
            fs::copy(place, copy).map(drop)
        }
        linked => linked,
    };
    tempfile::Builder::new().prefix(".horma-").make_in(folder_of(place), again).map(Some)
}

/// Puts back what stood at each place before.
fn take_back(done: Vec<(PathBuf, Option<NamedTempFile<()>>)>) {
    for (place, older) in done.into_iter().rev() {
        // The failure that led here is the one to tell.
        let _ = match older {
            Some(older) => older.persist(&place).map_err(|error| error.error),
            None => fs::remove_file(&place),
        };
    }
}

/// The temporary files that exist now.
static UNFINISHED: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());
/// Held while files get their own names.
static FINISHING: Mutex<()> = Mutex::new(());

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// An entry of [`UNFINISHED`], taken out when dropped.
#[derive(Debug)]
struct Listed(PathBuf);

impl Drop for Listed {
    fn drop(&mut self) {
        lock(&UNFINISHED).remove(&self.0);
    }
}
