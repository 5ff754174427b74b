//! `horma cam`: from a part to a program, with its report.

use super::Shell;
use super::simulated::{Cutting, Told};
use crate::exit::Usage;
use anyhow::{Context, bail};
use clap::Args;
use horma::cam::Block;
use horma::geom::{LengthUnit, Surface};
use horma::io::report::{cam_page, cam_summary, html, with_cut};
use horma::io::{self, JobFile, OutputSet, Overwrite, Reading};
use horma::machine::Machine;
use horma::progress::Progress;
use horma::tool::Tool;
use horma::workflow::cam::{CamError, CamOptions, Job, Plan, plan};
use horma::workflow::verify::{RawBlock, Verified, VerifyError};
use std::path::{Path, PathBuf};

/// Compute the program that cuts a part, and a report beside it.
#[derive(Debug, Args)]
#[command(after_help = "Writes OUTPUT, OUTPUT with .report.json and OUTPUT with .report.html.

For example:
  horma cam last.stl -m last-lathe -o last.ngc
  horma cam last.stl -m last-lathe --mirror --scallop 0.03 --allowance 1 -o right.ngc
  horma cam last.stl -m last-lathe --verify -o last.ngc
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

impl CamArgs {
    /// The unit the part's file is said to be in.
    pub(crate) fn units(&self) -> Option<LengthUnit> {
        self.units
    }
}

/// Plans the cut and writes the program and its reports: all of them, or none.
pub(crate) fn run(args: &CamArgs, shell: &Shell) -> anyhow::Result<()> {
    run_with(args, shell, None, plan)
}

/// Makes a plan of what the arguments ask for, and writes it. It cuts from `block`; without one, from
/// the part with the stock it assumes all over.
pub(crate) fn run_with(
    args: &CamArgs,
    shell: &Shell,
    block: Option<&Block>,
    plan: impl FnOnce(Job, &dyn Progress) -> Result<Plan, CamError>,
) -> anyhow::Result<()> {
    let job = args.job.as_deref().map(io::read_job).transpose()?.unwrap_or_default();
    let part = given(
        args.part.as_ref(),
        job.part.as_ref(),
        "a part to cut",
        "horma cam PART -m MACHINE -o OUT",
    )?;
    let machine = given(args.machine.as_ref(), job.machine.as_ref(), "a machine", "-m last-lathe")?;
    let output = given(args.output.as_ref(), job.output.as_ref(), "an output", "-o out.ngc")?;
    let machine = io::read_machine(&machine)?;
    let options = args.options.over(&job.options);
    let dialect = io::read_dialect(options.dialect.as_deref().unwrap_or(&machine.dialect))?;
    let tool = tool(args, &job, &options, &machine)?;
    let reading = io::read_surface(&part, args.units.or(job.units))?;
    let outputs = Outputs::checked(&output, args.force)?;
    let cutting = match args.verify {
        None => None,
        Some(_) if outputs.is_stream => {
            let text = "--verify tells in the report, and standard output has none; give -o FILE";
            return Err(Usage(text.to_owned()).into());
        }
        Some(resolution) => Some(Cutting {
            program_name: file_name(&output),
            surface: with_triangles(&reading.surface)?,
            machine: &machine,
            dialect: &dialect,
            tool: tool.clone(),
            options: &options,
            resolution,
        }),
    };
    let bar = shell.progress();
    let planned = plan(
        Job {
            name: file_name(&part),
            notes: notes(&reading),
            surface: reading.surface,
            machine: &machine,
            tool,
            dialect: &dialect,
            options: &options,
            keep_scene: !args.no_pictures && !outputs.is_stream,
        },
        &bar,
    )
    .with_context(|| format!("while cutting {}", part.display()))?;
    let block = match block {
        Some(block) => RawBlock::Body(block.clone()),
        None => RawBlock::Grown(planned.report.stock),
    };
    let verified = cutting.map(|cutting| cutting.run(&planned, block, &bar)).transpose()?;
    outputs.write(&planned, verified.as_ref())?;
    drop(bar);
    if outputs.is_stream {
        return Ok(());
    }
    let told = Told::new(&planned, verified.as_ref());
    let text = format!(
        "{}{}\n{}",
        cam_summary(&planned.report),
        told.in_words(),
        outputs.in_words(&machine, &planned)
    );
    shell.report(&told, &text)?;
    match verified.iter().flat_map(|verified| &verified.report.faults).next() {
        None => Ok(()),
        Some(fault) => bail!("{}: {fault}", output.display()),
    }
}

/// A copy of the part to compare with: refused before hours are spent if it has no surface.
fn with_triangles(surface: &Surface) -> anyhow::Result<Surface> {
    let mesh = surface.clone().into_mesh().ok_or(VerifyError::NoTriangles)?;
    Ok(Surface::Mesh(mesh))
}

/// The last part of a path, to call a file by.
pub(super) fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}

/// What the command line says, else the job file.
fn given<T: Clone>(
    flag: Option<&T>,
    job: Option<&T>,
    what: &str,
    example: &str,
) -> anyhow::Result<T> {
    let missing = || Usage(format!("{what} is missing; give it, as in: {example}")).into();
    flag.or(job).cloned().ok_or_else(missing)
}

fn tool(
    args: &CamArgs,
    job: &JobFile,
    options: &CamOptions,
    machine: &Machine,
) -> anyhow::Result<Tool> {
    let library = io::read_tools(args.tools.as_deref().or(job.tools.as_deref()))?;
    Ok(library.find(options.tool.as_deref().unwrap_or(&machine.default_tool))?)
}

/// How the part was read, for the report.
pub(crate) fn notes(reading: &Reading) -> Vec<String> {
    let units = format!("read as {:?} in {} ({})", reading.format, reading.unit, reading.unit_from);
    std::iter::once(units).chain(reading.notes.iter().cloned()).collect()
}

/// The files a job writes.
pub(crate) struct Outputs {
    program: PathBuf,
    overwrite: Overwrite,
    /// The program goes where no report can follow: standard output.
    pub(crate) is_stream: bool,
}

impl Outputs {
    /// Refuses names that cannot be written before hours are spent on what goes there.
    pub(crate) fn checked(program: &Path, force: bool) -> anyhow::Result<Self> {
        let overwrite = if force { Overwrite::Replace } else { Overwrite::Refuse };
        let outputs =
            Self { program: program.into(), overwrite, is_stream: io::is_standard_output(program) };
        if !outputs.is_stream {
            let mut trial = OutputSet::new(overwrite);
            for path in outputs.paths() {
                trial.add(&path, |_| Ok(()))?;
            }
        }
        Ok(outputs)
    }

    fn paths(&self) -> [PathBuf; 3] {
        let report = |extension| self.program.with_extension(extension);
        [self.program.clone(), report("report.json"), report("report.html")]
    }

    /// All three, or none; the reports with what the simulation found, if there was one.
    pub(super) fn write(&self, planned: &Plan, verified: Option<&Verified>) -> anyhow::Result<()> {
        let [_, json, page] = self.paths();
        let mut files = OutputSet::new(self.overwrite);
        for (path, text) in self.programs(planned) {
            files.add(&path, |out| out.write_all(text))?;
        }
        if !self.is_stream {
            let report = serde_json::to_vec_pretty(&Told::new(planned, verified))?;
            let mut shown = cam_page(&planned.report, planned.scene.as_ref())?;
            if let Some(verified) = verified {
                shown = with_cut(shown, verified)?;
            }
            let shown = html(&shown);
            files.add(&json, |out| out.write_all(&report))?;
            files.add(&page, |out| out.write_all(shown.as_bytes()))?;
        }
        Ok(files.commit()?)
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

    /// What was written, and what to do with it.
    pub(crate) fn in_words(&self, machine: &Machine, planned: &Plan) -> String {
        let [_, json, page] = self.paths().map(|path| path.display().to_string());
        let programs = self.programs(planned);
        let names: Vec<String> =
            programs.iter().map(|(path, _)| path.display().to_string()).collect();
        let program = names.join("\n      ");
        let first = &names[0];
        format!(
            "wrote {program}\n      {json}\n      {page}  (open it in a browser)\n\
             next  horma check {first} -m {}",
            machine.name
        )
    }
}
