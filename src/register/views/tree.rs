//! Which views lie together, and where, by the pairs that others confirm most.

use super::Pair;
use crate::geom::Pose;
use crate::register::icp::View;

/// Two ways from one view to another agree if they end nearer to each other than this [share of the
/// view's size].
const AGREES: f64 = 0.05;

/// The most views that believed pairs join, in order; of as many those with the last view.
pub(super) fn largest_group(n_views: usize, pairs: &[Pair]) -> Vec<usize> {
    let mut group_of: Vec<usize> = (0..n_views).collect();
    for pair in pairs.iter().filter(|pair| pair.is_believed()) {
        let [from, to] = [pair.source, pair.target].map(|view| group_of[view]);
        group_of.iter_mut().filter(|group| **group == from).for_each(|group| *group = to);
    }
    let members =
        |group: usize| (0..n_views).filter(|&i| group_of[i] == group).collect::<Vec<usize>>();
    // Of several that are as large the last one wins.
    (0..n_views)
        .map(members)
        .max_by_key(|members| (members.len(), members.last().copied()))
        .unwrap_or_default()
}

/// Where the views of `group` are, about their centroids, in the frame of `stays`: along the tree of the
/// pairs that lie on each other best and that most others agree with.
pub(super) fn spanned(views: &[View], group: &[usize], stays: usize, pairs: &[Pair]) -> Vec<Pose> {
    let believed: Vec<&Pair> = pairs.iter().filter(|pair| pair.is_believed()).collect();
    let mut ranked: Vec<(f64, &Pair)> =
        believed.iter().map(|pair| (score(views, pair, &believed), *pair)).collect();
    // Stable: of two as good the one that was tried first.
    ranked.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut poses: Vec<Option<Pose>> = vec![None; views.len()];
    poses[stays] = Some(Pose::identity());
    // Prim's tree: the best pair that leads from a view that is placed to one that is not.
    while let Some((view, pose)) = ranked.iter().find_map(|(_, pair)| next(pair, &poses)) {
        poses[view] = Some(pose);
    }
    group.iter().map(|&view| poses[view].unwrap_or_else(Pose::identity)).collect()
}

/// The end of `pair` that is not placed, and where it is by the other.
fn next(pair: &Pair, poses: &[Option<Pose>]) -> Option<(usize, Pose)> {
    let found = pair.found?.pose;
    match (poses[pair.source], poses[pair.target]) {
        (None, Some(target)) => Some((pair.source, target * found)),
        (Some(source), None) => Some((pair.target, source * found.inverse())),
        _ => None,
    }
}

/// How much of a pair lies on each other, counted once more for every third view by which the way is the
/// same.
fn score(views: &[View], pair: &Pair, believed: &[&Pair]) -> f64 {
    let Some(direct) = pair.found else { return 0.0 };
    let step = |from: usize, to: usize| {
        believed.iter().find_map(|pair| {
            let found = pair.found?.pose;
            match (pair.source, pair.target) {
                (source, target) if (source, target) == (from, to) => Some(found),
                (source, target) if (target, source) == (from, to) => Some(found.inverse()),
                _ => None,
            }
        })
    };
    let radius = views[pair.source].radius;
    let agrees = |third: &usize| {
        let way = || Some(step(*third, pair.target)? * step(pair.source, *third)?);
        way().is_some_and(|way| {
            let off = direct.pose.inverse() * way;
            off.rotation.angle() * radius + off.translation.vector.norm() < AGREES * radius
        })
    };
    let n_agree = (0..views.len()).filter(agrees).count();
    pair.fit * (1.0 + n_agree as f64)
}
