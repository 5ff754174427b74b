//! Every two views laid over each other, and what is known of each pair.

use super::{LEAST_OFF, Ready, ViewsError};
use crate::geom::Pose;
use crate::progress::{Cancelled, Progress};
use crate::register::coarse::{self, CoarseOptions};
use crate::register::icp::{Alignment, IcpError, Verdict, about_centers, from_centers, judged};
use crate::register::pose_graph::{Edge, EdgeKind};
use nalgebra::{Matrix6, Vector6};

/// Two views, and what became of laying them over each other.
#[derive(Debug, Clone, PartialEq)]
pub struct Pair {
    /// The one that was moved.
    pub source: usize,
    /// The one that stayed.
    pub target: usize,
    /// The share of both that lies on each other.
    pub fit: f64,
    /// What became of it.
    pub outcome: PairOutcome,
    /// The motion that was found, between the views about their centroids, and what is known of it.
    pub(super) found: Option<Known>,
}

/// What became of a pair.
#[derive(Debug, Clone, PartialEq)]
pub enum PairOutcome {
    /// It holds the views together.
    Kept,
    /// It was found when the others had brought the views near each other.
    Joined,
    /// It does not fit the others.
    Dropped {
        /// How far it is off what was settled [standard deviations].
        off: f64,
    },
    /// It is not believed.
    Refused {
        /// Whether it might be right.
        verdict: Verdict,
        /// What speaks against it.
        reasons: Vec<String>,
    },
}

/// A motion, and what is known of it: information of a small step from the left.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Known {
    pub(super) pose: Pose,
    pub(super) information: Matrix6<f64>,
}

impl Pair {
    /// True if it holds the views together.
    pub fn is_believed(&self) -> bool {
        matches!(self.outcome, PairOutcome::Kept | PairOutcome::Joined)
    }
}

/// Every two views, from nothing.
pub(super) fn all(
    ready: &Ready,
    coarse: &CoarseOptions,
    progress: &dyn Progress,
) -> Result<Vec<Pair>, ViewsError> {
    let n = ready.views.len();
    progress.start("pairs", (n * (n - 1) / 2) as u64);
    let mut pairs: Vec<Pair> = Vec::new();
    for (source, target) in
        (1..n).flat_map(|target| (0..target).map(move |source| (source, target)))
    {
        let clouds = [source, target].map(|i| ready.clouds[i]);
        let options = (coarse, &ready.fine);
        let found = coarse::align(clouds[0], clouds[1], None, options, &Quiet(progress));
        pairs.push(match found {
            Ok(found) => {
                let mut pair = Pair::of(ready, [source, target], &found.alignment);
                pair.fit = found.fit;
                pair
            }
            Err(IcpError::Cancelled(cancelled)) => return Err(cancelled.into()),
            Err(error) => {
                let (verdict, reasons) = (Verdict::Failed, vec![error.to_string()]);
                let outcome = PairOutcome::Refused { verdict, reasons };
                Pair { source, target, fit: 0.0, outcome, found: None }
            }
        });
        progress.advance(1)?;
        let n_believed = pairs.iter().filter(|pair| pair.is_believed()).count();
        progress.tell(&format!("{n_believed} of {} lie on each other", pairs.len()));
    }
    Ok(pairs)
}

impl Pair {
    /// What `alignment` says of two views.
    pub(super) fn of(ready: &Ready, [source, target]: [usize; 2], alignment: &Alignment) -> Self {
        let views = [source, target].map(|i| &ready.views[i]);
        let pose = about_centers(&alignment.target_from_source, views);
        let information = alignment.information_about(&views[1].center);
        let outcome = if alignment.verdict == Verdict::Ok {
            PairOutcome::Kept
        } else {
            let reasons = alignment.reasons.iter().map(ToString::to_string).collect();
            PairOutcome::Refused { verdict: alignment.verdict, reasons }
        };
        let fit = f64::midpoint(alignment.overlap[0], alignment.overlap[1]);
        Self { source, target, fit, outcome, found: Some(Known { pose, information }) }
    }
}

/// The pair as an edge between the nodes that its views are.
pub(super) fn edge(
    ready: &Ready,
    pair: &Pair,
    place: impl Fn(usize) -> Option<usize>,
) -> Option<Edge> {
    let found = pair.found?;
    let view = &ready.views[pair.target];
    let off = LEAST_OFF * view.voxel;
    let (turn, shift) = ((off / view.radius).powi(2), off.powi(2));
    let off = Matrix6::from_diagonal(&Vector6::new(turn, turn, turn, shift, shift, shift));
    // The inverse of the sum of both covariances, without the inverse of what may have none.
    let both = Matrix6::identity() + off * found.information;
    let known = found.information * both.try_inverse()?;
    Some(Edge {
        a: place(pair.target)?,
        b: place(pair.source)?,
        a_from_b: found.pose,
        information: (known + known.transpose()) / 2.0,
        kind: EdgeKind::Loop,
    })
}

/// How well views lie on each other at `poses` (of the views of `group`, about their centroids): root
/// mean square over the pairs that are believed, each counting by its points.
pub(super) fn residual(ready: &Ready, group: &[usize], poses: &[Pose], pairs: &[Pair]) -> f64 {
    let (mut squares, mut n) = (0.0, 0.0);
    for pair in pairs.iter().filter(|pair| pair.is_believed()) {
        let Some(between) = between(group, poses, pair) else { continue };
        let views = [pair.source, pair.target].map(|i| &ready.views[i]);
        let found = judged(views, &from_centers(&between, views), &ready.settled);
        squares += found.rms * found.rms * found.n_inliers as f64;
        n += found.n_inliers as f64;
    }
    (squares / f64::max(n, 1.0)).sqrt()
}

/// From the pair's source to its target by poses of the group's views, about their centroids.
pub(super) fn between(group: &[usize], poses: &[Pose], pair: &Pair) -> Option<Pose> {
    let [source, target] =
        [pair.source, pair.target].map(|view| group.iter().position(|member| *member == view));
    Some(poses[target?].inverse() * poses[source?])
}

/// Passes only the wish to stop on: the stages have measures of their own.
pub(super) struct Quiet<'a>(pub(super) &'a dyn Progress);

impl Progress for Quiet<'_> {
    fn start(&self, _: &str, _: u64) {}

    fn advance(&self, _: u64) -> Result<(), Cancelled> {
        self.0.advance(0)
    }
}
