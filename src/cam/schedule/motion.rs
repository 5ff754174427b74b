//! What a planner is given, and what it tells of each move.

use super::Drive;

/// Axis positions with least times: what shall be run through without standing.
#[derive(Debug, Clone, Copy)]
pub struct Motion<'a> {
    /// What the axes can do.
    pub drives: &'a [Drive],
    /// The way of each axis in the first move, then in the second, and so on [mm or rad].
    pub ways: &'a [f64],
    /// The time each move shall take at least [s].
    pub least: &'a [f64],
    /// How many moves the control plans at once, the running one included: it never runs faster
    /// than it can stop within them. `None` if it sees them all.
    pub look_ahead: Option<usize>,
}

/// How one move goes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Timing {
    /// How long it takes [s].
    pub seconds: f64,
    /// How long it would take all at its greatest speed [s]: what a program asks for, since a
    /// control takes a feed for the most it may reach and makes its ramps by itself.
    pub pace: f64,
    /// What keeps it from being faster.
    pub limit: Limit,
}

/// What keeps a move from being faster.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Limit {
    /// Its least time.
    Least,
    /// The velocity of this axis.
    Velocity(usize),
    /// The acceleration of this axis, perhaps for a move before or after it.
    Acceleration(usize),
    /// How far the control looks ahead.
    LookAhead,
}
