//! Which neurons lie side by side on the surface.

use crate::geom::{KdTree, Nearest, Point3, PointCloud};
use crate::progress::{Cancelled, Progress};
use crate::represent::gng::NeuronGraph;
use rayon::prelude::*;

/// Points looked up by one thread in a row.
const CHUNK: usize = 4096;

/// Neurons around one, as in a regular triangulation.
const N_AROUND: usize = 6;
/// What is longer than this many distances of neurons around spans a gap, unless a signal speaks for it.
const GAP: f64 = 2.0;

/// Halfway through a gap there is no point within so many distances of neurons, or of points.
const HALFWAY: [f64; 2] = [0.75, 2.5];
/// Points looked at to learn how far they are from each other.
const SAMPLE: usize = 10_000;

/// Pairs of neurons that a signal had as its two nearest, or would have.
pub(super) struct Links<'a> {
    points: &'a [Point3],
    /// Sorted, the lower number of a pair first.
    pairs: Vec<[u32; 2]>,
    /// How far off those around each neuron are on average [mm].
    spacing: Vec<f64>,
    cloud: Option<(KdTree, f64)>,
}

impl<'a> Links<'a> {
    /// Those of the network, and those that the points of its cloud speak for: the network itself forgets
    /// a pair whose points are few, and lacks those its last signals missed.
    pub(super) fn of(
        graph: &'a NeuronGraph,
        cloud: Option<&PointCloud>,
        progress: &dyn Progress,
    ) -> Result<Self, Cancelled> {
        let points = &graph.neurons.points;
        let mut pairs: Vec<[u32; 2]> = graph.edges.iter().map(|edge| edge.ends).collect();
        let tree = KdTree::build(points);
        if let Some(cloud) = cloud {
            pairs.par_extend(cloud.points.par_chunks(CHUNK).flat_map_iter(|chunk| {
                let mut found: Vec<_> =
                    chunk.iter().filter_map(|p| two_nearest(&tree, p)).collect();
                found.sort_unstable();
                found.dedup();
                found
            }));
        }
        pairs.par_sort_unstable();
        pairs.dedup();
        let spacing = tree.map_neighbourhoods(points, 1 + N_AROUND, progress, |_, found| {
            found.iter().map(|n| n.distance).sum::<f64>() / (found.len().max(2) - 1) as f64
        })?;
        let cloud = cloud.map(|cloud| {
            let tree = KdTree::build(&cloud.points);
            let spacing = point_spacing(&tree, &cloud.points);
            (tree, spacing)
        });
        Ok(Self { points, pairs, spacing, cloud })
    }

    /// How far off neurons around one are on average [mm]; nothing where no two are a pair.
    pub(super) fn mean_spacing(&self) -> Option<f64> {
        let sum: f64 = self.spacing.iter().sum();
        (!self.pairs.is_empty()).then(|| sum / self.spacing.len() as f64)
    }

    /// True if `a` and `b` are a pair.
    pub(super) fn contain(&self, a: u32, b: u32) -> bool {
        self.pairs.binary_search(&[a.min(b), a.max(b)]).is_ok()
    }

    /// True if nothing is missing between `a` and `b`: they are as near to each other as neurons go, or a pair, or
    /// there are points halfway. Where a cloud has few points to a neuron, most edges of its surface have no signal.
    pub(super) fn span_no_gap(&self, a: u32, b: u32) -> bool {
        let spacing = self.spacing[a as usize].max(self.spacing[b as usize]);
        let middle = nalgebra::center(&self.points[a as usize], &self.points[b as usize]);
        self.length([a, b]) <= GAP * spacing
            || self.contain(a, b)
            || self.cloud.as_ref().is_some_and(|(cloud, of_points)| {
                let within = (HALFWAY[0] * spacing).min(HALFWAY[1] * of_points);
                cloud.nearest(&middle, within).is_some()
            })
    }

    fn length(&self, [a, b]: [u32; 2]) -> f64 {
        (self.points[a as usize] - self.points[b as usize]).norm()
    }

    /// The sides of a triangle that are pairs.
    pub(super) fn n_of(&self, [a, b, c]: [u32; 3]) -> usize {
        [[a, b], [b, c], [c, a]].iter().filter(|[a, b]| self.contain(*a, *b)).count()
    }
}

fn two_nearest(tree: &KdTree, point: &Point3) -> Option<[u32; 2]> {
    let [first, second] = tree.two_nearest(point, f64::INFINITY);
    let (a, b) = (first?.index, second?.index);
    Some([a.min(b), a.max(b)])
}

/// How far points are from the nearest other on average [mm].
fn point_spacing(tree: &KdTree, points: &[Point3]) -> f64 {
    let sample = points.iter().step_by(points.len().div_ceil(SAMPLE).max(1));
    let distances = sample.filter_map(|p| tree.two_nearest(p, f64::INFINITY)[1]);
    let (n, sum) = distances.fold((0.0, 0.0), |(n, sum), other| (n + 1.0, sum + other.distance));
    if n > 0.0 { sum / n } else { 0.0 }
}
