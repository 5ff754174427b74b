//! A program, as read back from its file, replayed on a block.

mod bodies;
mod fixtures;
mod judge;
mod moves;
mod report;

pub use fixtures::{Fixture, Fixtures};
pub(super) use moves::for_each_batch;
pub use report::{
    BodiesReport, CheckedBody, Collision, CollisionKind, Extreme, ResolutionReport,
    SimulationReport,
};

use crate::gcode::{Program, StepKind};
use crate::machine::Machine;
use crate::progress::{Cancelled, Progress};
use crate::stock::{Stock, StockError};
use crate::tool::Tool;
use judge::Judge;

/// What a program runs on.
#[derive(Debug, Clone)]
pub struct Blank {
    /// The block.
    pub stock: Stock,
    /// What stands around it.
    pub fixtures: Fixtures,
}

/// What a program left of a block.
#[derive(Debug, Clone)]
pub struct Simulation {
    /// The block after the program.
    pub stock: Stock,
    /// What happened on the way.
    pub report: SimulationReport,
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

impl From<Stock> for Blank {
    /// A block with nothing known of what stands around it.
    fn from(stock: Stock) -> Self {
        Self { stock, fixtures: Fixtures::default() }
    }
}

/// Runs `program` on `blank`. A single tool cuts throughout; of several the T words choose.
pub fn simulate(
    program: &Program,
    machine: &Machine,
    tools: &[Tool],
    blank: Blank,
    progress: &dyn Progress,
) -> Result<Simulation, SimulateError> {
    let steps = || program.steps(machine);
    progress.start("simulating", steps().count() as u64);
    let mut judge = Judge::new(machine, blank);
    judge.report.n_moves = steps().filter(|step| step.kind != StepKind::Dwell).count();
    for_each_batch(program, machine, tools, |batch| judge.run(&batch, progress))?;
    Ok(judge.finish())
}

impl SimulateError {
    /// What the stock cannot tell, between two lines.
    pub(super) fn between([first, last]: [u32; 2], problem: StockError) -> Self {
        match problem {
            StockError::Cancelled(cancelled) => cancelled.into(),
            problem => Self::Stock { first, last, problem },
        }
    }
}
