//! The toolpath as a program: written, and read back before anybody may run it.

use super::operation::Operation;
use super::{CamError, CamOptions};
use crate::cam::{Move, Toolpath};
use crate::gcode::{self, CheckReport, Dialect, Header, Posted, Program, StepKind};
use crate::machine::{AxisKind, AxisValues, Machine};
use std::f64::consts::TAU;
use std::iter::Peekable;

/// Moves before the first of a path, at most: the retreat of the path before it, and the approach.
const MOST_BEFORE: usize = 5;

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
pub(super) fn header(operations: &[Operation], machine: &Machine, options: &CamOptions) -> Header {
    let reports = || operations.iter().map(|operation| &operation.report);
    // The block as it came out, so that the program can be verified on it.
    let block = reports().find_map(|report| report.rough.as_ref()?.shape.clone());
    let asked = CamOptions {
        block: block.or_else(|| options.block.clone()),
        // Whatever computed it, the program is the same.
        compute: None,
        adapter: None,
        ..options.clone()
    };
    let asked = serde_json::to_string(&asked).unwrap_or_default();
    let mut lines: Vec<String> = Vec::new();
    lines.extend(reports().take(1).map(|report| format!("part {}", report.part.name)));
    lines.push(format!("machine {}", machine.name));
    lines.extend(operations.iter().map(|Operation { tool, .. }| {
        format!("tool T{} {}: {}", tool.number, tool.name, tool.profile)
    }));
    lines.push(format!("options {asked}"));
    lines.push(format!("made by horma {}", env!("CARGO_PKG_VERSION")));
    lines.extend(reports().filter_map(|report| report.rough.as_ref()).map(|rough| {
        format!("roughing from {}, {} mm at most a layer", rough.block, rough.max_depth)
    }));
    if reports().any(|report| report.part.mode == "points") {
        lines.push("digitized on points alone, as in the thesis".into());
    }
    Header {
        lines,
        // A block that is roughed is told instead.
        stock: reports().next().filter(|first| first.rough.is_none()).map(|first| first.stock),
        number: options.program_number,
        tolerance: options.corner_tolerance,
        coolant: options.coolant,
    }
}

/// Writes the program, reads it back, and makes sure that it gives the toolpaths, which are gone
/// before the program is timed: with a million moves each of them takes 70 MB or more.
pub(super) fn write_and_read_back(
    posted: Posted,
    dialect: &Dialect,
    machine: &Machine,
    paths: Vec<Toolpath>,
    most_bytes: Option<usize>,
) -> Result<Written, CamError> {
    let warnings = posted.warnings.iter().map(ToString::to_string).collect();
    let text = text(&posted.program, dialect);
    let parts = parts(&posted.program, dialect, machine, most_bytes)?;
    drop(posted);
    let program = read_back(&text, dialect, machine)?;
    goes_along(&program, machine, &paths, dialect)?;
    drop(paths);
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

/// Refuses a program that goes anywhere but along `paths`, each after its approach and before its
/// retreat.
fn goes_along(
    program: &Program,
    machine: &Machine,
    paths: &[Toolpath],
    dialect: &Dialect,
) -> Result<(), CamError> {
    let moves = program.steps(machine).filter(|step| step.kind != StepKind::Dwell);
    let mut ends = moves.filter_map(|step| step.values(program)).peekable();
    let mut n_before = 0;
    for path in paths {
        follow(&mut ends, machine, &path.moves, dialect)
            .map_err(|i_move| CamError::ReadBack { i_move: n_before + i_move })?;
        n_before += path.moves.len();
    }
    match ends.count() {
        0 | 1 => Ok(()),
        _ => Err(CamError::ReadBack { i_move: n_before }),
    }
}

/// Follows one path; the first move that is not there.
fn follow(
    ends: &mut Peekable<impl Iterator<Item = AxisValues>>,
    machine: &Machine,
    moves: &[Move],
    dialect: &Dialect,
) -> Result<(), usize> {
    let mut at = None;
    let mut turns = AxisValues::default();
    for (i_move, planned) in moves.iter().enumerate() {
        if i_move == 0 {
            at = ends.by_ref().take(MOST_BEFORE).find(|end| {
                // Some controls call angles by less than they have turned, here from the start on.
                turns = whole_turns(machine, end, planned);
                is_near(machine, end, planned, &turns, dialect)
            });
            if at.is_none() {
                return Err(i_move);
            }
            continue;
        }
        let is_near = |end: &AxisValues| is_near(machine, end, planned, &turns, dialect);
        if let Some(next) = ends.next_if(is_near) {
            at = Some(next);
        }
        // A move too small for a word has no block: the machine is there already.
        if !at.as_ref().is_some_and(is_near) {
            return Err(i_move);
        }
    }
    Ok(())
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
