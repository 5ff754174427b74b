//! A frame as tracking wants it: points and normals, from coarse to fine.

use super::{Seen, TrackOptions};
use crate::rgbd::filter::bilateral;
use crate::rgbd::{Camera, Image, halved_depth};

/// One picture of points and normals; pixels without a normal have z 0.
pub(super) struct FrameLevel {
    pub(super) camera: Camera,
    pub(super) pixels: Image<Seen>,
    /// Pixels that have a normal.
    pub(super) n_pixels: usize,
}

/// A neighbour whose depth differs by more is another surface [share of depth].
const EDGE: f32 = 0.04;
/// Pictures with a shorter side than this are too small to track [px].
const SMALLEST: usize = 24;

/// The pictures of `depth`, the finest first: half the size of the frame, whose noise it averages, or
/// the frame itself if that is small.
pub(super) fn levels(
    depth: &Image<f32>,
    camera: &Camera,
    options: &TrackOptions,
) -> Vec<FrameLevel> {
    let mut depth = bilateral(depth, &options.smooth);
    let mut camera = *camera;
    let mut levels: Vec<FrameLevel> = Vec::new();
    for _ in 0..options.levels {
        if camera.width.min(camera.height) >= 2 * SMALLEST {
            depth = halved_depth(&depth);
            camera = camera.halved();
        } else if !levels.is_empty() {
            break;
        }
        levels.push(FrameLevel::new(&depth, &camera));
    }
    levels
}

impl FrameLevel {
    fn new(depth: &Image<f32>, camera: &Camera) -> Self {
        let none = Seen::default();
        let pixels = Image::from_rows(camera.width, camera.height, none, |y, row| {
            for (x, seen) in row.iter_mut().enumerate() {
                *seen = seen_at(depth, camera, [x, y]).unwrap_or(none);
            }
        });
        let n_pixels = pixels.pixels().iter().filter(|seen| seen.point[2] > 0.0).count();
        Self { camera: *camera, pixels, n_pixels }
    }
}

/// Point and normal at a pixel whose four neighbours lie on the same surface.
fn seen_at(depth: &Image<f32>, camera: &Camera, [x, y]: [usize; 2]) -> Option<Seen> {
    let z = *depth.get(x, y)?;
    let beside =
        |x: usize, y: usize| depth.get(x, y).copied().filter(|other| (other - z).abs() <= EDGE * z);
    if z <= 0.0 {
        return None;
    }
    let (left, right) = (beside(x.checked_sub(1)?, y)?, beside(x + 1, y)?);
    let (above, below) = (beside(x, y.checked_sub(1)?)?, beside(x, y + 1)?);
    // 1/z is `a x + b y + c` on a plane, and its normal is along (a, b, c).
    let [ray_x, ray_y] = camera.ray([x as f64, y as f64]).map(|c| c as f32);
    let a = (1.0 / right - 1.0 / left) * 0.5 * camera.fx as f32;
    let b = (1.0 / below - 1.0 / above) * 0.5 * camera.fy as f32;
    let c = 1.0 / z - a * ray_x - b * ray_y;
    // Towards the camera.
    let length = -(a * a + b * b + c * c).sqrt();
    Some(Seen { point: [ray_x * z, ray_y * z, z], normal: [a / length, b / length, c / length] })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slanting_plane_has_its_normal_at_every_level() {
        let camera = Camera::pinhole([160, 120], [140.0, 140.0], [79.5, 59.5]);
        let normal = [0.3_f64, -0.4, -0.75_f64.sqrt()];
        let depth = Image::from_rows(160, 120, 0.0, |y, row| {
            for (x, z) in row.iter_mut().enumerate() {
                let [a, b] = camera.ray([x as f64, y as f64]);
                *z = (normal[2] * 1000.0 / (normal[0] * a + normal[1] * b + normal[2])) as f32;
            }
        });
        let levels = levels(&depth, &camera, &TrackOptions::default());
        assert_eq!(levels.len(), 2, "30 x 40 is the smallest");
        for level in &levels {
            let (width, height) = (level.camera.width, level.camera.height);
            assert_eq!(level.n_pixels, (width - 2) * (height - 2));
            let seen = level.pixels[(width / 3, height / 4)];
            for (found, truth) in seen.normal.iter().zip(normal) {
                assert!((f64::from(*found) - truth).abs() < 0.01, "{seen:?}");
            }
        }
    }
}
