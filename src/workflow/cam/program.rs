//! The toolpath as a program: written, and read back before anybody may run it.

use super::{CamError, CamOptions};
use crate::cam::{Move, Toolpath};
use crate::gcode::{self, CheckReport, Dialect, Header, Posted, Program, StepKind};
use crate::machine::{AxisKind, AxisValues, Machine};
use crate::tool::Tool;
use std::f64::consts::TAU;

/// A program as the bytes of its file, with what reading them back says of it.
pub(super) struct Written {
    pub(super) text: Vec<u8>,
    /// The same in parts, if it was too large.
    pub(super) parts: Vec<Vec<u8>>,
    pub(super) check: CheckReport,
    /// What the post had to say.
    pub(super) warnings: Vec<String>,
}

/// What stands at the head of the program.
pub(super) fn header(
    name: &str,
    tool: &Tool,
    machine: &Machine,
    options: &CamOptions,
    stock: f64,
) -> Header {
    let asked = serde_json::to_string(options).unwrap_or_default();
    Header {
        lines: vec![
            format!("part {name}"),
            format!("machine {}", machine.name),
            format!("tool T{} {}: {}", tool.number, tool.name, tool.profile),
            format!("options {asked}"),
            format!("made by horma {}", env!("CARGO_PKG_VERSION")),
        ],
        stock: Some(stock),
        number: options.program_number,
        tolerance: options.corner_tolerance,
        coolant: options.coolant,
    }
}

/// Writes the program, reads it back, and makes sure that it gives the toolpath, which is gone
/// before the program is timed: with a million moves each of them takes 70 MB or more.
pub(super) fn write_and_read_back(
    posted: Posted,
    dialect: &Dialect,
    machine: &Machine,
    toolpath: Toolpath,
    most_bytes: Option<usize>,
) -> Result<Written, CamError> {
    let warnings = posted.warnings.iter().map(ToString::to_string).collect();
    let text = text(&posted.program, dialect);
    let parts = parts(&posted.program, dialect, machine, most_bytes)?;
    drop(posted);
    let program = read_back(&text, dialect, machine)?;
    goes_along(&program, machine, &toolpath, dialect)?;
    drop(toolpath);
    Ok(Written { text, parts, check: gcode::check(&program, machine), warnings })
}

fn text(program: &Program, dialect: &Dialect) -> Vec<u8> {
    let mut text = Vec::new();
    // Writing into memory does not fail.
    let _ = gcode::write(program, dialect, &mut text);
    text
}

fn read_back(text: &[u8], dialect: &Dialect, machine: &Machine) -> Result<Program, CamError> {
    let lost = |_| CamError::ReadBack { i_move: 0 };
    gcode::read(&mut &*text, machine, dialect).map_err(lost)
}

/// The texts of the parts of a program too large for its control, each read back; none if it fits.
fn parts(
    program: &Program,
    dialect: &Dialect,
    machine: &Machine,
    most_bytes: Option<usize>,
) -> Result<Vec<Vec<u8>>, CamError> {
    let Some(limit) = most_bytes.or(dialect.max_program_bytes) else { return Ok(Vec::new()) };
    let parts = gcode::split(program, machine, dialect, limit)?;
    if parts.len() == 1 {
        return Ok(Vec::new());
    }
    let texts: Vec<Vec<u8>> = parts.iter().map(|part| text(part, dialect)).collect();
    for text in &texts {
        read_back(text, dialect, machine)?;
    }
    Ok(texts)
}

/// Refuses a program that goes anywhere but along `toolpath`, after its approach and before its
/// retreat.
fn goes_along(
    program: &Program,
    machine: &Machine,
    toolpath: &Toolpath,
    dialect: &Dialect,
) -> Result<(), CamError> {
    let moves = program.steps(machine).filter(|step| step.kind != StepKind::Dwell);
    let mut ends = moves.filter_map(|step| step.values(program)).peekable();
    let mut at = None;
    let mut turns = AxisValues::default();
    for (i_move, planned) in toolpath.moves.iter().enumerate() {
        if i_move == 0 {
            at = ends.find(|end| {
                // Some controls call angles by less than they have turned, here from the start on.
                turns = whole_turns(machine, end, planned);
                is_near(machine, end, planned, &turns, dialect)
            });
            if at.is_none() {
                return Err(CamError::ReadBack { i_move });
            }
            continue;
        }
        let is_near = |end: &AxisValues| is_near(machine, end, planned, &turns, dialect);
        if let Some(next) = ends.next_if(is_near) {
            at = Some(next);
        }
        // A move too small for a word has no block: the machine is there already.
        if !at.as_ref().is_some_and(is_near) {
            return Err(CamError::ReadBack { i_move });
        }
    }
    match ends.count() {
        0 | 1 => Ok(()),
        _ => Err(CamError::ReadBack { i_move: toolpath.moves.len() }),
    }
}

/// By how many whole turns each endless axis is called otherwise than planned [rad].
fn whole_turns(machine: &Machine, end: &AxisValues, planned: &Move) -> AxisValues {
    let mut turns = AxisValues::default();
    for (i, axis) in machine.axes.iter().enumerate() {
        if axis.kind == AxisKind::Rotary && axis.limits.is_none() {
            turns[i] = TAU * ((end[i] - planned.to[i]) / TAU).round();
        }
    }
    turns
}

/// Within half the last decimal of every word.
fn is_near(
    machine: &Machine,
    end: &AxisValues,
    planned: &Move,
    turns: &AxisValues,
    dialect: &Dialect,
) -> bool {
    // A hundredth more: the comparison itself is rounded.
    let half = |decimals: u8| 0.505 * 10f64.powi(-i32::from(decimals));
    machine.axes.iter().enumerate().filter(|(_, axis)| axis.follows.is_none()).all(|(i, axis)| {
        let allowed = match axis.kind {
            AxisKind::Linear => half(dialect.decimals.linear),
            AxisKind::Rotary => half(dialect.decimals.rotary).to_radians(),
        };
        (end[i] - turns[i] - planned.to[i]).abs() <= allowed
    })
}
