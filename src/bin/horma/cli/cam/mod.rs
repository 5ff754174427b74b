//! `horma cam`: from a part to a program, with its report.

mod order;
mod outputs;

pub(super) use outputs::Outputs;

use super::Shell;
use super::simulated::{Told, Trial, Tried};
use super::table::listed;
use anyhow::bail;
use clap::Args;
use horma::geom::LengthUnit;
use horma::io::report::cam_summary;
use horma::io::{self, OutputSet, Reading};
use horma::tool::Tool;
use horma::workflow::cam::{CamOptions, Plan};
use order::Order;
use std::path::{Path, PathBuf};

/// Compute the program that cuts a part, and a report beside it.
#[derive(Debug, Args)]
#[command(after_help = "Writes OUTPUT, OUTPUT with .report.json and OUTPUT with .report.html.

For example:
  horma cam last.stl -m last-lathe -o last.ngc
  horma cam last.stl -m last-lathe --mirror --scallop 0.03 --allowance 1 -o right.ngc
  horma cam last.stl -m last-lathe --verify -o last.ngc
  horma cam last.stl -m mill-rotary --rough-with flat-12 --block cylinder:60 -o last.ngc
  horma cam --job last.toml")]
pub(crate) struct CamArgs {
    /// The part: STL, PLY, OBJ, glTF/GLB, PCD, points or a section grid.
    part: Option<PathBuf>,
    /// The machine: a name (`horma machine list`) or a machine file.
    #[arg(long, short, value_name = "MACHINE")]
    machine: Option<String>,
    /// Where the program goes; - for standard output, without reports.
    #[arg(long, short, value_name = "FILE")]
    output: Option<PathBuf>,
    /// The unit of the part's file [default: what it declares, else by its extent].
    #[arg(long, value_name = "UNIT")]
    units: Option<LengthUnit>,
    /// A tool library to look tools up in [default: the built-in one].
    #[arg(long, value_name = "FILE")]
    tools: Option<PathBuf>,
    /// A job file that says what the command line does not.
    #[arg(long, value_name = "FILE")]
    job: Option<PathBuf>,
    /// Cut the program in simulation, and show in the report what it leaves and how far that is from
    /// the part; the stock is looked at so finely [mm; default: 0.25].
    #[arg(
        long,
        value_name = "MM",
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = "0.25"
    )]
    verify: Option<f64>,
    /// Leave the pictures out of the report: less time and memory.
    #[arg(long)]
    no_pictures: bool,
    /// Replace outputs that are there already.
    #[arg(long)]
    force: bool,
    #[command(flatten)]
    options: CamOptions,
}

/// Plans the cut and writes the program and its reports: all of them, or none.
pub(crate) fn run(args: &CamArgs, shell: &Shell) -> anyhow::Result<()> {
    run_for(Aim::Finish, args, shell)
}

/// What is asked for.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Aim {
    /// A part roughed with room for finishing.
    Rough,
    /// A finished part, roughed first if that is asked for.
    Finish,
}

/// Makes what the arguments ask for, and writes it: all of it, or nothing.
pub(crate) fn run_for(aim: Aim, args: &CamArgs, shell: &Shell) -> anyhow::Result<()> {
    let order = Order::new(aim, args)?;
    let reading = io::read_surface(&order.part, order.units)?;
    let cutting = args.verify.map(|apart| order.cutting(&reading.surface, apart)).transpose()?;
    let bar = shell.progress();
    let plans = order.plans(reading, !args.no_pictures, &bar)?;
    let mut programs: Vec<Written> = order
        .outputs
        .iter()
        .zip(plans)
        .zip(order.tools())
        .map(|((outputs, plan), tools)| Written { outputs, plan, tools, tried: None })
        .collect();
    if let Some(cutting) = &cutting {
        let trials = programs.iter().map(Written::trial).collect();
        let tried = cutting.run(trials, order.block.as_ref(), &bar)?;
        for (program, tried) in programs.iter_mut().zip(tried) {
            program.tried = Some(tried);
        }
    }
    let mut files = OutputSet::new(order.overwrite);
    for Written { outputs, plan, tried, .. } in &programs {
        outputs.add_to(&mut files, plan, tried.as_ref())?;
    }
    bar.stop_if_asked()?;
    files.commit()?;
    drop(bar);
    if order.is_stream() {
        return Ok(());
    }
    tell(&programs, &order, shell)
}

/// A program with all that goes with it.
struct Written<'a> {
    outputs: &'a Outputs,
    plan: Plan,
    /// The tools it cuts with.
    tools: Vec<Tool>,
    /// What it leaves, if that was asked for.
    tried: Option<Tried>,
}

impl Written<'_> {
    fn trial(&self) -> Trial<'_> {
        Trial { name: self.outputs.name(), plan: &self.plan, tools: self.tools.clone() }
    }
}

/// Tells what was written, and of the first fault the simulation found.
fn tell(programs: &[Written], order: &Order, shell: &Shell) -> anyhow::Result<()> {
    let told: Vec<Told> =
        programs.iter().map(|program| Told::new(&program.plan, program.tried.as_ref())).collect();
    let texts = programs.iter().zip(&told).map(|(Written { outputs, plan, .. }, told)| {
        let next = [format!("horma check {} {}", outputs.first(plan), order.flags())];
        let files = listed("wrote", &outputs.told(plan)) + "\n" + &listed("next", &next);
        format!("{}{}\n{files}", cam_summary(&plan.report), told.in_words())
    });
    let text = texts.collect::<Vec<_>>().join("\n\n");
    match &told[..] {
        [one] => shell.report(one, &text)?,
        several => shell.report(&several, &text)?,
    }
    for (program, told) in programs.iter().zip(&told) {
        if let Some(fault) = told.fault() {
            bail!("{}: {fault}", program.outputs.program.display());
        }
    }
    Ok(())
}

/// The last part of a path, to call a file by.
pub(super) fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}

/// How the part was read, for the report.
pub(crate) fn notes(reading: &Reading) -> Vec<String> {
    let units = format!("read as {:?} in {} ({})", reading.format, reading.unit, reading.unit_from);
    std::iter::once(units).chain(reading.notes.iter().cloned()).collect()
}
