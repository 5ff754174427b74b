//! How long a program takes on its machine: the planner of `cam`, run over the program as read.
//!
//! What is planned through without standing are feed moves on end, or rapids on end; the machine
//! stands between the two, at pauses, and where the cutter starts or stops.

use super::operation::{OperationTime, Start};
use super::{Step, StepKind, way};
use crate::cam::{
    Cause, Drive, Limit, Motion, Slow, Slowdowns, Slowed, Spot, Timing, drives, time_motion,
};
use crate::machine::{AxisKind, MAX_AXES, Machine};
use serde::Serialize;
use std::fmt;

/// Times of a program with the accelerations of its machine, by what it does [s].
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct PlannedTime {
    /// Rapids to where cutting begins.
    pub approach: f64,
    /// Feed moves.
    pub cutting: f64,
    /// Rapids between feed moves.
    pub links: f64,
    /// Rapids when all is cut.
    pub retreat: f64,
    /// Pauses.
    pub pauses: f64,
}

impl PlannedTime {
    /// All of it [s].
    pub fn total(&self) -> f64 {
        self.approach + self.cutting + self.links + self.retreat + self.pauses
    }

    pub(super) fn add(&mut self, other: &Self) {
        self.approach += other.approach;
        self.cutting += other.cutting;
        self.links += other.links;
        self.retreat += other.retreat;
        self.pauses += other.pauses;
    }
}

impl fmt::Display for PlannedTime {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { approach, cutting, links, retreat, pauses } = self;
        write!(f, "approach {approach:.1}, cutting {cutting:.1}, links {links:.1}, ")?;
        write!(f, "retreat {retreat:.1}, pauses {pauses:.1}")
    }
}

/// Takes the steps of a program and times them.
pub(super) struct Stopwatch<'a> {
    machine: &'a Machine,
    drives: Vec<Drive>,
    /// Operations that are over.
    operations: Vec<OperationTime>,
    /// Of the operation on its way.
    tool: Option<u32>,
    line: u32,
    planned: PlannedTime,
    /// Rapids since the last feed move: links if another one comes [s].
    rapids: f64,
    has_cut: bool,
    /// Kind of the moves on end, and if the spindle turns in them.
    run: (StepKind, bool),
    ways: Vec<f64>,
    least: Vec<f64>,
    lines: Vec<u32>,
    slowed: Slowdowns,
}

impl<'a> Stopwatch<'a> {
    pub(super) fn new(machine: &'a Machine) -> Self {
        Self {
            machine,
            drives: drives(machine),
            operations: Vec::new(),
            tool: None,
            line: 1,
            planned: PlannedTime::default(),
            rapids: 0.0,
            has_cut: false,
            run: (StepKind::Rapid, false),
            ways: Vec::new(),
            least: Vec::new(),
            lines: Vec::new(),
            slowed: Slowdowns::default(),
        }
    }

    pub(super) fn take(&mut self, step: &Step) {
        let run = (step.kind, step.spindle_on);
        if run != self.run {
            self.stand();
            self.run = run;
        }
        let seconds = step.seconds.unwrap_or(0.0);
        match step.kind {
            StepKind::Dwell => self.planned.pauses += seconds,
            StepKind::Rapid | StepKind::Feed => {
                let n_axes = self.drives.len().min(MAX_AXES);
                self.ways.extend((0..n_axes).map(|i_axis| way(step, i_axis)));
                // Rapids are as fast as the axes.
                self.least.push(if step.kind == StepKind::Feed { seconds } else { 0.0 });
                self.lines.push(step.line);
            }
        }
    }

    /// The cutter starts: if something was cut before, for another operation.
    pub(super) fn start(&mut self, start: &Start) {
        self.stand();
        if self.has_cut {
            self.end_operation();
        }
        (self.tool, self.line) = (start.tool, start.line);
    }

    /// The times of all operations, and what keeps feeds from being held.
    pub(super) fn finish(mut self) -> (Vec<OperationTime>, Vec<Slowed>) {
        self.stand();
        self.end_operation();
        (self.operations, self.slowed.finish())
    }

    fn end_operation(&mut self) {
        let mut planned = std::mem::take(&mut self.planned);
        let rapids = std::mem::take(&mut self.rapids);
        let has_cut = std::mem::take(&mut self.has_cut);
        *(if has_cut { &mut planned.retreat } else { &mut planned.approach }) += rapids;
        self.operations.push(OperationTime { tool: self.tool, line: self.line, planned });
    }

    /// Times the moves on end, at the end of which the machine stands.
    fn stand(&mut self) {
        if self.least.is_empty() {
            return;
        }
        let timings = time_motion(&Motion {
            drives: &self.drives,
            ways: &self.ways,
            least: &self.least,
            look_ahead: self.machine.look_ahead_blocks,
        });
        let seconds = timings.iter().map(|timing| timing.seconds).sum::<f64>();
        if self.run.0 == StepKind::Rapid {
            self.rapids += seconds;
        } else {
            let rapids = std::mem::take(&mut self.rapids);
            let planned = &mut self.planned;
            *(if self.has_cut { &mut planned.links } else { &mut planned.approach }) += rapids;
            planned.cutting += seconds;
            self.has_cut = true;
            self.take_slowed(&timings);
        }
        self.ways.clear();
        self.least.clear();
        self.lines.clear();
    }

    fn take_slowed(&mut self, timings: &[Timing]) {
        let letter = |axis: usize| self.machine.axes[axis].letter;
        let ways = self.ways.chunks_exact(self.drives.len().clamp(1, MAX_AXES));
        let moves = self.least.iter().zip(timings).zip(&self.lines).zip(ways);
        for (((asked, timing), &line), ways) in moves {
            let cause = match timing.limit {
                // The feed itself: the rest is its ramps.
                Limit::Least => continue,
                limit => limit.cause(letter),
            };
            // A velocity beyond the limit is a violation, told line by line.
            if !matches!(cause, Cause::Velocity { .. }) {
                let way = self.fed_way(ways);
                let slow = Slow { cause, asked: *asked, taken: timing.seconds, way };
                self.slowed.take(slow, || Spot::Line { line });
            }
        }
    }

    /// The way of a move; none where the part turns, since what the tool then does on the part is not
    /// known from the program.
    fn fed_way(&self, ways: &[f64]) -> Option<f64> {
        let axes = || self.machine.axes.iter().zip(ways);
        let turns = axes().any(|(axis, way)| axis.kind == AxisKind::Rotary && *way != 0.0);
        (!turns).then(|| axes().map(|(_, way)| way * way).sum::<f64>().sqrt())
    }
}
