//! `horma cam`: from a part to a program, with its report.

use super::Shell;
use super::block::read_block;
use super::simulated::{Cutting, NOT_SIMULATED, Told, Trial, Tried};
use crate::exit::Usage;
use anyhow::{Context, bail};
use clap::Args;
use horma::cam::Block;
use horma::geom::{LengthUnit, Surface};
use horma::io::report::{cam_page, cam_summary, html, with_cut};
use horma::io::{self, OutputSet, Overwrite, Reading};
use horma::machine::Machine;
use horma::progress::Progress;
use horma::tool::Tool;
use horma::workflow::cam::{CamOptions, Job, Plan, is_one_program, plan, rough, rough_and_finish};
use horma::workflow::verify::{RawBlock, VerifyError, VerifyOptions};
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

/// Makes what the arguments ask for, and writes it.
pub(crate) fn run_for(aim: Aim, args: &CamArgs, shell: &Shell) -> anyhow::Result<()> {
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
    let library = io::read_tools(args.tools.as_deref().or(job.tools.as_deref()))?;
    let tool = library.find(options.tool.as_deref().unwrap_or(&machine.default_tool))?;
    let before = options.rough_with.as_deref().map(|name| library.find(name)).transpose()?;
    let units = args.units.or(job.units);
    let is_roughed = aim == Aim::Rough || before.is_some();
    let block = is_roughed.then(|| read_block(options.block(), units)).transpose()?;
    let is_split = before.as_ref().is_some_and(|before| !is_one_program(&machine, before, &tool));
    let outputs = checked_outputs(&output, is_split, args.force)?;
    let reading = io::read_surface(&part, units)?;
    let cutting = match args.verify {
        None => None,
        Some(_) if outputs[0].is_stream => {
            let text = "--verify tells in the report, and standard output has none; give -o FILE";
            return Err(Usage(text.to_owned()).into());
        }
        Some(resolution) => {
            VerifyOptions { resolution: Some(resolution), tolerance: None }.check()?;
            Some(Cutting {
                surface: with_triangles(&reading.surface)?,
                machine: &machine,
                dialect: &dialect,
                options: &options,
                resolution,
            })
        }
    };
    let tools: Vec<Vec<Tool>> = match &before {
        Some(before) if is_split => vec![vec![before.clone()], vec![tool.clone()]],
        before => vec![before.iter().cloned().chain([tool.clone()]).collect()],
    };
    let bar = shell.progress();
    let job = Job {
        name: file_name(&part),
        notes: notes(&reading),
        surface: reading.surface,
        machine: &machine,
        tool,
        dialect: &dialect,
        options: &options,
        keep_scene: !args.no_pictures && !outputs[0].is_stream,
    };
    let planned = match (&block, before) {
        (Some(block), _) if aim == Aim::Rough => rough(job, block, &bar).map(|plan| vec![plan]),
        (Some(block), Some(tool)) => rough_and_finish(job, tool, block, &bar),
        _ => plan(job, &bar).map(|plan| vec![plan]),
    };
    let planned = planned.with_context(|| format!("while cutting {}", part.display()))?;
    let programs: Vec<Written> = outputs
        .into_iter()
        .zip(planned)
        .zip(tools)
        .map(|((outputs, plan), tools)| Written { outputs, plan, tools, tried: None })
        .collect();
    let programs = match cutting {
        None => programs,
        Some(cutting) => verified(programs, &cutting, block, &bar)?,
    };
    let mut files = OutputSet::new(programs[0].outputs.overwrite);
    for program in &programs {
        program.outputs.add_to(&mut files, &program.plan, program.tried.as_ref())?;
    }
    files.commit()?;
    drop(bar);
    if programs[0].outputs.is_stream {
        return Ok(());
    }
    tell(&programs, &machine, shell)
}

/// A program with all that goes with it.
struct Written {
    outputs: Outputs,
    plan: Plan,
    /// The tools it cuts with.
    tools: Vec<Tool>,
    /// What it leaves, if that was asked for.
    tried: Option<Tried>,
}

/// Cuts one program after the other in simulation: from `block`, or from the part with the stock
/// that is assumed all over, and then from what the one before left.
fn verified(
    mut programs: Vec<Written>,
    cutting: &Cutting,
    block: Option<Block>,
    progress: &dyn Progress,
) -> anyhow::Result<Vec<Written>> {
    let mut next: Result<_, String> = Ok(match block {
        Some(block) => RawBlock::Body(block),
        None => RawBlock::Grown(programs[0].plan.report.stock),
    });
    for program in &mut programs {
        let trial = |block| Trial {
            name: file_name(&program.outputs.program),
            plan: &program.plan,
            tools: program.tools.clone(),
            block,
        };
        let tried = match next {
            Ok(block) => cutting.run(trial(block), progress)?,
            Err(why) => Err(why),
        };
        next = match &tried {
            Ok(left) => Ok(RawBlock::Left(Box::new(left.stock.clone()))),
            Err(why) => Err(format!("nobody knows what the program before it left ({why})")),
        };
        program.tried = Some(tried);
    }
    Ok(programs)
}

/// Tells what was written, and of the first fault the simulation found.
fn tell(programs: &[Written], machine: &Machine, shell: &Shell) -> anyhow::Result<()> {
    let told: Vec<Told> =
        programs.iter().map(|program| Told::new(&program.plan, program.tried.as_ref())).collect();
    let texts = programs.iter().zip(&told).map(|(program, told)| {
        let summary = cam_summary(&program.plan.report) + &told.in_words();
        summary + "\n" + &program.outputs.in_words(machine, &program.plan)
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

/// A copy of the part to compare with: refused before hours are spent if it has no surface.
fn with_triangles(surface: &Surface) -> anyhow::Result<Surface> {
    let mesh = surface.clone().into_mesh().ok_or(VerifyError::NoTriangles)?;
    Ok(Surface::Mesh(mesh))
}

/// The last part of a path, to call a file by.
pub(super) fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}

/// The files of one program; or of two, the first of which roughs.
fn checked_outputs(output: &Path, is_split: bool, force: bool) -> anyhow::Result<Vec<Outputs>> {
    let finishing = Outputs::checked(output, force)?;
    if !is_split {
        return Ok(vec![finishing]);
    }
    if finishing.is_stream {
        let text = "this machine has its tools changed between programs, and two programs cannot go to \
                    standard output; name a file";
        return Err(Usage(text.to_owned()).into());
    }
    let extension = output.extension().unwrap_or_default().to_string_lossy();
    let extension = format!("rough.{extension}");
    let roughing = output.with_extension(extension.trim_end_matches('.'));
    Ok(vec![Outputs::checked(&roughing, force)?, finishing])
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
    pub(super) fn write(&self, planned: &Plan, tried: Option<&Tried>) -> anyhow::Result<()> {
        let mut files = OutputSet::new(self.overwrite);
        self.add_to(&mut files, planned, tried)?;
        Ok(files.commit()?)
    }

    /// Adds all three to what is written together.
    fn add_to(
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
