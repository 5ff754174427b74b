//! A program just made, cut in simulation for its own report.

use anyhow::Context;
use horma::cam::Block;
use horma::gcode::{self, Dialect};
use horma::geom::Surface;
use horma::io::report::verify_summary;
use horma::machine::Machine;
use horma::progress::Progress;
use horma::stock::Stock;
use horma::tool::Tool;
use horma::workflow::cam::{CamOptions, CamReport, Plan};
use horma::workflow::verify::{RawBlock, Verified, VerifyJob, VerifyOptions, VerifyReport, verify};
use serde::Serialize;

/// How a report begins to say why there is no simulation in it.
pub(super) const NOT_SIMULATED: &str = "the program is not cut in simulation";

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
}

/// What came of a simulation: what it found, or why it could not be.
pub(super) type Tried = Result<Verified, String>;

impl Cutting<'_> {
    /// Cuts one program after the other: the first from its block as it came out, else from `asked`
    /// or the part with the stock that is assumed on it, and then from what the one before left.
    /// That one cannot be simulated is told, and spoils nothing that was made before.
    pub(super) fn run(
        &self,
        trials: Vec<Trial>,
        asked: Option<&Block>,
        progress: &dyn Progress,
    ) -> anyhow::Result<Vec<Tried>> {
        let mut left: Result<Option<Stock>, String> = Ok(None);
        let mut all = Vec::new();
        for trial in trials {
            let tried = match left {
                Ok(Some(stock)) => self.try_on(trial, RawBlock::Left(Box::new(stock)), progress)?,
                Ok(None) => {
                    let block = block_of(trial.plan, asked)?;
                    self.try_on(trial, block, progress)?
                }
                Err(why) => Err(why),
            };
            left = match &tried {
                Ok(found) => Ok(Some(found.stock.clone())),
                Err(why) => Err(format!("nobody knows what the program before it left ({why})")),
            };
            all.push(tried);
        }
        Ok(all)
    }

    /// Reads a program back and runs it on its block.
    fn try_on(
        &self,
        trial: Trial,
        block: RawBlock,
        progress: &dyn Progress,
    ) -> anyhow::Result<Tried> {
        let Trial { name, plan, tools } = trial;
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
        match verify(job, progress) {
            Err(problem) if problem.is_cancelled() => Err(problem).context(context),
            tried => Ok(tried.map_err(|problem| problem.to_string())),
        }
    }
}

fn block_of(plan: &Plan, asked: Option<&Block>) -> anyhow::Result<RawBlock> {
    let shape = plan.report.rough.as_ref().and_then(|rough| rough.shape.as_deref());
    Ok(match (shape, asked) {
        (Some(shape), _) => RawBlock::Body(shape.parse()?),
        (None, Some(body)) => RawBlock::Body(body.clone()),
        (None, None) => RawBlock::Grown(plan.report.stock),
    })
}

/// What a job tells programs: its report, with what the simulation found, if there was one.
#[derive(Debug, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(super) struct Told<'a> {
    #[serde(flatten)]
    planned: &'a CamReport,
    #[serde(skip_serializing_if = "Option::is_none")]
    verified: Option<&'a VerifyReport>,
    /// Why it could not be simulated.
    #[serde(skip_serializing_if = "Option::is_none")]
    not_verified: Option<&'a str>,
}

impl<'a> Told<'a> {
    pub(super) fn new(planned: &'a Plan, tried: Option<&'a Tried>) -> Self {
        Self {
            planned: &planned.report,
            verified: tried.and_then(|tried| tried.as_ref().ok()).map(|verified| &verified.report),
            not_verified: tried.and_then(|tried| tried.as_ref().err()).map(String::as_str),
        }
    }

    /// The simulation for people; nothing if none was asked for.
    pub(super) fn in_words(&self) -> String {
        match (self.verified, self.not_verified) {
            (Some(found), _) => format!("\n{}", verify_summary(found)),
            (None, Some(why)) => format!("\nfault       {NOT_SIMULATED}: {why}\n"),
            (None, None) => String::new(),
        }
    }

    /// What speaks against the program, if anything does: the first of it.
    pub(super) fn fault(&self) -> Option<String> {
        let why = self.not_verified.map(|why| format!("{NOT_SIMULATED}: {why}"));
        why.or_else(|| self.verified.and_then(|found| found.faults.first().cloned()))
    }
}
