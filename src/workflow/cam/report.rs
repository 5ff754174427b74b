//! What a job tells about its plan; what people and programs read beside the G-code.

use super::CamOptions;
use super::ground::Ground;
use super::heights::Heights;
use super::spacing::scallop;
use crate::cam::{Certificate, FeedReport, ReachReport, Setup, Strategy, TABLE_GAP, Trajectory};
use crate::gcode::CheckReport;
use crate::geom::Surface;
use serde::Serialize;

/// More than this left by lifts is worth a warning [mm].
const MUCH_LEFT: f64 = 0.5;

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

    /// Adds what is different on a tilted table.
    pub(super) fn warn_of_table(&mut self) {
        // It runs off the part's top, and down to its table.
        self.run.overrun = [self.run.overrun[1]; 2];
        self.warnings.push(format!(
            "turned on the tilted table: the lowest {TABLE_GAP} mm above it are spared, and what the \
             tool cannot reach at this tilt is not mapped"
        ));
    }

    /// Adds what the user should know before pressing start.
    pub(super) fn warn(&mut self) {
        let mut say = |text: String| self.warnings.push(text);
        if self.work == Work::Finish {
            say(format!(
                "the program assumes at most {:.1} mm of stock on the part: rough it first",
                self.stock
            ));
        }
        if self.part.mode == "points" {
            say("digitized on points alone, as in the thesis: between points the tool may cut into \
                 the part, and what is proved is proved of the points; give triangles to be exact"
                .into());
        }
        if self.certificate.is_none() && self.work != Work::Rough {
            say("not certified: between positions the tool may cut into the part; --tolerance proves \
                 how deep"
                .into());
        }
        if let Some(left) = self.certificate.as_ref().and_then(left_by_lifts) {
            say(left);
        }
        for end in &self.setup.loose {
            say(format!(
                "most of the {end} stub misses the part and holds it badly: try --centre ends or \
                 another --axis"
            ));
        }
        let [overrun, whole] = self.run.overrun;
        if overrun < 0.98 * whole {
            say(format!(
                "the tool runs only {overrun:.1} mm beyond the part's ends, where {whole:.1} mm would \
                 cut them whole: clamp longer or take a narrower tool"
            ));
        }
        if let Some(reach) = &self.reach {
            let share = |area: f64| 100.0 * area / reach.area;
            if share(reach.undercut) >= 0.05 {
                say(format!(
                    "{:.0} mm2 ({:.1} %) of the part are undercut: turned away from the tool in every \
                     pose",
                    reach.undercut,
                    share(reach.undercut)
                ));
            }
            if share(reach.hollow) >= 0.05 {
                say(format!(
                    "{:.0} mm2 ({:.1} %) lie in hollows the tool cannot enter: it keeps up to {:.2} mm off",
                    reach.hollow,
                    share(reach.hollow),
                    reach.deepest
                ));
            }
        }
        if let (Work::RoughAndFinish, Some(RoughReport { held, .. })) = (self.work, &self.rough) {
            for slowed in held.slowed.iter().filter(|slowed| slowed.is_worth_telling(held.taken)) {
                say(format!("roughing: {slowed}"));
            }
        }
        let held = &self.run.held;
        for slowed in held.slowed.iter().filter(|slowed| slowed.is_worth_telling(held.taken)) {
            say(slowed.to_string());
        }
        if let Some(rate) = self.program.block_rate.filter(|rate| rate.highest > rate.limit) {
            say(format!(
                "line {}: {:.0} blocks a second, the control reads {:.0}: it will stutter",
                rate.line, rate.highest, rate.limit
            ));
        }
    }
}

/// What lifts that follow each other leave standing, if it is much.
fn left_by_lifts(certificate: &Certificate) -> Option<String> {
    let Certificate { n_lifts, greatest_lift, left_by_lifts, .. } = certificate;
    if *left_by_lifts <= MUCH_LEFT {
        return None;
    }
    let at = greatest_lift.and_then(|lift| lift.at);
    let at = at.map_or_else(String::new, |[x, y, z]| {
        format!(", the highest lift at {x:.1}, {y:.1}, {z:.1} of the part set up")
    });
    Some(format!(
        "up to {left_by_lifts:.2} mm are left where the tool stays lifted over shoulders ({n_lifts} \
         lifts{at}): take a tool with a smaller nose, more positions a turn or a smaller --min-step"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cam::Lift;

    #[test]
    fn material_left_by_lifts_is_warned_of_where_it_is_much() {
        let lift = Lift { rise: 2.0, at: Some([10.0, 2.0, 3.25]) };
        let certificate = Certificate {
            n_lifts: 4,
            greatest_lift: Some(lift),
            left_by_lifts: 0.8,
            ..Certificate::default()
        };
        let told = left_by_lifts(&certificate).unwrap();
        let expected = "up to 0.80 mm are left where the tool stays lifted over shoulders (4 lifts, the \
                        highest lift at 10.0, 2.0, 3.2 of the part set up): ";
        assert!(told.starts_with(expected) && told.contains("--min-step"), "{told}");
        let little = Certificate { left_by_lifts: 0.4, ..certificate };
        assert_eq!(left_by_lifts(&little), None);
    }
}
