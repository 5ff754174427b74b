//! The kd-tree: halves of halves, down to leaves of sixteen points side by side.
//!
//! Every split halves its points, so all leaves are equally deep, nodes need no links, and a leaf is
//! four cache lines that are measured without a branch.

use super::search::{KNearest, TwoNearest};
use super::{Nearest, Neighbour};
use crate::geom::{Aabb, Point3};
use crate::progress::{Cancelled, Progress};
use rayon::prelude::*;

/// Points of a leaf at most.
pub(super) const WIDTH: usize = 16;
/// Below this many points one thread splits alone.
const SERIAL: usize = 4096;
/// Neighbourhoods asked for by one thread in a row.
const CHUNK: usize = 512;

/// A search tree over points.
#[derive(Debug, Clone)]
pub struct KdTree {
    /// Coordinates are relative to this point.
    pub(super) origin: Point3,
    /// Inner nodes; the children of `i` are `2 i + 1` and `2 i + 2`.
    pub(super) splits: Vec<Split>,
    /// As many as inner nodes and one more.
    pub(super) leaves: Vec<Leaf>,
    n_points: usize,
}

/// Where a node is cut in two.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Split {
    pub(super) value: f32,
    pub(super) axis: u32,
}

/// Up to sixteen points side by side; empty lanes are infinitely far off.
#[derive(Debug, Clone, Copy)]
#[repr(align(64))]
pub(super) struct Leaf {
    pub(super) at: [[f32; WIDTH]; 3],
    pub(super) points: [u32; WIDTH],
}

impl KdTree {
    /// A tree over `points`, which must be finite. The same points give the same tree, whatever the
    /// number of threads.
    pub fn build(points: &[Point3]) -> Self {
        let aabb = Aabb::around(points);
        let origin = if aabb.is_empty() { Point3::origin() } else { aabb.center() };
        let mut entries: Vec<Entry> = (0_u32..)
            .zip(points)
            .map(|(index, point)| Entry { at: relative(point, &origin), index })
            .collect();
        let n_leaves = points.len().div_ceil(WIDTH).next_power_of_two();
        let mut splits = vec![Split::default(); n_leaves - 1];
        let mut leaves = vec![Leaf::EMPTY; n_leaves];
        // Level by level: the nodes of a level lie in a row, each over a run of entries.
        let mut runs: Vec<&mut [Entry]> = vec![&mut entries];
        let mut rest = splits.as_mut_slice();
        while runs.len() < n_leaves {
            let (level, below) = rest.split_at_mut(runs.len());
            rest = below;
            let halves: Vec<[&mut [Entry]; 2]> = if points.len() < SERIAL {
                runs.into_iter().zip(level).map(halve).collect()
            } else {
                runs.into_par_iter().zip(level).map(halve).collect()
            };
            runs = halves.into_iter().flatten().collect();
        }
        for (leaf, run) in leaves.iter_mut().zip(&runs) {
            *leaf = Leaf::of(run);
        }
        Self { origin, splits, leaves, n_points: points.len() }
    }

    /// The points' places in the cloud, leaf by leaf: neighbours in space lie near each other.
    pub fn order(&self) -> Vec<u32> {
        let all = self.leaves.iter().flat_map(|leaf| leaf.points);
        all.filter(|&index| index != u32::MAX).collect()
    }

    /// The tree for the cloud once that is brought into [`KdTree::order`].
    #[must_use]
    pub fn in_order(mut self) -> Self {
        let mut next = 0..;
        for index in self.leaves.iter_mut().flat_map(|leaf| &mut leaf.points) {
            if *index != u32::MAX {
                *index = next.next().unwrap_or(u32::MAX);
            }
        }
        self
    }

    /// The `k` nearest points that are nearer than `within`, nearest first, into `found`.
    pub fn k_nearest(&self, place: &Point3, k: usize, within: f64, found: &mut Vec<Neighbour>) {
        let mut nearest = KNearest::new(k, within);
        nearest.search(self, place, found);
    }

    /// What `of` makes of every point's `k` nearest points, itself among them, in the points' order.
    ///
    /// `points` are those the tree was built over. Quickest when they are in [`KdTree::order`].
    pub fn map_neighbourhoods<T: Send>(
        &self,
        points: &[Point3],
        k: usize,
        progress: &dyn Progress,
        of: impl Fn(usize, &[Neighbour]) -> T + Sync,
    ) -> Result<Vec<T>, Cancelled> {
        let chunks: Result<Vec<Vec<T>>, Cancelled> = points
            .par_chunks(CHUNK)
            .enumerate()
            .map(|(i_chunk, chunk)| {
                let mut found = Vec::with_capacity(k + 1);
                let mut nearest = KNearest::new(k, f64::INFINITY);
                let mut before: Option<(Point3, f64)> = None;
                let results = chunk.iter().enumerate().map(|(i, point)| {
                    // As many points lie about the one before; they are no farther from here than
                    // the way from there.
                    let farthest = before.map_or(f64::INFINITY, |(p, d)| d + (point - p).norm());
                    nearest.limit(farthest * (1.0 + 1e-5));
                    nearest.search(self, point, &mut found);
                    let full = found.get(k - 1).map(|last| (*point, last.distance));
                    before = full;
                    of(i_chunk * CHUNK + i, &found)
                });
                let results = results.collect();
                progress.advance(chunk.len() as u64)?;
                Ok(results)
            })
            .collect();
        Ok(chunks?.into_iter().flatten().collect())
    }

    /// How many points there are.
    pub fn len(&self) -> usize {
        self.n_points
    }

    /// True if there are no points.
    pub fn is_empty(&self) -> bool {
        self.n_points == 0
    }
}

impl Nearest for KdTree {
    fn two_nearest(&self, place: &Point3, within: f64) -> [Option<Neighbour>; 2] {
        TwoNearest::new(within).search(self, place)
    }
}

/// `point` about `origin`, in the precision of the search.
pub(super) fn relative(point: &Point3, origin: &Point3) -> [f32; 3] {
    let out = point - origin;
    [out.x as f32, out.y as f32, out.z as f32]
}

#[derive(Debug, Clone, Copy)]
struct Entry {
    at: [f32; 3],
    index: u32,
}

/// Cuts a run in half, and says where.
fn halve<'a>((run, split): (&'a mut [Entry], &mut Split)) -> [&'a mut [Entry]; 2] {
    let (found, halves) = halved(run);
    *split = found;
    halves
}

/// Cuts `run` in half across its longest side.
fn halved(run: &mut [Entry]) -> (Split, [&mut [Entry]; 2]) {
    let mut low = [f32::INFINITY; 3];
    let mut high = [f32::NEG_INFINITY; 3];
    for entry in &*run {
        for k in 0..3 {
            low[k] = low[k].min(entry.at[k]);
            high[k] = high[k].max(entry.at[k]);
        }
    }
    let length = |k: &usize| high[*k] - low[*k];
    let axis = (0..3).max_by(|a, b| length(a).total_cmp(&length(b))).unwrap_or(0);
    let middle = run.len().div_ceil(2);
    let key = |entry: &Entry| (entry.at[axis], entry.index);
    let by_key = |a: &Entry, b: &Entry| {
        let (a, b) = (key(a), key(b));
        a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))
    };
    if middle == run.len() {
        // One point or none: all of it lies to the left.
        let split = Split { value: f32::INFINITY, axis: axis as u32 };
        return (split, [run, &mut []]);
    }
    let (_, first_right, _) = run.select_nth_unstable_by(middle, by_key);
    let split = Split { value: first_right.at[axis], axis: axis as u32 };
    let (left, right) = run.split_at_mut(middle);
    (split, [left, right])
}

impl Leaf {
    const EMPTY: Self = Self { at: [[f32::INFINITY; WIDTH]; 3], points: [u32::MAX; WIDTH] };

    fn of(run: &[Entry]) -> Self {
        let mut leaf = Self::EMPTY;
        for (lane, entry) in run.iter().enumerate() {
            for k in 0..3 {
                leaf.at[k][lane] = entry.at[k];
            }
            leaf.points[lane] = entry.index;
        }
        leaf
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::progress::Silent;

    /// Points on a wavy sheet, made up without a pattern the tree could profit from.
    pub(in super::super) fn sheet(n: u32) -> Vec<Point3> {
        (0..n)
            .map(|i| {
                let (u, v) =
                    ((f64::from(i) * 0.618_034).fract(), (f64::from(i) * 0.754_878).fract());
                Point3::new(100.0 * u, 60.0 * v, 5.0 * (9.0 * u).sin() * (7.0 * v).cos())
            })
            .collect()
    }

    fn by_hand(points: &[Point3], place: &Point3) -> Vec<Neighbour> {
        let mut all: Vec<Neighbour> = (0..)
            .zip(points)
            .map(|(index, p)| Neighbour { index, distance: (p - place).norm() })
            .collect();
        all.sort_by(|a, b| a.distance.total_cmp(&b.distance));
        all
    }

    #[test]
    fn the_tree_finds_what_trying_every_point_finds() {
        for n in [1, 2, 15, 16, 17, 33, 1000, 5000] {
            let points = sheet(n);
            let tree = KdTree::build(&points);
            assert_eq!(tree.len(), n as usize);
            for i in 0..50 {
                let t = f64::from(i);
                let place = Point3::new(2.3 * t - 5.0, 61.0 * (0.9 * t).sin().abs(), t - 25.0);
                let expected = by_hand(&points, &place);
                let [first, second] = tree.two_nearest(&place, f64::INFINITY);
                assert!((first.unwrap().distance - expected[0].distance).abs() < 1e-4, "{n} {i}");
                assert_eq!(second.is_some(), n > 1);
                if let Some(second) = second {
                    assert!((second.distance - expected[1].distance).abs() < 1e-4, "{n} {i}");
                }
                let mut found = Vec::new();
                tree.k_nearest(&place, 20, f64::INFINITY, &mut found);
                assert_eq!(found.len(), expected.len().min(20));
                for (ours, theirs) in found.iter().zip(&expected) {
                    assert!((ours.distance - theirs.distance).abs() < 1e-4, "{n} {i}");
                }
            }
        }
    }

    #[test]
    fn nothing_is_found_beyond_the_limit_nor_in_no_cloud() {
        let tree = KdTree::build(&sheet(100));
        let far = Point3::new(0.0, 0.0, 50.0);
        assert_eq!(tree.two_nearest(&far, 40.0), [None, None]);
        assert!(tree.nearest(&far, 60.0).is_some());
        let empty = KdTree::build(&[]);
        assert!(empty.is_empty() && empty.nearest(&far, f64::INFINITY).is_none());
    }

    #[test]
    fn a_thousand_equal_points_are_no_trouble() {
        let tree = KdTree::build(&vec![Point3::new(1.0, 2.0, 3.0); 1000]);
        let [first, second] = tree.two_nearest(&Point3::origin(), 10.0);
        assert!((first.unwrap().distance - 14.0_f64.sqrt()).abs() < 1e-6);
        assert!((second.unwrap().distance - 14.0_f64.sqrt()).abs() < 1e-6);
    }

    #[test]
    fn neighbourhoods_are_those_of_single_questions_in_any_order() {
        let points = sheet(3000);
        let tree = KdTree::build(&points);
        let order = tree.order();
        let sorted: Vec<Point3> = order.iter().map(|&i| points[i as usize]).collect();
        let in_order = tree.clone().in_order();
        let farthest = |_: usize, found: &[Neighbour]| found[19].distance;
        let ours = in_order.map_neighbourhoods(&sorted, 20, &Silent, farthest).unwrap();
        for (&i, distance) in order.iter().zip(ours) {
            assert!((by_hand(&points, &points[i as usize])[19].distance - distance).abs() < 1e-4);
        }
    }

    #[test]
    fn the_tree_is_the_same_for_any_number_of_threads() {
        let points = sheet(9000);
        let build = |n| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap();
            pool.install(|| KdTree::build(&points).order())
        };
        assert_eq!(build(1), build(3));
    }
}
