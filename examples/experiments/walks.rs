//! Sequences of a depth camera, and the five ways to follow it that chapter 2 compares.

use anyhow::Context as _;
use horma::io::rgbd::{DepthCamera, Sequence, open_sequence};
use horma::progress::Silent;
use horma::register::odometry::Method;
use horma::register::{Delta, OdometryErrorOptions, Statistics, odometry_error};
use horma::rgbd::simulated::{BuiltinScene, NoiseKind, SimulationOptions};
use horma::rgbd::{Camera, CameraTrajectory, RgbdFrame, SequenceError};
use horma::workflow::fuse::{FuseJob, FuseOptions, Placing, fuse};
use horma::workflow::scan::{ScanJob, ScanOptions, scan};
use horma::workflow::simulate_scan::{SimulateScanJob, SimulatedScan, Subject, simulate_scan};
use std::path::PathBuf;

/// Frames of a simulated walk.
const SIMULATED_FRAMES: usize = 30;

/// The methods, by the thesis' names: `KinectFusion`, and those that go from frame to frame.
pub(crate) const METHODS: [(&str, Option<Method>); 5] = [
    ("KinectFusion", None),
    ("dense visual odometry", Some(Method::Dvo)),
    ("visual features + ICP", Some(Method::VisualIcp)),
    ("visual features", Some(Method::Visual)),
    ("ICP", Some(Method::Icp)),
];

/// A walk with a known truth.
pub(crate) struct Walk {
    /// What it is called.
    pub(crate) name: String,
    camera: Camera,
    truth: CameraTrajectory,
    source: Source,
    n_frames: usize,
}

enum Source {
    Files(Box<Sequence>),
    Simulated(Box<SimulatedScan>),
}

/// How a method followed a walk: its relative pose errors from frame to frame [mm].
pub(crate) struct Followed {
    /// Of the frames that were placed.
    pub(crate) errors: Option<Statistics>,
    /// Placed frames.
    pub(crate) n_placed: usize,
    /// Frames of the walk.
    pub(crate) n_frames: usize,
}

/// The sequences of `HORMA_DATA`; none, with a word about it, where it is not set.
pub(crate) fn recorded(share: f64) -> anyhow::Result<Vec<Walk>> {
    let Some(data) = std::env::var_os("HORMA_DATA").map(PathBuf::from) else {
        eprintln!("HORMA_DATA is not set: there are no recorded sequences");
        return Ok(Vec::new());
    };
    ["tum_fr1_rpy_cut", "tum_fr1_rpy_fast_cut"]
        .into_iter()
        .map(|name| {
            let folder = data.join("rgbd").join(name);
            let sequence = open_sequence(&folder, Some(DepthCamera::FREIBURG1))?;
            let truth = sequence.truth.clone().with_context(|| format!("{name} has no truth"))?;
            Ok(Walk {
                name: name.to_owned(),
                camera: sequence.camera.camera,
                truth,
                n_frames: shared(sequence.files.len(), share),
                source: Source::Files(Box::new(sequence)),
            })
        })
        .collect()
}

/// Walks before the four scenes with and without texture and structure, with the noise of a Kinect.
pub(crate) fn simulated(share: f64) -> anyhow::Result<Vec<Walk>> {
    let scenes = [
        ("a: structure, texture", BuiltinScene::TexturedStructured),
        ("b: no structure, no texture", BuiltinScene::PlainFlat),
        ("c: no structure, texture", BuiltinScene::TexturedFlat),
        ("d: structure, no texture", BuiltinScene::PlainStructured),
    ];
    let options = SimulationOptions {
        views: SIMULATED_FRAMES,
        noise: NoiseKind::Kinect,
        ..SimulationOptions::default()
    };
    let walk = |(name, scene): (&str, BuiltinScene)| {
        let (subject, camera) = (Subject::Scene(scene), Camera::KINECT);
        let scan =
            simulate_scan(SimulateScanJob { subject, camera, along: None, options: &options })?;
        Ok(Walk {
            name: name.to_owned(),
            camera,
            truth: scan.truth.clone(),
            n_frames: shared(scan.truth.poses().len(), share),
            source: Source::Simulated(Box::new(scan)),
        })
    };
    scenes.into_iter().map(walk).collect()
}

fn shared(n: usize, share: f64) -> usize {
    ((n as f64 * share) as usize).clamp(4.min(n), n)
}

impl Walk {
    /// Follows the camera by a method; a method that is lost from the start has placed nothing.
    pub(crate) fn follow(&self, method: Option<Method>) -> anyhow::Result<Followed> {
        let went = match method {
            Some(method) => self.scanned(method),
            None => self.fused(),
        };
        let trajectory = went.inspect_err(|error| eprintln!("{}: {error:#}", self.name)).ok();
        let n_placed = trajectory.as_ref().map_or(0, |trajectory| trajectory.poses().len());
        let options = OdometryErrorOptions {
            deltas: vec![Delta::Poses(1)],
            ..OdometryErrorOptions::default()
        };
        let errors = match trajectory.filter(|trajectory| 1 < trajectory.poses().len()) {
            Some(trajectory) => {
                let error = odometry_error(&trajectory, &self.truth, &options)?;
                error.relative.first().map(|relative| relative.translation)
            }
            None => None,
        };
        Ok(Followed { errors, n_placed, n_frames: self.n_frames })
    }

    /// How far the camera goes from frame to frame [mm].
    pub(crate) fn steps(&self) -> Statistics {
        let at = |stamp: &f64| self.truth.at(*stamp).map(|pose| pose.translation.vector);
        let places: Vec<_> = self.stamps().iter().filter_map(at).collect();
        let steps: Vec<f64> = places.windows(2).map(|pair| (pair[1] - pair[0]).norm()).collect();
        Statistics::of(&steps)
    }

    fn scanned(&self, method: Method) -> anyhow::Result<CameraTrajectory> {
        let mut options = ScanOptions::default();
        options.odometry.method = method;
        // From frame to frame, as the thesis has it.
        options.loops.no_loops = true;
        let job = ScanJob {
            name: self.name.clone(),
            camera: self.camera,
            stamps: self.stamps(),
            truth: None,
            notes: Vec::new(),
            options: &options,
        };
        Ok(scan(|| self.frames(), &job, &Silent)?.trajectory)
    }

    fn fused(&self) -> anyhow::Result<CameraTrajectory> {
        let options = FuseOptions::default();
        let frames: Vec<_> = self.frames().collect();
        let job = FuseJob {
            frames: frames.into_iter(),
            stamps: self.stamps(),
            camera: self.camera,
            placing: Placing::Tracked,
            truth: None,
            notes: Vec::new(),
            options: &options,
        };
        Ok(fuse(job, &Silent)?.trajectory)
    }

    fn stamps(&self) -> Vec<f64> {
        let all: Vec<f64> = match &self.source {
            Source::Files(sequence) => sequence.files.iter().map(|files| files.stamp).collect(),
            Source::Simulated(_) => self.truth.poses().iter().map(|pose| pose.stamp).collect(),
        };
        all.into_iter().take(self.n_frames).collect()
    }

    fn frames(&self) -> Box<dyn Iterator<Item = Result<RgbdFrame, SequenceError>> + '_> {
        match &self.source {
            Source::Files(sequence) => Box::new(sequence.frames().take(self.n_frames)),
            Source::Simulated(scan) => Box::new(scan.frames().take(self.n_frames).map(Ok)),
        }
    }
}

impl Followed {
    /// Mean and standard deviation, and how many frames were placed if not all.
    pub(crate) fn cell(&self) -> String {
        let placed = if self.n_placed < self.n_frames {
            format!(" ({} of {})", self.n_placed, self.n_frames)
        } else {
            String::new()
        };
        match self.errors {
            Some(Statistics { mean, std, .. }) => format!("{mean:.2} ± {std:.2}{placed}"),
            None => format!("lost{placed}"),
        }
    }
}
