//! A camera that swings before a scene, and frames that are stamped late.

use super::*;
use crate::geom::{Pose, Vector3};
use crate::progress::Silent;
use crate::rgbd::simulated::{BuiltinScene, Noise, NoiseKind, SimulatedSensor};
use crate::rgbd::{Camera, StampedPose};

const CAMERA: Camera = Camera::pinhole([160, 120], [131.0, 131.0], [79.5, 59.5]);

/// Where the camera is at a time: `swing` [rad] to and fro, once in 1.3 s.
fn pose(stamp: f64, swing: f64) -> StampedPose {
    let phase = std::f64::consts::TAU * stamp / 1.3;
    let turn = Vector3::new(0.3 * swing * (1.7 * phase).sin(), swing * phase.sin(), 0.0);
    let steady = Pose::new(Vector3::new(0.0, -1500.0, 0.0), Vector3::zeros());
    let upright = Pose::new(Vector3::zeros(), Vector3::x() * -std::f64::consts::FRAC_PI_2);
    let world_from_camera = steady * upright * Pose::new(Vector3::zeros(), turn);
    StampedPose { stamp, world_from_camera }
}

/// Poses of a hundredth of a second, and frames of a tenth that say they were taken `late` after.
fn swung(swing: f64, late: f64, n_frames: usize) -> (Vec<Sketch>, CameraTrajectory) {
    let along = (0..300).map(|i| pose(f64::from(i) / 100.0, swing)).collect();
    let noise = Noise { kind: NoiseKind::Kinect, sigma: 1.0, seed: 4 };
    let sensor = SimulatedSensor { camera: CAMERA, noise };
    let scene = BuiltinScene::TexturedStructured.build();
    let sketch = |i: usize| {
        let taken = 0.6 + 0.1 * i as f64;
        let frame = sensor.expose(&scene, &pose(taken, swing), i);
        Sketch::new(&frame, &CAMERA, taken + late, f64::INFINITY).unwrap()
    };
    ((0..n_frames).map(sketch).collect(), CameraTrajectory::new(along).unwrap())
}

#[test]
fn a_delay_is_found_to_a_millisecond_or_two() {
    for late in [0.0, 0.025, -0.04] {
        let (frames, along) = swung(0.25, late, 14);
        let found = pose_delay(&frames, &along, &Silent).unwrap();
        assert!((found.seconds - late).abs() < 2e-3, "{late}: {found:?}");
        assert!(found.apart[1] <= found.apart[0] && found.n_pairs > 20, "{found:?}");
    }
}

#[test]
fn a_camera_that_stands_tells_no_delay() {
    let (frames, along) = swung(0.0, 0.02, 10);
    let error = pose_delay(&frames, &along, &Silent).unwrap_err();
    assert!(matches!(error, PoseDelayError::Even { .. }), "{error}");
    assert!(error.to_string().contains("too evenly"), "{error}");
}

#[test]
fn a_delay_that_is_too_long_to_be_one_is_refused() {
    let (frames, along) = swung(0.25, 0.16, 12);
    let error = pose_delay(&frames, &along, &Silent).unwrap_err();
    assert!(matches!(error, PoseDelayError::Beyond { .. }), "{error}");
}

#[test]
fn few_frames_and_frames_that_show_different_things_are_refused() {
    let (frames, along) = swung(0.25, 0.0, 3);
    let error = pose_delay(&frames, &along, &Silent).unwrap_err();
    assert!(error.to_string().contains("there are 3: it takes 6"), "{error}");
    // Turned by a picture's width each, no two show the same.
    let (frames, _) = swung(0.0, 0.0, 8);
    let apart = |i: i32| {
        let turn = Vector3::y() * f64::from(i / 10 * 2);
        let world_from_camera = Pose::new(Vector3::zeros(), turn);
        StampedPose { stamp: f64::from(i) / 100.0, world_from_camera }
    };
    let along = CameraTrajectory::new((0..300).map(apart).collect()).unwrap();
    let error = pose_delay(&frames, &along, &Silent).unwrap_err();
    assert!(matches!(error, PoseDelayError::TooFewPairs { .. }), "{error}");
}
