//! Walks before a simulated scene, whose truth is exact.

use super::*;
use crate::geom::{Point3, Vector3};
use crate::progress::Silent;
use crate::register::icp::Verdict;
use crate::rgbd::simulated::{BuiltinScene, Noise, NoiseKind, Orbit, SimulatedSensor};
use crate::rgbd::{Camera, RgbdFrame, StampedPose};

fn camera() -> Camera {
    Camera::pinhole([320, 240], [262.0, 262.0], [159.5, 119.5])
}

fn options() -> OdometryOptions {
    OdometryOptions::default()
}

/// A hand that is moved slowly before a scene.
fn walk(scene: BuiltinScene) -> (Vec<StampedPose>, Vec<RgbdFrame>) {
    let orbit = Orbit { center: Point3::origin(), axis: Vector3::z(), distance: 1500.0 };
    let truth = orbit.hand_held(120, 0.6, 5)[..12].to_vec();
    let noise = Noise { kind: NoiseKind::Kinect, sigma: 1.0, seed: 3 };
    let sensor = SimulatedSensor { camera: camera(), noise };
    let scene = scene.build();
    let frames = truth.iter().enumerate().map(|(i, pose)| sensor.expose(&scene, pose, i));
    let frames = frames.collect();
    (truth, frames)
}

fn followed(frames: Vec<RgbdFrame>, options: OdometryOptions) -> Vec<Placed> {
    let mut tracker = Tracker::new(camera(), options).unwrap();
    frames.into_iter().map(|frame| tracker.add(frame, &Silent).unwrap()).collect()
}

#[test]
fn a_hand_held_walk_is_followed_and_a_covered_frame_is_skipped() {
    let (truth, mut frames) = walk(BuiltinScene::TexturedStructured);
    frames[5].depth = frames[5].depth.map(|_| 0.0);
    let placed = followed(frames, options());
    assert!(matches!(placed[5].reasons[..], [Doubt::Unusable(_)]), "{:?}", placed[5].reasons);
    let first = truth[0].world_from_camera;
    for (i, (placed, known)) in placed.iter().zip(&truth).enumerate() {
        assert_eq!(placed.world_from_camera.is_none(), i == 5);
        let Some(found) = placed.world_from_camera else { continue };
        let off = (first.inverse() * known.world_from_camera).inverse() * found;
        let shift = off.translation.vector.norm();
        // Noise of depth is 3.5 mm a pixel there.
        assert!(shift < 3.0 && off.rotation.angle() < 0.002, "{i} {shift}");
    }
}

#[test]
fn every_frame_hangs_on_the_one_it_was_placed_against() {
    let (_, frames) = walk(BuiltinScene::TexturedStructured);
    // A key frame for every frame: each hangs on the one before.
    let placed = followed(frames, OdometryOptions { key_overlap: 1.0, ..options() });
    let at = |i: usize| placed[i].world_from_camera.unwrap();
    assert!(placed[0].link.is_none());
    for (i, placed) in placed.iter().enumerate().skip(1) {
        let link = placed.link.unwrap();
        assert_eq!(link.key, i - 1);
        let off = (at(link.key) * link.key_from_camera).inverse() * at(i);
        assert!(off.translation.vector.norm() < 1e-9);
        assert!(link.information.symmetric_eigenvalues().min() > 0.0);
    }
}

#[test]
fn what_dense_odometry_knows_is_told_about_the_previous_camera() {
    let (truth, mut frames) = walk(BuiltinScene::TexturedStructured);
    let next = Look::new(frames.remove(9), camera(), None).unwrap();
    let previous = Look::new(frames.remove(0), camera(), None).unwrap();
    let found = motion(&previous, &next, &Pose::identity(), &options(), &Silent).unwrap();
    assert_eq!(found.verdict, Verdict::Ok, "{:?}", found.reasons);
    let known = truth[0].world_from_camera.inverse() * truth[9].world_from_camera;
    let off = known.inverse() * found.previous_from_next;
    assert!(off.translation.vector.norm() < 3.0 && off.rotation.angle() < 0.002);
    let back =
        motion(&next, &previous, &found.previous_from_next.inverse(), &options(), &Silent).unwrap();
    // What both ways know, told about the same camera, is alike: a step of either costs as much.
    let there = found.information;
    let back = crate::register::small_motion::information_of_inverse(
        &back.information,
        &back.previous_from_next,
    );
    for k in 0..6 {
        let ratio = there[(k, k)] / back[(k, k)];
        assert!((0.5..2.0).contains(&ratio), "{k}: {ratio}");
    }
}

#[test]
fn frames_without_colour_are_told_what_would_go() {
    let (_, frames) = walk(BuiltinScene::TexturedStructured);
    let plain = |frame: &RgbdFrame| RgbdFrame { color: None, ..frame.clone() };
    let placed = followed(frames.iter().take(2).map(plain).collect(), options());
    let told = placed[1].reasons[0].to_string();
    assert!(told.contains("no colour") && told.contains("--method icp"), "{told}");
}

/// A wall lets surfaces slide, but it holds three of six motions better than features do.
#[test]
fn before_a_painted_wall_features_and_surfaces_together_are_nearer_the_truth() {
    let (truth, frames) = walk(BuiltinScene::TexturedFlat);
    let looks: Vec<Look> =
        frames.into_iter().map(|frame| Look::new(frame, camera(), None).unwrap()).collect();
    let found = |method: Method, i: usize| {
        let options = OdometryOptions { method, ..options() };
        motion(&looks[0], &looks[i], &Pose::identity(), &options, &Silent).unwrap()
    };
    let off = |method: Method| -> f64 {
        let squares = (1..looks.len()).map(|i| {
            let found = found(method, i);
            assert_eq!(found.verdict, Verdict::Ok, "{method:?} {i}: {:?}", found.reasons);
            let known = truth[0].world_from_camera.inverse() * truth[i].world_from_camera;
            (known.inverse() * found.previous_from_next).translation.vector.norm_squared()
        });
        (squares.sum::<f64>() / (looks.len() - 1) as f64).sqrt()
    };
    assert_eq!(found(Method::Icp, 3).verdict, Verdict::Failed);
    let [features, both] = [Method::Visual, Method::RgbdIcp].map(off);
    assert!(both < 0.9 * features, "{both} mm, and {features} mm without surfaces");
}
