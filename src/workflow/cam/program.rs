//! The toolpath as a program: written, and read back before anybody may run it.

use super::{CamError, CamOptions};
use crate::cam::{Move, Toolpath};
use crate::gcode::{self, CheckReport, Dialect, Header, Posted, Program, StepKind};
use crate::machine::{AxisKind, AxisValues, Machine};
use crate::tool::Tool;

/// A program as the bytes of its file, with what reading them back says of it.
pub(super) struct Written {
    pub(super) text: Vec<u8>,
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
    }
}

/// Writes the program, reads it back, and makes sure that it gives the toolpath.
pub(super) fn write_and_read_back(
    posted: Posted,
    dialect: &Dialect,
    machine: &Machine,
    toolpath: &Toolpath,
) -> Result<Written, CamError> {
    let warnings = posted.warnings.iter().map(ToString::to_string).collect();
    let mut text = Vec::new();
    // Writing into memory does not fail.
    let _ = gcode::write(&posted.program, dialect, &mut text);
    drop(posted);
    let lost = |_| CamError::ReadBack { i_move: 0 };
    let program = gcode::read(&mut text.as_slice(), machine).map_err(lost)?;
    goes_along(&program, machine, toolpath, dialect)?;
    Ok(Written { text, check: gcode::check(&program, machine), warnings })
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
    for (i_move, planned) in toolpath.moves.iter().enumerate() {
        let is_near = |end: &AxisValues| is_near(machine, end, planned, dialect);
        if i_move == 0 {
            at = ends.find(is_near);
        } else if let Some(next) = ends.next_if(is_near) {
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

/// Within half the last decimal of every word.
fn is_near(machine: &Machine, end: &AxisValues, planned: &Move, dialect: &Dialect) -> bool {
    // A hundredth more: the comparison itself is rounded.
    let half = |decimals: u8| 0.505 * 10f64.powi(-i32::from(decimals));
    machine.axes.iter().enumerate().filter(|(_, axis)| axis.follows.is_none()).all(|(i, axis)| {
        let allowed = match axis.kind {
            AxisKind::Linear => half(dialect.decimals.linear),
            AxisKind::Rotary => half(dialect.decimals.rotary).to_radians(),
        };
        (end[i] - planned.to[i]).abs() <= allowed
    })
}
