//! Machines as data: which axes there are, what they carry, and the poses that follow.
//!
//! A [`Machine`] is read from a TOML file ([`Machine::parse`]); nothing about a particular machine
//! is code. The conventions (ARCHITECTURE section 3): X runs along the spindle, heel to toe; the part
//! turns about X by `c` with `y' = y cos c - z sin c`, `z' = y sin c + z cos c`; a word in a program
//! is `zero + sign * motion`.

mod axis;
mod builtin;
mod description;
mod error;
mod file;
mod fit;
mod follow;
mod kinematics;
mod read_axis;

pub use axis::{Axis, AxisKind, AxisValues, Carries, Follow, MAX_AXES};
pub use error::MachineError;

/// A machine tool.
#[derive(Debug, Clone, PartialEq)]
pub struct Machine {
    /// The name it is called by on the command line.
    pub name: String,
    /// One line about it, for people.
    pub title: String,
    /// The axes; those that carry the same thing are listed from the frame outwards.
    pub axes: Vec<Axis>,
    /// Index into `axes` of the linear axis along which the tool attacks the part.
    pub attack: usize,
    /// Index into `axes` of the rotary axis that turns the part against the tool, if there is one.
    pub spindle: Option<usize>,
    /// How a tool sits on the machine.
    pub mount: Mount,
    /// How the part is held.
    pub clamping: Clamping,
    /// Name of the controller dialect its programs are written in.
    pub dialect: String,
    /// The tool it uses unless told otherwise, by its name in the tool library.
    pub default_tool: String,
    /// Part to tool clearance kept by rapid moves, along the attack axis [mm].
    pub clearance: f64,
    /// Blocks per second the control can read.
    pub blocks_per_second: f64,
    /// Where tools are changed.
    pub tool_changes: ToolChanges,
    /// Blocks the control plans at once, the running one included, 2 or more; `None` if they are
    /// so many that they slow nothing down.
    pub look_ahead_blocks: Option<usize>,
    /// What stands around the part, as far as its sizes are known.
    pub obstacles: Obstacles,
}

/// What stands around the part and must not be touched, as far as its sizes are known.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Obstacles {
    /// The dogs at both ends of a part that is held on stubs.
    pub dogs: Option<Dogs>,
    /// Of a round table about the axis that turns the part, or about the origin [mm].
    pub table_radius: Option<f64>,
}

/// Two dogs about the spindle axis; a chuck and a tailstock are such as well.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dogs {
    /// Radius [mm].
    pub radius: f64,
    /// From their faces outwards [mm].
    pub length: f64,
}

/// Which way the tool's own axis of revolution points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Mount {
    /// Along X, across the attack axis: the wheel of a last lathe.
    Across,
    /// Along the attack axis: an end mill.
    Along,
}

/// Where tools are changed.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ToolChanges {
    /// Within a program, by the machine or by hand while it waits: operations with tools of their own
    /// can follow each other in one program.
    WithinPrograms,
    /// Between programs alone: each program has one tool.
    #[default]
    BetweenPrograms,
}

/// How the part is held, and so which further surfaces the tool must spare.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Clamping {
    /// Held from below on a table, out of the tool's way.
    Table,
    /// Between a heel dog at X = 0 and a toe dog, on stubs (nibs) along the spindle axis.
    Nibs {
        /// Radius of the stubs [mm].
        radius: f64,
        /// Distance from each dog's face to the part [mm].
        length: f64,
    },
    /// By a post on the top of the cone, square to the spindle axis; toe and heel stay free.
    Cone {
        /// Radius of the post [mm].
        radius: f64,
        /// How far the post stands out of the cone top [mm].
        length: f64,
        /// Distance kept free between the heel end of travel (X = 0) and the part [mm].
        gap: f64,
    },
}
