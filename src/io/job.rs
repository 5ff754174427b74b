//! Job files: a `horma cam` call as TOML, to be kept and repeated.

use crate::geom::LengthUnit;
use crate::workflow::cam::CamOptions;
use serde::Deserialize;
use std::path::{Path, PathBuf};

/// The largest job file read [bytes].
const LARGEST: u64 = 1 << 20;

/// What a job file says; everything may be left to the command line. Paths are relative to the
/// file's own folder.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(default, rename_all = "kebab-case", deny_unknown_fields)]
pub struct JobFile {
    /// The part.
    pub part: Option<PathBuf>,
    /// The unit of the part's file.
    pub units: Option<LengthUnit>,
    /// The machine: a name, or a machine file.
    pub machine: Option<String>,
    /// A tool library.
    pub tools: Option<PathBuf>,
    /// Where the program goes.
    pub output: Option<PathBuf>,
    /// How the part is cut.
    pub options: CamOptions,
}

/// Why a job file cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum JobError {
    /// It cannot be read.
    #[error("cannot read the job file {path:?}: {problem}")]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        problem: std::io::Error,
    },
    /// It is no job file: far too large.
    #[error("the job file {path:?} has {bytes} bytes; a job file has a few lines")]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// Its size.
        bytes: u64,
    },
    /// It says something that is no job.
    #[error("the job file {path:?} cannot be used: {problem}")]
    Content {
        /// The file.
        path: PathBuf,
        /// What is wrong, with line and column.
        problem: Box<toml::de::Error>,
    },
}

/// Reads the job file at `path`.
pub fn read_job(path: &Path) -> Result<JobFile, JobError> {
    let unreadable = |problem| JobError::Read { path: path.into(), problem };
    let bytes = std::fs::metadata(path).map_err(unreadable)?.len();
    if bytes > LARGEST {
        return Err(JobError::TooLarge { path: path.into(), bytes });
    }
    let text = std::fs::read_to_string(path).map_err(unreadable)?;
    let mut job: JobFile = toml::from_str(&text)
        .map_err(|problem| JobError::Content { path: path.into(), problem: Box::new(problem) })?;
    let folder = path.parent().unwrap_or(Path::new(""));
    for named in [&mut job.part, &mut job.tools, &mut job.output] {
        *named = named.take().map(|path| folder.join(path));
    }
    if let Some(machine) = &mut job.machine
        && Path::new(machine).extension().is_some_and(|extension| extension == "toml")
    {
        *machine = folder.join(&*machine).to_string_lossy().into_owned();
    }
    Ok(job)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<JobFile, JobError> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("job.toml");
        std::fs::write(&path, text).unwrap();
        read_job(&path)
    }

    #[test]
    fn a_job_file_is_a_call_with_paths_of_its_own_folder() {
        let job = read("part = \"foot.stl\"\nunits = \"m\"\n[options]\npitch = 1\nmirror = true\n");
        let job = job.unwrap();
        assert!(job.part.unwrap().is_absolute());
        assert_eq!((job.options.pitch, job.options.mirror), (Some(1.0), true));
    }

    #[test]
    fn an_unknown_key_is_refused_by_name_and_line() {
        let error = read("part = \"foot.stl\"\n[options]\npich = 1\n").unwrap_err().to_string();
        assert!(error.contains("line 3") && error.contains("pich"), "{error}");
        assert!(error.contains("points-per-turn"), "{error}");
    }
}
