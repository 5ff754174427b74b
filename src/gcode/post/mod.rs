//! From a toolpath to a program.
//!
//! Every program has the same shape: comments, the dialect's preamble, the attack axis to where
//! nothing can be touched, tool, spindle, the other axes to their start, the moves, the attack axis
//! back, spindle off, end. A move with a duration goes out in inverse time; how it keeps its time honest
//! while words are rounded is told in `body.rs`.

mod body;
mod error;
mod fword;

use super::check::{AxisBounds, CheckReport, check};
use super::number::round_to;
use super::write::{comment_lines, longest_move, n_lines};
use super::{BlockKind, Coolant, Dialect, Language, Program, Spindle, SpindleRun, Tape};
use crate::cam::Toolpath;
use crate::machine::Machine;
use crate::tool::{Tool, Turns};
use body::Body;

pub use error::{PostError, PostWarning};

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
    let mut in_spindle = None;
    for Operation { path, tool } in operations {
        body.begin(path)?;
        if in_spindle != Some(tool.number) {
            body.program.push(BlockKind::ToolChange(tool.number));
            in_spindle = Some(tool.number);
        }
        start_spindle(&mut body.program, tool, dialect);
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

fn check_letters(machine: &Machine, dialect: &Dialect) -> Result<(), PostError> {
    let letters: Vec<char> = machine.axes.iter().map(|axis| dialect.letter(axis.letter)).collect();
    let twice = letters.iter().enumerate().find(|(i, letter)| letters[..*i].contains(letter));
    twice.map_or(Ok(()), |(_, &letter)| {
        let (machine, dialect) = (machine.name.clone(), dialect.name.clone());
        Err(PostError::SameLetter { letter, machine, dialect })
    })
}

fn start_spindle(program: &mut Program, tool: &Tool, dialect: &Dialect) {
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
    let planned = report.planned.total();
    comments.push(format!("time: {}, accelerations included", clock(planned)));
    comments.extend(report.several_operations().iter().map(|operation| {
        let tool = operation.tool.map_or_else(String::new, |tool| format!(" with T{tool}"));
        format!("of it{tool}: {}", clock(operation.planned.total()))
    }));
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
