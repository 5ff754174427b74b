//! Points by the cell they lie in: a search that never looks farther than the cells around.

use super::{Nearest, Neighbour};
use crate::geom::Point3;
use std::collections::HashMap;

/// A cloud in cubic cells.
#[derive(Debug, Clone)]
pub struct VoxelMap {
    origin: Point3,
    cell: f64,
    /// Where the points of a cell lie in `entries`.
    runs: HashMap<[i64; 3], std::ops::Range<u32>>,
    entries: Vec<(Point3, u32)>,
}

impl VoxelMap {
    /// The finite `points` in cells of the side `cell`, which must be above 0; no point farther
    /// than that from a place is ever found.
    pub fn build(points: &[Point3], cell: f64) -> Self {
        let origin = points.first().copied().unwrap_or_else(Point3::origin);
        let mut keyed: Vec<([i64; 3], u32)> =
            (0..).zip(points).map(|(i, point)| (key(point, &origin, cell), i)).collect();
        keyed.sort_unstable();
        let entries = keyed.iter().map(|&(_, i)| (points[i as usize], i)).collect();
        let mut runs = HashMap::new();
        let mut first = 0;
        for run in keyed.chunk_by(|a, b| a.0 == b.0) {
            let end = first + run.len() as u32;
            runs.insert(run[0].0, first..end);
            first = end;
        }
        Self { origin, cell, runs, entries }
    }
}

impl Nearest for VoxelMap {
    fn two_nearest(&self, place: &Point3, within: f64) -> [Option<Neighbour>; 2] {
        let within = within.min(self.cell);
        let middle = key(place, &self.origin, self.cell);
        let mut best: [Option<Neighbour>; 2] = [None; 2];
        for i in 0..27 {
            let cell = [0, 1, 2].map(|k| middle[k].saturating_add(i / 3_i64.pow(k as u32) % 3 - 1));
            let Some(run) = self.runs.get(&cell) else { continue };
            for &(point, index) in &self.entries[run.start as usize..run.end as usize] {
                let distance = (point - place).norm();
                let reach = best[1].map_or(within, |next| next.distance);
                if distance < reach {
                    let found = Some(Neighbour { index, distance });
                    let is_first = best[0].is_none_or(|first| distance < first.distance);
                    best = if is_first { [found, best[0]] } else { [best[0], found] };
                }
            }
        }
        best
    }

    fn reach(&self) -> f64 {
        self.cell
    }
}

fn key(point: &Point3, origin: &Point3, cell: f64) -> [i64; 3] {
    // The cast saturates: what lies that far out meets no other cell.
    [0, 1, 2].map(|k| ((point[k] - origin[k]) / cell).floor() as i64)
}

#[cfg(test)]
mod tests {
    use super::super::KdTree;
    use super::*;

    #[test]
    fn within_a_cell_the_map_finds_what_the_tree_finds() {
        let points: Vec<Point3> = (0..2000)
            .map(|i| {
                let t = f64::from(i);
                Point3::new((t * 0.618).fract() * 50.0, (t * 0.755).fract() * 50.0, (t * 0.1).sin())
            })
            .collect();
        let (map, tree) = (VoxelMap::build(&points, 3.0), KdTree::build(&points));
        for i in 0..200 {
            let t = f64::from(i);
            let place =
                Point3::new(0.3 * t - 4.0, 30.0 * (0.7 * t).cos().abs(), 2.0 * (t * 0.4).sin());
            let distances = |found: [Option<Neighbour>; 2]| found.map(|f| f.map(|f| f.distance));
            let ours = distances(map.two_nearest(&place, 10.0));
            let theirs = distances(tree.two_nearest(&place, 3.0));
            for (a, b) in ours.into_iter().zip(theirs) {
                assert_eq!(a.is_some(), b.is_some(), "{place}");
                assert!((a.unwrap_or(0.0) - b.unwrap_or(0.0)).abs() < 1e-4, "{place}");
            }
        }
    }

    #[test]
    fn a_place_beyond_all_cells_finds_nothing() {
        let map = VoxelMap::build(&[Point3::origin()], 1.0);
        assert_eq!(map.nearest(&Point3::new(1e300, 0.0, 0.0), 1e301), None);
    }
}
