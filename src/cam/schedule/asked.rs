//! What a pass asks for: the times of its moves by their feed, and what became of them.

use super::{FeedReport, Motion, PassOptions, Slow, Slowdowns, Spot, Timing, drives, time_motion};
use crate::cam::{Move, Position};
use crate::machine::{Axis, AxisKind, MAX_AXES, Machine};

/// On a mesh the contact leaps from edge to edge and stands in between; an axis that followed would
/// only jerk. Its way counts as the mean over so many moves before and after.
const MEAN_OVER: usize = 4;

/// The moves of a pass as the planner takes them.
pub(super) struct Asked<'a> {
    machine: &'a Machine,
    options: PassOptions,
    /// How long the feed alone would take [s].
    fed: Vec<f64>,
    ways: Vec<f64>,
}

impl<'a> Asked<'a> {
    /// For about `n` moves.
    pub(super) fn new(machine: &'a Machine, options: PassOptions, n: usize) -> Self {
        let ways = Vec::with_capacity(n * machine.axes.len().min(MAX_AXES));
        Self { machine, options, fed: Vec::with_capacity(n), ways }
    }

    /// Takes the move from one position to the next.
    pub(super) fn take(&mut self, from: &Position, to: &Position) {
        self.fed.push(self.fed_time(from, to));
        let [from, to] = [from, to].map(|end| self.machine.with_followers(&end.words));
        self.ways.extend((0..self.n_axes()).map(|i| to[i] - from[i]));
    }

    fn fed_time(&self, from: &Position, to: &Position) -> f64 {
        let turned = |spindle: usize| (to.words[spindle] - from.words[spindle]).abs();
        let turn = self.machine.spindle.map_or(0.0, turned);
        if let Some(rotation) = self.options.rotation.filter(|_| turn > 0.0) {
            return turn / rotation;
        }
        let tool_at = |end: &Position| self.machine.tool_point(&end.words);
        let way = match (from.touched, to.touched) {
            (Some(from), Some(to)) => (to - from).norm(),
            _ => (tool_at(to) - tool_at(from)).norm(),
        };
        way / self.options.cut
    }

    /// Shares the times of neighbouring moves out between them, by how far the part is turned and
    /// the tool carried on in each.
    pub(super) fn even_out(&mut self) {
        if self.options.rotation.is_some() {
            return;
        }
        let driven: Vec<f64> =
            self.ways.chunks_exact(self.n_axes()).map(|ways| self.driven(ways)).collect();
        let evened = (0..self.fed.len()).map(|i| {
            let around = i.saturating_sub(MEAN_OVER)..(i + MEAN_OVER + 1).min(self.fed.len());
            let [fed, whole] =
                [&self.fed, &driven].map(|all| all[around.clone()].iter().sum::<f64>());
            // Where only the attack axis moves the contact's own way is all there is.
            if whole > 0.0 && driven[i] > 0.0 { fed * driven[i] / whole } else { self.fed[i] }
        });
        self.fed = evened.collect();
    }

    /// How long the axes but the attack need for a move at their greatest speeds [s].
    fn driven(&self, ways: &[f64]) -> f64 {
        let axes = self.machine.axes.iter().zip(ways).enumerate();
        let driven = axes.filter(|(i, _)| *i != self.machine.attack);
        driven.map(|(_, (axis, way))| way.abs() / axis.velocity).fold(0.0, f64::max)
    }

    fn n_axes(&self) -> usize {
        self.machine.axes.len().min(MAX_AXES)
    }

    pub(super) fn timings(&self) -> Vec<Timing> {
        let shortest = 1.0 / self.machine.blocks_per_second;
        let least: Vec<f64> = self.fed.iter().map(|fed| fed.max(shortest)).collect();
        time_motion(&Motion {
            drives: &drives(self.machine),
            ways: &self.ways,
            least: &least,
            look_ahead: self.machine.look_ahead_blocks,
        })
    }

    pub(super) fn report(&self, timings: &[Timing], moves: &[Move]) -> FeedReport {
        let axes = &self.machine.axes;
        let along = self.along();
        let mut slowed = Slowdowns::default();
        for ((fed, timing), step) in self.fed.iter().zip(timings).zip(moves) {
            let cause = timing.limit.cause(|axis| axes[axis].letter);
            // A rotation has no way, a feed that of the contact.
            let way = self.options.rotation.is_none().then_some(fed * self.options.cut);
            let slow = Slow { cause, asked: *fed, taken: timing.seconds, way };
            slowed.take(slow, || spot(&axes[along], step.to[along]));
        }
        let taken = timings.iter().map(|timing| timing.seconds).sum();
        FeedReport { asked: self.fed.iter().sum(), taken, slowed: slowed.finish() }
    }

    /// The axis by whose word people find a place on the part: the first that is not the attack.
    fn along(&self) -> usize {
        let machine = self.machine;
        let mut axes = machine.axes.iter().enumerate().filter(|(i, _)| *i != machine.attack);
        let found = axes.find(|(_, axis)| axis.kind == AxisKind::Linear);
        found.map_or(machine.attack, |(i, _)| i)
    }
}

fn spot(axis: &Axis, value: f64) -> Spot {
    let word = if axis.kind == AxisKind::Rotary { value.to_degrees() } else { value };
    Spot::Word { axis: axis.letter, word }
}
