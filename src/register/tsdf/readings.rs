//! A frame as the model takes it in: how deep, how squarely seen, what it counts for.

use super::{TsdfOptions, TsdfWeight};
use crate::rgbd::{Camera, Image, RgbdError, RgbdFrame};

/// One pixel; four words, as kernels want them.
#[repr(C)]
#[derive(Debug, Clone, Copy, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Reading {
    /// z of what is seen [mm].
    pub depth: f32,
    /// The distance from the surface's tangent plane, for each unit of depth before it: 1 where it is
    /// seen squarely.
    pub facing: f32,
    /// What it counts for; 0 where there is no reading.
    pub weight: f32,
    /// Red, green, blue, and 1 if there is a colour.
    pub color: [u8; 4],
}

/// A frame as the model takes it in.
#[derive(Debug, Clone, PartialEq)]
pub struct Readings {
    /// What took it, its distortion undone.
    pub camera: Camera,
    /// Its pixels.
    pub pixels: Image<Reading>,
}

/// Pixels to the neighbours a slope is taken from: over fewer, noise passes for slope.
const REACH: usize = 3;
/// A neighbour whose depth differs by more is another surface [share of depth].
const EDGE: f32 = 0.05;
/// What is seen more aslant tells nothing: about 84 degrees.
const ASLANT: f32 = 0.1;

impl Readings {
    /// What `frame` says, seen by `camera`.
    pub fn new(
        frame: &RgbdFrame,
        camera: &Camera,
        options: &TsdfOptions,
    ) -> Result<Self, RgbdError> {
        frame.check(camera)?;
        let pinhole = camera.without_distortion();
        if camera.distortion.is_none() {
            return Ok(Self::of(&frame.depth, frame.color.as_ref(), pinhole, options));
        }
        let depth = rectified(&frame.depth, camera, 0.0);
        let color = frame.color.as_ref().map(|color| rectified(color, camera, [0; 3]));
        Ok(Self::of(&depth, color.as_ref(), pinhole, options))
    }

    /// Depth alone; 0 where nothing is fused.
    pub fn depth(&self) -> Image<f32> {
        self.pixels.map(|reading| reading.depth)
    }

    fn of(
        depth: &Image<f32>,
        color: Option<&Image<[u8; 3]>>,
        camera: Camera,
        options: &TsdfOptions,
    ) -> Self {
        let farthest = options.max_depth as f32;
        let focal = [camera.fx as f32, camera.fy as f32];
        let none = Reading::default();
        let pixels = Image::from_rows(camera.width, camera.height, none, |y, row| {
            let rows = [y.checked_sub(REACH), y.checked_add(REACH)]
                .map(|y| y.filter(|&y| y < camera.height).map(|y| depth.row(y)));
            let own = depth.row(y);
            let ray_y = (y as f64 - camera.cy) as f32 / focal[1];
            for (x, pixel) in row.iter_mut().enumerate() {
                let z = own[x];
                if !(z > 0.0 && z <= farthest) {
                    continue;
                }
                let across = [x.checked_sub(REACH).map(|x| own[x]), own.get(x + REACH).copied()];
                let down = rows.map(|row| row.map(|row| row[x]));
                let (Some(a), Some(b)) = (slope(z, across), slope(z, down)) else { continue };
                let ray_x = (x as f64 - camera.cx) as f32 / focal[0];
                let facing = facing([a * focal[0], b * focal[1]], [ray_x, ray_y], z);
                if facing < ASLANT {
                    continue;
                }
                let by_range = match options.weight {
                    TsdfWeight::Constant => 1.0,
                    TsdfWeight::InverseSquare => (1000.0 / z) * (1000.0 / z),
                };
                let color = color.map_or([0; 4], |color| {
                    let [red, green, blue] = color[(x, y)];
                    [red, green, blue, 1]
                });
                let weight = by_range * facing * facing;
                *pixel = Reading { depth: z, facing, weight, color };
            }
        });
        Self { camera, pixels }
    }
}

/// How 1/z changes from pixel to pixel, from the neighbours before and after on the same surface.
fn slope(z: f32, around: [Option<f32>; 2]) -> Option<f32> {
    let [before, after] =
        around.map(|other| other.filter(|other| *other > 0.0 && (other - z).abs() <= EDGE * z));
    let reach = REACH as f32;
    Some(match (before, after) {
        (Some(before), Some(after)) => (1.0 / after - 1.0 / before) / (2.0 * reach),
        (Some(before), None) => (1.0 / z - 1.0 / before) / reach,
        (None, Some(after)) => (1.0 / after - 1.0 / z) / reach,
        (None, None) => return None,
    })
}

/// On a plane 1/z is `a x + b y + c` for the ray (x, y, 1), and the plane's normal is along (a, b, c).
fn facing([a, b]: [f32; 2], [x, y]: [f32; 2], z: f32) -> f32 {
    let c = 1.0 / z - a * x - b * y;
    1.0 / (z * (a * a + b * b + c * c).sqrt())
}

/// The picture that the camera would have taken without its distortion.
fn rectified<T: Copy + Send + Sync>(image: &Image<T>, camera: &Camera, outside: T) -> Image<T> {
    let pinhole = camera.without_distortion();
    Image::from_rows(image.width(), image.height(), outside, |y, row| {
        for (x, pixel) in row.iter_mut().enumerate() {
            let place = camera.project(&pinhole.unproject([x as f64, y as f64], 1.0));
            let Some([u, v]) = place.filter(|place| camera.sees(*place)) else { continue };
            // Nothing is averaged: depths on both sides of an edge have no mean.
            let near = |c: f64| (c + 0.5).max(0.0) as usize;
            if let Some(found) = image.get(near(u), near(v)) {
                *pixel = *found;
            }
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::{Point3, Vector3};
    use crate::rgbd::Distortion;

    fn frame(camera: &Camera, depth: impl Fn([f64; 2]) -> f64 + Sync) -> RgbdFrame {
        let depth = Image::from_rows(camera.width, camera.height, 0.0, |y, row| {
            for (x, pixel) in row.iter_mut().enumerate() {
                *pixel = depth(camera.ray([x as f64, y as f64])) as f32;
            }
        });
        RgbdFrame { stamp: 0.0, color: None, depth, confidence: None }
    }

    #[test]
    fn facing_turns_depth_into_distance_from_a_slanting_plane() {
        let camera = Camera::pinhole([80, 60], [70.0, 70.0], [39.5, 29.5]);
        let normal = Vector3::new(0.3, -0.5, -1.0).normalize();
        let through = Point3::new(0.0, 0.0, 1000.0);
        let depth =
            |[x, y]: [f64; 2]| normal.dot(&through.coords) / normal.dot(&Vector3::new(x, y, 1.0));
        let readings =
            Readings::new(&frame(&camera, depth), &camera, &TsdfOptions::default()).unwrap();
        for (x, y) in [(40, 30), (5, 50), (0, 0), (79, 59)] {
            let reading = readings.pixels[(x, y)];
            let before = camera.unproject([x as f64, y as f64], f64::from(reading.depth) - 10.0);
            let distance = normal.dot(&(before - through));
            assert!((f64::from(reading.facing) * 10.0 - distance).abs() < 0.01, "{x} {y}");
        }
    }

    #[test]
    fn what_is_alone_or_too_far_counts_for_nothing() {
        let camera = Camera::pinhole([40, 30], [35.0, 35.0], [20.0, 15.0]);
        let options = TsdfOptions { max_depth: 1500.0, ..TsdfOptions::default() };
        let weights = |depth: &(dyn Fn([f64; 2]) -> f64 + Sync)| {
            let readings = Readings::new(&frame(&camera, depth), &camera, &options).unwrap();
            readings.pixels.map(|reading| reading.weight)
        };
        assert!(weights(&|_| 1600.0).pixels().iter().all(|w| *w == 0.0));
        let alone = weights(&|[x, y]| if x == 0.0 && y == 0.0 { 1000.0 } else { 0.0 });
        assert!(alone.pixels().iter().all(|w| *w == 0.0));
        let wall = weights(&|_| 500.0);
        assert!(wall.pixels().iter().all(|w| (w - 4.0).abs() < 1e-4), "1/z^2");
    }

    #[test]
    fn a_distorted_picture_is_seen_through_a_perfect_lens() {
        let bent = Distortion { k1: 0.2, k2: -0.1, ..Distortion::default() };
        let camera = Camera::pinhole([80, 60], [70.0, 70.0], [39.5, 29.5]);
        let camera = Camera { distortion: bent, ..camera };
        // Depth that tells the ray it belongs to.
        let depth = |[x, _]: [f64; 2]| 1000.0 + 100.0 * x;
        let readings =
            Readings::new(&frame(&camera, depth), &camera, &TsdfOptions::default()).unwrap();
        for x in [5, 30, 70] {
            let expected = depth(readings.camera.ray([f64::from(x), 25.0]));
            let found = f64::from(readings.pixels[(x as usize, 25)].depth);
            // Half a pixel of 100 / 70 mm.
            assert!((found - expected).abs() < 0.8, "{x}: {found} for {expected}");
        }
    }
}
