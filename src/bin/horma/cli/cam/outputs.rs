//! The files a job writes: its program, whole or in parts, and what is told of it.

use super::file_name;
use crate::cli::simulated::{NOT_SIMULATED, Told, Tried};
use horma::io::report::{cam_page, html, with_cut};
use horma::io::{self, OutputSet, Overwrite};
use horma::workflow::cam::Plan;
use std::path::{Path, PathBuf};

/// The files a job writes.
#[derive(Debug)]
pub(in crate::cli) struct Outputs {
    /// The program.
    pub(super) program: PathBuf,
    /// The program goes where no report can follow: standard output.
    pub(super) is_stream: bool,
}

impl Outputs {
    /// Refuses names that cannot be written before hours are spent on what goes there.
    pub(in crate::cli) fn checked(program: &Path, overwrite: Overwrite) -> anyhow::Result<Self> {
        let outputs = Self { program: program.into(), is_stream: io::is_standard_output(program) };
        if !outputs.is_stream {
            let mut trial = OutputSet::new(overwrite);
            for path in outputs.paths() {
                trial.add(&path, |_| Ok(()))?;
            }
        }
        Ok(outputs)
    }

    /// Adds program and reports to what is written together; the reports with what the simulation
    /// found, if there was one.
    pub(in crate::cli) fn add_to(
        &self,
        files: &mut OutputSet,
        planned: &Plan,
        tried: Option<&Tried>,
    ) -> anyhow::Result<()> {
        let [_, json, page] = self.paths();
        for (path, text) in self.programs(planned) {
            files.add(&path, |out| out.write_all(text))?;
        }
        if !self.is_stream {
            let report = serde_json::to_vec_pretty(&Told::new(planned, tried))?;
            let mut shown = cam_page(&planned.report, planned.scene.as_ref())?;
            match tried {
                Some(Ok(verified)) => shown = with_cut(shown, verified)?,
                Some(Err(why)) => shown.warnings.insert(0, format!("{NOT_SIMULATED}: {why}")),
                None => {}
            }
            let shown = html(&shown);
            files.add(&json, |out| out.write_all(&report))?;
            files.add(&page, |out| out.write_all(shown.as_bytes()))?;
        }
        Ok(())
    }

    /// What the program is called.
    pub(super) fn name(&self) -> String {
        file_name(&self.program)
    }

    /// The program, or the part of it that runs first.
    pub(in crate::cli) fn first(&self, planned: &Plan) -> String {
        let programs = self.programs(planned);
        programs.first().map_or(&self.program, |(path, _)| path).display().to_string()
    }

    /// All files, as people are told of them.
    pub(in crate::cli) fn told(&self, planned: &Plan) -> Vec<String> {
        let [_, json, page] = self.paths();
        let programs = self.programs(planned);
        let programs = programs.iter().map(|(path, _)| path.display().to_string());
        let page = format!("{}  (open it in a browser)", page.display());
        programs.chain([json.display().to_string(), page]).collect()
    }

    fn paths(&self) -> [PathBuf; 3] {
        let report = |extension| self.program.with_extension(extension);
        [self.program.clone(), report("report.json"), report("report.html")]
    }

    /// The program, or its parts in files with numbers of their own; a stream takes it whole.
    fn programs<'a>(&self, planned: &'a Plan) -> Vec<(PathBuf, &'a [u8])> {
        if planned.parts.is_empty() || self.is_stream {
            return vec![(self.program.clone(), &planned.text)];
        }
        let parts = (1..).zip(&planned.parts);
        parts.map(|(number, text)| (self.part(number), text.as_slice())).collect()
    }

    /// `last.nc` becomes `last-1.nc`.
    fn part(&self, number: usize) -> PathBuf {
        let stem = self.program.file_stem().unwrap_or_default().to_string_lossy();
        let name = format!("{stem}-{number}");
        match self.program.extension() {
            Some(extension) => {
                self.program.with_file_name(format!("{name}.{}", extension.to_string_lossy()))
            }
            None => self.program.with_file_name(name),
        }
    }
}
