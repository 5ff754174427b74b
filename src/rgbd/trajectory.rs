//! Where a camera stood when. It is named for the camera because a tool has a trajectory too.

use super::RgbdError;
use crate::geom::Pose;

/// The camera at one moment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StampedPose {
    /// When [s].
    pub stamp: f64,
    /// Where: takes points of the camera's frame into the world [mm].
    pub world_from_camera: Pose,
}

/// Where a camera stood when: poses with rising stamps.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CameraTrajectory {
    poses: Vec<StampedPose>,
}

impl CameraTrajectory {
    /// The trajectory of `poses`; an error if stamps do not rise or a number is not finite.
    pub fn new(poses: Vec<StampedPose>) -> Result<Self, RgbdError> {
        let mut before = f64::NEG_INFINITY;
        for (pose, number) in poses.iter().zip(1..) {
            let stamp = pose.stamp;
            let coords = pose.world_from_camera.rotation.coords;
            let shift = pose.world_from_camera.translation.vector;
            if !(stamp.is_finite() && coords.iter().chain(shift.iter()).all(|c| c.is_finite())) {
                return Err(RgbdError::Pose { number, stamp });
            }
            if stamp <= before {
                return Err(RgbdError::Stamps { number, stamp, before });
            }
            before = stamp;
        }
        Ok(Self { poses })
    }

    /// All poses, stamps rising.
    pub fn poses(&self) -> &[StampedPose] {
        &self.poses
    }

    /// All stamps, rising [s].
    pub fn stamps(&self) -> Vec<f64> {
        self.poses.iter().map(|pose| pose.stamp).collect()
    }

    /// The pose whose stamp is nearest; of two as near the earlier. `None` of an empty trajectory.
    pub fn nearest(&self, stamp: f64) -> Option<&StampedPose> {
        let after = self.poses.partition_point(|pose| pose.stamp < stamp);
        let around = self.poses.get(after.wrapping_sub(1)).into_iter().chain(self.poses.get(after));
        around.min_by(|a, b| (a.stamp - stamp).abs().total_cmp(&(b.stamp - stamp).abs()))
    }

    /// The pose at `stamp`, between the two around it if need be: places in a straight line, turns
    /// about one axis at an even rate. `None` before the first and after the last.
    pub fn at(&self, stamp: f64) -> Option<Pose> {
        let after = self.poses.partition_point(|pose| pose.stamp < stamp);
        let next = self.poses.get(after)?;
        if next.stamp == stamp {
            return Some(next.world_from_camera);
        }
        let last = self.poses.get(after.checked_sub(1)?)?;
        let share = (stamp - last.stamp) / (next.stamp - last.stamp);
        Some(between(&last.world_from_camera, &next.world_from_camera, share))
    }
}

/// The pose `share` of the way from `a` to `b`.
fn between(a: &Pose, b: &Pose, share: f64) -> Pose {
    let turn = a.rotation.rotation_to(&b.rotation).scaled_axis() * share;
    let rotation = nalgebra::UnitQuaternion::from_scaled_axis(turn) * a.rotation;
    let translation = a.translation.vector.lerp(&b.translation.vector, share);
    Pose::from_parts(translation.into(), rotation)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Vector3;
    use std::f64::consts::FRAC_PI_2;

    fn pose(stamp: f64, x: f64, turn: f64) -> StampedPose {
        let world_from_camera = Pose::new(Vector3::new(x, 0.0, 0.0), Vector3::z() * turn);
        StampedPose { stamp, world_from_camera }
    }

    #[test]
    fn between_two_poses_the_camera_moves_and_turns_evenly() {
        let walk = vec![pose(1.0, 0.0, 0.0), pose(2.0, 8.0, FRAC_PI_2), pose(4.0, 8.0, 0.0)];
        let walk = CameraTrajectory::new(walk).unwrap();
        let quarter = walk.at(1.25).unwrap();
        assert!((quarter.translation.x - 2.0).abs() < 1e-12);
        assert!((quarter.rotation.angle() - FRAC_PI_2 / 4.0).abs() < 1e-12);
        assert_eq!(walk.at(2.0).unwrap(), walk.poses()[1].world_from_camera);
        assert_eq!((walk.at(0.99), walk.at(4.01)), (None, None));
    }

    #[test]
    fn the_shorter_way_round_is_taken() {
        let minus = |q: Pose| {
            let rotation = nalgebra::UnitQuaternion::new_unchecked(-q.rotation.into_inner());
            Pose { rotation, ..q }
        };
        let mut end = pose(1.0, 0.0, 0.2);
        end.world_from_camera = minus(end.world_from_camera);
        let walk = CameraTrajectory::new(vec![pose(0.0, 0.0, 0.0), end]).unwrap();
        assert!((walk.at(0.5).unwrap().rotation.angle() - 0.1).abs() < 1e-12);
    }

    #[test]
    fn the_nearest_pose_may_lie_before_or_after() {
        let walk = vec![pose(1.0, 0.0, 0.0), pose(2.0, 1.0, 0.0), pose(4.0, 2.0, 0.0)];
        let walk = CameraTrajectory::new(walk).unwrap();
        for (stamp, nearest) in [(-9.0, 1.0), (1.4, 1.0), (1.6, 2.0), (3.0, 2.0), (9.0, 4.0)] {
            assert_eq!(walk.nearest(stamp).unwrap().stamp, nearest, "{stamp}");
        }
        assert_eq!(CameraTrajectory::default().nearest(0.0), None);
    }

    #[test]
    fn stamps_that_fall_and_poses_that_are_no_numbers_are_told() {
        let error = |poses| CameraTrajectory::new(poses).unwrap_err().to_string();
        let repeated = error(vec![pose(1.0, 0.0, 0.0), pose(1.0, 1.0, 0.0)]);
        assert!(repeated.starts_with("pose 2 has the stamp 1, but the one before has 1"));
        let nan = error(vec![pose(1.0, f64::NAN, 0.0)]);
        assert!(nan.starts_with("pose 1 (stamp 1) has a value that is no finite number"), "{nan}");
    }
}
