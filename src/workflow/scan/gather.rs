//! Clouds of many frames as one, with a mean point for each voxel.

use super::ScanOptions;
use crate::geom::{Point3, PointCloud, Vector3, VoxelError};
use std::collections::HashMap;

/// More cells are a mistake, not a scan: some gigabytes.
const MOST: usize = 1 << 25;

/// What was gathered so far.
#[derive(Debug)]
pub(super) struct Gathered {
    voxel: f64,
    cells: HashMap<[i32; 3], Cell>,
}

/// Sums of what came to lie in a cell.
#[derive(Debug, Clone, Copy, Default)]
struct Cell {
    n: u32,
    /// From the cell's corner [mm].
    place: Vector3,
    normal: Vector3,
    color: [u32; 3],
    n_colored: u32,
}

impl Gathered {
    pub(super) fn new(voxel: f64) -> Result<Self, VoxelError> {
        Ok(Self { voxel: ScanOptions::side(voxel)?, cells: HashMap::new() })
    }

    /// The side of a cell [mm].
    pub(super) fn voxel(&self) -> f64 {
        self.voxel
    }

    /// Adds the points of `cloud`; an error if there are too many cells, or too far out to be numbered.
    pub(super) fn add(&mut self, cloud: &PointCloud) -> Result<(), VoxelError> {
        let extent = cloud.points.iter().map(|point| point.coords.amax()).fold(0.0, f64::max);
        let most = f64::from(i32::MAX - 1);
        // A comparison that NaN fails.
        let is_near = extent < most * self.voxel;
        if !is_near || self.cells.len() > MOST {
            let least = if is_near { 2.0 * self.voxel } else { extent / most };
            return Err(VoxelError::TooSmall { side: self.voxel, extent, least });
        }
        for (i, point) in cloud.points.iter().enumerate() {
            let corner = (point.coords / self.voxel).map(f64::floor);
            let cell = self.cells.entry(corner.map(|c| c as i32).into()).or_default();
            cell.n += 1;
            cell.place += point.coords - corner * self.voxel;
            if let Some(normals) = &cloud.normals {
                cell.normal += normals[i];
            }
            if let Some(colors) = &cloud.colors {
                cell.n_colored += 1;
                (0..3).for_each(|k| cell.color[k] += u32::from(colors[i][k]));
            }
        }
        Ok(())
    }

    /// The mean of every cell, in the order of the cells. Cells whose normals cancel are left out: both
    /// sides of something thinner than a voxel.
    pub(super) fn cloud(&self) -> PointCloud {
        let mut keys: Vec<&[i32; 3]> = self.cells.keys().collect();
        keys.sort_unstable();
        let has_colors = self.cells.values().any(|cell| cell.n_colored > 0);
        let mut cloud = PointCloud {
            points: Vec::with_capacity(keys.len()),
            normals: Some(Vec::with_capacity(keys.len())),
            colors: has_colors.then(|| Vec::with_capacity(keys.len())),
        };
        for key in keys {
            let cell = &self.cells[key];
            let Some(normal) = cell.normal.try_normalize(1e-9) else { continue };
            let corner = Vector3::from(key.map(f64::from)) * self.voxel;
            cloud.points.push(Point3::from(corner + cell.place / f64::from(cell.n)));
            cloud.normals.iter_mut().for_each(|normals| normals.push(normal));
            let mean = cell.color.map(|sum| (sum / cell.n_colored.max(1)) as u8);
            cloud.colors.iter_mut().for_each(|colors| colors.push(mean));
        }
        cloud
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cloud(x: f64, color: u8) -> PointCloud {
        PointCloud {
            points: vec![Point3::new(x, 1.0, 1.0)],
            normals: Some(vec![Vector3::z()]),
            colors: Some(vec![[color; 3]]),
        }
    }

    #[test]
    fn points_of_one_cell_become_their_mean() {
        let mut gathered = Gathered::new(10.0).unwrap();
        for (x, color) in [(-1.0, 10), (2.0, 100), (4.0, 200)] {
            gathered.add(&cloud(x, color)).unwrap();
        }
        let all = gathered.cloud();
        assert_eq!(all.points, [Point3::new(-1.0, 1.0, 1.0), Point3::new(3.0, 1.0, 1.0)]);
        assert_eq!(all.colors.unwrap(), [[10; 3], [150; 3]]);
        assert_eq!(all.normals.unwrap(), [Vector3::z(); 2]);
    }

    #[test]
    fn cells_that_cannot_be_numbered_are_refused() {
        assert!(Gathered::new(0.0).is_err() && Gathered::new(f64::NAN).is_err());
        let mut gathered = Gathered::new(1e-9).unwrap();
        let error = gathered.add(&cloud(1e6, 1)).unwrap_err();
        assert!(matches!(error, VoxelError::TooSmall { .. }), "{error}");
    }
}
