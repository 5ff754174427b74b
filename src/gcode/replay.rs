//! A program carried out move by move, with the time each takes.

use super::{BlockKind, Mode, Motion, MoveWords, Program, SpindleRun};
use crate::machine::{AxisValues, MAX_AXES, Machine};

/// Where the axes stand, as far as the program has said so yet [mm or rad].
pub type Position = [Option<f64>; MAX_AXES];

/// One move or pause of a program.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// Index of its block.
    pub i_block: usize,
    /// The line it stands in.
    pub line: u32,
    /// What happens.
    pub kind: StepKind,
    /// Where it begins.
    pub from: Position,
    /// Where it ends.
    pub to: Position,
    /// How long it takes: by its feed, or for a rapid by the fastest the axes can; nothing is known
    /// of acceleration here. `None` for a feed move without a feed [s].
    pub seconds: Option<f64>,
    /// True while the spindle turns.
    pub spindle_on: bool,
}

/// What happens in a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StepKind {
    /// A move that cuts nothing.
    Rapid,
    /// A feed move.
    Feed,
    /// A pause.
    Dwell,
}

impl Program {
    /// The moves and pauses in order. `machine` is the one the program was posted or read for.
    pub fn steps<'a>(&'a self, machine: &'a Machine) -> Steps<'a> {
        Steps {
            program: self,
            machine,
            i_block: 0,
            words: [None; MAX_AXES],
            inverse_time: false,
            feed: None,
            speed_rpm: 0.0,
            runs: false,
        }
    }
}

impl Step {
    /// Where it ends as plain values, if the program has placed each of its axes by then.
    pub fn values(&self, program: &Program) -> Option<AxisValues> {
        let n_axes = program.axes.len();
        let placed = self.to.iter().take(n_axes).all(Option::is_some);
        placed.then(|| self.to.map(Option::unwrap_or_default))
    }
}

/// Iterator over the [`Step`]s of a program.
#[derive(Debug, Clone)]
pub struct Steps<'a> {
    program: &'a Program,
    machine: &'a Machine,
    i_block: usize,
    /// Where the axes stand [mm or deg].
    words: Position,
    inverse_time: bool,
    feed: Option<f64>,
    speed_rpm: f64,
    runs: bool,
}

impl Iterator for Steps<'_> {
    type Item = Step;

    fn next(&mut self) -> Option<Step> {
        loop {
            let i_block = self.i_block;
            let block = self.program.blocks.get(i_block)?;
            self.i_block += 1;
            let before = self.words;
            let (kind, seconds) = match &block.kind {
                BlockKind::Dwell(seconds) => (StepKind::Dwell, Some(*seconds)),
                BlockKind::Move(words) => self.move_to(words),
                other => {
                    self.obey(other);
                    continue;
                }
            };
            let (from, to) = (self.inside(&before), self.inside(&self.words));
            let spindle_on = self.runs && self.speed_rpm > 0.0;
            return Some(Step { i_block, line: block.line, kind, from, to, seconds, spindle_on });
        }
    }
}

impl Steps<'_> {
    /// Lets a block that moves nothing change the state.
    fn obey(&mut self, kind: &BlockKind) {
        match kind {
            BlockKind::Modes(modes) => {
                let was_inverse = self.inverse_time;
                self.inverse_time = modes.contains(Mode::InverseTime)
                    || was_inverse && !modes.contains(Mode::PerMinute);
                if self.inverse_time != was_inverse {
                    self.feed = None;
                }
            }
            BlockKind::Feed(feed) => self.feed = Some(*feed),
            BlockKind::Spindle(spindle) => {
                self.speed_rpm = spindle.speed_rpm.unwrap_or(self.speed_rpm);
                self.runs = spindle.run.map_or(self.runs, |run| run != SpindleRun::Stop);
            }
            // The control stops the spindle before it changes the tool.
            BlockKind::ToolChange(_) => self.runs = false,
            _ => {}
        }
    }

    /// Moves, and says how and how long.
    fn move_to(&mut self, words: &MoveWords) -> (StepKind, Option<f64>) {
        let before = self.words;
        for (i_axis, word) in self.words.iter_mut().enumerate() {
            *word = words.axis(i_axis).or(*word);
        }
        self.feed = words.feed().or(self.feed.filter(|_| !self.inverse_time));
        match words.motion {
            Motion::Rapid => (StepKind::Rapid, Some(self.shortest_time(&before))),
            Motion::Feed => (StepKind::Feed, self.fed_time(&before)),
        }
    }

    fn inside(&self, words: &Position) -> Position {
        let mut values = *words;
        for (value, axis) in values.iter_mut().zip(&self.program.axes) {
            *value = value.map(|word| axis.value(word));
        }
        values
    }

    /// The way of an axis [mm or deg]; none where its start is unknown.
    fn way(&self, before: &Position, i_axis: usize) -> f64 {
        before[i_axis].zip(self.words[i_axis]).map_or(0.0, |(from, to)| to - from)
    }

    /// How long the axes need at their greatest speeds [s].
    fn shortest_time(&self, before: &Position) -> f64 {
        let axes = self.program.axes.iter().zip(&self.machine.axes).enumerate();
        let times = axes.map(|(i_axis, (address, axis))| {
            address.value(self.way(before, i_axis)).abs() / axis.velocity
        });
        times.fold(0.0, f64::max)
    }

    fn fed_time(&self, before: &Position) -> Option<f64> {
        let feed = self.feed?;
        let Program { feeds, axes, .. } = self.program;
        if self.inverse_time {
            return Some(feeds.inverse_seconds(feed));
        }
        Some(60.0 * feeds.length(axes, |i_axis| self.way(before, i_axis)) / feed)
    }
}
