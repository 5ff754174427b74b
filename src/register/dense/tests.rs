use super::*;
use crate::geom::{Point3, Vector3};
use crate::rgbd::simulated::{BuiltinScene, Noise, NoiseKind, SimulatedSensor};
use crate::rgbd::{Camera, Image, RgbdFrame, StampedPose};
use nalgebra::UnitQuaternion;

fn camera() -> Camera {
    Camera::pinhole([320, 240], [262.0, 262.0], [159.5, 119.5])
}

fn options() -> DenseOptions {
    DenseOptions { levels: 3, ..DenseOptions::default() }
}

/// What a camera in `world_from_camera` sees of the plane `normal . x = distance`, painted in waves.
fn plane(world_from_camera: &Pose, light: [f64; 2]) -> RgbdFrame {
    let (normal, distance) = (Vector3::new(0.3, -0.2, 1.0), 1000.0);
    let camera = camera();
    let eye = world_from_camera.translation.vector;
    let mut depth = Image::filled(camera.width, camera.height, 0.0_f32);
    let mut color = Image::filled(camera.width, camera.height, [0_u8; 3]);
    for y in 0..camera.height {
        for x in 0..camera.width {
            let ray = camera.unproject([x as f64, y as f64], 1.0).coords;
            let ray = world_from_camera.rotation * ray;
            let along = (distance - normal.dot(&eye)) / normal.dot(&ray);
            let place = eye + ray * along;
            let waves = (place.x / 31.0).sin() * (place.y / 43.0).cos()
                + (place.x / 83.0 + place.y / 61.0).sin();
            let bright = light[0] * (120.0 + 45.0 * waves) + light[1];
            depth[(x, y)] = along as f32;
            color[(x, y)] = [bright.round().clamp(0.0, 255.0) as u8; 3];
        }
    }
    RgbdFrame { stamp: 0.0, color: Some(color), depth, confidence: None }
}

fn pyramid(frame: &RgbdFrame) -> Pyramid {
    Pyramid::new(frame, &camera(), &options()).unwrap()
}

fn moved() -> Pose {
    Pose::new(Vector3::new(14.0, -9.0, 21.0), Vector3::new(0.012, -0.021, 0.03))
}

/// How far `motion` is from the truth: turn [rad], shift [mm].
fn off(motion: &DenseMotion, next_from_reference: &Pose) -> [f64; 2] {
    let off = next_from_reference.inverse() * motion.next_from_reference;
    [off.rotation.angle(), off.translation.vector.norm()]
}

#[test]
fn a_painted_plane_moved_by_a_known_motion_is_found() {
    let reference = pyramid(&plane(&Pose::identity(), [1.0, 0.0]));
    let next = pyramid(&plane(&moved(), [1.0, 0.0]));
    for residuals in [Residuals::BrightnessAndDepth, Residuals::Brightness] {
        let options = DenseOptions { residuals, ..options() };
        let motion = align_frames(&reference, &next, &Pose::identity(), &options).unwrap();
        assert_eq!(motion.verdict, Verdict::Ok, "{:?}", motion.reasons);
        // A metre away a pixel is 4 mm; brightness is rounded to 1/255.
        let [turn, shift] = off(&motion, &moved().inverse());
        assert!(turn < 1e-4 && shift < 0.15, "{residuals:?}: {turn} rad, {shift} mm");
        assert_eq!(motion.depth_sigma.is_some(), residuals == Residuals::BrightnessAndDepth);
    }
}

#[test]
fn a_darker_picture_is_the_same_picture_where_light_is_corrected() {
    let reference = pyramid(&plane(&Pose::identity(), [1.0, 0.0]));
    let next = pyramid(&plane(&moved(), [0.8, 12.0]));
    let motion = align_frames(&reference, &next, &Pose::identity(), &options()).unwrap();
    let [turn, shift] = off(&motion, &moved().inverse());
    assert!(turn < 2e-4 && shift < 0.3, "{turn} rad, {shift} mm");
    assert!((motion.light[0] - 1.25).abs() < 0.01, "{:?}", motion.light);
    assert!((motion.light[1] + 1.25 * 12.0 / 255.0).abs() < 0.01, "{:?}", motion.light);
    let options = DenseOptions { light: Light::Constant, ..options() };
    let motion = align_frames(&reference, &next, &Pose::identity(), &options).unwrap();
    assert_eq!(motion.light, [1.0, 0.0]);
}

#[test]
fn a_motion_that_is_expected_surely_is_kept() {
    let reference = pyramid(&plane(&Pose::identity(), [1.0, 0.0]));
    let next = pyramid(&plane(&moved(), [1.0, 0.0]));
    let expected = Pose::translation(1.0, 0.0, 0.0);
    let sure = DenseOptions {
        prior_turn_deg: Some(1e-5),
        prior_shift: Some(1e-5),
        search: Search::Never,
        ..options()
    };
    let motion = align_frames(&reference, &next, &expected, &sure).unwrap();
    let [turn, shift] = off(&motion, &expected);
    assert!(turn < 1e-4 && shift < 0.05, "{turn} {shift}");
}

/// A frame of a scene, from `eye` towards its middle, turned aside.
fn seen(scene: BuiltinScene, eye: Point3, aside_deg: f64, number: usize) -> RgbdFrame {
    let noise = Noise { kind: NoiseKind::Kinect, sigma: 1.0, seed: 3 };
    let sensor = SimulatedSensor { camera: camera(), noise };
    sensor.expose(&scene.build(), &pose(eye, aside_deg, number), number)
}

fn pose(eye: Point3, aside_deg: f64, number: usize) -> StampedPose {
    // Camera z along world Y, y down along -Z.
    let front = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), -std::f64::consts::FRAC_PI_2);
    let aside = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), aside_deg.to_radians());
    let world_from_camera = Pose::from_parts(eye.coords.into(), aside * front);
    StampedPose { stamp: number as f64 / 30.0, world_from_camera }
}

fn between(eyes: [Point3; 2], asides_deg: [f64; 2]) -> (DenseMotion, Pose) {
    let frame = |k: usize| seen(BuiltinScene::TexturedStructured, eyes[k], asides_deg[k], k);
    let place = |k: usize| pose(eyes[k], asides_deg[k], k).world_from_camera;
    let frames = [pyramid(&frame(0)), pyramid(&frame(1))];
    let motion = align_frames(&frames[0], &frames[1], &Pose::identity(), &options()).unwrap();
    (motion, place(1).inverse() * place(0))
}

#[test]
fn a_turn_far_beyond_what_a_descent_reaches_is_searched_for() {
    let eyes = [Point3::new(0.0, -1500.0, 0.0), Point3::new(20.0, -1490.0, 10.0)];
    let (motion, truth) = between(eyes, [0.0, 17.0]);
    assert_eq!(motion.verdict, Verdict::Ok, "{:?}", motion.reasons);
    let [turn, shift] = off(&motion, &truth);
    // Noise of depth is 3.5 mm a pixel there.
    assert!(turn < 0.002 && shift < 4.0, "{turn} rad, {shift} mm");
}

#[test]
fn frames_that_share_nothing_are_refused() {
    let eyes = [Point3::new(0.0, -1500.0, 0.0); 2];
    let (motion, _) = between(eyes, [-45.0, 45.0]);
    assert_eq!(motion.verdict, Verdict::Failed, "{:?}", motion.reasons);
}

#[test]
fn a_bare_wall_is_refused_and_what_it_lets_pass_is_named() {
    let frame = |x: f64, number: usize| {
        pyramid(&seen(BuiltinScene::PlainFlat, Point3::new(x, -1500.0, 0.0), 0.0, number))
    };
    let motion = align_frames(&frame(0.0, 0), &frame(30.0, 1), &Pose::identity(), &options());
    let motion = motion.unwrap();
    assert_eq!(motion.verdict, Verdict::Failed, "{:?}", motion.reasons);
    let words: Vec<String> = motion.reasons.iter().map(ToString::to_string).collect();
    assert!(
        words.iter().any(|words| words.contains("sliding along x, sliding along y")),
        "{words:?}"
    );
    assert!(motion.reasons.iter().all(|reason| !matches!(reason, DenseReason::Unlike { .. })));
}

#[test]
fn the_motion_has_the_same_bits_for_any_number_of_threads() {
    let with_threads = |n_threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads).build().unwrap();
        let eyes = [Point3::new(0.0, -1500.0, 0.0), Point3::new(20.0, -1490.0, 10.0)];
        pool.install(|| between(eyes, [0.0, 15.0]).0)
    };
    assert_eq!(with_threads(1), with_threads(2));
}

#[test]
fn frames_that_cannot_be_compared_are_told() {
    let frame = plane(&Pose::identity(), [1.0, 0.0]);
    let good = pyramid(&frame);
    let no_colour = RgbdFrame { color: None, ..frame.clone() };
    let error = Pyramid::new(&no_colour, &camera(), &options()).unwrap_err();
    assert!(error.to_string().starts_with("the frame has no colour picture"), "{error}");
    let deep = DenseOptions { levels: 6, ..options() };
    let error = Pyramid::new(&frame, &camera(), &deep).unwrap_err().to_string();
    assert!(error.starts_with("pictures of 320 x 240 cannot be halved to 6 levels"), "{error}");
    let nowhere = Pose::translation(f64::NAN, 0.0, 0.0);
    let error = align_frames(&good, &good, &nowhere, &options()).unwrap_err();
    assert!(matches!(error, DenseError::Start));
    let other = Camera { fx: 300.0, ..camera() };
    let other = Pyramid::new(&frame, &other, &options()).unwrap();
    let error = align_frames(&good, &other, &Pose::identity(), &options()).unwrap_err();
    assert!(matches!(error, DenseError::Cameras));
}
