//! One scan laid over another: the pose, what is to be known about it, and both as one cloud.

use crate::geom::{LengthUnit, PointCloud, Pose};
use crate::progress::Progress;
use crate::register::coarse::{self, CoarseOptions, PlaneSupport, StartedFrom, Support};
use crate::register::icp::{Alignment, IcpError, IcpOptions, Settled, Verdict};
use crate::register::{FreeSpace, Seen, heed_free_space};
use crate::rgbd::Exposure;
use serde::Serialize;

/// What is to be registered.
#[derive(Debug)]
pub struct RegisterJob<'a> {
    /// The scan that is moved.
    pub source: &'a PointCloud,
    /// The scan that stays.
    pub target: &'a PointCloud,
    /// The frames that source and target are of, where depth cameras saw them.
    pub seen: Option<[&'a Exposure; 2]>,
    /// Where the source starts, if somebody knows.
    pub target_from_source: Option<Pose>,
    /// The unit the report gives the matrix in.
    pub unit: LengthUnit,
    /// What the user must know about the inputs.
    pub notes: Vec<String>,
    /// How a start is found.
    pub coarse: &'a CoarseOptions,
    /// How it is refined.
    pub options: &'a IcpOptions,
}

/// The result.
#[derive(Debug, Clone, PartialEq)]
pub struct Registered {
    /// The pose and everything about it.
    pub alignment: Alignment,
    /// The same for people and programs.
    pub report: RegisterReport,
}

/// What is told about a registration; lengths in mm but for the matrix.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RegisterReport {
    /// Whether the pose may be believed.
    pub verdict: Verdict,
    /// Why not, or not quite.
    pub reasons: Vec<String>,
    /// The motion, row by row, its lengths in `unit`.
    pub target_from_source: [[f64; 4]; 4],
    /// The unit of `target_from_source`: that of the target's file.
    pub unit: LengthUnit,
    /// How far the source turned from where it was [deg].
    pub turned_deg: f64,
    /// How far the fine stage moved the source from its start, root mean square of its points [mm].
    pub moved: f64,
    /// Where the start came from.
    pub started_from: StartedFrom,
    /// Starts that were tried out.
    pub n_starts: usize,
    /// The share of both clouds that lies on each other, normals and all.
    pub fit: f64,
    /// What speaks for the pose among places that look alike, where any were looked for.
    pub support: Option<Support>,
    /// What speaks for the pose among planes, where any were looked for.
    pub planes: Option<PlaneSupport>,
    /// How the pose goes together with what both cameras looked through, where there were cameras.
    pub free_space: Option<FreeSpace>,
    /// What was settled about metric and lengths.
    pub settled: Settled,
    /// Points of source and target, one to a voxel.
    pub n_points: [usize; 2],
    /// Source points with a partner at the end.
    pub n_inliers: usize,
    /// Steps taken.
    pub n_iterations: u32,
    /// True if the last step was small enough.
    pub converged: bool,
    /// Root mean square residual, in the metric [mm].
    pub rms: f64,
    /// Root mean square distance of partners [mm].
    pub point_rms: f64,
    /// Median distance from the partners' tangent planes [mm].
    pub plane_distance: f64,
    /// How far neighbours lie off their plane [mm].
    pub roughness: f64,
    /// The share of the source that lies on the target, and of the target on the source.
    pub overlap: [f64; 2],
    /// Information of a small motion, turn [rad] before shift [mm], about `pivot`.
    pub information: [[f64; 6]; 6],
    /// Its inverse; nothing where a motion is free.
    pub covariance: Option<[[f64; 6]; 6]>,
    /// What `information` turns about, in the target's frame [mm].
    pub pivot: [f64; 3],
    /// What the user must know about the inputs.
    pub notes: Vec<String>,
}

/// Lays the source over the target.
pub fn register(job: RegisterJob, progress: &dyn Progress) -> Result<Registered, IcpError> {
    let start = job.target_from_source;
    let options = (job.coarse, job.options);
    let found = coarse::align(job.source, job.target, start.as_ref(), options, progress)?;
    let mut alignment = found.alignment;
    let heed = |seen: [&Exposure; 2]| heed_free_space(&mut alignment, seen.map(Seen::from));
    let free_space = job.seen.map(heed).transpose()?;
    let start = start.unwrap_or_else(Pose::identity);
    let pose = alignment.target_from_source;
    let mut matrix = pose.to_homogeneous();
    for k in 0..3 {
        matrix[(k, 3)] /= job.unit.in_mm();
    }
    let report = RegisterReport {
        verdict: alignment.verdict,
        reasons: alignment.reasons.iter().map(ToString::to_string).collect(),
        target_from_source: std::array::from_fn(|a| std::array::from_fn(|b| matrix[(a, b)])),
        unit: job.unit,
        turned_deg: pose.rotation.angle_to(&start.rotation).to_degrees(),
        moved: alignment.moved,
        started_from: found.started_from,
        n_starts: found.n_starts,
        fit: found.fit,
        support: found.support,
        planes: found.planes,
        free_space,
        settled: alignment.settled,
        n_points: alignment.n_points,
        n_inliers: alignment.n_inliers,
        n_iterations: alignment.n_iterations,
        converged: alignment.converged,
        rms: alignment.rms,
        point_rms: alignment.point_rms,
        plane_distance: alignment.plane_distance,
        roughness: alignment.roughness,
        overlap: alignment.overlap,
        information: rows(&alignment.information),
        covariance: alignment.covariance().as_ref().map(rows),
        pivot: alignment.pivot.into(),
        notes: job.notes,
    };
    Ok(Registered { alignment, report })
}

/// The target, and the source where `target_from_source` puts it, as one cloud; with normals and
/// colours where both have them.
pub fn merged(source: &PointCloud, target: &PointCloud, target_from_source: &Pose) -> PointCloud {
    let moved = source.points.iter().map(|point| target_from_source * point);
    let turned = source
        .normals
        .as_ref()
        .map(|normals| normals.iter().map(|normal| target_from_source.rotation * normal).collect());
    PointCloud {
        points: target.points.iter().copied().chain(moved).collect(),
        normals: joined(target.normals.clone(), turned),
        colors: joined(target.colors.clone(), source.colors.clone()),
    }
}

fn joined<T>(first: Option<Vec<T>>, second: Option<Vec<T>>) -> Option<Vec<T>> {
    let mut all = first?;
    all.extend(second?);
    Some(all)
}

fn rows(matrix: &nalgebra::Matrix6<f64>) -> [[f64; 6]; 6] {
    std::array::from_fn(|a| std::array::from_fn(|b| matrix[(a, b)]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::{Point3, Vector3};

    #[test]
    fn both_clouds_become_one_with_what_both_have() {
        let one = |color| PointCloud {
            points: vec![Point3::new(1.0, 2.0, 3.0)],
            normals: Some(vec![Vector3::x()]),
            colors: color,
        };
        let pose = Pose::new(Vector3::new(0.0, 0.0, 5.0), Vector3::z() * std::f64::consts::PI);
        let both = merged(&one(Some(vec![[1; 3]])), &one(None), &pose);
        assert!((both.points[1] - Point3::new(-1.0, -2.0, 8.0)).norm() < 1e-12);
        assert!((both.normals.unwrap()[1] + Vector3::x()).norm() < 1e-12);
        assert_eq!(both.colors, None);
    }
}
