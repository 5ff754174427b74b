//! From the views of a part on a turntable to how it turned.

use crate::geom::{Point3, PointCloud};
use crate::progress::{Cancelled, Progress};
use crate::register::icp::Verdict;
use crate::register::turntable::{Calibration, TurntableError, TurntableOptions, calibrate};
use crate::rgbd::{Camera, NormalOptions, RgbdError, RgbdFrame, SequenceError};
use serde::Serialize;

/// Every second pixel of every second row: voxels are larger anyway.
const STEP: usize = 2;

/// What is told about a turntable. Lengths in millimetres, in the frame of the camera.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct TurntableReport {
    /// The direction of its axis.
    pub axis: [f64; 3],
    /// A point of it.
    pub through: [f64; 3],
    /// The turn from view to view [deg].
    pub step_deg: f64,
    /// Whether it may be believed.
    pub verdict: Verdict,
    /// What speaks against it.
    pub reasons: Vec<String>,
    /// Views it was found from; none if it was given.
    pub n_views: usize,
    /// Median distance of surfaces of neighbouring views.
    pub apart: f64,
    /// The same of views a whole turn apart.
    pub apart_after_a_turn: Option<f64>,
}

/// Why a turntable cannot be calibrated.
#[derive(Debug, thiserror::Error)]
pub enum CalibrateError {
    /// The views do not tell.
    #[error(transparent)]
    Turntable(#[from] TurntableError),
    /// The camera is none.
    #[error(transparent)]
    Camera(#[from] RgbdError),
    /// What they tell is not to be believed.
    #[error("the turntable cannot be calibrated: {reasons}")]
    Failed {
        /// What speaks against it.
        reasons: String,
    },
    /// The caller asked to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// Finds the turntable on which a part turned while `camera` took `frames`, one step after the other.
/// Depths beyond `max_depth` are left out; so are frames that cannot be read.
pub fn calibrate_turntable(
    frames: impl ExactSizeIterator<Item = Result<RgbdFrame, SequenceError>>,
    camera: &Camera,
    max_depth: f64,
    options: &TurntableOptions,
    progress: &dyn Progress,
) -> Result<Calibration, CalibrateError> {
    options.check()?;
    camera.check()?;
    progress.start("read views", frames.len() as u64);
    let mut clouds = Vec::new();
    for frame in frames {
        clouds.push(frame.map(|frame| cloud(frame, camera, max_depth)).unwrap_or_default());
        progress.advance(1)?;
    }
    let found = calibrate(&clouds, options, progress)?;
    if found.verdict == Verdict::Failed {
        return Err(CalibrateError::Failed { reasons: told(&found).join("; ") });
    }
    Ok(found)
}

/// What is told about `found`.
pub fn turntable_report(found: &Calibration) -> TurntableReport {
    let table = &found.turntable;
    TurntableReport {
        axis: table.axis.into(),
        through: table.through.into(),
        step_deg: table.step.to_degrees(),
        verdict: found.verdict,
        reasons: told(found),
        n_views: found.n_views,
        apart: found.apart,
        apart_after_a_turn: found.apart_after_a_turn,
    }
}

fn told(found: &Calibration) -> Vec<String> {
    found.doubts.iter().map(ToString::to_string).collect()
}

/// The points of a frame with normals; none of a frame of another size.
fn cloud(mut frame: RgbdFrame, camera: &Camera, max_depth: f64) -> PointCloud {
    let farthest = max_depth as f32;
    frame.depth.pixels_mut().iter_mut().filter(|z| **z > farthest).for_each(|z| *z = 0.0);
    let eye = Point3::origin();
    let organised =
        frame.cloud(camera).map(|cloud| cloud.with_normals(&eye, &NormalOptions::default()));
    organised.map(|cloud| cloud.to_sparse_cloud(STEP)).unwrap_or_default()
}
