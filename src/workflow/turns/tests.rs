use super::*;
use crate::geom::{Aabb, Point3, Vector3, distances_from_mesh, shapes};
use crate::progress::Silent;
use crate::rgbd::simulated::{Noise, NoiseKind, Orbit, Scene, SimulatedSensor, Texture};

const VIEWS: usize = 18;

fn camera() -> Camera {
    Camera::pinhole([160, 120], [200.0, 200.0], [79.5, 59.5])
}

fn body() -> TriMesh {
    shapes::last(&shapes::LastParameters::default()).unwrap()
}

/// What a camera saw of a body on a turntable that turned it about `axis`; and where the camera was at
/// first.
fn turn(mesh: &TriMesh, axis: Vector3, elevation: f64, seed: u64) -> (Vec<RgbdFrame>, Pose) {
    let around = mesh.aabb();
    let center = Point3::from((around.min.coords + around.max.coords) / 2.0);
    let orbit = Orbit { center, axis, distance: 500.0 };
    let truth = CameraTrajectory::new(orbit.turntable(VIEWS, &[elevation])).unwrap();
    let noise = Noise { kind: NoiseKind::Gaussian, sigma: 0.5, seed };
    let sensor = SimulatedSensor { camera: camera(), noise };
    let scene = Scene::new(mesh.clone(), Texture::default());
    (sensor.frames(&scene, &truth).collect(), truth.poses()[0].world_from_camera)
}

fn named<'a>(name: &str, frames: &'a [RgbdFrame]) -> Turn<'a> {
    Turn {
        name: name.to_owned(),
        stamps: frames.iter().map(|frame| frame.stamp).collect(),
        frames: Box::new(move || Box::new(frames.iter().cloned().map(Ok))),
    }
}

fn fused(turns: Vec<Turn>) -> Result<Fused, TurnsError> {
    let mut options = FuseOptions::default();
    options.volume.voxel = 4.0;
    let calibration = TurntableOptions::default();
    let (turntable, notes) = (None, Vec::new());
    let camera = camera();
    let job =
        TurnsJob { turns, camera, turntable, calibration: &calibration, notes, options: &options };
    fuse_turns(&job, &Silent)
}

/// How far half of the vertices lie from the body, the first camera being where it was.
fn median_off(fused: &Fused, world_from_first: &Pose, body: &TriMesh) -> f64 {
    let mesh = fused.mesh.clone().moved(world_from_first);
    let mut off = distances_from_mesh(body, &mesh.points);
    off.sort_by(f64::total_cmp);
    off[off.len() / 2]
}

#[test]
fn a_part_that_stood_and_then_lay_becomes_one_surface_and_a_stranger_is_left_out() {
    let body = body();
    let (standing, first) = turn(&body, Vector3::z(), 0.6, 1);
    let (lying, _) = turn(&body, Vector3::y(), 0.6, 2);
    // A ball looks alike from all sides: nobody knows how it turned.
    let ball = shapes::sphere(&Point3::origin(), 60.0, 40);
    let (rolling, _) = turn(&ball, Vector3::z(), 0.6, 3);
    let both = [("standing", &standing), ("rolling", &rolling), ("lying", &lying)];
    let whole = fused(both.map(|(name, frames)| named(name, frames)).into()).unwrap();
    let told = &whole.report.turns;
    assert!(told[0].is_in() && told[2].is_in() && !told[1].is_in(), "{told:#?}");
    assert!(told[1].reasons[0].contains("degenerate"), "{told:#?}");
    assert_eq!((whole.report.n_frames, whole.report.n_fused), (2 * VIEWS, 2 * VIEWS));
    assert!(told[2].lies_on_others.unwrap() > 0.3, "{told:#?}");
    let off = median_off(&whole, &first, &body);
    assert!(off < 0.5, "half of the vertices lie within {off} mm");
    // One turn alone does not see all of it.
    let one = fused(vec![named("standing", &standing)]).unwrap();
    assert!(one.report.mesh.area < 0.95 * whole.report.mesh.area, "{:?}", one.report.mesh);
}

#[test]
fn turns_of_two_parts_do_not_lie_together_and_the_first_is_kept() {
    let body = body();
    let (part, _) = turn(&body, Vector3::z(), 0.6, 1);
    let cube = Aabb { min: Point3::new(-60.0, -40.0, -50.0), max: Point3::new(60.0, 40.0, 50.0) };
    let (other, _) = turn(&shapes::cuboid(&cube), Vector3::z(), 0.6, 2);
    let whole = fused(vec![named("part", &part), named("other", &other)]).unwrap();
    let told = &whole.report.turns;
    assert!(told[0].is_in() && !told[1].is_in(), "{told:#?}");
    assert!(told[1].reasons.len() > 1, "{told:#?}");
    assert_eq!(whole.report.n_frames, VIEWS);
}

#[test]
fn turns_that_show_nothing_are_refused_by_the_first() {
    let ball = shapes::sphere(&Point3::origin(), 60.0, 40);
    let (rolling, _) = turn(&ball, Vector3::z(), 0.6, 3);
    let error = fused(vec![named("one", &rolling), named("two", &rolling)]).err().unwrap();
    let TurnsError::NoTurn { n_turns: 2, name, reason } = &error else { panic!("{error}") };
    assert!(name == "one" && reason.contains("degenerate"), "{error}");
}

#[test]
fn stamps_of_a_turn_begin_after_those_of_the_one_before() {
    let pose = |stamp| StampedPose { stamp, world_from_camera: Pose::identity() };
    let along = CameraTrajectory::new(vec![pose(3.0), pose(4.0)]).unwrap();
    let late = CameraTrajectory::new(vec![pose(9.0)]).unwrap();
    let mut whole = Whole::default();
    for (i, along) in [&along, &along, &late].into_iter().enumerate() {
        whole.add(i, along, &Pose::identity());
    }
    let stamps: Vec<f64> = whole.poses.iter().map(|pose| pose.stamp).collect();
    assert_eq!(stamps, [3.0, 4.0, 5.0, 6.0, 9.0]);
}
