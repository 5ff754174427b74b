//! The operations of a program: what is cut between a start of the cutter and the next.

use super::PlannedTime;
use crate::gcode::{BlockKind, Program, SpindleRun};
use serde::Serialize;

/// How long an operation takes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct OperationTime {
    /// The T word of its tool, if the program has said one.
    pub tool: Option<u32>,
    /// The line in which its cutter starts.
    pub line: u32,
    /// What it takes from there, or from the program's first line, to the next operation.
    pub planned: PlannedTime,
}

/// Where the cutter starts.
#[derive(Debug, Clone, Copy)]
pub(super) struct Start {
    pub(super) i_block: usize,
    pub(super) line: u32,
    pub(super) tool: Option<u32>,
}

/// Every start of a cutter that stood.
pub(super) fn starts(program: &Program) -> impl Iterator<Item = Start> {
    let (mut tool, mut runs) = (None, false);
    program.blocks.iter().enumerate().filter_map(move |(i_block, block)| {
        let stood = !runs;
        match block.kind {
            BlockKind::ToolChange(number) => (tool, runs) = (Some(number), false),
            BlockKind::Spindle(spindle) => {
                runs = spindle.run.map_or(runs, |run| run != SpindleRun::Stop);
            }
            _ => {}
        }
        (stood && runs).then_some(Start { i_block, line: block.line, tool })
    })
}
