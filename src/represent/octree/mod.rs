//! An octree over a cloud: cells of a voxel grid, joined by eights up to one that holds them all.
//!
//! The leaves are the cells that [`voxel_grid`](super::voxel::voxel_grid) makes of the same size, so the
//! representatives are the same by the same rule; [M] and PCL take the middle of each leaf. Every level is kept: a
//! coarser one is a smaller cloud of the same part, and the eight bits of each cell, level after level, are what
//! a progressive stream sends.

mod code;
mod query;

use super::voxel::{CellSize, CellSum, Reached, ReduceError, cell_sums, cells_for};
use crate::geom::{Cells, CloudParts, Point3, PointCloud, Vector3};
use crate::progress::Progress;
use code::Code;

/// An octree.
#[derive(Debug, Clone, PartialEq)]
pub struct Octree {
    /// The cells of the leaves.
    pub cells: Cells,
    /// How their size was found, if it was looked for.
    pub reached: Option<Reached>,
    /// From the root to the leaves; codes rise in each.
    levels: Vec<Vec<Node>>,
}

/// A cell that has points.
#[derive(Debug, Clone, PartialEq)]
struct Node {
    code: Code,
    /// What its points sum up to, from its middle.
    sum: CellSum,
    /// The first of its cells in the level below.
    first: usize,
    /// Which of the eight are there, a bit each.
    occupied: u8,
}

/// A cell as others see it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OctreeCell {
    /// Its place among the cells of its level.
    pub index: usize,
    /// Its middle.
    pub middle: Point3,
    /// How long its sides are [mm].
    pub side: f64,
    /// The mean of its points.
    pub mean: Point3,
    /// How many it has.
    pub n_points: u64,
}

impl Octree {
    /// The octree whose leaves have the size `size`.
    pub fn build(
        parts: &mut dyn CloudParts,
        size: CellSize,
        progress: &dyn Progress,
    ) -> Result<Self, ReduceError> {
        let (cells, reached) = cells_for(parts, size, progress)?;
        progress.start("sorting into cells", parts.n_points());
        let sums = cell_sums(parts, &cells, progress)?;
        let depth = Code::depth_of(sums.iter().map(|sum| sum.key));
        let leaf =
            |sum: CellSum| Node { code: Code::of_cell(sum.key, depth), sum, first: 0, occupied: 0 };
        let mut leaves: Vec<Node> = sums.into_iter().map(leaf).collect();
        leaves.sort_unstable_by_key(|node| node.code);
        let mut levels = vec![leaves];
        for above in 0..depth {
            let side = cells.side * f64::from(1_u32 << above);
            levels.push(joined(&levels[above as usize], side));
        }
        levels.reverse();
        Ok(Self { cells, reached, levels })
    }

    /// How many levels there are below the root.
    pub fn depth(&self) -> usize {
        self.levels.len() - 1
    }

    /// The cells of a level that have points: level 0 is the root, none are below [`depth`](Self::depth).
    pub fn level(&self, level: usize) -> impl ExactSizeIterator<Item = OctreeCell> + '_ {
        let nodes = self.levels.get(level).map_or(&[][..], Vec::as_slice);
        (0..nodes.len()).map(move |index| self.cell(level, index))
    }

    /// The points that stand for the cells of a level, with mean normals and colours.
    pub fn to_cloud(&self, level: usize, at: impl Fn(OctreeCell) -> Point3) -> PointCloud {
        let nodes = self.levels.get(level).map_or(&[][..], Vec::as_slice);
        CellSum::cloud_of(self.level(level).map(at).collect(), nodes.iter().map(|node| &node.sum))
    }

    /// Which cells are there, level after level from the root on: a byte for each cell that has cells.
    pub fn occupancy(&self) -> Vec<u8> {
        let above_leaves = &self.levels[..self.depth()];
        above_leaves.iter().flatten().map(|node| node.occupied).collect()
    }

    fn cell(&self, level: usize, index: usize) -> OctreeCell {
        let Node { code, sum, .. } = &self.levels[level][index];
        let side = self.cells.side * (1_u64 << (self.depth() - level)) as f64;
        let half = (1_u64 << level) as f64 / 2.0;
        let out = Vector3::from(code.along().map(|x| f64::from(x) + 0.5 - half));
        let middle = self.cells.origin + out * side;
        let mean = middle + sum.shift / sum.n as f64;
        OctreeCell { index, middle, side, mean, n_points: sum.n }
    }
}

/// The cells above cells of the side `side`.
fn joined(below: &[Node], side: f64) -> Vec<Node> {
    let mut above: Vec<Node> = Vec::new();
    for (i, node) in below.iter().enumerate() {
        let mut sum = node.sum;
        sum.key = 0;
        sum.shift += from_middle_above(node.code, side) * sum.n as f64;
        let bit = 1 << node.code.octant();
        match above.last_mut().filter(|last| last.code == node.code.above()) {
            Some(last) => {
                last.sum = last.sum.and(&sum);
                last.occupied |= bit;
            }
            None => above.push(Node { code: node.code.above(), sum, first: i, occupied: bit }),
        }
    }
    above
}

/// Where the middle of a cell is from that of the cell above.
fn from_middle_above(code: Code, side: f64) -> Vector3 {
    let octant = code.octant();
    Vector3::from([2, 1, 0].map(|k| if octant >> k & 1 == 1 { 0.5 } else { -0.5 })) * side
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::progress::Silent;
    use crate::represent::voxel::{Rule, voxel_grid};

    pub(super) fn sheet(n: u32) -> PointCloud {
        let at = |i: u32| {
            let (u, v) = ((f64::from(i) * 0.618_034).fract(), (f64::from(i) * 0.754_878).fract());
            Point3::new(100.0 * u + 1e3, 60.0 * v, 5.0 * (9.0 * u).sin() * (7.0 * v).cos())
        };
        PointCloud {
            points: (0..n).map(at).collect(),
            normals: None,
            colors: Some((0..n).map(|i| [i as u8, 7, 255]).collect()),
        }
    }

    pub(super) fn octree(cloud: &PointCloud, side: f64) -> Octree {
        Octree::build(&mut &*cloud, CellSize::Side(side), &Silent).unwrap()
    }

    fn sorted(mut points: Vec<Point3>) -> Vec<Point3> {
        points.sort_by(|a, b| (a.x, a.y).partial_cmp(&(b.x, b.y)).unwrap());
        points
    }

    #[test]
    fn the_leaves_are_the_cells_of_the_voxel_grid() {
        let cloud = sheet(9000);
        let octree = octree(&cloud, 3.0);
        for (rule, is_mean) in [(Rule::Centroid, true), (Rule::Centre, false)] {
            let voxels = voxel_grid(&mut &cloud, CellSize::Side(3.0), rule, &Silent).unwrap();
            let at = |cell: OctreeCell| if is_mean { cell.mean } else { cell.middle };
            let leaves = sorted(octree.to_cloud(octree.depth(), at).points);
            let expected = sorted(voxels.cloud.points);
            assert_eq!(leaves.len(), expected.len());
            assert!(leaves.iter().zip(&expected).all(|(a, b)| (a - b).norm() < 1e-9));
        }
    }

    #[test]
    fn every_level_holds_all_points_and_the_root_their_mean() {
        let cloud = sheet(5000);
        let octree = octree(&cloud, 2.0);
        for level in 0..=octree.depth() {
            assert_eq!(octree.level(level).map(|cell| cell.n_points).sum::<u64>(), 5000);
            for cell in octree.level(level) {
                assert!((cell.mean - cell.middle).amax() <= cell.side / 2.0 + 1e-9);
            }
        }
        let root = octree.level(0).next().unwrap();
        let sum: Vector3 = cloud.points.iter().map(|p| p.coords).sum();
        assert!((root.mean.coords - sum / 5000.0).norm() < 1e-9);
        assert_eq!(octree.level(octree.depth() + 1).len(), 0);
    }

    #[test]
    fn the_stream_of_occupied_cells_tells_how_many_each_level_has() {
        let octree = octree(&sheet(3000), 2.5);
        let bytes = octree.occupancy();
        let mut at = 0;
        for level in 0..octree.depth() {
            let n = octree.level(level).len();
            let n_below: u32 = bytes[at..at + n].iter().map(|byte| byte.count_ones()).sum();
            assert_eq!(n_below as usize, octree.level(level + 1).len());
            at += n;
        }
        assert_eq!(at, bytes.len());
    }

    #[test]
    fn one_point_has_one_leaf() {
        let one = PointCloud { points: vec![Point3::new(1.0, 2.0, 3.0)], ..PointCloud::default() };
        let octree = octree(&one, 0.5);
        assert!((octree.level(octree.depth()).next().unwrap().mean - one.points[0]).norm() < 1e-12);
        assert_eq!((octree.depth(), octree.occupancy()), (1, vec![128]));
    }
}
