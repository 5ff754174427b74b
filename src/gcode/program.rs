//! A program: blocks in order, compact enough to hold a million of them.

use super::feeds::FeedLaw;
use super::{Dialect, Modes};
use crate::machine::{AxisKind, MAX_AXES, Machine};

/// A program for one machine.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Program {
    /// The axes its words stand for: those of the machine it was posted or read for, in that order.
    pub axes: Vec<Address>,
    /// What its F words mean.
    pub feeds: FeedLaw,
    /// What it says, in the order it is carried out.
    pub blocks: Vec<Block>,
    /// The longest line of the text it was read from, if it was read.
    pub longest_line: Option<LongestLine>,
}

/// An axis as a program addresses it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Address {
    /// Its letter.
    pub letter: char,
    /// Linear words are millimetres, rotary words degrees.
    pub kind: AxisKind,
}

/// The longest line of a text.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
pub struct LongestLine {
    /// Which line, counted from 1.
    pub line: u32,
    /// Its length in bytes, line ending not counted.
    pub length: usize,
}

/// One thing a program says. A line that says several is several blocks of the same line.
#[derive(Debug, Clone, PartialEq)]
pub struct Block {
    /// The line it stands in, counted from 1.
    pub line: u32,
    /// What it says.
    pub kind: BlockKind,
}

/// What a block says.
#[derive(Debug, Clone, PartialEq)]
pub enum BlockKind {
    /// A remark for people.
    Comment(Box<str>),
    /// What the program is called: an O word, or the number in its name.
    Number(u32),
    /// Modal words.
    Modes(Modes),
    /// A line that only its control understands; its dialect lists it.
    Setup(Box<str>),
    /// Round corners off by no more than this [mm]; `None` switches it off again.
    Smoothing(Option<f64>),
    /// Put this tool into the spindle.
    ToolChange(u32),
    /// Run or stop the spindle, or set its speed.
    Spindle(Spindle),
    /// Open or close the coolant.
    Coolant(Coolant),
    /// The feed from here on [mm/min], without a move.
    Feed(f64),
    /// Stand still [s].
    Dwell(f64),
    /// Move.
    Move(MoveWords),
    /// Take whole turns off what the position of a rotary axis is called from here on. Words of
    /// a [`Program`] count on all the same: only its text has them shorter.
    Rezero {
        /// The axis.
        i_axis: usize,
        /// How many turns.
        turns: i32,
    },
    /// What begins or ends a tape: `%`, or the `END PGM` of Klartext.
    Percent,
    /// The end of the program.
    End,
}

/// A spindle command.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spindle {
    /// New speed [rpm].
    pub speed_rpm: Option<f64>,
    /// Start or stop.
    pub run: Option<SpindleRun>,
}

/// Start or stop of the spindle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SpindleRun {
    /// Start clockwise.
    Clockwise,
    /// Start counter-clockwise.
    CounterClockwise,
    /// Stop.
    Stop,
}

/// What cools the cut.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize, clap::ValueEnum,
)]
#[serde(rename_all = "kebab-case")]
pub enum Coolant {
    /// Nothing.
    Off,
    /// Mist or air.
    Mist,
    /// Flood.
    Flood,
}

/// How a move is made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Motion {
    /// As fast as the machine can.
    Rapid,
    /// Straight, with the feed in force.
    Feed,
}

/// A move: the words its block holds, packed because a program is mostly these.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MoveWords {
    /// A word per axis, then the F word; only those flagged in `present` mean anything.
    values: [f64; MAX_AXES + 1],
    present: u8,
    /// How the move is made.
    pub motion: Motion,
}

impl MoveWords {
    /// A move without words yet.
    pub fn new(motion: Motion) -> Self {
        Self { values: [0.0; MAX_AXES + 1], present: 0, motion }
    }

    /// The move with a word for axis `i_axis` [mm or deg].
    #[must_use]
    pub fn with_axis(self, i_axis: usize, word: f64) -> Self {
        debug_assert!(i_axis < MAX_AXES, "a machine has at most {MAX_AXES} axes");
        self.with(i_axis, word)
    }

    /// The move with an F word [mm/min, or 1/min under inverse time].
    #[must_use]
    pub fn with_feed(self, feed: f64) -> Self {
        self.with(MAX_AXES, feed)
    }

    /// The word of axis `i_axis`, if the block has one [mm or deg].
    pub fn axis(&self, i_axis: usize) -> Option<f64> {
        debug_assert!(i_axis < MAX_AXES, "a machine has at most {MAX_AXES} axes");
        self.get(i_axis)
    }

    /// The F word, if the block has one.
    pub fn feed(&self) -> Option<f64> {
        self.get(MAX_AXES)
    }

    /// True if the block names an axis.
    pub fn names_an_axis(&self) -> bool {
        self.present & !(1 << MAX_AXES) != 0
    }

    fn with(mut self, index: usize, value: f64) -> Self {
        self.values[index] = value;
        self.present |= 1 << index;
        self
    }

    fn get(&self, index: usize) -> Option<f64> {
        (self.present >> index & 1 == 1).then(|| self.values[index])
    }
}

impl Program {
    /// A program for `machine` in `dialect`, without blocks yet.
    pub fn for_machine(machine: &Machine, dialect: &Dialect) -> Self {
        let axes = machine.axes.iter().map(|axis| Address { letter: axis.letter, kind: axis.kind });
        let axes = axes.take(MAX_AXES).collect();
        Self { axes, feeds: dialect.feed_law(), ..Self::default() }
    }

    /// Appends a block on a line of its own.
    pub fn push(&mut self, kind: BlockKind) {
        let line = self.blocks.last().map_or(0, |block| block.line) + 1;
        self.blocks.push(Block { line, kind });
    }
}

impl Address {
    /// A value from inside (mm or rad) as a word (mm or deg).
    pub(super) fn word(self, value: f64) -> f64 {
        match self.kind {
            AxisKind::Linear => value,
            AxisKind::Rotary => value.to_degrees(),
        }
    }

    /// A word (mm or deg) as a value for inside (mm or rad).
    pub(super) fn value(self, word: f64) -> f64 {
        match self.kind {
            AxisKind::Linear => word,
            AxisKind::Rotary => word.to_radians(),
        }
    }

    /// What its words are counted in.
    pub(super) fn unit(self) -> &'static str {
        match self.kind {
            AxisKind::Linear => "mm",
            AxisKind::Rotary => "deg",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_block_takes_at_most_72_bytes() {
        assert!(size_of::<Block>() <= 72, "{}", size_of::<Block>());
    }

    #[test]
    fn a_move_remembers_which_words_it_holds() {
        let words = MoveWords::new(Motion::Feed).with_axis(2, 0.0).with_feed(5.0);
        assert_eq!((words.axis(0), words.axis(2), words.feed()), (None, Some(0.0), Some(5.0)));
        assert!(words.names_an_axis());
        assert!(!MoveWords::new(Motion::Feed).with_feed(5.0).names_an_axis());
    }
}
