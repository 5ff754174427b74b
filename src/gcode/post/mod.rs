//! From a toolpath to a program.
//!
//! Every program has the same shape: comments, the dialect's preamble, the attack axis to where
//! nothing can be touched, tool, spindle, the other axes to their start, the moves, the attack axis
//! back, spindle off, end. A move with a duration goes out in inverse time; how it keeps its time honest
//! while words are rounded is told in `body.rs`.

mod body;
mod fword;

use super::check::{AxisBounds, CheckReport, check};
use super::number::round_to;
use super::write::{comment_lines, longest_move, n_lines};
use super::{BlockKind, Coolant, Dialect, Language, Program, Spindle, SpindleRun, Tape};
use crate::cam::Toolpath;
use crate::machine::Machine;
use crate::tool::{Tool, Turns};
use body::Body;
use std::fmt;

/// One path with one tool.
#[derive(Debug, Clone, Copy)]
pub struct Operation<'a> {
    /// The path.
    pub path: &'a Toolpath,
    /// The tool.
    pub tool: &'a Tool,
}

/// What a program is told before its path, and says about itself.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Header {
    /// Comment lines: part, tool, machine, options.
    pub lines: Vec<String>,
    /// How deep the first cut may be, where the program relies on it [mm].
    pub stock: Option<f64>,
    /// What the program is called, where the control wants a number [default: 1].
    pub number: Option<u32>,
    /// By how much the control may round corners off [mm; default: the dialect's tolerance].
    pub tolerance: Option<f64>,
    /// What cools the cut [default: nothing].
    pub coolant: Option<Coolant>,
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
    /// The control has no F word for as fast as the toolpath asks for, or not with as many digits.
    FeedLowered {
        /// How many blocks.
        n_blocks: usize,
        /// The first of them, by line.
        first_line: u32,
        /// How much later the program is done [s].
        seconds: f64,
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
    /// A machine that turns something, for a control that cannot.
    #[error(
        "{machine} turns {axis}, but {dialect} has linear axes alone; choose a control with rotary \
         axes, such as linuxcnc or grblhal, with --dialect"
    )]
    NoRotary {
        /// The rotary axis.
        axis: char,
        /// The machine.
        machine: String,
        /// The dialect.
        dialect: String,
    },
    /// A block that turns so far that the control could take the other way.
    #[error(
        "move {i_move} turns {axis} by {degrees} degrees at once, but {dialect} takes the shorter \
         way; use more points per turn"
    )]
    HalfTurn {
        /// The move.
        i_move: usize,
        /// The rotary axis.
        axis: char,
        /// How far.
        degrees: f64,
        /// The dialect.
        dialect: String,
    },
    /// A coolant the control has no word for.
    #[error("{dialect} has no word for {coolant:?} coolant; choose another one, or none")]
    NoCoolant {
        /// The coolant.
        coolant: Coolant,
        /// The dialect.
        dialect: String,
    },
    /// Two axes by the same letter.
    #[error("{dialect} calls two axes of {machine} {letter}; change its letters")]
    SameLetter {
        /// The letter.
        letter: char,
        /// The machine.
        machine: String,
        /// The dialect.
        dialect: String,
    },
    /// A tolerance that is none.
    #[error("the tolerance for corners is {value} mm; it must be a number, 0.0001 or more")]
    Tolerance {
        /// Its value.
        value: f64,
    },
    /// A name the control does not take.
    #[error("program number {number} is not one of 1 to 9999")]
    Number {
        /// The number.
        number: u32,
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
    post_operations(&[Operation { path, tool }], machine, dialect, header)
}

/// The program of several operations one after the other, each with its own tool.
pub fn post_operations(
    operations: &[Operation],
    machine: &Machine,
    dialect: &Dialect,
    header: &Header,
) -> Result<Posted, PostError> {
    check_letters(machine, dialect)?;
    let mut body = Body::new(machine, dialect);
    for Operation { path, tool } in operations {
        body.begin(path)?;
        mount(&mut body.program, tool, dialect);
        body.cool(header.coolant.unwrap_or(Coolant::Off))?;
        body.approach(path)?;
        for (i_move, step) in path.moves.iter().enumerate().skip(1) {
            body.take(i_move, step)?;
        }
        body.retreat(path.clear);
    }
    if operations.is_empty() {
        return Err(PostError::Empty);
    }
    let report = check(&body.program, machine);
    fits_lines(&body.program, &report.bounds, dialect)?;
    let front = front(&report, dialect, header)?;
    let n_front = front.blocks.len();
    let program = join(front, std::mem::take(&mut body.program), dialect);
    let warnings = body.warnings(|i_block| program.blocks[n_front + i_block].line);
    Ok(Posted { program, warnings })
}

impl fmt::Display for PostWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::FeedRaised { n_blocks, first_line, seconds, min_rate } => write!(
                f,
                "{n_blocks} blocks (the first in line {first_line}) run {seconds:.3} s faster than \
                 planned: the control goes no slower than {min_rate} mm/min"
            ),
            Self::FeedLowered { n_blocks, first_line, seconds } => write!(
                f,
                "{n_blocks} blocks (the first in line {first_line}) run {seconds:.3} s slower than \
                 planned: the control has no F word for their pace"
            ),
        }
    }
}

fn check_letters(machine: &Machine, dialect: &Dialect) -> Result<(), PostError> {
    let letters: Vec<char> = machine.axes.iter().map(|axis| dialect.letter(axis.letter)).collect();
    let twice = letters.iter().enumerate().find(|(i, letter)| letters[..*i].contains(letter));
    twice.map_or(Ok(()), |(_, &letter)| {
        let (machine, dialect) = (machine.name.clone(), dialect.name.clone());
        Err(PostError::SameLetter { letter, machine, dialect })
    })
}

/// Tool and spindle.
fn mount(program: &mut Program, tool: &Tool, dialect: &Dialect) {
    program.push(BlockKind::ToolChange(tool.number));
    let run = Some(match tool.turns {
        Turns::Clockwise => SpindleRun::Clockwise,
        Turns::CounterClockwise => SpindleRun::CounterClockwise,
    });
    let speed_rpm = Some(round_to(tool.speed_rpm, dialect.decimals.speed));
    // In Klartext they are two lines, and so two blocks.
    if dialect.language == Language::Klartext {
        program.push(BlockKind::Spindle(Spindle { speed_rpm, run: None }));
        program.push(BlockKind::Spindle(Spindle { speed_rpm: None, run }));
    } else {
        program.push(BlockKind::Spindle(Spindle { speed_rpm, run }));
    }
}

/// What stands before the first move: comments and preamble.
fn front(report: &CheckReport, dialect: &Dialect, header: &Header) -> Result<Program, PostError> {
    let mut front = Program::default();
    if matches!(dialect.tape, Tape::Percent | Tape::PercentNumber) {
        front.push(BlockKind::Percent);
    }
    if matches!(dialect.tape, Tape::PercentNumber | Tape::Pgm) {
        let number = header.number.unwrap_or(1);
        if !(1..=9999).contains(&number) {
            return Err(PostError::Number { number });
        }
        front.push(BlockKind::Number(number));
    }
    for comment in comments(report, header) {
        for line in comment_lines(&comment, dialect) {
            front.push(BlockKind::Comment(line));
        }
    }
    for &modes in &dialect.preamble {
        front.push(BlockKind::Modes(modes));
    }
    for line in &dialect.setup {
        front.push(BlockKind::Setup(line.as_str().into()));
    }
    if let Some(smoothing) = &dialect.smoothing {
        let value = header.tolerance.unwrap_or(smoothing.tolerance);
        // A tenth of a micrometre is the least that is written.
        if !value.is_finite() || value < 1e-4 {
            return Err(PostError::Tolerance { value });
        }
        front.push(BlockKind::Smoothing(Some(round_to(value, 4))));
    }
    Ok(front)
}

/// The whole program; a block's line is the last of its lines, where it takes effect.
fn join(front: Program, body: Program, dialect: &Dialect) -> Program {
    let mut program = body;
    program.blocks.splice(0..0, front.blocks);
    close(&mut program, dialect);
    let mut line = 0;
    for block in &mut program.blocks {
        line += n_lines(&block.kind, dialect);
        block.line = line;
    }
    program
}

/// Ends a program.
pub(super) fn close(program: &mut Program, dialect: &Dialect) {
    if dialect.smoothing.as_ref().is_some_and(|smoothing| !smoothing.off.is_empty()) {
        program.push(BlockKind::Smoothing(None));
    }
    program.push(BlockKind::End);
    if dialect.tape != Tape::None {
        program.push(BlockKind::Percent);
    }
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
