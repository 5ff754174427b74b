//! `horma verify`: what a program makes of its block, against the part.

use super::Shell;
use super::block::read_block;
use super::cam::{file_name, notes};
use super::table::listed;
use crate::bar::Bar;
use anyhow::{Context, bail};
use clap::Args;
use horma::cam::Centre;
use horma::gcode::{BlockKind, Program};
use horma::geom::{LengthUnit, Surface, TriMesh};
use horma::io::report::{deviation_map, html, verify_page, verify_summary};
use horma::io::{self, OutputSet, Overwrite};
use horma::machine::Machine;
use horma::tool::Tool;
use horma::workflow::cam::CamOptions;
use horma::workflow::verify::{Asked, RawBlock, Verified, VerifyJob, VerifyOptions, asked, verify};
use std::path::PathBuf;

/// Stock on the part where the program's header says nothing [mm].
const ASSUMED: f64 = 1.0;

/// Cut a program in simulation, as it stands in its file, and compare what is left with the part.
#[derive(Debug, Args)]
#[command(
    after_help = "The part is set up as `horma cam` did: from the options in the program's header; flags win over
them. Writes PROGRAM with .verify.html and .verify.json. Exits with 65 where the part is cut deeper
than the tolerance or something collides.

For example:
  horma verify last.ngc last.stl -m last-lathe
  horma verify rough.ngc last.stl -m last-lathe --block cylinder:65 --map left.ply"
)]
pub(crate) struct VerifyArgs {
    /// The program.
    program: PathBuf,
    /// The part it is to make.
    part: PathBuf,
    /// The machine it is for: a name, or a machine file.
    #[arg(long, short, value_name = "MACHINE")]
    machine: String,
    /// The language it is written in: a name (`horma dialect list`) or a dialect file [default: the
    /// machine's].
    #[arg(long, value_name = "DIALECT")]
    dialect: Option<String>,
    /// The block: cylinder or cylinder:RADIUS, box or box:MARGIN, or the file of a moulded block that
    /// lies about the part as the part's file has it [default: what the program's header says is
    /// roughed, else the part with the stock the program assumes all over].
    #[arg(long, value_name = "BLOCK")]
    block: Option<String>,
    /// Write what was cut as a mesh, coloured by how far it is off; .ply or .glb.
    #[arg(long, value_name = "FILE")]
    map: Option<PathBuf>,
    /// Where the page goes [default: beside the program].
    #[arg(long, short, value_name = "FILE")]
    output: Option<PathBuf>,
    /// The tool: a name, number or shape [default: that of the header, else the machine's].
    #[arg(long, value_name = "TOOL")]
    tool: Option<String>,
    /// A tool library to look tools up in [default: the built-in one].
    #[arg(long, value_name = "FILE")]
    tools: Option<PathBuf>,
    /// The unit of the part's file [default: what it declares, else by its extent].
    #[arg(long, value_name = "UNIT")]
    units: Option<LengthUnit>,
    /// Do not read the program's header; the part is set up by the flags alone.
    #[arg(long)]
    no_header: bool,
    /// Replace outputs that are there already.
    #[arg(long)]
    force: bool,
    #[command(flatten)]
    setup: SetupFlags,
    #[command(flatten)]
    options: VerifyOptions,
}

/// How the part lies on the machine, as `horma cam` takes it; over what the header says.
#[derive(Debug, Args)]
struct SetupFlags {
    /// The part's direction along the spindle, heel to toe: auto, x, -x, y, z or "1 0 0.2".
    #[arg(long, value_name = "AXIS", allow_hyphen_values = true)]
    axis: Option<String>,
    /// Swap heel and toe.
    #[arg(long)]
    flip: bool,
    /// Which point lies on the spindle axis.
    #[arg(long, value_name = "POINT")]
    centre: Option<Centre>,
    /// Turn of the part before the first step [deg].
    #[arg(long, value_name = "DEG", allow_hyphen_values = true)]
    start_angle: Option<f64>,
    /// Compare with the mirror image: the other foot.
    #[arg(long)]
    mirror: bool,
}

/// Simulates, compares, writes and tells; a program that gouges or collides is a bad input.
pub(crate) fn run(args: &VerifyArgs, shell: &Shell) -> anyhow::Result<()> {
    let machine = io::read_machine(&args.machine)?;
    let dialect = io::read_dialect(args.dialect.as_ref().unwrap_or(&machine.dialect))?;
    let program = io::read_program(&args.program, &machine, &dialect)?;
    let head = if args.no_header { Asked::default() } else { asked(&program)? };
    let setup = args.setup(head.options.as_ref());
    let tools = args.tools(&program, &setup, &machine)?;
    let reading = io::read_surface(&args.part, args.units)?;
    let block = args.block(&head)?;
    let outputs = args.outputs()?;
    let mut notes = notes(&reading);
    notes.push(match &head.options {
        Some(_) => "set up by the options in the program's header".to_owned(),
        None => "set up by the flags alone: the program's header says nothing".to_owned(),
    });
    let bar = shell.progress();
    let job = VerifyJob {
        program_name: file_name(&args.program),
        program: &program,
        part_name: file_name(&args.part),
        surface: reading.surface,
        notes,
        machine: &machine,
        tools,
        setup: &setup,
        block,
        options: &args.options,
    };
    let verified =
        verify(job, &bar).with_context(|| format!("while verifying {}", args.program.display()))?;
    args.write(&verified, &outputs, &bar)?;
    drop(bar);
    let [page, json] = outputs.map(|path| path.display().to_string());
    let map = args.map.iter().map(|path| path.display().to_string());
    let written: Vec<String> =
        [page + "  (open it in a browser)", json].into_iter().chain(map).collect();
    let text = format!("{}\n{}", verify_summary(&verified.report), listed("wrote", &written));
    shell.report(&verified.report, &text)?;
    match verified.report.faults.first() {
        None => Ok(()),
        Some(fault) => bail!("{}: {fault}", args.program.display()),
    }
}

impl VerifyArgs {
    /// The header's setup, with what the flags say over it.
    fn setup(&self, header: Option<&CamOptions>) -> CamOptions {
        let flags = CamOptions {
            axis: self.setup.axis.clone(),
            flip: self.setup.flip,
            centre: self.setup.centre,
            start_angle: self.setup.start_angle,
            mirror: self.setup.mirror,
            tool: self.tool.clone(),
            ..CamOptions::default()
        };
        header.map_or(flags.clone(), |header| flags.over(header))
    }

    /// The tool that is named; or, where the program changes tools, all those it names.
    fn tools(
        &self,
        program: &Program,
        setup: &CamOptions,
        machine: &Machine,
    ) -> anyhow::Result<Vec<Tool>> {
        let library = io::read_tools(self.tools.as_deref())?;
        let mut numbers: Vec<u32> = program
            .blocks
            .iter()
            .filter_map(|block| match block.kind {
                BlockKind::ToolChange(number) => Some(number),
                _ => None,
            })
            .collect();
        numbers.sort_unstable();
        numbers.dedup();
        if self.tool.is_none() && numbers.len() > 1 {
            // Those the header names may stand in no library.
            let named = [&setup.tool, &setup.rough_with].into_iter().flatten();
            let named: Vec<Tool> =
                named.map(|name| library.find(name)).collect::<Result<_, _>>()?;
            let tools = numbers.iter().map(|&number| {
                let named = named.iter().find(|tool| tool.number == number).cloned();
                named.map_or_else(|| library.find(&number.to_string()), Ok)
            });
            return Ok(tools.collect::<Result<_, _>>()?);
        }
        Ok(vec![library.find(setup.tool.as_deref().unwrap_or(&machine.default_tool))?])
    }

    fn block(&self, head: &Asked) -> anyhow::Result<RawBlock> {
        let roughed = head.options.as_ref().and_then(|options| options.block.as_ref());
        match self.block.as_ref().or(roughed) {
            Some(text) => Ok(RawBlock::Body(read_block(text, self.units)?)),
            None => Ok(RawBlock::Grown(head.stock.unwrap_or(ASSUMED))),
        }
    }

    /// The page and its numbers beside it; refused before the work begins if they or the map cannot be
    /// written.
    fn outputs(&self) -> anyhow::Result<[PathBuf; 2]> {
        let page = self.output.clone();
        let page = page.unwrap_or_else(|| self.program.with_extension("verify.html"));
        let outputs = [page.clone(), page.with_extension("json")];
        let mut trial = OutputSet::new(self.overwrite());
        for path in &outputs {
            trial.add(path, |_| Ok(()))?;
        }
        if let Some(path) = &self.map {
            trial.add_surface(path, &Surface::Mesh(TriMesh::default()))?;
        }
        Ok(outputs)
    }

    /// Writes the page, its numbers, and the map if it was asked for: all of them, or none.
    fn write(
        &self,
        verified: &Verified,
        [page, json]: &[PathBuf; 2],
        bar: &Bar,
    ) -> anyhow::Result<()> {
        let shown = html(&verify_page(verified)?);
        let numbers = serde_json::to_vec_pretty(&verified.report)?;
        let mut files = OutputSet::new(self.overwrite());
        files.add(page, |out| out.write_all(shown.as_bytes()))?;
        files.add(json, |out| out.write_all(&numbers))?;
        if let Some(path) = &self.map {
            let full = verified.report.tolerance.max(0.1);
            files.add_surface(path, &Surface::Mesh(deviation_map(verified, full)))?;
        }
        bar.stop_if_asked()?;
        Ok(files.commit()?)
    }

    fn overwrite(&self) -> Overwrite {
        if self.force { Overwrite::Replace } else { Overwrite::Refuse }
    }
}
