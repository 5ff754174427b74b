//! Normals of an organised cloud, from the four neighbours of each point.

use super::{Image, OrganisedCloud};
use crate::geom::{Point3, Vector3};

/// How [`OrganisedCloud::with_normals`] looks around a point.
#[derive(Debug, Clone, PartialEq, clap::Args, serde::Serialize, serde::Deserialize)]
#[serde(default, rename_all = "kebab-case", deny_unknown_fields)]
pub struct NormalOptions {
    /// Pixels from a point to the neighbours its normal is taken from.
    #[arg(long, value_name = "PX", default_value_t = Self::default().normal_reach)]
    pub normal_reach: usize,
    /// A neighbour whose distance from the camera differs by more than this share of it, for each pixel
    /// it is away, is another surface.
    #[arg(long, value_name = "SHARE", default_value_t = Self::default().normal_edge)]
    pub normal_edge: f64,
}

impl Default for NormalOptions {
    fn default() -> Self {
        Self { normal_reach: 2, normal_edge: 0.02 }
    }
}

impl OrganisedCloud {
    /// The cloud with normals, all looking at `eye`: the camera, in the frame of the cloud.
    ///
    /// A normal is the sum of the cross products of neighbours side by side (right and below, below and
    /// left, ...), each as long as the area between them. Neighbours over an edge are left out; where no
    /// two are left the normal is NaN.
    #[must_use]
    pub fn with_normals(self, eye: &Point3, options: &NormalOptions) -> Self {
        let points = &self.points;
        let nowhere = Vector3::repeat(f64::NAN);
        let normals = Image::from_rows(points.width(), points.height(), nowhere, |y, row| {
            for (x, normal) in row.iter_mut().enumerate() {
                if let Some(found) = self.normal_from_neighbours([x, y], eye, options) {
                    *normal = found;
                }
            }
        });
        Self { normals: Some(normals), ..self }
    }

    fn normal_from_neighbours(
        &self,
        [x, y]: [usize; 2],
        eye: &Point3,
        options: &NormalOptions,
    ) -> Option<Vector3> {
        let point = self.point(x, y)?;
        let seen = point - eye;
        let distance = seen.norm();
        let reach = options.normal_reach.max(1);
        let jump = options.normal_edge * distance * reach as f64;
        let side = |x: Option<usize>, y: Option<usize>| {
            let other = self.point(x?, y?)?;
            let same_surface = ((other - eye).norm() - distance).abs() <= jump;
            same_surface.then(|| other - point)
        };
        let sides = [
            side(x.checked_add(reach), Some(y)),
            side(Some(x), y.checked_add(reach)),
            side(x.checked_sub(reach), Some(y)),
            side(Some(x), y.checked_sub(reach)),
        ];
        let pairs = (0..4).filter_map(|i| Some(sides[i]?.cross(&sides[(i + 1) % 4]?)));
        let normal = pairs.sum::<Vector3>().try_normalize(1e-12)?;
        Some(if normal.dot(&seen) > 0.0 { -normal } else { normal })
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Camera, RgbdFrame};
    use super::*;

    fn cloud_of(camera: &Camera, depth: impl Fn([f64; 2]) -> f64 + Sync) -> OrganisedCloud {
        let depth = Image::from_rows(camera.width, camera.height, 0.0, |y, row| {
            for (x, pixel) in row.iter_mut().enumerate() {
                *pixel = depth(camera.ray([x as f64, y as f64])) as f32;
            }
        });
        let frame = RgbdFrame { stamp: 0.0, color: None, depth, confidence: None };
        let cloud = frame.cloud(camera).unwrap();
        cloud.with_normals(&Point3::origin(), &NormalOptions::default())
    }

    fn camera() -> Camera {
        Camera::pinhole([80, 60], [70.0, 70.0], [39.5, 29.5])
    }

    #[test]
    fn normals_of_a_sphere_point_from_its_center() {
        let camera = Camera::pinhole([240, 180], [210.0, 210.0], [119.5, 89.5]);
        let (center, radius) = (Point3::new(20.0, -10.0, 1000.0), 300.0);
        let cloud = cloud_of(&camera, |[x, y]| {
            let ray = Vector3::new(x, y, 1.0);
            let b = ray.dot(&center.coords) / ray.norm_squared();
            let c = (center.coords.norm_squared() - radius * radius) / ray.norm_squared();
            let root = b * b - c;
            if root > 0.0 { b - root.sqrt() } else { 0.0 }
        });
        let mut n_normals = 0;
        for y in 0..camera.height {
            for x in 0..camera.width {
                let (Some(point), Some(normal)) = (cloud.point(x, y), cloud.normal(x, y)) else {
                    continue;
                };
                let radial = (point - center) / radius;
                // Near the rim neighbours lie beyond what is taken for an edge.
                if radial.dot(&point.coords.normalize()) < -0.5 {
                    n_normals += 1;
                    assert!(normal.angle(&radial) < 0.02, "{x} {y}: {}", normal.angle(&radial));
                }
            }
        }
        assert!(n_normals > 5000, "{n_normals}");
    }

    #[test]
    fn a_normal_keeps_to_its_side_of_an_edge() {
        // A step from 1000 to 1500 in the middle: both sides look straight at the camera.
        let cloud = cloud_of(&camera(), |[x, _]| if x < 0.0 { 1000.0 } else { 1500.0 });
        for x in 0..80 {
            let normal = cloud.normal(x, 30).unwrap();
            assert!((normal + Vector3::z()).norm() < 1e-6, "{x}: {normal}");
        }
    }

    #[test]
    fn a_lone_reading_has_no_normal() {
        let cloud = cloud_of(&camera(), |[x, y]| if x.hypot(y) < 0.012 { 1000.0 } else { 0.0 });
        assert!(cloud.n_points() > 0);
        assert_eq!((0..80).filter(|&x| cloud.normal(x, 29).is_some()).count(), 0);
    }
}
