//! What a job tells about its plan; what people and programs read beside the G-code.

use super::CamOptions;
use super::computing::ComputeReport;
use super::ground::Ground;
use super::heights::Heights;
use super::spacing::scallop;
use crate::cam::{Certificate, FeedReport, ReachReport, Setup, Strategy, Trajectory};
use crate::gcode::CheckReport;
use crate::geom::Surface;
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
    /// What the program does.
    pub work: Work,
    /// How a block was roughed; absent for a finishing program.
    pub rough: Option<RoughReport>,
    /// What is proved of the path between its positions; absent if nothing was asked for.
    pub certificate: Option<Certificate>,
    /// What of the part the tool can reach; absent for a cloud, and where the table is tilted or a
    /// block is roughed.
    pub reach: Option<ReachReport>,
    /// Material the first cut may meet above the finished surface [mm].
    pub stock: f64,
    /// The program, read back and checked.
    pub program: CheckReport,
    /// What the user should know before pressing start.
    pub warnings: Vec<String>,
}

/// What a program does to its part. Of one that roughs and finishes, tool, run, certificate and reach
/// are those of finishing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Work {
    /// Roughs it out of its block.
    Rough,
    /// Finishes it.
    Finish,
    /// First the one, then the other.
    RoughAndFinish,
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
    /// Ends whose stub is for the most part not inside the part.
    pub loose: Vec<&'static str>,
    /// Rows of the matrix `machine_from_file`, after mirroring.
    pub machine_from_file: [[f64; 4]; 3],
}

/// From the block down to the part and its allowance.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct RoughReport {
    /// What it is cut from.
    pub block: String,
    /// The same as the command line has it, such as `cylinder:60`; absent for a body from a file.
    pub shape: Option<String>,
    /// The tool, as the library or the command line names it, and its shape.
    pub tool: [String; 2],
    /// The most the tool takes at once, along the attack axis [mm].
    pub max_depth: f64,
    /// Material left for finishing [mm].
    pub allowance: f64,
    /// Layers.
    pub n_layers: usize,
    /// Cuts, with a link before each.
    pub n_cuts: usize,
    /// Positions of all cuts.
    pub n_positions: usize,
    /// What the machine can hold of the feed, in the cuts alone.
    pub held: FeedReport,
    /// What is proved of the rapids.
    pub links: LinkReport,
}

/// What is proved of the rapids of a roughing.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct LinkReport {
    /// How many there are.
    pub n_rapids: usize,
    /// Each of them, but for those that lead out of a cut, is clear of the stock as it stands at that
    /// moment by this much, along the attack axis [mm].
    pub clearance: f64,
    /// How far apart the stock was looked at [mm].
    pub resolution: f64,
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
    /// How far it runs beyond the part's ends, and how far it would have to cut them whole [mm].
    pub overrun: [f64; 2],
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
    /// Rotation of the part asked for instead of it, where the part turns [rpm].
    pub rpm: Option<f64>,
    /// What the machine can hold of the feed, in the cut alone.
    pub held: FeedReport,
    /// Greatest change of the attack axis between two positions digitized [mm].
    pub greatest_rise: f64,
    /// What digitized.
    pub compute: ComputeReport,
}

impl PartReport {
    /// Of the part set up.
    pub(super) fn new(name: String, setup: &Setup, notes: Vec<String>) -> Self {
        let size = setup.part.size();
        let mode = if matches!(setup.surface, Surface::Points(_)) { "points" } else { "triangles" };
        Self { name, mode, n_primitives: setup.n_own, size: size.into(), notes }
    }
}

impl SetupReport {
    /// Of the part set up.
    pub(super) fn new(setup: &Setup, options: &CamOptions) -> Self {
        let pose = setup.machine_from_file.to_homogeneous();
        let row = |i: usize| [0, 1, 2, 3].map(|j| pose[(i, j)]);
        Self {
            axis: [0, 1, 2].map(|j| pose[(0, j)]),
            start_angle_deg: options.start_angle.unwrap_or(0.0),
            mirrored: options.mirror,
            swing: setup.swing,
            part_x: [setup.part.min.x, setup.part.max.x],
            clamped_x: setup.stretch,
            loose: setup.loose.clone(),
            machine_from_file: [row(0), row(1), row(2)],
        }
    }
}

impl RunReport {
    /// Of a run and what came of it, but for what is held of its feed.
    pub(super) fn new(ground: &Ground, way: &Trajectory, heights: &Heights) -> Self {
        let Ground { setup, tool, options, .. } = ground;
        let allowance = options.allowance.unwrap_or(0.0);
        Self {
            strategy: way.strategy(),
            n_positions: way.n_positions(),
            per_turn: way.spacing().per_turn,
            pitch: way.spacing().pitch_range(),
            step: way.spacing().step,
            along: way.along(),
            overrun: [setup.part.min.x - way.along()[0], ground.cutter.reach().x],
            allowance,
            n_missed: heights.n_missed(),
            off_part: options.off_part.unwrap_or_default().in_words(),
            scallop: scallop(&tool.profile, way, heights.contacts),
            feed: options.feed.unwrap_or(tool.feed * 60.0),
            rpm: options.rpm,
            held: FeedReport::default(),
            greatest_rise: heights.greatest_rise(),
            compute: ComputeReport::default(),
        }
    }
}

impl CamReport {
    /// This report of finishing, after the roughing that `before` tells of.
    pub(super) fn after(mut self, before: Self) -> Self {
        self.work = Work::RoughAndFinish;
        self.rough = before.rough;
        // Both may have the same to say of how the part is held.
        let new = before.warnings.into_iter().filter(|text| !self.warnings.contains(text));
        self.warnings.splice(0..0, new.collect::<Vec<_>>());
        self
    }
}
