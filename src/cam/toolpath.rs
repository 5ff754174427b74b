//! What the machine shall do, before any control's language: moves with their pace.

use crate::geom::Point3;
use crate::machine::AxisValues;

/// A position of a path, before it is known how fast the tool gets there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Position {
    /// The words of all axes, attack axis included.
    pub words: AxisValues,
    /// Where the tool touches the part, if it does.
    pub touched: Option<Point3>,
}

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
