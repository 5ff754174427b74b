//! What a check found, for people and for programs.

use super::{OperationTime, PlannedTime};
use crate::cam::Slowed;
use crate::gcode::LongestLine;
use serde::Serialize;
use std::fmt;

/// A broken program can have a violation per line; people read this many.
const MOST_PRINTED: usize = 50;

/// What [`check`](crate::gcode::check) found.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct CheckReport {
    /// Number of blocks.
    pub n_blocks: usize,
    /// Number of moves among them.
    pub n_moves: usize,
    /// How far each axis goes.
    pub bounds: Vec<AxisBounds>,
    /// Programmed time: feed moves by their feeds, rapids at the axes' speeds, pauses [s].
    pub seconds: f64,
    /// The part of it spent in feed moves [s].
    pub feed_seconds: f64,
    /// What a planner needs for it that has the accelerations of the machine.
    pub planned: PlannedTime,
    /// The same for each operation: what is cut between a start of the cutter and the next.
    pub operations: Vec<OperationTime>,
    /// Why it needs more, the costliest reason first.
    pub slowed: Vec<Slowed>,
    /// Way of the linear axes in feed moves [mm].
    pub feed_distance_mm: f64,
    /// Way of the linear axes in rapid moves [mm].
    pub rapid_distance_mm: f64,
    /// How fast blocks follow each other where they do so fastest, if there are enough of them.
    pub block_rate: Option<BlockRate>,
    /// The longest line, if the program was read from a text.
    pub longest_line: Option<LongestLine>,
    /// What is wrong, by line.
    pub violations: Vec<Violation>,
}

/// How far an axis goes, in the units of its words.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct AxisBounds {
    /// Its letter.
    pub axis: char,
    /// `mm` or `deg`.
    pub unit: &'static str,
    /// The least word.
    pub least: f64,
    /// The greatest word.
    pub greatest: f64,
}

/// Where feed moves follow each other fastest.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct BlockRate {
    /// Blocks per second, over 16 moves.
    pub highest: f64,
    /// The line of the last of them.
    pub line: u32,
    /// What the machine's control can read; above it the cutter stutters.
    pub limit: f64,
}

/// Something wrong with a line.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Violation {
    /// The line, counted from 1.
    pub line: u32,
    /// What is wrong with it.
    #[serde(flatten)]
    pub kind: ViolationKind,
}

/// What is wrong with a line.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum ViolationKind {
    /// An axis leaves its travel.
    Limit {
        /// The axis.
        axis: char,
        /// Its word.
        word: f64,
        /// Its least and greatest word.
        limits: [f64; 2],
        /// `mm` or `deg`.
        unit: &'static str,
    },
    /// A feed move asks an axis to go faster than it can.
    Velocity {
        /// The axis.
        axis: char,
        /// The speed asked for, per second.
        velocity: f64,
        /// The greatest it has, per second.
        limit: f64,
        /// `mm` or `deg`.
        unit: &'static str,
    },
    /// A feed move without a feed.
    NoFeed,
    /// A feed move while the spindle stands; said once per stretch of such moves.
    SpindleOff,
    /// A feed move before an axis was ever placed: where it cuts depends on what ran before.
    UnknownStart {
        /// The axis.
        axis: char,
    },
    /// The program stops without saying that it ends; said of its last line.
    NoEnd,
}

impl CheckReport {
    /// True if nothing is wrong.
    pub fn is_clean(&self) -> bool {
        self.violations.is_empty()
    }

    /// The operations, if there is more than one.
    pub fn several_operations(&self) -> &[OperationTime] {
        if self.operations.len() > 1 { &self.operations } else { &[] }
    }
}

impl fmt::Display for ViolationKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Limit { axis, word, limits: [least, greatest], unit } => {
                write!(f, "{axis}{word} is outside the axis limits, {least} to {greatest} {unit}")
            }
            Self::Velocity { axis, velocity, limit, unit } => {
                write!(f, "{axis} would move at {velocity:.3} {unit}/s; its limit is {limit:.3}")
            }
            Self::NoFeed => write!(f, "a G1 without a feed in force"),
            Self::SpindleOff => write!(f, "feed moves begin here while the spindle stands"),
            Self::UnknownStart { axis } => {
                write!(f, "a feed move before {axis} was ever placed; begin with a rapid that does")
            }
            Self::NoEnd => write!(f, "the program ends without M2 or M30"),
        }
    }
}

impl fmt::Display for CheckReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{} blocks, {} moves", self.n_blocks, self.n_moves)?;
        for AxisBounds { axis, unit, least, greatest } in &self.bounds {
            writeln!(f, "{axis}  {least:.4} to {greatest:.4} {unit}")?;
        }
        let (seconds, fed, planned) = (self.seconds, self.feed_seconds, &self.planned);
        let total = planned.total();
        writeln!(f, "programmed {seconds:.1} s, {fed:.1} s of it feeding")?;
        writeln!(f, "with these accelerations {total:.1} s: {planned}")?;
        for OperationTime { tool, line, planned } in self.several_operations() {
            let tool = tool.map_or_else(String::new, |tool| format!("T{tool} "));
            writeln!(f, "{tool}from line {line}: {:.1} s: {planned}", planned.total())?;
        }
        for slowed in self.slowed.iter().filter(|slowed| slowed.is_worth_telling(total)) {
            writeln!(f, "{slowed}")?;
        }
        let (feed, rapid) = (self.feed_distance_mm, self.rapid_distance_mm);
        writeln!(f, "way {feed:.1} mm feeding, {rapid:.1} mm rapid")?;
        if let Some(BlockRate { highest, line, limit }) = self.block_rate {
            let verdict = if highest > limit { ": too fast, the cutter will stutter" } else { "" };
            writeln!(
                f,
                "up to {highest:.0} blocks/s (line {line}) of {limit:.0} possible{verdict}"
            )?;
        }
        if let Some(LongestLine { line, length }) = self.longest_line {
            writeln!(f, "longest line: {line}, {length} characters")?;
        }
        for Violation { line, kind } in self.violations.iter().take(MOST_PRINTED) {
            writeln!(f, "line {line}: {kind}")?;
        }
        match self.violations.len() {
            0 => writeln!(f, "nothing against it"),
            n if n > MOST_PRINTED => {
                writeln!(f, "... and {} more; --json lists them all", n - MOST_PRINTED)
            }
            _ => Ok(()),
        }
    }
}
