//! A frame with the camera that took it, also of clouds that do not name theirs.

use super::{Camera, Image, OrganisedCloud, RgbdFrame};

/// Points that it takes to tell the camera.
const LEAST_POINTS: usize = 500;
/// Points lie on the rays of their pixels up to this [px].
const OFF: f64 = 0.5;
/// No more than this share of the points lies farther off.
const STRAYS: f64 = 0.01;

/// A frame with the camera that took it.
#[derive(Debug, Clone, PartialEq)]
pub struct Exposure {
    /// The camera, at the origin.
    pub camera: Camera,
    /// What it saw.
    pub frame: RgbdFrame,
}

impl Exposure {
    /// The exposure that became `cloud`: every point lies on the ray of its pixel. `None` where there is no
    /// pinhole camera at the origin for which that is so: a scanner of another kind, or a cloud that
    /// was moved.
    pub fn of(cloud: &OrganisedCloud) -> Option<Self> {
        let (width, height) = (cloud.points.width(), cloud.points.height());
        let pixels = || (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        let seen = || {
            let point = |(x, y)| cloud.point(x, y).filter(|point| point.z > 0.0);
            pixels().filter_map(move |at: (usize, usize)| Some((at, *point(at)?)))
        };
        let n = seen().count();
        if n < LEAST_POINTS || n < cloud.n_points() {
            return None;
        }
        let [fx, cx] = line(&seen().map(|((x, _), point)| [point.x / point.z, x as f64]))?;
        let [fy, cy] = line(&seen().map(|((_, y), point)| [point.y / point.z, y as f64]))?;
        let camera = Camera::pinhole([width, height], [fx, fy], [cx, cy]);
        camera.check().ok()?;
        let is_off = |((x, y), point): &((usize, usize), crate::geom::Point3)| {
            let at = camera.project(point);
            at.is_none_or(|[u, v]| (u - *x as f64).hypot(v - *y as f64) > OFF)
        };
        if seen().filter(is_off).count() as f64 > STRAYS * n as f64 {
            return None;
        }
        let depth = Image::from_rows(width, height, 0.0, |y, row: &mut [f32]| {
            for (x, depth) in row.iter_mut().enumerate() {
                *depth = cloud.point(x, y).map_or(0.0, |point| point.z as f32);
            }
        });
        let frame = RgbdFrame { stamp: 0.0, color: cloud.colors.clone(), depth, confidence: None };
        Some(Self { camera, frame })
    }
}

/// The slope and the height at 0 of the line through points, by least squares; `None` if all have one
/// abscissa.
fn line(points: &(impl Iterator<Item = [f64; 2]> + Clone)) -> Option<[f64; 2]> {
    let all = || points.clone();
    let n = all().count() as f64;
    let [ma, mb] = [0, 1].map(|k| all().map(|p| p[k]).sum::<f64>() / n);
    let sum = |k: usize, m: f64| all().map(|p| (p[0] - ma) * (p[k] - m)).sum::<f64>();
    let slope = sum(1, mb) / sum(0, ma);
    slope.is_finite().then_some([slope, mb - slope * ma])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::{Pose, Vector3};

    const CAMERA: Camera = Camera::pinhole([64, 48], [52.5, 51.0], [30.5, 25.0]);

    fn frame() -> RgbdFrame {
        let depth = Image::from_rows(64, 48, 0.0, |y, row: &mut [f32]| {
            for (x, depth) in row.iter_mut().enumerate() {
                *depth = if x + y < 9 { 0.0 } else { 900.0 + 10.0 * (x * y % 70) as f32 };
            }
        });
        RgbdFrame { stamp: 0.0, color: None, depth, confidence: None }
    }

    #[test]
    fn a_cloud_in_its_cameras_frame_tells_the_camera_and_the_depths() {
        let found = Exposure::of(&frame().cloud(&CAMERA).unwrap()).unwrap();
        assert_eq!(found.frame, frame());
        let off = |a: f64, b: f64| (a - b).abs() < 1e-9;
        let Camera { width, height, fx, fy, cx, cy, .. } = found.camera;
        assert_eq!([width, height], [64, 48]);
        assert!(off(fx, 52.5) && off(fy, 51.0) && off(cx, 30.5) && off(cy, 25.0), "{found:?}");
    }

    #[test]
    fn a_cloud_that_was_moved_or_is_no_picture_has_no_camera() {
        let cloud = frame().cloud(&CAMERA).unwrap();
        for pose in [
            Pose::new(Vector3::new(0.0, 0.0, 0.0), Vector3::x() * 0.5),
            Pose::translation(80.0, 0.0, 0.0),
            Pose::new(Vector3::zeros(), Vector3::x() * 3.0),
        ] {
            assert_eq!(Exposure::of(&cloud.clone().moved(&pose)), None, "{pose}");
        }
        let flat = cloud.to_cloud();
        let n = flat.points.len();
        assert_eq!(Exposure::of(&OrganisedCloud::from_cloud(flat, n, 1).unwrap()), None);
    }
}
