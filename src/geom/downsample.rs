//! One point for each cell of a grid.

use super::{Point3, PointCloud, Vector3};
use rayon::prelude::*;

/// Bits of a cell's number along one axis.
const BITS: u32 = 21;
/// Points summed up in a row: sums are the same for any number of threads.
const CHUNK: usize = 1 << 14;

/// Why a cloud could not be put into cells.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum VoxelError {
    /// The side is no length.
    #[error("a voxel of {side} mm has no size; give a length above 0")]
    Side {
        /// The side asked for [mm].
        side: f64,
    },
    /// More cells along an axis than can be numbered.
    #[error(
        "voxels of {side} mm are too small for a cloud of {extent:.1} mm; use at least {least:.3e} mm"
    )]
    TooSmall {
        /// The side asked for [mm].
        side: f64,
        /// The longest side of the cloud [mm].
        extent: f64,
        /// The least side that works [mm].
        least: f64,
    },
}

/// Cubic cells, numbered: a corner of theirs lies at the origin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cells {
    /// Where eight cells meet.
    pub origin: Point3,
    /// How long their sides are [mm].
    pub side: f64,
}

/// Half the cells along an axis.
const HALF: f64 = (1_u32 << (BITS - 1)) as f64;

impl Cells {
    /// Cells of the side `side` for points that are no farther than `extent` from `origin` along any axis.
    pub fn new(origin: Point3, side: f64, extent: f64) -> Result<Self, VoxelError> {
        if !(side > 0.0 && side.is_finite()) {
            return Err(VoxelError::Side { side });
        }
        let most = HALF - 1.0;
        if extent > side * most {
            return Err(VoxelError::TooSmall { side, extent, least: extent / most });
        }
        Ok(Self { origin, side })
    }

    /// The number of the cell the point is in: ordered by x, then y, then z.
    pub fn key(&self, point: &Point3) -> u64 {
        let cell = (point - self.origin) / self.side;
        cell.iter().fold(0_u64, |key, x| (key << BITS) | (x.floor() + HALF) as u64)
    }

    /// Where a cell is, counted from the origin along each axis: 0 begins there, -1 ends there.
    pub fn along(key: u64) -> [i32; 3] {
        let bits = |k: u32| (key >> (BITS * k)) as i32 & ((1 << BITS) - 1);
        [2, 1, 0].map(|k| bits(k) - HALF as i32)
    }

    /// The middle of a cell.
    pub fn middle(&self, key: u64) -> Point3 {
        self.origin + Vector3::from(Self::along(key).map(|x| f64::from(x) + 0.5)) * self.side
    }
}

/// The mean point of every cubic cell of the side `side` that has points; in the order of the cells.
///
/// A corner of the grid lies at the centroid of the cloud, so that neither its unit nor its distance
/// from the origin changes which points share a cell. Normals and colours are means too. The points
/// must be finite.
pub fn voxel_grid(cloud: &PointCloud, side: f64) -> Result<PointCloud, VoxelError> {
    let cells = Cells::new(centroid(&cloud.points), side, cloud.aabb().size().max())?;
    let points = cloud.points.par_iter().enumerate();
    let mut keyed: Vec<(u64, u32)> = points.map(|(i, p)| (cells.key(p), i as u32)).collect();
    keyed.par_sort_unstable();
    let runs: Vec<&[(u64, u32)]> = keyed.chunk_by(|a, b| a.0 == b.0).collect();
    let normals = cloud.normals.as_ref();
    let colors = cloud.colors.as_ref();
    Ok(PointCloud {
        points: runs.par_iter().map(|run| mean_point(&cloud.points, run)).collect(),
        normals: normals.map(|normals| runs.par_iter().map(|r| mean_normal(normals, r)).collect()),
        colors: colors.map(|colors| runs.par_iter().map(|run| mean_color(colors, run)).collect()),
    })
}

/// The mean of `points`, summed up in an order that no number of threads changes; the origin if
/// there are none.
pub(crate) fn centroid(points: &[Point3]) -> Point3 {
    let Some(first) = points.first() else { return Point3::origin() };
    // About the first point: far from the origin coordinates are long and differences short.
    let sum = |chunk: &[Point3]| chunk.iter().map(|point| point - first).sum::<Vector3>();
    let sums: Vec<Vector3> = points.par_chunks(CHUNK).map(sum).collect();
    first + sums.iter().sum::<Vector3>() / points.len() as f64
}

fn mean_point(points: &[Point3], run: &[(u64, u32)]) -> Point3 {
    let first = points[run[0].1 as usize];
    let sum: Vector3 = run.iter().map(|&(_, i)| points[i as usize] - first).sum();
    first + sum / run.len() as f64
}

fn mean_normal(normals: &[Vector3], run: &[(u64, u32)]) -> Vector3 {
    let sum: Vector3 = run.iter().map(|&(_, i)| normals[i as usize]).sum();
    sum.try_normalize(1e-9).unwrap_or(normals[run[0].1 as usize])
}

fn mean_color(colors: &[[u8; 3]], run: &[(u64, u32)]) -> [u8; 3] {
    [0, 1, 2].map(|k| {
        let sum: u64 = run.iter().map(|&(_, i)| u64::from(colors[i as usize][k])).sum();
        let n = run.len() as u64;
        ((sum + n / 2) / n) as u8
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cloud(n: u32) -> PointCloud {
        let at = |i: u32| {
            let t = f64::from(i);
            Point3::new((t * 0.618).fract() * 9.0, (t * 0.755).fract() * 7.0, (t * 0.57).fract())
        };
        let colors = (0..n).map(|i| [i as u8, 7, 255]).collect();
        PointCloud { points: (0..n).map(at).collect(), normals: None, colors: Some(colors) }
    }

    #[test]
    fn a_cell_becomes_the_mean_of_its_points() {
        let points = [[0.0; 3], [0.2, 0.2, 0.2], [10.0; 3], [10.4, 10.4, 10.4]].map(Point3::from);
        let colors = vec![[0; 3], [3; 3], [9; 3], [9; 3]];
        let normals = vec![Vector3::x(), Vector3::y(), Vector3::z(), Vector3::z()];
        let cloud =
            PointCloud { points: points.to_vec(), normals: Some(normals), colors: Some(colors) };
        let few = voxel_grid(&cloud, 6.0).unwrap();
        assert!((few.points[0] - Point3::new(0.1, 0.1, 0.1)).norm() < 1e-12);
        assert!((few.points[1] - Point3::new(10.2, 10.2, 10.2)).norm() < 1e-12);
        assert_eq!(few.colors, Some(vec![[2; 3], [9; 3]]));
        let diagonal = Vector3::new(1.0, 1.0, 0.0).normalize();
        assert!((few.normals.unwrap()[0] - diagonal).norm() < 1e-12);
    }

    #[test]
    fn the_middle_of_a_cell_is_in_it_half_a_side_from_its_faces() {
        let cells = Cells::new(Point3::new(1.0, -2.0, 0.5), 0.25, 100.0).unwrap();
        for point in [[1.0, -2.0, 0.5], [-50.1, 60.0, 99.9], [0.99, -2.01, 0.49]].map(Point3::from)
        {
            let middle = cells.middle(cells.key(&point));
            assert_eq!(cells.key(&middle), cells.key(&point));
            assert!((middle - point).amax() <= 0.125 + 1e-12);
        }
    }

    #[test]
    fn neither_unit_nor_origin_changes_which_points_share_a_cell() {
        let here = cloud(5000);
        let few = voxel_grid(&here, 0.5).unwrap();
        let metres =
            PointCloud { points: here.points.iter().map(|p| p / 1000.0).collect(), ..here.clone() };
        let away = Vector3::new(1e6, -1e6, 3e5);
        let shifted = PointCloud { points: here.points.iter().map(|p| p + away).collect(), ..here };
        let in_metres = voxel_grid(&metres, 0.0005).unwrap();
        let far_off = voxel_grid(&shifted, 0.5).unwrap();
        assert_eq!([in_metres.points.len(), far_off.points.len()], [few.points.len(); 2]);
        for ((a, b), c) in few.points.iter().zip(&in_metres.points).zip(&far_off.points) {
            assert!((a - b * 1000.0).norm() < 1e-9 && (a + away - c).norm() < 1e-8);
        }
    }

    #[test]
    fn a_voxel_without_size_or_far_too_small_is_refused() {
        for side in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(voxel_grid(&cloud(9), side), Err(VoxelError::Side { .. })), "{side}");
        }
        let error = voxel_grid(&cloud(9), 1e-9).unwrap_err().to_string();
        assert!(error.contains("too small for a cloud of"), "{error}");
        assert!(voxel_grid(&PointCloud::default(), 1.0).unwrap().points.is_empty());
    }
}
