//! An estimated trajectory beside the true one, as numbers.

use crate::register::{
    Delta, OdometryError, OdometryErrorOptions, Statistics, TruthAt, Unmatched, odometry_error,
};
use crate::rgbd::CameraTrajectory;
use serde::Serialize;

/// What a comparison finds.
#[derive(Debug, Clone, PartialEq)]
pub struct Evaluation {
    /// The numbers.
    pub report: EvaluationReport,
    /// The errors one by one.
    pub error: OdometryError,
}

/// What a comparison finds, as numbers. Lengths in millimetres, angles in degrees.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct EvaluationReport {
    /// Poses of the estimate.
    pub n_poses: usize,
    /// Those without a true pose near enough.
    pub n_unmatched: usize,
    /// What was taken for the truth at a stamp.
    pub truth_at: TruthAt,
    /// The absolute trajectory error, after the best rigid alignment [mm].
    pub ate_mm: Statistics,
    /// The relative pose errors.
    pub rpe: Vec<RelativeReport>,
    /// What aligns the estimate with the truth, row by row [mm].
    pub truth_from_estimate: [[f64; 4]; 3],
}

/// The relative pose error over one step.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct RelativeReport {
    /// The step.
    pub delta: Delta,
    /// How many steps there are.
    pub n_steps: usize,
    /// How far they lead astray [mm].
    pub translation_mm: Statistics,
    /// How much they turn too far [deg].
    pub rotation_deg: Statistics,
}

/// Compares `estimate` with `truth`.
pub fn evaluate(
    estimate: &CameraTrajectory,
    truth: &CameraTrajectory,
    options: &OdometryErrorOptions,
) -> Result<Evaluation, Unmatched> {
    let error = odometry_error(estimate, truth, options)?;
    let rpe = error.relative.iter().map(|relative| RelativeReport {
        delta: relative.delta,
        n_steps: relative.errors.len(),
        translation_mm: relative.translation,
        rotation_deg: relative.rotation.map(f64::to_degrees),
    });
    let matrix = error.absolute.truth_from_estimate.to_homogeneous();
    let report = EvaluationReport {
        n_poses: estimate.poses().len(),
        n_unmatched: error.n_unmatched,
        truth_at: options.truth_at,
        ate_mm: error.absolute.statistics,
        rpe: rpe.collect(),
        truth_from_estimate: [0, 1, 2].map(|i| [0, 1, 2, 3].map(|j| matrix[(i, j)])),
    };
    Ok(Evaluation { report, error })
}

/// The usual steps, but for those that are longer than `walk`.
pub(super) fn steps_within(walk: &CameraTrajectory) -> OdometryErrorOptions {
    let stamps = walk.stamps();
    let lasts = stamps.last().zip(stamps.first()).map_or(0.0, |(last, first)| last - first);
    let mut options = OdometryErrorOptions::default();
    options.deltas.retain(|delta| match delta {
        Delta::Poses(n) => *n < stamps.len(),
        Delta::Seconds(seconds) => *seconds < lasts,
    });
    options
}
