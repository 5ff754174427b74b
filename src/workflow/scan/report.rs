//! What is told about a scan.

use super::ScanOptions;
use crate::register::icp::Verdict;
use crate::register::odometry::{FrameRole, Placed};
use crate::rgbd::CameraTrajectory;
use crate::workflow::evaluate::EvaluationReport;
use serde::Serialize;

/// Below this share of frames placed, the scan as a whole failed.
const LEAST_PLACED: f64 = 0.5;

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
    /// How far the camera went.
    pub way: f64,
    /// How much it turned on its way, all turns added up [deg].
    pub turned_deg: f64,
    /// How far that is from the truth, if it is known.
    pub against_truth: Option<EvaluationReport>,
    /// Every frame.
    pub frames: Vec<FrameReport>,
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
            way: 0.0,
            turned_deg: 0.0,
            against_truth: None,
            frames,
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
