//! Where on the rays of a picture there are blocks, tile by tile.

use super::block::SIDE;
use super::lattice::Lattice;
use crate::geom::{Point3, Pose};
use crate::rgbd::Camera;
use std::ops::Range;

/// Pixels along the side of a tile, whose rays begin and end together.
pub(super) const TILE: usize = 16;
/// No surface is looked for nearer than this [mm].
const NEAREST: f64 = 1.0;

/// From where to where there are blocks on the rays of each tile; in z.
pub(super) struct Tiles {
    pub(super) ranges: Vec<Range<f64>>,
    pub(super) n_columns: usize,
}

impl Tiles {
    pub(super) fn new(lattice: &Lattice, camera: &Camera, world_from_camera: &Pose) -> Self {
        let [n_columns, n_rows] = [camera.width, camera.height].map(|n| n.div_ceil(TILE));
        let mut tiles = Self { ranges: vec![f64::INFINITY..0.0; n_columns * n_rows], n_columns };
        let camera_from_world = world_from_camera.inverse();
        let voxel = lattice.options.voxel;
        let side = SIDE as f64 * voxel;
        // Of the ball around a block's points, and half a voxel.
        let radius = 0.5 * 3.0_f64.sqrt() * side;
        // Frames see no farther.
        let farthest = lattice.options.max_depth + lattice.options.truncation();
        for key in &lattice.keys {
            let middle = key.map(|c| (f64::from(c) + 0.5) * side - 0.5 * voxel);
            let middle = camera_from_world * Point3::from(middle);
            let (near, far) = (middle.z - radius, middle.z + radius);
            if far < NEAREST || near > farthest {
                continue;
            }
            let depths = near.max(NEAREST)..far;
            let across = |c: f64| c - radius..c + radius;
            let columns = span(&across(middle.x), &depths, [camera.fx, camera.cx], camera.width);
            let rows = span(&across(middle.y), &depths, [camera.fy, camera.cy], camera.height);
            tiles.widen(columns, rows, depths.start..far.min(farthest));
        }
        tiles
    }

    /// That of a pixel.
    pub(super) fn range(&self, [x, y]: [usize; 2]) -> &Range<f64> {
        &self.ranges[y / TILE * self.n_columns + x / TILE]
    }

    fn widen(&mut self, columns: Range<usize>, rows: Range<usize>, depths: Range<f64>) {
        for row in rows {
            for tile in &mut self.ranges[row * self.n_columns..][columns.clone()] {
                *tile = tile.start.min(depths.start)..tile.end.max(depths.end);
            }
        }
    }
}

/// The tiles along one axis of the picture that show anything of what reaches `across` at `depths`.
fn span(
    across: &Range<f64>,
    depths: &Range<f64>,
    [focal, center]: [f64; 2],
    n_pixels: usize,
) -> Range<usize> {
    let at = |c: f64, is_outward: bool| {
        focal * c / if is_outward { depths.start } else { depths.end } + center
    };
    let low = at(across.start, across.start < 0.0);
    let high = at(across.end, across.end > 0.0);
    if high < -0.5 || low > n_pixels as f64 {
        return 0..0;
    }
    // Both ends saturate.
    let tile = |c: f64| (c.max(0.0) as usize).min(n_pixels - 1) / TILE;
    tile(low)..tile(high.ceil()) + 1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::register::tsdf::TsdfOptions;

    #[test]
    fn rays_begin_before_the_block_they_meet_and_end_behind_it() {
        let options = TsdfOptions { voxel: 10.0, ..TsdfOptions::default() };
        let mut lattice = Lattice::new(&options).unwrap();
        // Points from 960 to 1030 mm before the camera, 0 to 70 mm to its right and below.
        lattice.make(&[[0, 0, 12]]).unwrap();
        let camera = Camera::pinhole([320, 240], [300.0, 300.0], [160.0, 120.0]);
        let tiles = Tiles::new(&lattice, &camera, &Pose::identity());
        for pixel in [[160, 120], [175, 135], [180, 140]] {
            let range = tiles.range(pixel);
            assert!(range.start < 960.0 && range.end > 1030.0, "{range:?}");
            assert!(range.start > 900.0 && range.end < 1100.0, "{range:?}");
        }
        for pixel in [[40, 120], [160, 20], [319, 239]] {
            assert!(tiles.range(pixel).is_empty());
        }
        let behind = Pose::translation(0.0, 0.0, 2000.0);
        let tiles = Tiles::new(&lattice, &camera, &behind);
        assert!(tiles.ranges.iter().all(Range::is_empty));
    }
}
