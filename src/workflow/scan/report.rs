//! What is told about a scan.

use super::ScanOptions;
use crate::geom::Pose;
use crate::register::Unmatched;
use crate::register::icp::Verdict;
use crate::register::loops::{Closed, Loop, LoopOutcome};
use crate::register::odometry::{FrameRole, Placed};
use crate::rgbd::CameraTrajectory;
use crate::workflow::evaluate::{EvaluationReport, evaluate, steps_within};
use serde::Serialize;

/// Below this share of frames placed, the scan as a whole failed.
const LEAST_PLACED: f64 = 0.5;

/// A walk that no loop holds together may leave this share of the distance to what is seen open; more is
/// doubtful.
const LOOSE: f64 = 0.02;

/// What is told about a scan. Lengths in millimetres, angles in degrees.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct ScanReport {
    /// The sequence.
    pub name: String,
    /// Failed if most frames were skipped, doubtful if some were or are doubtful, else ok.
    pub verdict: Verdict,
    /// How many frames have which verdict.
    pub counts: VerdictCounts,
    /// How it was done.
    pub options: ScanOptions,
    /// Side of the cells of the cloud.
    pub voxel: f64,
    /// Points of the cloud.
    pub n_points: usize,
    /// Points that were left out of it as outliers.
    pub n_outliers: usize,
    /// How far the camera went.
    pub way: f64,
    /// How much it turned on its way, all turns added up [deg].
    pub turned_deg: f64,
    /// How far the camera may have gone astray at most, by what all motions leave open: three standard
    /// deviations, before loops are closed [mm].
    pub drift: f64,
    /// How far it is from the truth, if that is known.
    pub against_truth: Option<EvaluationReport>,
    /// The absolute error before loops were closed, root mean square [mm]; if the truth is known and any
    /// were.
    pub ate_before_loops_mm: Option<f64>,
    /// What became of loops; nothing if none were looked for.
    pub loops: Option<LoopsReport>,
    /// Every frame.
    pub frames: Vec<FrameReport>,
    /// What speaks against the walk as a whole, though frames may be believed one by one.
    pub doubts: Vec<String>,
    /// What the user must know.
    pub notes: Vec<String>,
}

/// How many frames have which verdict.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct VerdictCounts {
    /// Believed.
    pub ok: usize,
    /// Placed with doubts.
    pub doubtful: usize,
    /// Left out.
    pub skipped: usize,
    /// Key frames, among those believed.
    pub key: usize,
}

/// What became of loops.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct LoopsReport {
    /// How many hold the walk together.
    pub n_closed: usize,
    /// How many did not fit the others.
    pub n_dropped: usize,
    /// How many were not believed.
    pub n_refused: usize,
    /// How far the camera was moved by them at most [mm].
    pub moved: f64,
    /// Every one that was tried.
    pub tried: Vec<LoopReport>,
}

/// What became of a loop.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct LoopReport {
    /// When what was seen again had been seen [s].
    pub earlier: f64,
    /// When it was seen again [s].
    pub later: f64,
    /// What became of it.
    pub result: LoopResult,
    /// How far it is off the walk as it was settled [standard deviations]; of those that were believed.
    pub off: Option<f64>,
    /// What speaks against it.
    pub reasons: Vec<String>,
}

/// What became of a loop.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum LoopResult {
    /// It holds the walk together.
    Closed,
    /// It was not believed.
    Refused,
    /// It does not fit the others.
    Dropped,
}

impl LoopsReport {
    /// What is told of `closed`, where the camera was at `before`.
    pub(super) fn new(closed: &Closed, before: &[Option<Pose>], stamps: &[f64]) -> Self {
        let tried: Vec<LoopReport> =
            closed.loops.iter().map(|tried| LoopReport::of(tried, stamps)).collect();
        let n = |result| tried.iter().filter(|tried| tried.result == result).count();
        let ways = closed.world_from_camera.iter().zip(before).filter_map(|(after, before)| {
            let (after, before) = ((*after)?, (*before)?);
            Some((after.translation.vector - before.translation.vector).norm())
        });
        Self {
            n_closed: n(LoopResult::Closed),
            n_dropped: n(LoopResult::Dropped),
            n_refused: n(LoopResult::Refused),
            moved: ways.fold(0.0, f64::max),
            tried,
        }
    }
}

impl LoopReport {
    fn of(tried: &Loop, stamps: &[f64]) -> Self {
        let (result, off, reasons) = match &tried.outcome {
            LoopOutcome::Closed { off } => (LoopResult::Closed, Some(*off), Vec::new()),
            LoopOutcome::Dropped { off } => {
                let why =
                    format!("it is {off:.1} standard deviations off the walk and other loops");
                (LoopResult::Dropped, Some(*off), vec![why])
            }
            LoopOutcome::Refused(doubts) => {
                let reasons = doubts.iter().map(ToString::to_string).collect();
                (LoopResult::Refused, None, reasons)
            }
        };
        let stamp = |number: usize| stamps.get(number).copied().unwrap_or_default();
        Self { earlier: stamp(tried.earlier), later: stamp(tried.later), result, off, reasons }
    }
}

/// What became of a frame.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct FrameReport {
    /// When it was taken [s].
    pub stamp: f64,
    /// Whether it is believed.
    pub verdict: Verdict,
    /// What part it has.
    pub role: FrameRole,
    /// What speaks against it.
    pub reasons: Vec<String>,
    /// The share of what its key frame shows that it shows too; of those placed against one.
    pub overlap: Option<f64>,
    /// How far its camera may be astray, seen from the first one, by what the motions that lead there leave
    /// open: three standard deviations, before loops are closed [mm].
    pub open: Option<f64>,
    /// How far it is off the truth, the whole way laid over the true one; if that is known [mm].
    pub off: Option<f64>,
}

impl FrameReport {
    /// What became of `placed`.
    pub(super) fn of(placed: &Placed) -> Self {
        Self {
            stamp: placed.stamp,
            verdict: placed.verdict,
            role: if placed.world_from_camera.is_some() {
                FrameRole::Placed
            } else {
                FrameRole::Skipped
            },
            reasons: placed.reasons.iter().map(ToString::to_string).collect(),
            overlap: placed.link.map(|link| link.overlap),
            open: None,
            off: None,
        }
    }
}

impl ScanReport {
    /// The report of `frames`; what is measured comes later.
    pub(super) fn new(
        name: String,
        options: &ScanOptions,
        frames: Vec<FrameReport>,
        notes: Vec<String>,
    ) -> Self {
        let n = |is: &dyn Fn(&FrameReport) -> bool| frames.iter().filter(|frame| is(frame)).count();
        let counts = VerdictCounts {
            ok: n(&|frame| frame.verdict == Verdict::Ok),
            doubtful: n(&|frame| frame.verdict == Verdict::Doubtful),
            skipped: n(&|frame| frame.role == FrameRole::Skipped),
            key: n(&|frame| frame.role == FrameRole::Key),
        };
        let n_placed = counts.ok + counts.doubtful;
        let is_failed = n_placed < 2 || (n_placed as f64) < LEAST_PLACED * frames.len() as f64;
        let verdict = if is_failed {
            Verdict::Failed
        } else if counts.doubtful + counts.skipped > 0 {
            Verdict::Doubtful
        } else {
            Verdict::Ok
        };
        Self {
            name,
            verdict,
            counts,
            options: options.clone(),
            voxel: 0.0,
            n_points: 0,
            n_outliers: 0,
            way: 0.0,
            turned_deg: 0.0,
            drift: 0.0,
            against_truth: None,
            ate_before_loops_mm: None,
            loops: None,
            frames,
            doubts: Vec::new(),
            notes,
        }
    }

    /// Adds how far the camera went.
    pub(super) fn measure(&mut self, trajectory: &CameraTrajectory) {
        for pair in trajectory.poses().windows(2) {
            let step = pair[0].world_from_camera.inverse() * pair[1].world_from_camera;
            self.way += step.translation.vector.norm();
            self.turned_deg += step.rotation.angle().to_degrees();
        }
    }

    /// Adds how far the camera may have gone astray. If that is far for what it sees, `depth` away, and no loop
    /// closed that would hold it, the scan is doubtful, though no motion was.
    pub(super) fn doubt_drift(&mut self, depth: f64) {
        self.drift = self.frames.iter().filter_map(|frame| frame.open).fold(0.0, f64::max);
        let is_held = self.loops.as_ref().is_some_and(|loops| loops.n_closed > 0);
        if is_held || self.drift <= LOOSE * depth {
            return;
        }
        self.verdict = self.verdict.max(Verdict::Doubtful);
        self.doubts.push(format!(
            "the motions add up to a camera that may be {:.0} mm astray, {:.1} % of the distance to what it sees, and \
             no loop holds it: take another --method, go nearer, or go on until it sees again where it began",
            self.drift,
            100.0 * self.drift / depth
        ));
    }

    /// Adds how far the camera is off the truth, and was `before` loops were closed.
    pub(super) fn hold_against(
        &mut self,
        truth: &CameraTrajectory,
        trajectory: &CameraTrajectory,
        before: &CameraTrajectory,
    ) {
        let options = steps_within(trajectory);
        match evaluate(trajectory, truth, &options) {
            Ok(found) => {
                for frame in &mut self.frames {
                    frame.off = found.error.absolute.at(frame.stamp);
                }
                self.against_truth = Some(found.report);
            }
            Err(Unmatched::MaxDifference(_)) => {}
            Err(error) => self.notes.push(format!("not compared with the truth: {error}")),
        }
        if self.loops.as_ref().is_some_and(|loops| loops.n_closed > 0) {
            let before = evaluate(before, truth, &options).ok();
            self.ate_before_loops_mm = before.map(|found| found.report.ate_mm.rmse);
        }
    }

    /// The reasons given, the most frequent first, each with how many frames it was given for. Numbers
    /// in them differ from frame to frame, so it is their first words that are counted.
    pub fn reasons(&self) -> Vec<(String, usize)> {
        let mut counted: Vec<(String, usize, &str)> = Vec::new();
        for reason in self.frames.iter().flat_map(|frame| &frame.reasons) {
            let kind: String = reason.chars().filter(|c| !c.is_ascii_digit()).take(30).collect();
            match counted.iter_mut().find(|known| known.0 == kind) {
                Some(known) => known.1 += 1,
                None => counted.push((kind, 1, reason)),
            }
        }
        counted.sort_by_key(|known| std::cmp::Reverse(known.1));
        counted.into_iter().map(|(_, n, example)| (example.to_owned(), n)).collect()
    }
}
