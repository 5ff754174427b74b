//! What the machine shall do, before any control's language: moves with their pace.

use crate::machine::AxisValues;

/// One move of all axes at once, interpolated linearly, from where the last one ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Move {
    /// Where it ends: program values (words), millimetres and radians, followers not yet set.
    pub to: AxisValues,
    /// How fast it gets there.
    pub pace: Pace,
}

/// How fast a move goes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Pace {
    /// As fast as the machine can; cuts nothing.
    Rapid,
    /// At this speed of the linear axes [mm/s].
    Feed(f64),
    /// In this time, all axes together [s]; what a cutting move with rotary axes uses.
    Duration(f64),
}

/// A whole operation: moves in order, and which axes the machine homes in first.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Toolpath {
    /// The moves. The first ones are rapids and may leave the attack axis at its clear position.
    pub moves: Vec<Move>,
    /// The attack word at which nothing on the machine can be touched [mm].
    pub clear: f64,
}
