//! A camera that goes along an arc and comes back, and a walk that has it drift.

use super::*;
use crate::geom::{Point3, Vector3};
use crate::progress::Silent;
use crate::register::odometry::Look;
use crate::rgbd::Camera;
use crate::rgbd::simulated::{BuiltinScene, Noise, NoiseKind, Orbit, SimulatedSensor};

const CAMERA: Camera = Camera::pinhole([320, 240], [262.0, 262.0], [159.5, 119.5]);
/// What every step is off.
fn drift() -> Pose {
    Pose::new(Vector3::new(2.0, -1.0, 3.0), Vector3::new(0.002, 0.004, -0.002))
}

/// Where the camera really was: along an arc and back, a little beside its way.
fn truth() -> Vec<Pose> {
    let orbit = Orbit { center: Point3::origin(), axis: Vector3::z(), distance: 1500.0 };
    let there = orbit.hand_held(8, 0.7, 5);
    let back = orbit.hand_held(8, 0.7, 9);
    there.iter().chain(back.iter().rev()).map(|pose| pose.world_from_camera).collect()
}

/// The walk as odometry has it, and its frames; every step says that it is off by `sigma` (radians, and
/// metres).
fn walk(truth: &[Pose], sigma: f64, scene: BuiltinScene) -> (Vec<Step>, Vec<KeyFrame>) {
    let noise = Noise { kind: NoiseKind::Kinect, sigma: 1.0, seed: 3 };
    let sensor = SimulatedSensor { camera: CAMERA, noise };
    let scene = scene.build();
    let [turn, shift] = [sigma, 1000.0 * sigma].map(|sigma| 1.0 / (sigma * sigma));
    let known = Matrix6::from_diagonal(&Vector6::new(turn, turn, turn, shift, shift, shift));
    let (mut steps, mut keys): (Vec<Step>, Vec<KeyFrame>) = (Vec::new(), Vec::new());
    for (number, pose) in truth.iter().enumerate() {
        let stamped = crate::rgbd::StampedPose { stamp: number as f64, world_from_camera: *pose };
        let link = number.checked_sub(1).map(|key| Link {
            key,
            key_from_camera: truth[key].inverse() * pose * drift(),
            information: known,
            overlap: 1.0,
        });
        let before = number.checked_sub(1).and_then(|key| steps[key].world_from_camera);
        let world_from_camera = match (before, &link) {
            (Some(before), Some(link)) => before * link.key_from_camera,
            _ => Pose::identity(),
        };
        let frame = sensor.expose(&scene, &stamped, number);
        let look = Look::new(frame, CAMERA, None).unwrap();
        steps.push(Step { world_from_camera: Some(world_from_camera), link });
        keys.push(KeyFrame { number, look, world_from_camera });
    }
    (steps, keys)
}

/// How far the camera is off at the worst, the first pose being given.
fn off(found: &[Option<Pose>], truth: &[Pose]) -> f64 {
    let off = |(found, known): (&Option<Pose>, &Pose)| {
        let known = truth[0].inverse() * known;
        (found.unwrap().translation.vector - known.translation.vector).norm()
    };
    found.iter().zip(truth).map(off).fold(0.0, f64::max)
}

#[test]
fn a_walk_that_comes_back_is_put_right_by_its_loops() {
    let truth = truth();
    let (walk, keys) = walk(&truth, 0.004, BuiltinScene::TexturedStructured);
    let before: Vec<Option<Pose>> = walk.iter().map(|step| step.world_from_camera).collect();
    let options = (&LoopOptions::default(), &OdometryOptions::default());
    let closed = close_loops(&walk, &keys, options, &Silent).unwrap();
    assert!(closed.n_closed() >= 2, "{:?}", closed.loops);
    let [before, after] = [off(&before, &truth), off(&closed.world_from_camera, &truth)];
    assert!(before > 60.0 && after < before / 3.0, "{before} {after}");
    // The turn at the far end is held by nothing but the walk; the end lies on the start.
    let end = |poses: &[Option<Pose>]| {
        let known = truth[0].inverse() * truth[15];
        (known.inverse() * poses[15].unwrap()).translation.vector.norm()
    };
    // Drift of 4 mm a step is shared with the steps around.
    assert!(end(&closed.world_from_camera) < 15.0, "{}", end(&closed.world_from_camera));
    assert_eq!(closed.world_from_camera[0], Some(Pose::identity()));
}

#[test]
fn loops_that_agree_outvote_a_walk_that_is_too_sure_of_itself() {
    let truth = truth();
    let (walk, keys) = walk(&truth, 1e-6, BuiltinScene::TexturedStructured);
    let options = (&LoopOptions::default(), &OdometryOptions::default());
    let found = found(&keys, options, &Silent).unwrap();
    let n_believed = found.iter().filter(|(_, motion)| is_believed(motion)).count();
    assert!(n_believed >= VOTERS, "{n_believed}");
    let (graph, _) = graph(&walk, &keys, &found);
    let weights = |settled: &Settled| settled.weights.iter().filter(|w| **w == 0.0).count();
    let alone = settle(&graph, &options.0.graph, &Silent).unwrap();
    let voted = outvoted(&graph, options.0, &Silent).unwrap();
    assert!(2 * weights(&alone) >= n_believed, "{:?}", alone.weights);
    assert!(2 * weights(&voted) < n_believed, "{:?}", voted.weights);
    let poses: Vec<Option<Pose>> = voted.world_from_node.iter().copied().map(Some).collect();
    assert!(off(&poses, &truth) < 25.0, "{}", off(&poses, &truth));
}

#[test]
fn where_nothing_tells_places_apart_no_loop_closes_and_the_walk_stays() {
    let truth = truth();
    let (walk, keys) = walk(&truth, 0.004, BuiltinScene::PlainFlat);
    let options = (&LoopOptions::default(), &OdometryOptions::default());
    let closed = close_loops(&walk, &keys, options, &Silent).unwrap();
    assert_eq!(closed.n_closed(), 0);
    assert!(closed.loops.iter().all(|tried| match &tried.outcome {
        LoopOutcome::Refused(reasons) => !reasons.is_empty(),
        _ => false,
    }));
    let before: Vec<Option<Pose>> = walk.iter().map(|step| step.world_from_camera).collect();
    assert_eq!(closed.world_from_camera, before);
}

#[test]
fn what_is_known_is_no_better_than_a_camera_can_be() {
    let sure = Matrix6::identity() * 1e12;
    let known = no_better(&sure, 0.002, 1000.0);
    assert!((known[(0, 0)].sqrt() * 0.002 - 1.0).abs() < 1e-3);
    assert!((known[(5, 5)].sqrt() * 2.0 - 1.0).abs() < 1e-3);
    let nothing = no_better(&Matrix6::zeros(), 0.002, 1000.0);
    assert_eq!(nothing, Matrix6::zeros());
}
