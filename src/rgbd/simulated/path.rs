//! Where simulated cameras go: around a turntable, or in a hand.

use super::looking_at;
use super::texture::mixed;
use crate::geom::{Point3, Pose, Vector3};
use crate::rgbd::StampedPose;
use nalgebra::UnitQuaternion;
use std::f64::consts::{FRAC_PI_2, TAU};

/// Frames a second.
const RATE: f64 = 30.0;

/// What a camera goes around.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Orbit {
    /// The middle, which the camera looks at.
    pub center: Point3,
    /// Up, and what it goes around; any length.
    pub axis: Vector3,
    /// From the middle to the camera [mm].
    pub distance: f64,
}

impl Orbit {
    /// One whole turn of `n_views` for each of `elevations` (above the plane across the axis) [rad]. It is
    /// the same whether the camera turns or the part on its table.
    pub fn turntable(&self, n_views: usize, elevations: &[f64]) -> Vec<StampedPose> {
        let views =
            elevations.iter().flat_map(|elevation| (0..n_views).map(move |i| (elevation, i)));
        let pose = |(number, (elevation, i_view)): (usize, (&f64, usize))| {
            let turn = TAU * i_view as f64 / n_views as f64;
            let eye = self.center + around(&self.axis, turn, *elevation) * self.distance;
            let world_from_camera = looking_at(&eye, &self.center, &self.axis);
            StampedPose { stamp: number as f64 / RATE, world_from_camera }
        };
        views.enumerate().map(pose).collect()
    }

    /// A camera in a hand: `n_views` along an arc of `span` [rad], with a hand's sway in height, distance
    /// and direction, drawn from `seed`.
    pub fn hand_held(&self, n_views: usize, span: f64, seed: u64) -> Vec<StampedPose> {
        let last = n_views.saturating_sub(1).max(1) as f64;
        let pose = |number: usize| {
            let stamp = number as f64 / RATE;
            let sway = |i_motion: u64| sway(stamp, mixed(seed ^ mixed(i_motion)));
            let turn = span * (number as f64 / last - 0.5) + 0.02 * sway(0);
            let distance = self.distance * (1.0 + 0.03 * sway(2));
            let eye = self.center + around(&self.axis, turn, 0.08 * sway(1)) * distance;
            // A few degrees off the middle, and tilted.
            let off = Vector3::new(0.03 * sway(3), 0.03 * sway(4), 0.04 * sway(5));
            let steady = looking_at(&eye, &self.center, &self.axis);
            let turned = steady.rotation * UnitQuaternion::from_scaled_axis(off);
            let world_from_camera = Pose::from_parts(steady.translation, turned);
            StampedPose { stamp, world_from_camera }
        };
        (0..n_views).map(pose).collect()
    }
}

/// The direction from the middle to a camera; turn 0 lies as near to -Y as the axis allows.
fn around(axis: &Vector3, turn: f64, elevation: f64) -> Vector3 {
    let axis = axis.normalize();
    let seed = if axis.y.abs() < 0.9 { -Vector3::y() } else { Vector3::x() };
    let front = (seed - axis * axis.dot(&seed)).normalize();
    let side = axis.cross(&front);
    (front * turn.cos() + side * turn.sin()) * elevation.cos() + axis * elevation.sin()
}

/// A slow smooth motion between about -1 and 1: three sines whose phases come from `seed`.
fn sway(time: f64, seed: u64) -> f64 {
    let wave = |(i, (hertz, size)): (u64, (f64, f64))| {
        let phase = TAU * (mixed(seed ^ i) >> 11) as f64 / (1_u64 << 53) as f64;
        size * (TAU * hertz * time + phase).sin()
    };
    (0..).zip([(0.31, 0.6), (0.73, 0.3), (1.7, 0.1)]).map(wave).sum()
}

/// True if an elevation leaves the camera beside its axis [rad].
pub(super) fn is_elevation(angle: f64) -> bool {
    angle.abs() < FRAC_PI_2
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turntable_goes_around_once_for_each_elevation() {
        let center = Point3::new(10.0, 20.0, 30.0);
        let orbit = Orbit { center, axis: Vector3::z(), distance: 800.0 };
        let poses = orbit.turntable(72, &[0.6, -0.6]);
        assert_eq!(poses.len(), 144);
        for (i, pose) in poses.iter().enumerate() {
            let eye = pose.world_from_camera.translation.vector - center.coords;
            assert!((eye.norm() - 800.0).abs() < 1e-9);
            let elevation: f64 = if i < 72 { 0.6 } else { -0.6 };
            assert!((eye.z - 800.0 * elevation.sin()).abs() < 1e-9);
            let seen = pose.world_from_camera.inverse() * center;
            assert!((seen - Point3::new(0.0, 0.0, 800.0)).norm() < 1e-9);
        }
        let first = poses[0].world_from_camera.translation.vector - center.coords;
        assert!(first.x.abs() < 1e-9 && first.y < -600.0, "from the front");
        let step =
            poses[0].world_from_camera.rotation.angle_to(&poses[1].world_from_camera.rotation);
        // Five degrees about an axis that is not the camera's own: less than five degrees.
        assert!((0.06..TAU / 72.0 + 1e-9).contains(&step), "{step}");
    }

    #[test]
    fn a_hand_sways_smoothly_and_by_its_seed() {
        let orbit = Orbit { center: Point3::origin(), axis: Vector3::z(), distance: 1000.0 };
        let walk = |seed| orbit.hand_held(120, 0.5, seed);
        let poses = walk(1);
        for pair in poses.windows(2) {
            let [a, b] = [pair[0].world_from_camera, pair[1].world_from_camera];
            let step = (a.translation.vector - b.translation.vector).norm();
            assert!(0.1 < step && step < 40.0, "{step}");
            assert!(a.rotation.angle_to(&b.rotation) < 0.04);
        }
        assert_eq!(poses, walk(1));
        assert_ne!(poses, walk(2));
        let across = Orbit { axis: Vector3::y(), ..orbit };
        assert_eq!(across.hand_held(1, 0.5, 0).len(), 1);
    }
}
