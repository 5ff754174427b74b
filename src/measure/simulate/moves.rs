//! The moves of a program with all a simulation must know of them, some at a time.

use super::SimulateError;
use crate::gcode::{BlockKind, Program, Step, StepKind};
use crate::machine::{AxisValues, Machine};
use crate::stock::Sweep;
use crate::tool::Tool;
use std::ops::Range;

/// Moves handed over together.
const BATCH: usize = 65_536;

/// Some moves of one tool.
pub(in crate::measure) struct Batch<'a> {
    /// What cuts.
    pub(in crate::measure) tool: &'a Tool,
    /// Where it goes.
    pub(in crate::measure) sweeps: Vec<Sweep>,
    /// What else there is to know, move by move.
    pub(super) facts: Vec<Fact>,
}

/// What a move is, besides where it goes.
pub(super) struct Fact {
    pub(super) line: u32,
    pub(super) is_rapid: bool,
    /// In or out of the material: along the attack axis alone, or beside a rapid.
    pub(super) is_lead: bool,
    pub(super) seconds: f64,
}

impl Batch<'_> {
    /// The first and the last line.
    pub(in crate::measure) fn lines(&self) -> [u32; 2] {
        let line = |fact: Option<&Fact>| fact.map_or(0, |fact| fact.line);
        [line(self.facts.first()), line(self.facts.last())]
    }

    /// The moves in strokes: some rapids, and the feed moves they lead to.
    pub(super) fn strokes(&self) -> Vec<Range<usize>> {
        let is_first = |i: &usize| self.facts[*i].is_rapid && !self.facts[i - 1].is_rapid;
        let starts = (1..self.facts.len()).filter(is_first).chain([self.facts.len()]);
        let mut from = 0;
        let stroke = |to: usize| std::mem::replace(&mut from, to)..to;
        starts.map(stroke).collect()
    }

    /// The line of a move.
    pub(in crate::measure) fn line(&self, i_sweep: usize) -> Option<u32> {
        self.facts.get(i_sweep).map(|fact| fact.line)
    }
}

/// Hands all moves of `program` over in order, with the tool that makes them. A single tool cuts
/// throughout; of several the T words choose.
pub(in crate::measure) fn for_each_batch(
    program: &Program,
    machine: &Machine,
    tools: &[Tool],
    mut take: impl FnMut(Batch) -> Result<(), SimulateError>,
) -> Result<(), SimulateError> {
    let tool = tools.first().ok_or(SimulateError::NoTools)?;
    let mut batch = Batch { tool, sweeps: Vec::new(), facts: Vec::new() };
    // Blocks before this one were looked through for tool changes.
    let mut i_block = 0;
    let mut was_rapid = true;
    let mut steps = program.steps(machine).filter(|step| step.kind != StepKind::Dwell).peekable();
    while let Some(step) = steps.next() {
        let change = tool_change(program, i_block, step.i_block);
        i_block = step.i_block;
        let mut tool = batch.tool;
        if let Some((number, line)) = change.filter(|_| tools.len() > 1) {
            let named = tools.iter().find(|tool| tool.number == number);
            tool = named.ok_or(SimulateError::NoTool { line, number })?;
        }
        if batch.sweeps.len() == BATCH || tool.number != batch.tool.number {
            let next = Batch { tool, sweeps: Vec::new(), facts: Vec::new() };
            take(std::mem::replace(&mut batch, next))?;
        }
        let is_last = steps.peek().is_none_or(|next| next.kind == StepKind::Rapid);
        let is_rapid = step.kind == StepKind::Rapid;
        if let Some([from, to]) = placed(machine, &step)? {
            let attacks_alone = (0..machine.axes.len())
                .all(|axis| axis == machine.attack || from[axis] == to[axis]);
            batch.sweeps.push(Sweep { from, to, engages: is_rapid || was_rapid });
            batch.facts.push(Fact {
                line: step.line,
                is_rapid,
                is_lead: was_rapid || is_last || attacks_alone,
                seconds: step.seconds.unwrap_or(0.0),
            });
        }
        was_rapid = is_rapid;
    }
    if batch.sweeps.is_empty() { Ok(()) } else { take(batch) }
}

/// The last tool change between two blocks, and its line.
fn tool_change(program: &Program, from: usize, to: usize) -> Option<(u32, u32)> {
    program.blocks[from..to].iter().rev().find_map(|block| match block.kind {
        BlockKind::ToolChange(number) => Some((number, block.line)),
        _ => None,
    })
}

/// Both ends of a move; `None` while rapids still place the axes.
fn placed(machine: &Machine, step: &Step) -> Result<Option<[AxisValues; 2]>, SimulateError> {
    let axes = machine.axes.iter().enumerate();
    let unplaced = axes
        .filter(|(_, axis)| axis.follows.is_none())
        .find(|(index, _)| step.from[*index].is_none());
    match unplaced {
        None => Ok(Some([step.from, step.to].map(|at| at.map(Option::unwrap_or_default)))),
        Some(_) if step.kind == StepKind::Rapid => Ok(None),
        Some((_, axis)) => Err(SimulateError::NotPlaced { line: step.line, letter: axis.letter }),
    }
}
