//! From a program and a part to what the program makes of it: replayed on a block, compared.

mod block;
mod header;
mod options;

pub use block::RawBlock;
use block::Rays;
pub use header::{Asked, HeaderError, asked};
pub use options::VerifyOptions;

use crate::cam::{BlockError, Part, Setup, SetupError, TurnLine, set_up};
use crate::gcode::{BlockKind, Program, StepKind};
use crate::geom::Surface;
use crate::machine::{AxisValues, Machine, MachineError};
use crate::measure::{
    Blank, Deviation, DeviationReport, Fixtures, SimulateError, SimulationReport, Target, blame,
    deviation, simulate,
};
use crate::progress::Progress;
use crate::stock::{Resolution, Stock, StockError};
use crate::tool::{Tool, ToolError};
use crate::workflow::cam::{CamOptions, OptionsError};
use serde::Serialize;

/// What a verification is made from.
#[derive(Debug)]
pub struct VerifyJob<'a> {
    /// What the program is called: most often its file.
    pub program_name: String,
    /// The program, as read back.
    pub program: &'a Program,
    /// What the part is called.
    pub part_name: String,
    /// The part, in millimetres.
    pub surface: Surface,
    /// What reading it had to say.
    pub notes: Vec<String>,
    /// The machine the program is for.
    pub machine: &'a Machine,
    /// The tools: one that cuts throughout, or several that the T words choose from.
    pub tools: Vec<Tool>,
    /// How the part was set up for cutting.
    pub setup: &'a CamOptions,
    /// The block it is cut from.
    pub block: RawBlock,
    /// How it is verified.
    pub options: &'a VerifyOptions,
}

/// What a verification finds.
#[derive(Debug, Clone)]
pub struct Verified {
    /// The numbers.
    pub report: VerifyReport,
    /// What is left of the block.
    pub stock: Stock,
    /// How far each of its rays is off, row by row; NaN where nothing was to be cut.
    pub deviation: Vec<f64>,
}

/// What a verification finds, as numbers. Lengths in millimetres, times in seconds.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct VerifyReport {
    /// The program.
    pub program: String,
    /// The part.
    pub part: String,
    /// The machine's name and title.
    pub machine: [String; 2],
    /// The tools, by name and shape.
    pub tools: Vec<[String; 2]>,
    /// The block it was cut from, in words.
    pub block: String,
    /// What happened on the way.
    pub simulation: SimulationReport,
    /// How far what is left is from the part.
    pub deviation: DeviationReport,
    /// The depth allowed into the part.
    pub tolerance: f64,
    /// What speaks against the program; empty if nothing does.
    pub faults: Vec<String>,
    /// What reading the part, the header and the options had to say.
    pub notes: Vec<String>,
}

/// Why a program cannot be verified.
#[derive(Debug, thiserror::Error)]
pub enum VerifyError {
    /// An option cannot be.
    #[error(transparent)]
    Options(#[from] OptionsError),
    /// The header says something else than options.
    #[error(transparent)]
    Header(#[from] HeaderError),
    /// A tool cannot be.
    #[error(transparent)]
    Tool(#[from] ToolError),
    /// A tool does not sit on the machine.
    #[error(transparent)]
    Machine(#[from] MachineError),
    /// The part cannot be set up.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// The block cannot be.
    #[error(transparent)]
    Block(#[from] BlockError),
    /// Points have no surface to compare with.
    #[error("a cloud of points has no surface to compare with; give the part as triangles")]
    NoTriangles,
    /// The program moves nothing.
    #[error("the program has no feed move; there is nothing to verify")]
    NoMoves,
    /// The stock cannot be told.
    #[error(transparent)]
    Stock(#[from] StockError),
    /// The program cannot be simulated.
    #[error(transparent)]
    Simulate(#[from] SimulateError),
}

impl VerifyError {
    /// True if nothing is wrong and the caller asked to stop.
    pub fn is_cancelled(&self) -> bool {
        matches!(
            self,
            Self::Stock(StockError::Cancelled(_)) | Self::Simulate(SimulateError::Cancelled(_))
        )
    }
}

/// Runs the program on its block, and compares what is left with the part.
pub fn verify(job: VerifyJob, progress: &dyn Progress) -> Result<Verified, VerifyError> {
    job.options.check()?;
    for tool in &job.tools {
        tool.profile.check()?;
        job.machine.check_tool(tool)?;
    }
    let mesh = job.surface.into_mesh().ok_or(VerifyError::NoTriangles)?;
    let setup = set_up(Surface::Mesh(mesh), job.machine, &job.setup.setup()?)?;
    let first = first_cut(job.program, job.machine).ok_or(VerifyError::NoMoves)?;
    let turner = turntable(job.program, job.machine, &first);
    let resolution = Resolution::even(job.options.resolution());
    let rays = Rays { values: &first, turner, resolution };
    let block = || job.block.stock(&setup, job.machine, &rays);
    let stock = block()?;
    let Surface::Mesh(mesh) = &setup.surface else { return Err(VerifyError::NoTriangles) };
    let blank = Blank { stock, fixtures: Fixtures::around(&setup, job.machine)? };
    let simulated = simulate(job.program, job.machine, &job.tools, blank, progress)?;
    let part = match turner {
        Some(axis) => above_table(setup.clone(), job.machine, axis, &job.tools, &simulated.stock)
            .ok_or(VerifyError::NoTriangles)?,
        None => Part::triangles(mesh),
    };
    let target = Target { mesh, n_own: setup.n_own, part: &part };
    let tool = last_tool(job.program, &job.tools).ok_or(SimulateError::NoTools)?;
    let cutter = tool.profile.cutter(0.0);
    let tolerance = job.options.tolerance();
    let Deviation { values, report: deviation } =
        deviation(&simulated.stock, &target, &cutter, tolerance, progress)?;
    let mut report = VerifyReport {
        program: job.program_name,
        part: job.part_name,
        machine: [job.machine.name.clone(), job.machine.title.clone()],
        tools: job.tools.iter().map(|tool| [tool.name.clone(), tool.profile.to_string()]).collect(),
        block: job.block.to_string(),
        simulation: simulated.report,
        deviation,
        tolerance,
        faults: Vec::new(),
        notes: job.notes,
    };
    for spot in report.deviation.faults(tolerance) {
        let stocks = [&block()?, &simulated.stock];
        spot.line = blame(job.program, job.machine, &job.tools, stocks, &spot.at.into())?;
    }
    report.find_faults();
    Ok(Verified { report, stock: simulated.stock, deviation: values })
}

impl VerifyReport {
    /// True if nothing speaks against the program.
    pub fn is_clean(&self) -> bool {
        self.faults.is_empty()
    }

    fn find_faults(&mut self) {
        let gouges = [(&self.deviation.gouge, "part"), (&self.deviation.clamp_gouge, "clamp")];
        for (spot, what) in gouges {
            if let Some(spot) = spot.filter(|spot| spot.value > self.tolerance) {
                let [x, y, z] = spot.at;
                let by = spot.line.map_or_else(String::new, |line| format!(", by line {line}"));
                self.faults.push(format!(
                    "the {what} is cut {:.3} mm deep at X {x:.2} Y {y:.2} Z {z:.2} of the part set \
                     up{by}; {:.3} mm are allowed",
                    spot.value, self.tolerance
                ));
            }
        }
        if let Some(first) = self.simulation.collisions.first() {
            self.faults.push(format!(
                "{} collisions, the first in line {}: {}",
                self.simulation.n_collisions,
                first.line,
                first.in_words()
            ));
        }
    }
}

/// Where the program first cuts, or would.
fn first_cut(program: &Program, machine: &Machine) -> Option<AxisValues> {
    let mut feeds = program.steps(machine).filter(|step| step.kind == StepKind::Feed);
    feeds.next().map(|step| step.to.map(Option::unwrap_or_default))
}

/// The axis of a table that turns the part while the tool cuts, tilted so that it shows the tool
/// other sides of it; `None` where a spindle does, or nothing.
fn turntable(program: &Program, machine: &Machine, first: &AxisValues) -> Option<usize> {
    if machine.spindle.is_some() {
        return None;
    }
    let TurnLine { axis, .. } = TurnLine::of(machine, first).ok()?;
    let mut feeds = program.steps(machine).filter(|step| step.kind == StepKind::Feed);
    feeds.any(|step| step.from[axis] != step.to[axis]).then_some(axis)
}

/// What tools can come down on: the part and the table that turns it, which is no part of the stock.
fn above_table(
    mut setup: Setup,
    machine: &Machine,
    axis: usize,
    tools: &[Tool],
    stock: &Stock,
) -> Option<Part> {
    let widest = tools.iter().map(|tool| tool.profile.cutter(0.0).reach().x).fold(0.0, f64::max);
    setup.add_table(&machine.axes[axis].point, stock.layout().reach() + 2.0 * widest);
    setup.surface.into_mesh().map(|mesh| Part::triangles(&mesh))
}

/// The tool that cuts last, and so the one whose marks are left.
fn last_tool<'a>(program: &Program, tools: &'a [Tool]) -> Option<&'a Tool> {
    let changes = program.blocks.iter().rev().find_map(|block| match block.kind {
        BlockKind::ToolChange(number) => Some(number),
        _ => None,
    });
    let named = tools.iter().find(|tool| Some(tool.number) == changes);
    if tools.len() > 1 { named.or(tools.last()) } else { tools.first() }
}
