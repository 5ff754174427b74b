//! What a machine would have against a program, before it runs.

mod operation;
mod report;
mod time;

use super::number::round_to;
use super::{Address, Block, BlockKind, Program, Step, StepKind};
use crate::machine::{Axis, AxisKind, MAX_AXES, Machine};
use std::collections::VecDeque;
use time::Stopwatch;

pub use operation::OperationTime;
pub use report::{AxisBounds, BlockRate, CheckReport, Violation, ViolationKind};
pub use time::PlannedTime;

/// Blocks a second are counted over this many moves on end: as many as the smallest look-ahead
/// buffer in use holds (GRBL), so that a single short block is no alarm.
const BLOCK_WINDOW: usize = 16;

/// Numbers come from decimals; more than this part of a limit is beyond it.
const TOLERANCE: f64 = 1e-9;

/// Checks `program` against the `machine` it was posted or read for.
pub fn check(program: &Program, machine: &Machine) -> CheckReport {
    let mut checker = Checker::new(program, machine);
    let mut starts = operation::starts(program).peekable();
    for step in program.steps(machine) {
        while let Some(start) = starts.next_if(|start| start.i_block < step.i_block) {
            checker.stopwatch.start(&start);
        }
        checker.take(&step);
    }
    checker.finish()
}

struct Checker<'a> {
    program: &'a Program,
    machine: &'a Machine,
    report: CheckReport,
    /// Least and greatest value of each axis [mm or rad].
    bounds: [[f64; 2]; MAX_AXES],
    /// Times of the last feed moves, and their sum.
    window: VecDeque<f64>,
    stopwatch: Stopwatch<'a>,
    spindle_was_off: bool,
    was_placed: [bool; MAX_AXES],
}

impl<'a> Checker<'a> {
    fn new(program: &'a Program, machine: &'a Machine) -> Self {
        let report = CheckReport {
            n_blocks: program.blocks.len(),
            longest_line: program.longest_line,
            ..CheckReport::default()
        };
        Self {
            program,
            machine,
            report,
            bounds: [[f64::INFINITY, f64::NEG_INFINITY]; MAX_AXES],
            window: VecDeque::with_capacity(BLOCK_WINDOW + 1),
            stopwatch: Stopwatch::new(machine),
            spindle_was_off: false,
            was_placed: [false; MAX_AXES],
        }
    }

    /// Index, address and description of each axis.
    fn axes(&self) -> impl Iterator<Item = (usize, Address, &'a Axis)> + use<'a> {
        let axes = self.program.axes.iter().zip(&self.machine.axes).enumerate();
        axes.map(|(i_axis, (address, axis))| (i_axis, *address, axis))
    }

    fn take(&mut self, step: &Step) {
        let seconds = step.seconds.unwrap_or(0.0);
        self.report.seconds += seconds;
        self.stopwatch.take(step);
        if step.kind == StepKind::Dwell {
            self.window.clear();
            return;
        }
        self.report.n_moves += 1;
        self.take_limits(step);
        let distance = self.linear_way(step);
        if step.kind == StepKind::Rapid {
            self.report.rapid_distance_mm += distance;
            self.window.clear();
            return;
        }
        self.report.feed_seconds += seconds;
        self.report.feed_distance_mm += distance;
        self.take_start(step);
        self.take_feed(step);
        self.take_spindle(step);
        self.take_rate(step.line, seconds);
    }

    fn violate(&mut self, line: u32, kind: ViolationKind) {
        self.report.violations.push(Violation { line, kind });
    }

    fn take_limits(&mut self, step: &Step) {
        for (i_axis, address, axis) in self.axes() {
            let Some(value) = step.to[i_axis] else { continue };
            let [least, greatest] = &mut self.bounds[i_axis];
            *least = least.min(value);
            *greatest = greatest.max(value);
            let moved = step.from[i_axis] != step.to[i_axis];
            if moved && let Some(limits) = axis.limits.filter(|limits| is_outside(value, *limits)) {
                let kind = ViolationKind::Limit {
                    axis: axis.letter,
                    word: for_people(address.word(value)),
                    limits: limits.map(|limit| for_people(address.word(limit))),
                    unit: address.unit(),
                };
                self.violate(step.line, kind);
            }
        }
    }

    /// A feed move of an axis nobody placed begins wherever the last program left it.
    fn take_start(&mut self, step: &Step) {
        for (i_axis, axis) in self.program.axes.iter().enumerate() {
            if step.from[i_axis].is_none() && !self.was_placed[i_axis] {
                self.was_placed[i_axis] = true;
                self.violate(step.line, ViolationKind::UnknownStart { axis: axis.letter });
            }
        }
    }

    fn take_feed(&mut self, step: &Step) {
        let Some(seconds) = step.seconds else {
            return self.violate(step.line, ViolationKind::NoFeed);
        };
        for (i_axis, address, axis) in self.axes() {
            let way = way(step, i_axis).abs();
            if way > axis.velocity * seconds * (1.0 + TOLERANCE) {
                let kind = ViolationKind::Velocity {
                    axis: axis.letter,
                    velocity: for_people(address.word(way / seconds)),
                    limit: for_people(address.word(axis.velocity)),
                    unit: address.unit(),
                };
                self.violate(step.line, kind);
            }
        }
    }

    fn take_spindle(&mut self, step: &Step) {
        if !step.spindle_on && !self.spindle_was_off {
            self.violate(step.line, ViolationKind::SpindleOff);
        }
        self.spindle_was_off = !step.spindle_on;
    }

    fn take_rate(&mut self, line: u32, seconds: f64) {
        self.window.push_back(seconds);
        if self.window.len() > BLOCK_WINDOW {
            self.window.pop_front();
        }
        let total: f64 = self.window.iter().sum();
        if self.window.len() < BLOCK_WINDOW || total <= 0.0 {
            return;
        }
        let highest = BLOCK_WINDOW as f64 / total;
        if self.report.block_rate.is_none_or(|rate| rate.highest < highest) {
            let limit = self.machine.blocks_per_second;
            self.report.block_rate = Some(BlockRate { highest, line, limit });
        }
    }

    fn linear_way(&self, step: &Step) -> f64 {
        let axes = self.program.axes.iter().enumerate();
        let linear = axes.filter(|(_, axis)| axis.kind == AxisKind::Linear);
        linear.map(|(i_axis, _)| way(step, i_axis).powi(2)).sum::<f64>().sqrt()
    }

    fn finish(mut self) -> CheckReport {
        let axes = self.program.axes.iter().zip(self.bounds);
        let placed = axes.filter(|(_, [least, greatest])| least <= greatest);
        self.report.bounds = placed
            .map(|(address, [least, greatest])| AxisBounds {
                axis: address.letter,
                unit: address.unit(),
                least: for_people(address.word(least)),
                greatest: for_people(address.word(greatest)),
            })
            .collect();
        let ends = |block: &Block| matches!(block.kind, BlockKind::End);
        if !self.program.blocks.iter().rev().take(2).any(ends) {
            let line = self.program.blocks.last().map_or(1, |block| block.line);
            self.violate(line, ViolationKind::NoEnd);
        }
        (self.report.operations, self.report.slowed) = self.stopwatch.finish();
        for operation in &self.report.operations {
            self.report.planned.add(&operation.planned);
        }
        self.report
    }
}

fn way(step: &Step, i_axis: usize) -> f64 {
    step.from[i_axis].zip(step.to[i_axis]).map_or(0.0, |(from, to)| to - from)
}

/// True if `value` is beyond `limits` by more than the noise of decimals.
pub(super) fn is_outside(value: f64, [least, greatest]: [f64; 2]) -> bool {
    let slack = TOLERANCE * least.abs().max(greatest.abs()).max(1.0);
    value < least - slack || greatest + slack < value
}

/// Takes the noise of radians out of a word: `90` for `90.00000000000001`.
fn for_people(word: f64) -> f64 {
    round_to(word, 9)
}
