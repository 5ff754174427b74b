//! A frame fused with the model: running means at every lattice point it sees.
//!
//! Curless and Levoy (1996), Newcombe et al. (2011). They keep distances along the line of sight, which
//! surfaces seen aslant stretch; here a distance is that from the tangent plane of the reading, and a
//! reading counts for the square of the cosine it was taken under. Both make what many views say agree.
//! More than a voxel behind the surface it counts the less the deeper (Bylow et al., 2013): nobody has
//! looked there, and where the part is thin it is before the surface of the other side.

use super::block::{Block, Key, SIDE, index_of};
use super::{Reading, Readings, TsdfError, TsdfOptions, Volume};
use crate::geom::{Point3, Pose};
use crate::rgbd::Image;
use rayon::prelude::*;

/// What fusing a frame took.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Integrated {
    /// Blocks it had something to say about.
    pub n_touched: usize,
    /// Those that did not exist before.
    pub n_new: usize,
}

/// Beyond this sum of weights the model stays open to change.
pub(super) const MOST_WEIGHT: f32 = 1e4;
/// A colour is the mean of that many readings at least.
pub(super) const MOST_COLORS: u16 = 255;

impl Volume {
    /// Fuses what `readings` say, taken from `world_from_camera`. An error leaves the model as it was.
    pub fn integrate(
        &mut self,
        readings: &Readings,
        world_from_camera: &Pose,
    ) -> Result<Integrated, TsdfError> {
        let keys = self.lattice.touched(readings, world_from_camera)?;
        let n_new = self.make(&keys)?;
        let mut is_touched = vec![false; self.n_blocks()];
        for i in keys.iter().filter_map(|key| self.lattice.find(key)) {
            is_touched[i] = true;
        }
        let view = View::new(readings, world_from_camera, self.options());
        let blocks = self.lattice.keys.par_iter().zip(&mut self.blocks).zip(is_touched);
        blocks.filter(|(_, is_touched)| *is_touched).for_each(|((key, block), _)| {
            view.fuse(key, block);
        });
        Ok(Integrated { n_touched: keys.len(), n_new })
    }
}

/// A frame and the lattice as its camera sees it.
pub(super) struct View<'a> {
    pub(super) pixels: &'a Image<Reading>,
    camera_from_world: Pose,
    voxel: f64,
    pub(super) truncation: f32,
    /// Up to here behind the surface a reading counts in full; 1 is the truncation.
    pub(super) sure: f32,
    /// One step along x, y and z of the lattice, in the camera.
    pub(super) steps: [[f32; 3]; 3],
    pub(super) focal: [f32; 2],
    /// Of the picture, and half a pixel: whole numbers then begin where a pixel does.
    pub(super) center: [f32; 2],
}

impl<'a> View<'a> {
    pub(super) fn new(
        readings: &'a Readings,
        world_from_camera: &Pose,
        options: &TsdfOptions,
    ) -> Self {
        let voxel = options.voxel;
        let camera_from_world = world_from_camera.inverse();
        let turn = camera_from_world.rotation.to_rotation_matrix();
        let camera = &readings.camera;
        Self {
            pixels: &readings.pixels,
            camera_from_world,
            voxel,
            truncation: options.truncation() as f32,
            sure: (voxel / options.truncation()) as f32,
            steps: [0, 1, 2].map(|axis| [0, 1, 2].map(|k| (turn[(k, axis)] * voxel) as f32)),
            focal: [camera.fx as f32, camera.fy as f32],
            center: [(camera.cx + 0.5) as f32, (camera.cy + 0.5) as f32],
        }
    }

    /// The first point of a block, in the camera. In `f64` as far as here, so that nothing is lost far
    /// from the origin.
    pub(super) fn first_point(&self, key: &Key) -> [f32; 3] {
        let first = key.map(|c| f64::from(c) * SIDE as f64 * self.voxel);
        let first = self.camera_from_world * Point3::from(first);
        [first.x as f32, first.y as f32, first.z as f32]
    }

    fn fuse(&self, key: &Key, block: &mut Block) {
        let first = self.first_point(key);
        let [along_x, along_y, along_z] = self.steps;
        for z in 0..SIDE {
            for y in 0..SIDE {
                let row: [f32; 3] =
                    [0, 1, 2].map(|k| first[k] + y as f32 * along_y[k] + z as f32 * along_z[k]);
                // Eight points side by side.
                let lane = |k: usize| -> [f32; SIDE] {
                    std::array::from_fn(|x| row[k] + x as f32 * along_x[k])
                };
                let (px, py, pz) = (lane(0), lane(1), lane(2));
                let u: [f32; SIDE] =
                    std::array::from_fn(|x| self.focal[0] * px[x] / pz[x] + self.center[0]);
                let v: [f32; SIDE] =
                    std::array::from_fn(|x| self.focal[1] * py[x] / pz[x] + self.center[1]);
                for x in 0..SIDE {
                    // Comparisons that NaN fails; what is cut off is below 1 and not below 0.
                    if pz[x] > 0.0
                        && u[x] >= 0.0
                        && v[x] >= 0.0
                        && let Some(reading) = self.pixels.get(u[x] as usize, v[x] as usize)
                    {
                        self.tell(reading, pz[x], block, index_of([x, y, z]));
                    }
                }
            }
        }
    }

    /// Adds one reading to the means of one point at `depth`.
    fn tell(&self, reading: &Reading, depth: f32, block: &mut Block, i: usize) {
        let before = reading.depth - depth;
        if reading.weight == 0.0 || before < -self.truncation {
            return;
        }
        let distance = (before * reading.facing / self.truncation).min(1.0);
        let weight = reading.weight * ((1.0 + distance) / (1.0 - self.sure)).clamp(0.0, 1.0);
        if weight <= 0.0 {
            return;
        }
        let sum = block.weight[i] + weight;
        block.distance[i] += (distance - block.distance[i]) * (weight / sum);
        block.weight[i] = sum.min(MOST_WEIGHT);
        let [.., has_color] = reading.color;
        if has_color == 1 && distance < 1.0 {
            let [.., n] = &mut block.color[i];
            *n = (*n + 1).min(MOST_COLORS);
            let n = i32::from(*n);
            for (mean, told) in block.color[i].iter_mut().zip(&reading.color[..3]) {
                let told = i32::from(*told) << 8;
                *mean = (i32::from(*mean) + (told - i32::from(*mean)) / n) as u16;
            }
        }
    }
}
