//! Trying starts out on the surfaces: how much of both clouds comes to lie on each other.
//!
//! Features only propose. Every start is refined on few points, and the share of either cloud that
//! then lies on the other decides: truly, tangent planes and normals agreeing, not merely near it.

use super::StartedFrom;
use super::matching::between;
use crate::geom::{Nearest, Pose};
use crate::progress::Progress;
use crate::register::icp::{
    IcpError, IcpOptions, Metric, Settled, View, about_centers, align_views,
};
use rayon::prelude::*;

/// Starts nearer to each other than this are one [voxels].
const SAME: f64 = 3.0;
/// The first distance of the refinement [voxels].
const FAR: f64 = 3.0;
/// The last distance of the refinement [voxels].
const NEAR: f64 = 1.5;
/// Iterations of each of its two levels.
const ITERATIONS: u32 = 25;
/// A point lies on a surface if it is no farther from its tangent plane [voxels],
const OFF_PLANE: f64 = 0.5;
/// and if the normals enclose less: the cosine of 30 degrees.
const ALIKE: f64 = 0.866;

/// A pose to begin with, between clouds about their centroids.
#[derive(Debug, Clone, Copy)]
pub(super) struct Start {
    pub(super) pose: Pose,
    pub(super) from: StartedFrom,
}

/// A start after its refinement on few points.
#[derive(Debug, Clone, Copy)]
pub(super) struct Tried {
    pub(super) start: Start,
    pub(super) pose: Pose,
    /// The share of both clouds that lies on each other.
    pub(super) fit: f64,
}

/// Refines all `starts` and keeps those that end in different poses, the best first.
pub(super) fn tried(
    views: [&View; 2],
    starts: &[Start],
    seed: u64,
    progress: &dyn Progress,
) -> Result<Vec<Tried>, IcpError> {
    let [source, target] = views;
    let voxel = source.voxel;
    let options = IcpOptions {
        levels: 2,
        iterations: ITERATIONS,
        rotation_eps_deg: 0.05,
        seed,
        ..IcpOptions::default()
    };
    let settled = Settled {
        metric: Metric::Generalised,
        voxel,
        max_distance: FAR * voxel,
        final_distance: NEAR * voxel,
        translation_eps: 0.01 * voxel,
    };
    progress.start("starts", starts.len() as u64);
    let found: Result<Vec<Tried>, IcpError> = starts
        .par_iter()
        .map(|start| {
            let alignment =
                align_views([source, target], &start.pose, &settled, &options, &Quiet(progress))?;
            let pose = alignment.target_from_source;
            progress.advance(1)?;
            let fit = fit([source, target], &about_centers(&pose, [source, target]));
            Ok(Tried { start: *start, pose, fit })
        })
        .collect();
    let mut found = found?;
    found.sort_by(|a, b| b.fit.total_cmp(&a.fit));
    let mut kept: Vec<Tried> = Vec::new();
    for tried in found {
        let is_known =
            |other: &Tried| between(&other.pose, &tried.pose, source.radius) < SAME * voxel;
        if !kept.iter().any(is_known) {
            kept.push(tried);
        }
    }
    Ok(kept)
}

/// The first of poses that lie nearly on each other.
pub(super) fn distinct(
    starts: impl IntoIterator<Item = Start>,
    radius: f64,
    voxel: f64,
) -> Vec<Start> {
    let mut kept: Vec<Start> = Vec::new();
    for start in starts {
        if !kept.iter().any(|other| between(&other.pose, &start.pose, radius) < SAME * voxel) {
            kept.push(start);
        }
    }
    kept
}

/// The share of both clouds that lies on each other, the mean of both; `pose` is about their centres.
pub(in crate::register) fn fit([source, target]: [&View; 2], pose: &Pose) -> f64 {
    let [there, back] = [lying_on(source, target, pose), lying_on(target, source, &pose.inverse())];
    f64::midpoint(there, back)
}

/// The share of `moved` that lies on `still`.
fn lying_on(moved: &View, still: &View, still_from_moved: &Pose) -> f64 {
    let voxel = moved.voxel.max(still.voxel);
    let is_on = |i: usize| {
        let at = still_from_moved * moved.points[i];
        still.tree.nearest(&at, NEAR * voxel).is_some_and(|found| {
            let j = found.index as usize;
            let normal = &still.normals[j];
            let cosine = (still_from_moved.rotation * moved.normals[i]).dot(normal);
            let is_oriented = moved.is_oriented && still.is_oriented;
            let cosine = if is_oriented { cosine } else { cosine.abs() };
            cosine > ALIKE && normal.dot(&(at - still.points[j])).abs() < OFF_PLANE * voxel
        })
    };
    let n_on = (0..moved.len()).into_par_iter().filter(|&i| is_on(i)).count();
    n_on as f64 / moved.len() as f64
}

/// Passes only the request to stop on.
struct Quiet<'a>(&'a dyn Progress);

impl Progress for Quiet<'_> {
    fn start(&self, _: &str, _: u64) {}

    fn advance(&self, _: u64) -> Result<(), crate::progress::Cancelled> {
        self.0.advance(0)
    }
}
