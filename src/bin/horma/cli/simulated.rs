//! A program just made, cut in simulation for its own report.

use anyhow::Context;
use horma::gcode::{self, Dialect};
use horma::geom::Surface;
use horma::io::report::verify_summary;
use horma::machine::Machine;
use horma::progress::Progress;
use horma::tool::Tool;
use horma::workflow::cam::{CamOptions, CamReport, Plan};
use horma::workflow::verify::{RawBlock, Verified, VerifyJob, VerifyOptions, VerifyReport, verify};
use serde::Serialize;

/// All that cutting a plan in simulation takes besides the plan.
pub(super) struct Cutting<'a> {
    /// What the program is called: most often its file.
    pub(super) program_name: String,
    pub(super) surface: Surface,
    pub(super) machine: &'a Machine,
    pub(super) dialect: &'a Dialect,
    pub(super) tool: Tool,
    pub(super) options: &'a CamOptions,
    /// How far apart the stock is looked at [mm].
    pub(super) resolution: f64,
}

impl Cutting<'_> {
    /// Reads the program back and runs it on `block`.
    pub(super) fn run(
        self,
        planned: &Plan,
        block: RawBlock,
        progress: &dyn Progress,
    ) -> anyhow::Result<Verified> {
        let context = format!("while cutting {} in simulation", self.program_name);
        let program = gcode::read(&mut planned.text.as_slice(), self.machine, self.dialect)?;
        let job = VerifyJob {
            program_name: self.program_name,
            program: &program,
            part_name: planned.report.part.name.clone(),
            surface: self.surface,
            notes: Vec::new(),
            machine: self.machine,
            tools: vec![self.tool],
            setup: self.options,
            block,
            options: &VerifyOptions { resolution: Some(self.resolution), tolerance: None },
        };
        verify(job, progress).context(context)
    }
}

/// What a job tells programs: its report, with what the simulation found, if there was one.
#[derive(Debug, Serialize)]
pub(super) struct Told<'a> {
    #[serde(flatten)]
    planned: &'a CamReport,
    #[serde(skip_serializing_if = "Option::is_none")]
    verified: Option<&'a VerifyReport>,
}

impl<'a> Told<'a> {
    pub(super) fn new(planned: &'a Plan, verified: Option<&'a Verified>) -> Self {
        Self { planned: &planned.report, verified: verified.map(|verified| &verified.report) }
    }

    /// The simulation for people; nothing if there was none.
    pub(super) fn in_words(&self) -> String {
        self.verified.map_or_else(String::new, |found| format!("\n{}", verify_summary(found)))
    }
}
