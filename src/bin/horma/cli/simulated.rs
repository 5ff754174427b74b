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

/// All that cutting plans in simulation takes besides the plans.
pub(super) struct Cutting<'a> {
    pub(super) surface: Surface,
    pub(super) machine: &'a Machine,
    pub(super) dialect: &'a Dialect,
    pub(super) options: &'a CamOptions,
    /// How far apart the stock is looked at [mm].
    pub(super) resolution: f64,
}

/// A program to cut in simulation.
pub(super) struct Trial<'a> {
    /// What it is called: most often its file.
    pub(super) name: String,
    pub(super) plan: &'a Plan,
    pub(super) tools: Vec<Tool>,
    pub(super) block: RawBlock,
}

impl Cutting<'_> {
    /// Reads the program back and runs it on its block.
    pub(super) fn run(&self, trial: Trial, progress: &dyn Progress) -> anyhow::Result<Verified> {
        let Trial { name, plan, tools, block } = trial;
        let context = format!("while cutting {name} in simulation");
        let program = gcode::read(&mut plan.text.as_slice(), self.machine, self.dialect)?;
        let job = VerifyJob {
            program_name: name,
            program: &program,
            part_name: plan.report.part.name.clone(),
            surface: self.surface.clone(),
            notes: Vec::new(),
            machine: self.machine,
            tools,
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
