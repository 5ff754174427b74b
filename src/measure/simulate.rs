//! A program, as read back from its file, replayed on a block.

use super::ridge::ridge_error;
use crate::gcode::{BlockKind, Program, Step, StepKind};
use crate::machine::{AxisValues, Machine};
use crate::progress::{Cancelled, Progress};
use crate::stock::{Cut, Stock, StockError, Sweep};
use crate::tool::{Cutter, Tool};
use serde::Serialize;

/// A feed move that cuts no deeper than this cuts air [mm].
const AIR: f64 = 0.01;
/// A rapid this deep in the material is a collision: what is less, rounding explains [mm].
const TOUCH: f64 = 0.01;
/// Moves handed to the stock together.
const BATCH: usize = 65_536;
/// Collisions are all counted, but only so many told.
const MOST_COLLISIONS: usize = 100;

/// What a program left of a block.
#[derive(Debug, Clone)]
pub struct Simulation {
    /// The block after the program.
    pub stock: Stock,
    /// What happened on the way.
    pub report: SimulationReport,
}

/// What happened while a program ran. Lengths in millimetres, volumes in mm3, times in seconds.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct SimulationReport {
    /// Moves, rapids and feeds.
    pub n_moves: usize,
    /// The block before the program.
    pub start_volume: f64,
    /// What is left of it.
    pub end_volume: f64,
    /// What was taken away.
    pub removed: f64,
    /// Time of the feed moves that are no leads.
    pub feed_seconds: f64,
    /// The part of it in which less than 0.01 mm is cut.
    pub air_seconds: f64,
    /// That as a share of it.
    pub air_share: f64,
    /// The deepest cut: material over the tool since its engagement (since the last rapid) began.
    pub greatest_depth: Option<Extreme>,
    /// The most material in a second, over one move [mm3/s].
    pub greatest_rate: Option<Extreme>,
    /// How many collisions there were.
    pub n_collisions: usize,
    /// The first hundred of them.
    pub collisions: Vec<Collision>,
    /// Moves that passed beneath material standing over the tool, as seen along a ray: it was kept
    /// whole, with what they took from below it.
    pub n_overhanging: usize,
    /// How exact all this is.
    pub resolution: ResolutionReport,
}

/// The greatest of something, and where.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct Extreme {
    /// How great.
    pub value: f64,
    /// The line of the program.
    pub line: u32,
}

/// A move that must not be.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct Collision {
    /// The line of the program.
    pub line: u32,
    /// What collides.
    pub kind: CollisionKind,
    /// How deep [mm].
    pub depth: f64,
}

/// What collides.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum CollisionKind {
    /// A rapid runs through material.
    Rapid,
    /// The tool cuts the part off: it lies across the spindle axis.
    AcrossAxis,
    /// The tool goes below the block: into the table.
    BelowBlock,
}

/// How exact a simulation is. What the rays show is right to within `sweep`; between them lies what
/// the others bound.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct ResolutionReport {
    /// From ray to ray along X [mm].
    pub along: f64,
    /// From ray to ray around the part, at the block's greatest radius; across X on a table [mm].
    pub across: f64,
    /// Rays end no more than this too far out, because moves are followed in steps; along the
    /// surface's normal [mm].
    pub sweep: f64,
    /// A hollow cut by the tool is no deeper than shown by more than this; absent for a tool with a
    /// sharp edge or point, whose cut may hide between two rays [mm].
    pub hollow: Option<f64>,
    /// Ridges along X stand no higher than shown by more than this, on 99 % of the rays [mm].
    pub ridge: f64,
}

/// Why a program cannot be simulated.
#[derive(Debug, thiserror::Error)]
pub enum SimulateError {
    /// No axis words, so nobody knows where the tool is.
    #[error(
        "line {line}: the program cuts before it has placed axis {letter}; \
         give its words from the beginning of the program on"
    )]
    NotPlaced {
        /// The line.
        line: u32,
        /// The axis.
        letter: char,
    },
    /// A tool nobody described.
    #[error("line {line}: T{number} is none of the tools given; name a library that has it")]
    NoTool {
        /// The line.
        line: u32,
        /// The tool's number.
        number: u32,
    },
    /// No tool at all was given.
    #[error("no tool is given to simulate with")]
    NoTools,
    /// The stock cannot tell what a move does.
    #[error("between lines {first} and {last}: {problem}")]
    Stock {
        /// The first line of the moves in question.
        first: u32,
        /// The last line of the moves in question.
        last: u32,
        /// What the stock cannot tell.
        problem: StockError,
    },
    /// The caller asked to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// Runs `program` on `stock`. A single tool cuts throughout; of several the T words choose.
pub fn simulate(
    program: &Program,
    machine: &Machine,
    tools: &[Tool],
    stock: Stock,
    progress: &dyn Progress,
) -> Result<Simulation, SimulateError> {
    let first = tools.first().ok_or(SimulateError::NoTools)?;
    let n_steps = program.steps(machine).count();
    progress.start("simulating", n_steps as u64);
    let mut replay = Replay::new(program, machine, first, stock);
    let mut steps = program.steps(machine).peekable();
    while let Some(step) = steps.next() {
        if tools.len() > 1
            && let Some((number, line)) = replay.tool_change(step.i_block)
        {
            replay.flush(progress)?;
            let tool = tools.iter().find(|tool| tool.number == number);
            replay.tool = tool.ok_or(SimulateError::NoTool { line, number })?;
        }
        let is_last = steps.peek().is_none_or(|next| next.kind == StepKind::Rapid);
        replay.take(&step, is_last)?;
        if replay.sweeps.len() == BATCH {
            replay.flush(progress)?;
        }
    }
    replay.flush(progress)?;
    Ok(replay.finish())
}

struct Replay<'a> {
    program: &'a Program,
    machine: &'a Machine,
    tool: &'a Tool,
    stock: Stock,
    report: SimulationReport,
    /// Moves not yet cut.
    sweeps: Vec<Sweep>,
    facts: Vec<Fact>,
    /// Blocks before this one were looked through for tool changes.
    i_block: usize,
    /// The last move was a rapid, or there was none.
    was_rapid: bool,
    /// The least sharp edge that cut [mm]; none if one was sharp.
    roundest: Option<[f64; 2]>,
}

/// What a move is, besides where it goes.
struct Fact {
    line: u32,
    is_rapid: bool,
    is_lead: bool,
    seconds: f64,
}

impl<'a> Replay<'a> {
    fn new(program: &'a Program, machine: &'a Machine, tool: &'a Tool, stock: Stock) -> Self {
        let resolution = stock.layout().resolution();
        let start_volume = stock.volume();
        Self {
            program,
            machine,
            tool,
            report: SimulationReport {
                n_moves: 0,
                start_volume,
                end_volume: start_volume,
                removed: 0.0,
                feed_seconds: 0.0,
                air_seconds: 0.0,
                air_share: 0.0,
                greatest_depth: None,
                greatest_rate: None,
                n_collisions: 0,
                collisions: Vec::new(),
                n_overhanging: 0,
                resolution: ResolutionReport {
                    along: resolution.along,
                    across: resolution.across,
                    sweep: 0.0,
                    hollow: None,
                    ridge: 0.0,
                },
            },
            stock,
            sweeps: Vec::new(),
            facts: Vec::new(),
            i_block: 0,
            was_rapid: true,
            roundest: Some([f64::INFINITY; 2]),
        }
    }

    /// The last tool change before block `i_block` that was not yet obeyed, and its line.
    fn tool_change(&mut self, i_block: usize) -> Option<(u32, u32)> {
        let passed = &self.program.blocks[self.i_block..i_block];
        self.i_block = i_block;
        passed.iter().rev().find_map(|block| match block.kind {
            BlockKind::ToolChange(number) => Some((number, block.line)),
            _ => None,
        })
    }

    fn take(&mut self, step: &Step, is_last: bool) -> Result<(), SimulateError> {
        if step.kind == StepKind::Dwell {
            return Ok(());
        }
        self.report.n_moves += 1;
        let is_rapid = step.kind == StepKind::Rapid;
        let was_rapid = std::mem::replace(&mut self.was_rapid, is_rapid);
        let Some([from, to]) = self.placed(step)? else { return Ok(()) };
        // In and out of the material: along the attack axis alone, or beside a rapid.
        let attacks_alone = (0..self.machine.axes.len())
            .all(|axis| axis == self.machine.attack || from[axis] == to[axis]);
        self.sweeps.push(Sweep { from, to, engages: is_rapid || was_rapid });
        self.facts.push(Fact {
            line: step.line,
            is_rapid,
            is_lead: was_rapid || is_last || attacks_alone,
            seconds: step.seconds.unwrap_or(0.0),
        });
        Ok(())
    }

    /// Both ends of a move; `None` while rapids still place the axes.
    fn placed(&self, step: &Step) -> Result<Option<[AxisValues; 2]>, SimulateError> {
        let axes = self.machine.axes.iter().enumerate();
        let unplaced = axes
            .filter(|(_, axis)| axis.follows.is_none())
            .find(|(index, _)| step.from[*index].is_none());
        match unplaced {
            None => Ok(Some([step.from, step.to].map(|at| at.map(Option::unwrap_or_default)))),
            Some(_) if step.kind == StepKind::Rapid => Ok(None),
            Some((_, axis)) => {
                Err(SimulateError::NotPlaced { line: step.line, letter: axis.letter })
            }
        }
    }

    /// Cuts what was taken so far.
    fn flush(&mut self, progress: &dyn Progress) -> Result<(), SimulateError> {
        let (Some(first), Some(last)) = (self.facts.first(), self.facts.last()) else {
            return Ok(());
        };
        let (first, last) = (first.line, last.line);
        let cutter = self.tool.profile.cutter(0.0);
        let cuts = self.stock.remove(self.machine, &cutter, &self.sweeps, progress);
        let cuts = cuts.map_err(|problem| match problem {
            StockError::Cancelled(cancelled) => cancelled.into(),
            problem => SimulateError::Stock { first, last, problem },
        })?;
        self.roundest = self
            .roundest
            .zip(roundness(&cutter))
            .map(|([along, across], new)| [along.min(new[0]), across.min(new[1])]);
        let facts = std::mem::take(&mut self.facts);
        for (fact, cut) in facts.iter().zip(&cuts) {
            self.judge(fact, cut);
        }
        self.sweeps.clear();
        Ok(())
    }

    fn judge(&mut self, fact: &Fact, cut: &Cut) {
        let report = &mut self.report;
        report.removed += cut.removed;
        report.n_overhanging += usize::from(cut.n_overhangs > 0);
        if cut.is_through {
            let is_turned = self.stock.layout().is_turned();
            let kind =
                if is_turned { CollisionKind::AcrossAxis } else { CollisionKind::BelowBlock };
            report.collide(Collision { line: fact.line, kind, depth: cut.depth });
        }
        if fact.is_rapid {
            if cut.depth > TOUCH + 2.0 * self.stock.sweep_error() {
                let kind = CollisionKind::Rapid;
                report.collide(Collision { line: fact.line, kind, depth: cut.depth });
            }
            return;
        }
        keep_greatest(&mut report.greatest_depth, cut.depth, fact.line);
        if fact.seconds > 0.0 {
            keep_greatest(&mut report.greatest_rate, cut.removed / fact.seconds, fact.line);
        }
        if !fact.is_lead {
            report.feed_seconds += fact.seconds;
            report.air_seconds += if cut.depth < AIR { fact.seconds } else { 0.0 };
        }
    }

    fn finish(mut self) -> Simulation {
        let report = &mut self.report;
        report.end_volume = self.stock.volume();
        if report.feed_seconds > 0.0 {
            report.air_share = report.air_seconds / report.feed_seconds;
        }
        let resolution = &mut report.resolution;
        resolution.sweep = self.stock.sweep_error();
        resolution.ridge = ridge_error(&self.stock);
        // A surface hollow with radius r sinks s^2 / (8 r) between rays s apart; around a part the
        // part's own roundness comes on top.
        let round = |[along, across]: [f64; 2]| {
            let layout = self.stock.layout();
            let around = if layout.is_turned() { 1.0 / layout.reach() } else { 0.0 };
            resolution.along.powi(2) / (8.0 * along)
                + resolution.across.powi(2) / 8.0 * (1.0 / across + around)
        };
        resolution.hollow = self.roundest.filter(|round| round[0] > 0.0).map(round);
        Simulation { stock: self.stock, report: self.report }
    }
}

impl Collision {
    /// What it is, for people.
    pub fn in_words(&self) -> String {
        match self.kind {
            CollisionKind::Rapid => {
                format!("a rapid runs {:.2} mm deep through material", self.depth)
            }
            CollisionKind::AcrossAxis => {
                "the tool lies across the spindle axis and cuts the part in two".into()
            }
            CollisionKind::BelowBlock => "the tool goes below the block, into the table".into(),
        }
    }
}

impl SimulationReport {
    fn collide(&mut self, collision: Collision) {
        self.n_collisions += 1;
        if self.collisions.len() < MOST_COLLISIONS {
            self.collisions.push(collision);
        }
    }
}

fn keep_greatest(extreme: &mut Option<Extreme>, value: f64, line: u32) {
    if value > extreme.map_or(0.0, |found| found.value) {
        *extreme = Some(Extreme { value, line });
    }
}

/// The least radii of a tool along X and across it; `None` if it has an edge or a point.
fn roundness(cutter: &Cutter) -> Option<[f64; 2]> {
    match cutter {
        Cutter::Wheel(wheel) => Some([wheel.minor, wheel.major + wheel.minor]),
        Cutter::Mill(mill) => mill.ball_radius().map(|radius| [radius; 2]),
    }
}
