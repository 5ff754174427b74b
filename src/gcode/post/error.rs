//! What a post refuses, and what it warns of.

use crate::gcode::Coolant;
use std::fmt;

/// What came out differently from what the toolpath asks for.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum PostWarning {
    /// The control would not move as slowly as the toolpath asks for; the F words say what it does.
    FeedRaised {
        /// How many blocks.
        n_blocks: usize,
        /// The first of them, by line.
        first_line: u32,
        /// How much sooner the program is done [s].
        seconds: f64,
        /// The control's slowest rate [mm/min].
        min_rate: f64,
    },
    /// The control has no F word for as fast as the toolpath asks for, or not with as many digits.
    FeedLowered {
        /// How many blocks.
        n_blocks: usize,
        /// The first of them, by line.
        first_line: u32,
        /// How much later the program is done [s].
        seconds: f64,
    },
}

/// Why a toolpath cannot become a program. Moves are counted from 0, as in the toolpath.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PostError {
    /// There is nothing to write.
    #[error("the toolpath has no moves; there is nothing to write")]
    Empty,
    /// The path begins with a cut.
    #[error("move 0 is not a rapid: the machine may stand anywhere; begin with one to the start")]
    NoStart,
    /// A number that is none.
    #[error("move {i_move} sends {axis} to {value}, which is no position")]
    NotFinite {
        /// The move.
        i_move: usize,
        /// The axis.
        axis: char,
        /// Where it would go [mm or rad].
        value: f64,
    },
    /// An axis would leave its travel.
    #[error(
        "move {i_move} sends {axis} to {word} {unit}, outside its limits {} to {} {unit}; \
         shift the part or choose a larger machine", limits[0], limits[1]
    )]
    Limit {
        /// The move.
        i_move: usize,
        /// The axis.
        axis: char,
        /// The word it would have.
        word: f64,
        /// Its least and greatest word.
        limits: [f64; 2],
        /// `mm` or `deg`.
        unit: &'static str,
    },
    /// An axis would have to be faster than it is.
    #[error(
        "move {i_move} asks {axis} for {velocity:.6} {unit}/s, above its limit {limit:.6}; \
         give the move more time"
    )]
    Velocity {
        /// The move.
        i_move: usize,
        /// The axis.
        axis: char,
        /// The speed asked for, per second.
        velocity: f64,
        /// The greatest it has, per second.
        limit: f64,
        /// `mm` or `deg`.
        unit: &'static str,
    },
    /// A feed or a duration that is none.
    #[error("move {i_move} has the {what} {value}; it must be a number greater than 0")]
    Pace {
        /// The move.
        i_move: usize,
        /// `feed` or `duration`.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// A feed of the linear axes on a move that has none.
    #[error("move {i_move} turns rotary axes only, but its feed is of linear ones; use a duration")]
    RotaryFeed {
        /// The move.
        i_move: usize,
    },
    /// A machine that turns something, for a control that cannot.
    #[error(
        "{machine} turns {axis}, but {dialect} has linear axes alone; choose a control with rotary \
         axes, such as linuxcnc or grblhal, with --dialect"
    )]
    NoRotary {
        /// The rotary axis.
        axis: char,
        /// The machine.
        machine: String,
        /// The dialect.
        dialect: String,
    },
    /// A block that turns so far that the control could take the other way.
    #[error(
        "move {i_move} turns {axis} by {degrees} degrees at once, but {dialect} takes the shorter \
         way; use more points per turn"
    )]
    HalfTurn {
        /// The move.
        i_move: usize,
        /// The rotary axis.
        axis: char,
        /// How far.
        degrees: f64,
        /// The dialect.
        dialect: String,
    },
    /// A coolant the control has no word for.
    #[error("{dialect} has no word for {coolant:?} coolant; choose another one, or none")]
    NoCoolant {
        /// The coolant.
        coolant: Coolant,
        /// The dialect.
        dialect: String,
    },
    /// Two axes by the same letter.
    #[error("{dialect} calls two axes of {machine} {letter}; change its letters")]
    SameLetter {
        /// The letter.
        letter: char,
        /// The machine.
        machine: String,
        /// The dialect.
        dialect: String,
    },
    /// A tolerance that is none.
    #[error("the tolerance for corners is {value} mm; it must be a number, 0.0001 or more")]
    Tolerance {
        /// Its value.
        value: f64,
    },
    /// A name the control does not take.
    #[error("program number {number} is not one of 1 to 9999")]
    Number {
        /// The number.
        number: u32,
    },
    /// Blocks could be longer than the control reads.
    #[error("a block can take {length} characters, but {dialect} reads {limit}; use less decimals")]
    LineTooLong {
        /// The most a block of this program can take.
        length: usize,
        /// The most the control reads.
        limit: usize,
        /// The dialect.
        dialect: String,
    },
}

impl fmt::Display for PostWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::FeedRaised { n_blocks, first_line, seconds, min_rate } => write!(
                f,
                "{n_blocks} blocks (the first in line {first_line}) run {seconds:.3} s faster than \
                 planned: the control goes no slower than {min_rate} mm/min"
            ),
            Self::FeedLowered { n_blocks, first_line, seconds } => write!(
                f,
                "{n_blocks} blocks (the first in line {first_line}) run {seconds:.3} s slower than \
                 planned: the control has no F word for their pace"
            ),
        }
    }
}
