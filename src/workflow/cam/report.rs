//! What a job tells about its plan; what people and programs read beside the G-code.

use crate::cam::{ReachReport, Strategy};
use crate::gcode::CheckReport;
use serde::Serialize;

/// The report of one job. Lengths in millimetres, angles in degrees, times in seconds.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct CamReport {
    /// What was cut.
    pub part: PartReport,
    /// The machine's name and title.
    pub machine: [String; 2],
    /// The tool, as the library or the command line names it, and its shape.
    pub tool: [String; 2],
    /// How the part was laid on the machine.
    pub setup: SetupReport,
    /// How the tool runs over it.
    pub run: RunReport,
    /// What of the part the tool can reach; absent for a cloud.
    pub reach: Option<ReachReport>,
    /// Material the first cut may meet above the finished surface [mm].
    pub stock: f64,
    /// The program, read back and checked.
    pub program: CheckReport,
    /// What the user should know before pressing start.
    pub warnings: Vec<String>,
}

/// What was cut.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct PartReport {
    /// Its name, most often the file's.
    pub name: String,
    /// `triangles` (exact) or `points` (the thesis' mode: between points the tool may sink in).
    pub mode: &'static str,
    /// How many of them.
    pub n_primitives: usize,
    /// Extent on the machine, x, y and z [mm].
    pub size: [f64; 3],
    /// What reading it had to say: units, points left out.
    pub notes: Vec<String>,
}

/// How the part lies on the machine.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct SetupReport {
    /// The file's direction that lies along the spindle, or along X on a table.
    pub axis: [f64; 3],
    /// Turn about the spindle before the first step [deg].
    pub start_angle_deg: f64,
    /// True if the mirror image is cut.
    pub mirrored: bool,
    /// Greatest distance from the spindle axis [mm].
    pub swing: f64,
    /// The part along X [mm].
    pub part_x: [f64; 2],
    /// The part with its clamps along X [mm].
    pub clamped_x: [f64; 2],
    /// Rows of the matrix `machine_from_file`, after mirroring.
    pub machine_from_file: [[f64; 4]; 3],
}

/// How the tool runs over the part, and what came of it.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct RunReport {
    /// The strategy.
    pub strategy: Strategy,
    /// Positions digitized.
    pub n_positions: usize,
    /// Positions a turn, or lines around the part.
    pub per_turn: u32,
    /// Least and greatest distance of neighbouring turns, rings or rows [mm].
    pub pitch: [f64; 2],
    /// Distance of positions along a line [mm].
    pub step: f64,
    /// The stretch of X run over [mm].
    pub along: [f64; 2],
    /// Material left on purpose [mm].
    pub allowance: f64,
    /// Positions at which the tool meets nothing; they take the height the rule gives them.
    pub n_missed: usize,
    /// The rule for them.
    pub off_part: &'static str,
    /// The greatest scallop foreseen between neighbouring turns; absent where the tool leaves none
    /// that is known [mm].
    pub scallop: Option<f64>,
    /// Cutting feed asked for, at the contact [mm/min].
    pub feed: f64,
    /// Greatest change of the attack axis between two positions [mm]: between positions nothing is
    /// promised yet.
    pub greatest_rise: f64,
}
