//! Rounds: every two views that lie on each other are paired again, and all poses settled together.

use super::pairs::{Quiet, between};
use super::{Pair, PairOutcome, Ready, ViewsError};
use crate::geom::Pose;
use crate::progress::Progress;
use crate::register::coarse::fit;
use crate::register::icp::{IcpError, IcpOptions, Verdict, align_views, from_centers};
use crate::register::pose_graph::{Edge, EdgeKind, GraphOptions, LoopKernel, PoseGraph, settle};

/// Rounds at most.
const ROUNDS: u32 = 6;
/// A round that moves no view by more than this is the last one [voxels].
const STILL: f64 = 0.01;
/// Views of which this share lies on each other are paired, though nobody found them before.
const JOINS: f64 = 0.1;

/// Poses after the last round.
pub(super) struct Refined {
    /// Of the views of the group, about their centroids.
    pub(super) poses: Vec<Pose>,
    pub(super) n_rounds: u32,
    pub(super) converged: bool,
}

/// Pairs again from `poses` until nothing moves; the view `fixed` of the group stays.
pub(super) fn refined(
    ready: &Ready,
    group: &[usize],
    (fixed, poses): (usize, &[Pose]),
    pairs: &mut [Pair],
    progress: &dyn Progress,
) -> Result<Refined, ViewsError> {
    let mut done = Refined { poses: poses.to_vec(), n_rounds: 0, converged: group.len() < 2 };
    progress.start("rounds", u64::from(ROUNDS));
    let joined = join(ready, group, &done.poses, pairs, progress)?;
    while !done.converged && done.n_rounds < ROUNDS {
        let edges = paired(ready, group, &done.poses, pairs, progress)?;
        let world_from_node = done.poses.clone();
        let graph = PoseGraph { world_from_node, edges, fixed };
        let even = GraphOptions { loop_kernel: LoopKernel::None, ..GraphOptions::default() };
        let settled = settle(&graph, &even, progress).map_err(ViewsError::of_graph)?;
        let moved = moved(ready, group, &done.poses, &settled.world_from_node);
        done.poses = settled.world_from_node;
        done.n_rounds += 1;
        done.converged = moved < STILL * ready.settled.voxel;
        progress.advance(1)?;
        progress.tell(&format!("{joined} more pairs; moved {moved:.4} mm"));
    }
    Ok(done)
}

/// Believes pairs that nobody found from nothing, but that lie on each other now.
fn join(
    ready: &Ready,
    group: &[usize],
    poses: &[Pose],
    pairs: &mut [Pair],
    progress: &dyn Progress,
) -> Result<usize, ViewsError> {
    let mut n_joined = 0;
    for pair in pairs.iter_mut().filter(|pair| !pair.is_believed()) {
        let Some(start) = between(group, poses, pair) else { continue };
        let views = [pair.source, pair.target].map(|i| &ready.views[i]);
        if fit(views, &start) < JOINS {
            continue;
        }
        let start = from_centers(&start, views);
        match align_views(views, &start, &ready.settled, &near(ready), &Quiet(progress)) {
            Ok(found) if found.verdict == Verdict::Ok => {
                *pair = Pair::of(ready, [pair.source, pair.target], &found);
                pair.outcome = PairOutcome::Joined;
                n_joined += 1;
            }
            Ok(_) => {}
            Err(IcpError::Cancelled(cancelled)) => return Err(cancelled.into()),
            Err(error) => return Err(ViewsError::Options(error)),
        }
    }
    Ok(n_joined)
}

/// Believed pairs as edges, laid over each other from where they are.
fn paired(
    ready: &Ready,
    group: &[usize],
    poses: &[Pose],
    pairs: &[Pair],
    progress: &dyn Progress,
) -> Result<Vec<Edge>, ViewsError> {
    let place = |view: usize| group.iter().position(|member| *member == view);
    let mut edges = Vec::new();
    for pair in pairs.iter().filter(|pair| pair.is_believed()) {
        let ends = (place(pair.target), place(pair.source), between(group, poses, pair));
        let (Some(a), Some(b), Some(start)) = ends else { continue };
        let views = [pair.source, pair.target].map(|i| &ready.views[i]);
        let start = from_centers(&start, views);
        let found = align_views(views, &start, &ready.settled, &near(ready), &Quiet(progress))
            .map_err(ViewsError::of_icp)?;
        let found = Pair::of(ready, [pair.source, pair.target], &found);
        let Some(known) = found.found else { continue };
        let (a_from_b, information) = (known.pose, known.information);
        edges.push(Edge { a, b, a_from_b, information, kind: EdgeKind::Step });
    }
    Ok(edges)
}

/// One level, at the last distance: the views are in place but for a little.
fn near(ready: &Ready) -> IcpOptions {
    IcpOptions { levels: 1, ..ready.fine.clone() }
}

/// How far the points of any view were moved at most, root mean square [mm].
fn moved(ready: &Ready, group: &[usize], before: &[Pose], after: &[Pose]) -> f64 {
    let of = |(&view, (before, after)): (&usize, (&Pose, &Pose))| {
        let off = before.inverse() * after;
        // A turn by an angle about the centroid moves its points by two thirds of what the root mean
        // square of their distances would have it, in the square.
        let turn = off.rotation.angle() * ready.views[view].radius;
        (off.translation.vector.norm_squared() + 2.0 / 3.0 * turn * turn).sqrt()
    };
    group.iter().zip(before.iter().zip(after)).map(of).fold(0.0, f64::max)
}
