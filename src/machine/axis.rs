//! One axis of a machine, and a value for each of them.

use crate::geom::{Point3, Vector3};

/// The most axes a machine can have.
pub const MAX_AXES: usize = 6;

/// One program value per axis, in the order of [`Machine::axes`](super::Machine::axes) [mm or rad].
pub type AxisValues = [f64; MAX_AXES];

/// One axis: how a word in a program moves what it carries.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// Its address in a program: X, Y, Z, A, B, C, U, V or W.
    pub letter: char,
    /// Slides or turns.
    pub kind: AxisKind,
    /// What it moves.
    pub carries: Carries,
    /// Unit vector in the machine frame: the way of travel, or the axis of rotation (right hand),
    /// of what is carried as the motion grows.
    pub direction: Vector3,
    /// A point on the axis of rotation, in the machine frame at motion 0 (rotary axes) [mm].
    pub point: Point3,
    /// `word = zero + sign * motion`; +1 or -1.
    pub sign: f64,
    /// The word at motion 0 [mm or rad].
    pub zero: f64,
    /// Least and greatest word; `None` turns without end.
    pub limits: Option<[f64; 2]>,
    /// Greatest speed [mm/s or rad/s].
    pub velocity: f64,
    /// Greatest acceleration [mm/s2 or rad/s2].
    pub acceleration: f64,
    /// Set on an axis that only copies another: the second spindle of a pair.
    pub follows: Option<Follow>,
}

/// An axis that is not driven on its own: `motion = ratio * motion of the leader`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Follow {
    /// Index of the leading axis.
    pub leader: usize,
    /// Motion of this axis per motion of the leader.
    pub ratio: f64,
}

/// Slides or turns.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum AxisKind {
    /// Words are millimetres.
    Linear,
    /// Words are degrees in files, radians inside.
    Rotary,
}

/// What an axis moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Carries {
    /// The tool.
    Tool,
    /// The part.
    Part,
}

impl Axis {
    /// The motion behind a program word.
    pub fn motion(&self, word: f64) -> f64 {
        (word - self.zero) * self.sign
    }

    /// The program word of a motion.
    pub fn word(&self, motion: f64) -> f64 {
        self.zero + self.sign * motion
    }
}
