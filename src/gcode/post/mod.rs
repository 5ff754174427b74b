//! From a toolpath to a program.
//!
//! Every program has the same shape: comments, the dialect's preamble, the attack axis to where
//! nothing can be touched, tool, spindle, the other axes to their start, the moves, the attack axis
//! back, spindle off, end. A move with a duration goes out in inverse time; how it keeps its time honest
//! while words are rounded is told in `body.rs`.

mod body;

use super::check::{AxisBounds, CheckReport, check};
use super::number::round_to;
use super::write::{SPEED_DECIMALS, comment_lines, longest_move};
use super::{BlockKind, Dialect, Program, Spindle, SpindleRun};
use crate::cam::Toolpath;
use crate::machine::Machine;
use crate::tool::{Tool, Turns};
use body::Body;
use std::fmt;

/// What a program says about itself before it begins.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Header {
    /// Comment lines: part, tool, machine, options.
    pub lines: Vec<String>,
    /// How deep the first cut may be, where the program relies on it [mm].
    pub stock: Option<f64>,
}

/// A program and what its author should know.
#[derive(Debug, Clone, PartialEq)]
pub struct Posted {
    /// The program.
    pub program: Program,
    /// What came out differently from what the toolpath asks for.
    pub warnings: Vec<PostWarning>,
}

/// What came out differently from what the toolpath asks for.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum PostWarning {
    /// The control would not move as slowly as the toolpath asks for; the F words say what it does.
    FeedRaised {
        /// How many blocks.
        n_blocks: usize,
        /// The first of them, by line.
        first_line: u32,
        /// How much sooner the program is done [s].
        seconds: f64,
        /// The control's slowest rate [mm/min].
        min_rate: f64,
    },
}

/// Why a toolpath cannot become a program. Moves are counted from 0, as in the toolpath.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PostError {
    /// There is nothing to write.
    #[error("the toolpath has no moves; there is nothing to write")]
    Empty,
    /// The path begins with a cut.
    #[error("move 0 is not a rapid: the machine may stand anywhere; begin with one to the start")]
    NoStart,
    /// A number that is none.
    #[error("move {i_move} sends {axis} to {value}, which is no position")]
    NotFinite {
        /// The move.
        i_move: usize,
        /// The axis.
        axis: char,
        /// Where it would go [mm or rad].
        value: f64,
    },
    /// An axis would leave its travel.
    #[error(
        "move {i_move} sends {axis} to {word} {unit}, outside its limits {} to {} {unit}; \
         shift the part or choose a larger machine", limits[0], limits[1]
    )]
    Limit {
        /// The move.
        i_move: usize,
        /// The axis.
        axis: char,
        /// The word it would have.
        word: f64,
        /// Its least and greatest word.
        limits: [f64; 2],
        /// `mm` or `deg`.
        unit: &'static str,
    },
    /// An axis would have to be faster than it is.
    #[error(
        "move {i_move} asks {axis} for {velocity:.6} {unit}/s, above its limit {limit:.6}; \
         give the move more time"
    )]
    Velocity {
        /// The move.
        i_move: usize,
        /// The axis.
        axis: char,
        /// The speed asked for, per second.
        velocity: f64,
        /// The greatest it has, per second.
        limit: f64,
        /// `mm` or `deg`.
        unit: &'static str,
    },
    /// A feed or a duration that is none.
    #[error("move {i_move} has the {what} {value}; it must be a number greater than 0")]
    Pace {
        /// The move.
        i_move: usize,
        /// `feed` or `duration`.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// A feed of the linear axes on a move that has none.
    #[error("move {i_move} turns rotary axes only, but its feed is of linear ones; use a duration")]
    RotaryFeed {
        /// The move.
        i_move: usize,
    },
    /// A timed rotary move for a control that cannot be told the time.
    #[error("move {i_move} turns {axis} in a given time, but {dialect} has no inverse time (G93)")]
    NoInverseTime {
        /// The move.
        i_move: usize,
        /// The rotary axis.
        axis: char,
        /// The dialect.
        dialect: String,
    },
    /// Blocks could be longer than the control reads.
    #[error("a block can take {length} characters, but {dialect} reads {limit}; use less decimals")]
    LineTooLong {
        /// The most a block of this program can take.
        length: usize,
        /// The most the control reads.
        limit: usize,
        /// The dialect.
        dialect: String,
    },
}

/// The program that takes `tool` along `path` on `machine`, as `dialect` wants it.
///
/// A program that would leave the limits of an axis, or ask it for more than its speed, is refused.
pub fn post(
    path: &Toolpath,
    machine: &Machine,
    tool: &Tool,
    dialect: &Dialect,
    header: &Header,
) -> Result<Posted, PostError> {
    let mut body = Body::new(machine, dialect);
    body.begin(path)?;
    mount(&mut body.program, tool);
    body.approach(path)?;
    for (i_move, step) in path.moves.iter().enumerate().skip(1) {
        body.take(i_move, step)?;
    }
    body.retreat(path.clear);
    let report = check(&body.program, machine);
    fits_lines(&body.program, &report.bounds, dialect)?;
    let front = front(&report, dialect, header);
    let warnings = body.warnings(front.blocks.len());
    Ok(Posted { program: join(front, body.program, dialect), warnings })
}

impl fmt::Display for PostWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::FeedRaised { n_blocks, first_line, seconds, min_rate } => write!(
                f,
                "{n_blocks} blocks (the first in line {first_line}) run {seconds:.3} s faster than \
                 planned: the control goes no slower than {min_rate} mm/min"
            ),
        }
    }
}

/// Tool and spindle.
fn mount(program: &mut Program, tool: &Tool) {
    program.push(BlockKind::ToolChange(tool.number));
    let run = Some(match tool.turns {
        Turns::Clockwise => SpindleRun::Clockwise,
        Turns::CounterClockwise => SpindleRun::CounterClockwise,
    });
    let speed_rpm = Some(round_to(tool.speed_rpm, SPEED_DECIMALS));
    program.push(BlockKind::Spindle(Spindle { speed_rpm, run }));
}

/// What stands before the first move: comments and preamble.
fn front(report: &CheckReport, dialect: &Dialect, header: &Header) -> Program {
    let mut front = Program::default();
    if dialect.percent {
        front.push(BlockKind::Percent);
    }
    for comment in comments(report, header) {
        for line in comment_lines(&comment, dialect) {
            front.push(BlockKind::Comment(line));
        }
    }
    for &modes in &dialect.preamble {
        front.push(BlockKind::Modes(modes));
    }
    front
}

/// The whole program, a line per block.
fn join(front: Program, body: Program, dialect: &Dialect) -> Program {
    let mut program = body;
    program.blocks.splice(0..0, front.blocks);
    program.push(BlockKind::End);
    if dialect.percent {
        program.push(BlockKind::Percent);
    }
    for (line, block) in (1..).zip(&mut program.blocks) {
        block.line = line;
    }
    program
}

fn comments(report: &CheckReport, header: &Header) -> Vec<String> {
    let mut comments = header.lines.clone();
    for AxisBounds { axis, unit, least, greatest } in &report.bounds {
        comments.push(format!("{axis}: {least:.4} to {greatest:.4} {unit}"));
    }
    comments.push(format!("time: {}, without acceleration", clock(report.seconds)));
    comments.push(format!("moves: {}", report.n_moves));
    if let Some(stock) = header.stock {
        comments.push(format!("assumes at most {stock:.2} mm of stock"));
    }
    comments
}

fn clock(seconds: f64) -> String {
    let whole = seconds.round() as u64;
    format!("{}:{:02}:{:02} h", whole / 3600, whole / 60 % 60, whole % 60)
}

fn fits_lines(
    program: &Program,
    bounds: &[AxisBounds],
    dialect: &Dialect,
) -> Result<(), PostError> {
    let greatest: Vec<_> =
        bounds.iter().map(|axis| axis.least.abs().max(axis.greatest.abs())).collect();
    let (length, limit) = (longest_move(program, &greatest, dialect), dialect.line_length);
    if length <= limit {
        return Ok(());
    }
    Err(PostError::LineTooLong { length, limit, dialect: dialect.name.clone() })
}
