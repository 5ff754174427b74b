use super::*;
use crate::geom::{PointCloud, TriMesh, shapes};
use crate::progress::Silent;
use crate::register::icp::Verdict;
use crate::rgbd::simulated::{Noise, NoiseKind, Orbit, Scene, SimulatedSensor, Texture};
use crate::rgbd::{Camera, NormalOptions};

const CENTER: Point3 = Point3::new(10.0, -20.0, 30.0);

fn camera() -> Camera {
    Camera::pinhole([160, 120], [200.0, 200.0], [79.5, 59.5])
}

/// A camera that goes around is a part that turns the other way round.
fn orbit(n_views: usize, elevations: &[f64]) -> Vec<StampedPose> {
    let orbit = Orbit { center: CENTER, axis: Vector3::z(), distance: 500.0 };
    orbit.turntable(n_views, elevations)
}

/// The turntable that such an orbit is, in the frame of its first camera.
fn turntable_of(poses: &[StampedPose], step: f64) -> Turntable {
    let camera_from_world = poses[0].world_from_camera.inverse();
    let axis = camera_from_world.rotation * -Vector3::z();
    Turntable::new(axis, camera_from_world * CENTER, step).unwrap()
}

/// What the camera sees, each view in its own frame, with normals.
fn views(mesh: TriMesh, poses: &[StampedPose], sigma: f64) -> Vec<PointCloud> {
    let scene = Scene::new(mesh, Texture::default());
    let kind = if sigma > 0.0 { NoiseKind::Gaussian } else { NoiseKind::None };
    let sensor = SimulatedSensor { camera: camera(), noise: Noise { kind, sigma, seed: 3 } };
    let eye = Point3::origin();
    let cloud = |(number, pose)| {
        let frame = sensor.expose(&scene, pose, number);
        let organised = frame.cloud(&sensor.camera).unwrap();
        organised.with_normals(&eye, &NormalOptions::default()).to_cloud()
    };
    poses.iter().enumerate().map(cloud).collect()
}

/// Stands askew: no plane or axis of it is one of the turntable.
fn part() -> TriMesh {
    let mut mesh = shapes::last(&shapes::LastParameters::default()).unwrap();
    let middle = mesh.aabb();
    let middle = (middle.min.coords + middle.max.coords) / 2.0;
    let turn = Pose::rotation(Vector3::new(0.3, 1.2, -0.4));
    let shift = CENTER.coords + Vector3::new(15.0, 5.0, 0.0);
    for point in &mut mesh.points {
        *point = Point3::from((turn * Point3::from(point.coords - middle)).coords + shift);
    }
    mesh
}

/// Tilt of the axis [rad], its distance at the part [mm], and the step [rad].
fn off(found: &Turntable, truth: &Turntable) -> [f64; 3] {
    let between = found.through - truth.through;
    let across = between - truth.axis * truth.axis.dot(&between);
    [found.axis.angle(&truth.axis), across.norm(), (found.step - truth.step).abs()]
}

#[test]
fn a_camera_that_goes_around_is_a_part_that_turns() {
    let poses = orbit(12, &[0.6]);
    let step = std::f64::consts::TAU / 12.0;
    let turntable = turntable_of(&poses, step);
    let stamps: Vec<f64> = poses.iter().map(|pose| pose.stamp).collect();
    let trajectory = turntable.trajectory(&stamps).unwrap();
    let first_from_world = poses[0].world_from_camera.inverse();
    for (found, truth) in trajectory.poses().iter().zip(&poses) {
        let truth = first_from_world * truth.world_from_camera;
        let off = truth.inverse() * found.world_from_camera;
        assert!(off.translation.vector.norm() < 1e-9 && off.rotation.angle() < 1e-12);
    }
    let still = turntable.turned(3.0) * turntable.through;
    assert!((still - turntable.through).norm() < 1e-9);
}

#[test]
fn numbers_that_are_no_turntable_are_refused() {
    let through = Point3::new(0.0, 0.0, 500.0);
    assert!(Turntable::new(Vector3::zeros(), through, 0.1).is_err());
    assert!(Turntable::new(Vector3::y(), through, f64::NAN).is_err());
    assert!(Turntable::new(Vector3::y() * f64::INFINITY, through, 0.1).is_err());
    let none = TurntableOptions { turntable_step: Some(-5.0), ..TurntableOptions::default() };
    let error = none.check().unwrap_err().to_string();
    assert!(error.starts_with("--turntable-step is -5; it must be above 0"), "{error}");
    let none = TurntableOptions { turntable_voxel: Some(0.0), ..TurntableOptions::default() };
    assert!(none.check().unwrap_err().to_string().starts_with("--turntable-voxel is 0"));
}

#[test]
fn one_turn_is_fitted_to_many_motions_and_not_to_strays() {
    let axis = Vector3::new(0.1, -1.0, 0.2);
    let truth = Turntable::new(axis, Point3::new(20.0, 0.0, 600.0), 0.1).unwrap();
    let mut motions = vec![truth.turned(1.0); 20];
    let stray = Pose::new(Vector3::new(9.0, 0.0, -3.0), Vector3::new(0.0, 0.1, 0.0));
    motions[4] = stray * motions[4];
    motions[11] = Pose::identity();
    let middle = Point3::new(25.0, 10.0, 590.0);
    let found = fit::fit(&motions, &middle, 60.0).unwrap();
    let [tilt, place, step] = off(&found, &truth);
    assert!(tilt < 1e-6 && place < 1e-4 && step < 1e-7, "{tilt} {place} {step}");
    assert!(found.axis.dot(&(found.through - middle)).abs() < 1e-6, "named by its nearest point");
    assert_eq!(fit::fit(&[Pose::identity(); 5], &middle, 60.0), None);
}

#[test]
fn views_of_a_part_find_the_turntable_it_stood_on() {
    let n_views = 24;
    let poses = orbit(n_views, &[0.5]);
    let truth = turntable_of(&poses, std::f64::consts::TAU / n_views as f64);
    // A pixel is 2.5 mm wide there.
    for (sigma, most) in [(0.0, [2e-3, 0.15, 1e-4]), (1.0, [4e-3, 0.4, 3e-4])] {
        let clouds = views(part(), &poses, sigma);
        let found = calibrate(&clouds, &TurntableOptions::default(), &Silent).unwrap();
        let off = off(&found.turntable, &truth);
        assert!((0..3).all(|k| off[k] < most[k]), "{sigma}: {off:?} {found:?}");
        assert_eq!((found.verdict, found.n_views), (Verdict::Ok, n_views), "{:?}", found.doubts);
        assert!(found.apart_after_a_turn.is_some());
    }
}

#[test]
fn a_step_that_is_known_stays_and_a_wrong_one_is_told() {
    let poses = orbit(24, &[0.5]);
    let clouds = views(part(), &poses[..6], 0.0);
    let with =
        |step| TurntableOptions { turntable_step: Some(step), ..TurntableOptions::default() };
    let found = calibrate(&clouds, &with(15.0), &Silent).unwrap();
    assert_eq!(found.turntable.step, 15.0_f64.to_radians());
    let [tilt, place, _] = off(&found.turntable, &turntable_of(&poses, 15.0_f64.to_radians()));
    assert!(tilt < 0.01 && place < 0.5, "{tilt} {place} {found:?}");
    assert!(found.apart_after_a_turn.is_none() && found.verdict == Verdict::Ok, "{found:?}");
    let found = calibrate(&clouds, &with(12.0), &Silent).unwrap();
    assert_eq!(found.verdict, Verdict::Failed);
    let told = found.doubts.iter().map(ToString::to_string).collect::<Vec<_>>().join("; ");
    assert!(told.contains("the part turns by 1"), "{told}");
    assert!(told.contains("deg, not by 12.00 (--turntable-step)"), "{told}");
}

#[test]
fn two_turns_from_different_heights_are_not_one() {
    let poses = orbit(12, &[0.6, -0.6]);
    let clouds = views(part(), &poses, 0.0);
    let told = match calibrate(&clouds, &TurntableOptions::default(), &Silent) {
        Ok(found) => {
            assert_eq!(found.verdict, Verdict::Failed, "{found:?}");
            found.doubts.iter().map(ToString::to_string).collect::<Vec<_>>().join("; ")
        }
        Err(error) => error.to_string(),
    };
    assert!(told.contains("neighbouring views turn otherwise"), "{told}");
}

#[test]
fn a_ball_does_not_tell_how_it_turns_and_three_views_are_too_few() {
    let poses = orbit(12, &[0.6]);
    let ball = shapes::sphere(&CENTER, 80.0, 60);
    let clouds = views(ball, &poses[..5], 0.0);
    let error = calibrate(&clouds, &TurntableOptions::default(), &Silent).unwrap_err();
    assert!(matches!(error, TurntableError::Still { .. }), "{error}");
    let clouds = views(part(), &poses[..3], 0.0);
    let error = calibrate(&clouds, &TurntableOptions::default(), &Silent).unwrap_err();
    assert!(matches!(error, TurntableError::TooFewViews { n_pairs: 2, least: 3 }), "{error}");
    assert!(error.to_string().contains("give its axis in a file"));
}
