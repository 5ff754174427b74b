//! The model as a camera would see it.

use super::Volume;
use super::tiles::Tiles;
use super::volume::Look;
use crate::geom::{Pose, Vector3};
use crate::rgbd::{Camera, Image};
use std::ops::Range;

/// A point of the model and its normal, in the camera's frame; six words and no reading if z is 0.
#[repr(C)]
#[derive(Debug, Clone, Copy, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Seen {
    /// Where it is [mm].
    pub point: [f32; 3],
    /// Unit normal, towards the camera's side of the surface.
    pub normal: [f32; 3],
}

/// The model as a camera would see it.
#[derive(Debug, Clone, PartialEq)]
pub struct ModelView {
    /// The camera, without distortion.
    pub camera: Camera,
    /// From where.
    pub world_from_camera: Pose,
    /// What each pixel sees.
    pub pixels: Image<Seen>,
}

/// Through what is not known a ray goes in steps of this share of the truncation: it cannot leap over
/// the layer that is known.
const BLIND: f64 = 0.5;
/// Before the surface a ray goes this share of the distance to it.
const CAREFUL: f64 = 0.8;

impl Volume {
    /// The model as `camera` (its distortion undone) would see it from `world_from_camera`.
    pub fn cast(&self, camera: &Camera, world_from_camera: &Pose) -> ModelView {
        let camera = camera.without_distortion();
        let tiles = Tiles::new(&self.lattice, &camera, world_from_camera);
        let caster = Caster::new(self, world_from_camera);
        let none = Seen::default();
        let pixels = Image::from_rows(camera.width, camera.height, none, |y, row| {
            let mut look = self.look();
            for (x, seen) in row.iter_mut().enumerate() {
                let range = tiles.range([x, y]);
                let [ray_x, ray_y] = camera.ray([x as f64, y as f64]);
                let ray = Vector3::new(ray_x, ray_y, 1.0);
                *seen = caster.cast(&mut look, &ray, range).unwrap_or(none);
            }
        });
        ModelView { camera, world_from_camera: *world_from_camera, pixels }
    }
}

struct Caster<'a> {
    world_from_camera: &'a Pose,
    voxel: f64,
    truncation: f64,
}

impl<'a> Caster<'a> {
    fn new(volume: &Volume, world_from_camera: &'a Pose) -> Self {
        let options = volume.options();
        Self { world_from_camera, voxel: options.voxel, truncation: options.truncation() }
    }

    /// Where the ray first comes from before the surface to behind it.
    fn cast(&self, look: &mut Look, ray: &Vector3, range: &Range<f64>) -> Option<Seen> {
        let eye = self.world_from_camera.translation.vector / self.voxel;
        let way = self.world_from_camera.rotation * ray / self.voxel;
        let at = |z: f64| <[f64; 3]>::from(eye + way * z);
        // One millimetre along the ray, in z.
        let unit = 1.0 / ray.norm();
        let mut before: Option<f64> = None;
        let mut z = range.start;
        while z < range.end {
            match look.nearest(at(z)) {
                None => {
                    before = None;
                    z += BLIND * self.truncation * unit;
                }
                Some(distance) if distance > 0.0 => {
                    before = Some(z);
                    let free = CAREFUL * f64::from(distance) * self.truncation;
                    z += free.max(self.voxel) * unit;
                }
                Some(_) => {
                    let found = before.and_then(|before| {
                        let z = crossing(look, &at, [before, z], 0.5 * self.voxel * unit)?;
                        Some((z, self.normal(look, at(z))?))
                    });
                    if let Some((z, normal)) = found {
                        let point = ray * z;
                        let point = [point.x as f32, point.y as f32, point.z as f32];
                        return Some(Seen { point, normal });
                    }
                    before = None;
                    z += self.voxel * unit;
                }
            }
        }
        None
    }

    /// The direction in which the distance grows, in the camera's frame.
    fn normal(&self, look: &mut Look, at: [f64; 3]) -> Option<[f32; 3]> {
        let mut gradient = Vector3::zeros();
        for k in 0..3 {
            let mut beside = |step: f64| {
                let mut at = at;
                at[k] += step;
                look.between(at)
            };
            gradient[k] = f64::from(beside(1.0)?) - f64::from(beside(-1.0)?);
        }
        let normal = self.world_from_camera.rotation.inverse() * gradient.try_normalize(1e-9)?;
        Some([normal.x as f32, normal.y as f32, normal.z as f32])
    }
}

/// Where the distance is 0 between two places, of which the nearest points of the lattice have
/// different signs; a little around them if need be.
fn crossing(
    look: &mut Look,
    at: &impl Fn(f64) -> [f64; 3],
    [before, behind]: [f64; 2],
    little: f64,
) -> Option<f64> {
    let mut distance = |z: f64| look.between(at(z)).map(f64::from);
    let (mut near, mut far) = (before, behind);
    let (mut d_near, mut d_far) = (distance(near)?, distance(far)?);
    if d_near < 0.0 {
        near -= little;
        d_near = distance(near)?;
    }
    if d_far > 0.0 {
        far += little;
        d_far = distance(far)?;
    }
    if d_near < 0.0 || d_far > 0.0 || d_near == d_far {
        return None;
    }
    // The field is bent at cells' borders: a second straight line finds what the first left.
    for _ in 0..2 {
        let z = near + (far - near) * d_near / (d_near - d_far);
        let d = distance(z)?;
        if d > 0.0 {
            (near, d_near) = (z, d);
        } else {
            (far, d_far) = (z, d);
        }
        if d_near == d_far {
            return Some(z);
        }
    }
    Some(near + (far - near) * d_near / (d_near - d_far))
}
