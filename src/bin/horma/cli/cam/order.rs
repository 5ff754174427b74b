//! What is asked for: the command line over the job file, all that it names read and checked before
//! hours are spent.

use super::{Aim, CamArgs, Outputs, file_name, notes};
use crate::cli::block::read_block;
use crate::cli::simulated::Cutting;
use crate::exit::Usage;
use anyhow::Context;
use horma::cam::Block;
use horma::gcode::Dialect;
use horma::geom::{LengthUnit, Surface};
use horma::io::{self, Overwrite, Reading};
use horma::machine::Machine;
use horma::progress::Progress;
use horma::tool::Tool;
use horma::workflow::cam::{
    CamOptions, Job, OptionsError, Plan, is_one_program, plan, rough, rough_and_finish,
};
use horma::workflow::verify::VerifyError;
use std::path::{Path, PathBuf};

/// What is asked for.
pub(super) struct Order {
    aim: Aim,
    /// The file of the part.
    pub(super) part: PathBuf,
    /// Its unit, if that is said.
    pub(super) units: Option<LengthUnit>,
    /// The machine as it is called, for the command that comes next.
    machine_name: String,
    machine: Machine,
    dialect: Dialect,
    options: CamOptions,
    tool: Tool,
    /// The tool that roughs before it.
    before: Option<Tool>,
    /// What is roughed.
    pub(super) block: Option<Block>,
    /// The files of the program; or of two, the first of which roughs.
    pub(super) outputs: Vec<Outputs>,
    pub(super) overwrite: Overwrite,
}

impl Order {
    /// What the command line says, and what it does not the job file.
    pub(super) fn new(aim: Aim, args: &CamArgs) -> anyhow::Result<Self> {
        let job = args.job.as_deref().map(io::read_job).transpose()?.unwrap_or_default();
        let example = "horma cam PART -m MACHINE -o OUT";
        let part = given(args.part.as_ref(), job.part.as_ref(), "a part to cut", example)?;
        let machine_name =
            given(args.machine.as_ref(), job.machine.as_ref(), "a machine", "-m last-lathe")?;
        let output = given(args.output.as_ref(), job.output.as_ref(), "an output", "-o out.ngc")?;
        let machine = io::read_machine(&machine_name)?;
        let options = args.options.over(&job.options);
        options.check()?;
        let dialect = io::read_dialect(options.dialect.as_deref().unwrap_or(&machine.dialect))?;
        let library = io::read_tools(args.tools.as_deref().or(job.tools.as_deref()))?;
        let tool = library.find(options.tool.as_deref().unwrap_or(&machine.default_tool))?;
        let before = options.rough_with.as_deref().map(|name| library.find(name)).transpose()?;
        let units = args.units.or(job.units);
        let is_roughed = aim == Aim::Rough || before.is_some();
        let block = is_roughed.then(|| read_block(options.block(), units)).transpose()?;
        let overwrite = if args.force { Overwrite::Replace } else { Overwrite::Refuse };
        let is_split = is_split(&machine, before.as_ref(), &tool);
        let outputs = checked_outputs(&output, is_split, overwrite)?;
        Ok(Self {
            aim,
            part,
            units,
            machine_name,
            machine,
            dialect,
            options,
            tool,
            before,
            block,
            outputs,
            overwrite,
        })
    }

    /// The program goes where no report can follow.
    pub(super) fn is_stream(&self) -> bool {
        self.outputs.iter().any(|outputs| outputs.is_stream)
    }

    /// What cutting the programs in simulation takes, the stock looked at `apart` mm apart.
    pub(super) fn cutting(&self, surface: &Surface, apart: f64) -> anyhow::Result<Cutting<'_>> {
        if !(apart > 0.0 && apart.is_finite()) {
            let (option, must) = ("--verify", "a number above 0");
            return Err(OptionsError::OutOfRange { option, value: apart, must }.into());
        }
        if self.is_stream() {
            let text = "--verify tells in the report, and standard output has none; give -o FILE";
            return Err(Usage(text.to_owned()).into());
        }
        // Refused before hours are spent if it has no surface to compare with.
        let mesh = surface.clone().into_mesh().ok_or(VerifyError::NoTriangles)?;
        Ok(Cutting {
            surface: Surface::Mesh(mesh),
            machine: &self.machine,
            dialect: &self.dialect,
            options: &self.options,
            resolution: apart,
        })
    }

    /// The programs, one or two.
    pub(super) fn plans(
        &self,
        reading: Reading,
        with_pictures: bool,
        progress: &dyn Progress,
    ) -> anyhow::Result<Vec<Plan>> {
        let job = Job {
            name: file_name(&self.part),
            notes: notes(&reading),
            surface: reading.surface,
            machine: &self.machine,
            tool: self.tool.clone(),
            dialect: &self.dialect,
            options: &self.options,
            keep_scene: with_pictures && !self.is_stream(),
        };
        let planned = match (self.aim, &self.block, &self.before) {
            (Aim::Rough, Some(block), _) => rough(job, block, progress).map(|plan| vec![plan]),
            (_, Some(block), Some(tool)) => rough_and_finish(job, tool.clone(), block, progress),
            _ => plan(job, progress).map(|plan| vec![plan]),
        };
        planned.with_context(|| format!("while cutting {}", self.part.display()))
    }

    /// The tools of each program.
    pub(super) fn tools(&self) -> Vec<Vec<Tool>> {
        let own = self.tool.clone();
        match &self.before {
            None => vec![vec![own]],
            Some(before) if self.outputs.len() > 1 => vec![vec![before.clone()], vec![own]],
            Some(before) => vec![vec![before.clone(), own]],
        }
    }

    /// How another command is told of the machine and its language.
    pub(super) fn flags(&self) -> String {
        let dialect = self.options.dialect.as_ref();
        let dialect = dialect.map_or_else(String::new, |name| format!(" --dialect {name}"));
        format!("-m {}{dialect}", self.machine_name)
    }
}

/// True if roughing and finishing are programs of their own.
fn is_split(machine: &Machine, before: Option<&Tool>, tool: &Tool) -> bool {
    before.is_some_and(|before| !is_one_program(machine, before, tool))
}

/// The files of one program; or of two, the first of which roughs.
fn checked_outputs(
    output: &Path,
    is_split: bool,
    overwrite: Overwrite,
) -> anyhow::Result<Vec<Outputs>> {
    let finishing = Outputs::checked(output, overwrite)?;
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
    Ok(vec![Outputs::checked(&roughing, overwrite)?, finishing])
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
