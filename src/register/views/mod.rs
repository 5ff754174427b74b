//! Many views of a part laid over each other at once.
//!
//! Every two views are laid over each other from nothing ([`coarse`](super::coarse)); pairs that are
//! believed are edges of a pose graph, begun at the tree of those that other pairs confirm most. Pairs
//! that do not fit the others are dropped. Then, in rounds, every two views that lie on each other by now
//! are paired again, and all poses are settled together: no view is laid over one that has
//! an error of its own already, as in a chain.
//!
//! Pulli, *Multiview registration for large data sets* (1999); Lu and Milios (1997).

mod pairs;
mod refine;
mod tree;

use super::coarse::CoarseOptions;
use super::icp::{self, IcpError, IcpOptions, Role, Settled, Verdict, View};
use super::pose_graph::{GraphError, GraphOptions, PoseGraph, settle};
use crate::geom::{PointCloud, Pose};
use crate::progress::{Cancelled, Progress};
use pairs::edge;
pub use pairs::{Pair, PairOutcome};
use refine::refined;
use serde::Serialize;
use tree::{largest_group, spanned};

/// What a pair may be off and still fit the others, besides what its points say [voxels]: surfaces that
/// are seen from two sides err together.
const LEAST_OFF: f64 = 0.5;

/// Views laid over each other.
#[derive(Debug, Clone, PartialEq)]
pub struct ViewsAligned {
    /// Where each view is, in the frame of `stays`; `None` of views that no other confirms.
    pub stays_from_view: Vec<Option<Pose>>,
    /// The view that stays where it is: the last one, if it lies with the most others.
    pub stays: usize,
    /// Every two views.
    pub pairs: Vec<Pair>,
    /// How well all lie on each other.
    pub residual: ViewsResidual,
    /// Rounds of pairing again.
    pub n_rounds: u32,
    /// True if the last round moved nothing worth mentioning.
    pub converged: bool,
    /// The side of the voxels [mm].
    pub voxel: f64,
}

/// How well all views lie on each other: root mean square residual of all that lie on another, in the
/// metric of the fine stage [mm].
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct ViewsResidual {
    /// Of pairs laid end to end.
    pub chained: f64,
    /// After the pose graph.
    pub settled: f64,
    /// After the last round.
    pub refined: f64,
}

/// Why views cannot be laid over each other.
#[derive(Debug, thiserror::Error)]
pub enum ViewsError {
    /// A view that is none.
    #[error("view {number}: {problem}")]
    View {
        /// Which, counted from 1.
        number: usize,
        /// What is wrong with it.
        problem: IcpError,
    },
    /// Fewer than two.
    #[error("{n_views} views cannot be laid over each other; give two or more")]
    TooFew {
        /// How many.
        n_views: usize,
    },
    /// The options.
    #[error(transparent)]
    Options(IcpError),
    /// The graph of all pairs.
    #[error(transparent)]
    Graph(GraphError),
    /// The caller asked to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// Views ready to be laid over each other.
struct Ready<'a> {
    clouds: &'a [&'a PointCloud],
    views: Vec<View>,
    settled: Settled,
    fine: IcpOptions,
}

/// Lays `clouds` over each other, wherever they are. The result is the same for any number of threads.
pub fn align_all(
    clouds: &[&PointCloud],
    (coarse, fine, graph): (&CoarseOptions, &IcpOptions, &GraphOptions),
    progress: &dyn Progress,
) -> Result<ViewsAligned, ViewsError> {
    let ready = Ready::new(clouds, fine, progress)?;
    let mut pairs = pairs::all(&ready, coarse, progress)?;
    let group = largest_group(clouds.len(), &pairs);
    let stays = group.last().copied().unwrap_or(clouds.len() - 1);
    let chained = spanned(&ready.views, &group, stays, &pairs);
    // Nodes are the views of the group, each about its centroid.
    let place = |view: usize| group.iter().position(|member| *member == view);
    let kept: Vec<usize> = (0..pairs.len())
        .filter(|&i| pairs[i].is_believed() && place(pairs[i].source).is_some())
        .collect();
    let edges = kept.iter().filter_map(|&i| edge(&ready, &pairs[i], place)).collect();
    let fixed = place(stays).unwrap_or(0);
    let first = PoseGraph { world_from_node: chained.clone(), edges, fixed };
    let settled = settle(&first, graph, progress).map_err(ViewsError::of_graph)?;
    for (&i, (&weight, &off)) in kept.iter().zip(settled.weights.iter().zip(&settled.off)) {
        if weight == 0.0 {
            pairs[i].outcome = PairOutcome::Dropped { off };
        }
    }
    // What was held by pairs that were dropped is held no more.
    let still = largest_group(clouds.len(), &pairs);
    let of_still = |poses: &[Pose]| -> Vec<Pose> {
        still.iter().filter_map(|&view| Some(poses[place(view)?])).collect()
    };
    let stays = still.last().copied().unwrap_or(stays);
    let (chained, settled) = (of_still(&chained), of_still(&settled.world_from_node));
    let fixed = still.len().saturating_sub(1);
    let done = refined(&ready, &still, (fixed, &settled), &mut pairs, progress)?;
    let of = |poses: &[Pose]| pairs::residual(&ready, &still, poses, &pairs);
    let residual =
        ViewsResidual { chained: of(&chained), settled: of(&settled), refined: of(&done.poses) };
    let mut stays_from_view = vec![None; clouds.len()];
    for (&view, pose) in still.iter().zip(&done.poses) {
        let between = done.poses[fixed].inverse() * pose;
        let views = [&ready.views[view], &ready.views[stays]];
        stays_from_view[view] = Some(icp::from_centers(&between, views));
    }
    Ok(ViewsAligned {
        stays_from_view,
        stays,
        pairs,
        residual,
        n_rounds: done.n_rounds,
        converged: done.converged,
        voxel: ready.settled.voxel,
    })
}

impl ViewsAligned {
    /// Failed if fewer than two views lie together, doubtful if some are left out or it has not come to
    /// rest, else ok.
    pub fn verdict(&self) -> Verdict {
        let n_placed = self.stays_from_view.iter().flatten().count();
        if n_placed < 2 {
            Verdict::Failed
        } else if n_placed < self.stays_from_view.len() || !self.converged {
            Verdict::Doubtful
        } else {
            Verdict::Ok
        }
    }
}

impl ViewsError {
    fn of_graph(error: GraphError) -> Self {
        match error {
            GraphError::Cancelled(cancelled) => Self::Cancelled(cancelled),
            other => Self::Graph(other),
        }
    }

    fn of_icp(error: IcpError) -> Self {
        match error {
            IcpError::Cancelled(cancelled) => Self::Cancelled(cancelled),
            other => Self::Options(other),
        }
    }
}

impl<'a> Ready<'a> {
    fn new(
        clouds: &'a [&'a PointCloud],
        fine: &IcpOptions,
        progress: &dyn Progress,
    ) -> Result<Self, ViewsError> {
        fine.check().map_err(ViewsError::of_icp)?;
        let n_views = clouds.len();
        // Lengths follow the smallest, so that all pairs are judged alike.
        let size = |cloud: &&&PointCloud| cloud.aabb().size().norm();
        let smallest = clouds.iter().min_by(|a, b| size(a).total_cmp(&size(b)));
        let (Some(smallest), 2..) = (smallest, n_views) else {
            return Err(ViewsError::TooFew { n_views });
        };
        let plain = clouds.iter().find(|cloud| cloud.colors.is_none()).unwrap_or(smallest);
        let mut settled = Settled::new(smallest, smallest, fine).map_err(ViewsError::of_icp)?;
        settled.metric = Settled::new(plain, plain, fine).map_err(ViewsError::of_icp)?.metric;
        let fine = IcpOptions {
            fine: Some(settled.metric),
            voxel: Some(settled.voxel),
            max_distance: Some(settled.max_distance),
            final_distance: Some(settled.final_distance),
            translation_eps: Some(settled.translation_eps),
            ..fine.clone()
        };
        progress.start("views", n_views as u64);
        let mut views = Vec::with_capacity(n_views);
        for (cloud, number) in clouds.iter().zip(1..) {
            let view =
                icp::view(cloud, Role::Source, (&settled, &fine), None, &pairs::Quiet(progress));
            views.push(view.map_err(|problem| match problem {
                IcpError::Cancelled(cancelled) => ViewsError::Cancelled(cancelled),
                problem => ViewsError::View { number, problem },
            })?);
            progress.advance(1)?;
        }
        Ok(Self { clouds, views, settled, fine })
    }
}

#[cfg(test)]
mod tests;
