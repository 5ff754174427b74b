use super::*;
use crate::geom::{Point3, Pose, TriMesh, Vector3, shapes, topology};
use crate::rgbd::simulated::{
    BuiltinScene, Noise, NoiseKind, Orbit, Scene, SimulatedSensor, Texture, TextureKind,
};
use crate::rgbd::{Camera, Image, RgbdFrame, StampedPose};

fn camera() -> Camera {
    Camera::pinhole([160, 120], [131.0, 131.0], [79.5, 59.5])
}

fn options(voxel: f64) -> TsdfOptions {
    TsdfOptions { voxel, ..TsdfOptions::default() }
}

fn sensor(sigma: f64) -> SimulatedSensor {
    let kind = if sigma > 0.0 { NoiseKind::Gaussian } else { NoiseKind::None };
    SimulatedSensor { camera: camera(), noise: Noise { kind, sigma, seed: 1 } }
}

fn fused(scene: &Scene, sensor: &SimulatedSensor, poses: &[StampedPose], voxel: f64) -> Volume {
    let mut volume = Volume::new(&options(voxel)).unwrap();
    for (number, pose) in poses.iter().enumerate() {
        let frame = sensor.expose(scene, pose, number);
        let readings = Readings::new(&frame, &sensor.camera, volume.options()).unwrap();
        volume.integrate(&readings, &pose.world_from_camera).unwrap();
    }
    volume
}

fn ball() -> (Scene, Vec<StampedPose>) {
    let mesh = shapes::sphere(&Point3::new(5.0, -3.0, 8.0), 100.0, 90);
    let center = Point3::new(5.0, -3.0, 8.0);
    let orbit = Orbit { center, axis: Vector3::z(), distance: 500.0 };
    let scene = Scene::new(mesh, Texture { kind: TextureKind::Patches, size: 20.0, seed: 0 });
    (scene, orbit.turntable(12, &[0.7, -0.7]))
}

fn radii(mesh: &TriMesh) -> Vec<f64> {
    let center = Point3::new(5.0, -3.0, 8.0);
    let mut off: Vec<f64> =
        mesh.points.iter().map(|p| ((p - center).norm() - 100.0).abs()).collect();
    off.sort_by(f64::total_cmp);
    off
}

#[test]
fn a_ball_seen_from_all_sides_is_closed_and_round() {
    let (scene, poses) = ball();
    for (sigma, median, most) in [(0.0, 0.15, 1.5), (1.0, 0.4, 3.0)] {
        let volume = fused(&scene, &sensor(sigma), &poses, 5.0);
        let mesh = volume.mesh().unwrap();
        let report = topology(&mesh);
        assert!(report.is_closed(), "{report:?}");
        assert_eq!((report.n_non_manifold_edges, report.n_flipped_edges), (0, 0));
        assert_eq!(report.n_components, 1);
        let off = radii(&mesh);
        assert!(off[off.len() / 2] < median, "{sigma}: median {}", off[off.len() / 2]);
        assert!(off[off.len() - 1] < most, "{sigma}: most {}", off[off.len() - 1]);
        let volume = report.volume.unwrap() / (4.0 / 3.0 * std::f64::consts::PI * 1e6);
        assert!((volume - 1.0).abs() < 0.01, "{volume}");
        assert!(mesh.colors.unwrap().iter().any(|color| color[0] > 150 || color[1] > 150));
    }
}

#[test]
fn threads_change_no_bit() {
    let (scene, poses) = ball();
    let with = |n: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap();
        pool.install(|| {
            let volume = fused(&scene, &sensor(1.0), &poses[..4], 6.0);
            let view = volume.cast(&camera(), &poses[1].world_from_camera);
            let mut tracker = Tracker::new(&TrackOptions::default()).unwrap();
            tracker.begin(&poses[3].world_from_camera);
            let frame = sensor(1.0).expose(&scene, &poses[3], 77);
            let readings = Readings::new(&frame, &camera(), volume.options()).unwrap();
            let mesh = volume.mesh().unwrap();
            let placed = tracker.place(&mut Model::Cpu(volume), &readings);
            (mesh, view, placed)
        })
    };
    let (one, two) = (with(1), with(2));
    assert!(one.0 == two.0 && one.1 == two.1);
    assert_eq!(format!("{:?}", one.2), format!("{:?}", two.2));
}

/// A slanting wall: depth, and its normal and distance in the camera's frame.
fn wall() -> (RgbdFrame, Vector3, f64) {
    let normal = Vector3::new(0.2, -0.3, -1.0).normalize();
    let distance = 900.0;
    let camera = camera();
    let depth = Image::from_rows(160, 120, 0.0, |y, row| {
        for (x, z) in row.iter_mut().enumerate() {
            let [a, b] = camera.ray([x as f64, y as f64]);
            *z = (-distance / normal.dot(&Vector3::new(a, b, 1.0))) as f32;
        }
    });
    (RgbdFrame { stamp: 0.0, color: None, depth, confidence: None }, normal, distance)
}

#[test]
fn a_wall_is_found_back_and_cast_to_the_eye_again() {
    let (frame, normal, distance) = wall();
    // Far from the origin, and turned.
    let pose = Pose::new(Vector3::new(1e5, -2e5, 3e5), Vector3::new(0.4, 1.0, -0.3));
    let mut volume = Volume::new(&options(10.0)).unwrap();
    let readings = Readings::new(&frame, &camera(), volume.options()).unwrap();
    let done = volume.integrate(&readings, &pose).unwrap();
    assert!(done.n_new == done.n_touched && done.n_new == volume.n_blocks());
    let mesh = volume.mesh().unwrap();
    assert!(mesh.points.len() > 4000 && mesh.colors.is_none());
    for point in &mesh.points {
        let off = normal.dot(&(pose.inverse() * point).coords) + distance;
        // Depth is taken from the nearest pixel, 7 mm wide, by a plane of slope 0.4: but along the
        // tangent plane, not along the ray.
        assert!(off.abs() < 2.5, "{off}");
    }
    let mean: f64 =
        mesh.points.iter().map(|p| normal.dot(&(pose.inverse() * p).coords) + distance).sum();
    assert!((mean / mesh.points.len() as f64).abs() < 0.05);
    let view = volume.cast(&camera(), &pose);
    let seen: Vec<&Seen> = view.pixels.pixels().iter().filter(|seen| seen.point[2] > 0.0).collect();
    assert!(seen.len() > 140 * 100, "{}", seen.len());
    let mut tilts = Vec::new();
    for seen in seen {
        let point = Vector3::from(seen.point.map(f64::from));
        assert!((normal.dot(&point) + distance).abs() < 2.5);
        tilts.push(normal.angle(&Vector3::from(seen.normal.map(f64::from))));
    }
    tilts.sort_by(f64::total_cmp);
    // Steps of 2.5 mm over the 20 mm a normal is taken from.
    assert!(tilts[tilts.len() / 2] < 0.05 && tilts[tilts.len() - 1] < 0.25, "{:?}", tilts.last());
    // From behind there is no surface.
    let behind = pose * Pose::new(Vector3::z() * 2000.0, Vector3::y() * std::f64::consts::PI);
    let view = volume.cast(&camera(), &behind);
    assert!(view.pixels.pixels().iter().all(|seen| seen.point[2] == 0.0));
}

#[test]
fn a_frame_too_large_for_the_memory_leaves_the_model_as_it_was() {
    let (scene, poses) = ball();
    let options = TsdfOptions { voxel: 1.0, memory: 3, ..TsdfOptions::default() };
    let mut volume = Volume::new(&options).unwrap();
    let frame = sensor(0.0).expose(&scene, &poses[0], 0);
    let readings = Readings::new(&frame, &camera(), &options).unwrap();
    let error = volume.integrate(&readings, &poses[0].world_from_camera).unwrap_err();
    assert!(matches!(error, TsdfError::Memory { allowed: 3, .. }), "{error}");
    assert_eq!(volume.n_blocks(), 0);
    let far = Pose::translation(1e12, 0.0, 0.0);
    let error = volume.integrate(&readings, &far).unwrap_err().to_string();
    assert!(error.contains("is the trajectory in metres?"), "{error}");
}

#[test]
fn numbers_that_mean_nothing_are_refused() {
    for (options, flag) in [
        (options(0.0), "--voxel is 0"),
        (options(f64::NAN), "--voxel is NaN"),
        (TsdfOptions { truncation: Some(5.0), ..options(5.0) }, "--truncation is 5"),
        (TsdfOptions { max_depth: -1.0, ..options(5.0) }, "--max-depth is -1"),
        (TsdfOptions { memory: 0, ..options(5.0) }, "--memory is 0"),
    ] {
        let error = Volume::new(&options).unwrap_err().to_string();
        assert!(error.starts_with(flag), "{error}");
    }
    let usual = TrackOptions::default();
    for (options, flag) in [
        (TrackOptions { levels: 0, ..usual.clone() }, "--levels is 0"),
        (TrackOptions { least_overlap: 2.0, ..usual.clone() }, "--least-overlap is 2"),
        (TrackOptions { most_moved: 0.0, ..usual.clone() }, "--most-moved is 0"),
    ] {
        let error = Tracker::new(&options).unwrap_err().to_string();
        assert!(error.starts_with(flag), "{error}");
    }
}

/// A structured scene, a hand's walk before it, and a model of its first frames.
fn walk() -> (Scene, Vec<StampedPose>, Volume) {
    let scene = BuiltinScene::PlainStructured.build();
    let middle = scene.mesh.aabb();
    let center = Point3::from((middle.min.coords + middle.max.coords) / 2.0);
    let orbit = Orbit { center, axis: Vector3::z(), distance: 1500.0 };
    let poses = orbit.hand_held(40, 0.4, 3);
    let volume = fused(&scene, &sensor(0.0), &poses[..1], 20.0);
    (scene, poses, volume)
}

fn why_lost(found: Result<Tracked, Unplaced>) -> Lost {
    match found {
        Err(Unplaced::Lost(lost)) => lost,
        other => panic!("{other:?}"),
    }
}

#[test]
fn frames_are_placed_where_they_were_taken() {
    let (scene, poses, volume) = walk();
    let mut model = Model::Cpu(volume);
    let mut tracker = Tracker::new(&TrackOptions::default()).unwrap();
    tracker.begin(&poses[0].world_from_camera);
    for pose in &poses[1..] {
        let frame = sensor(0.0).expose_exactly(&scene, pose);
        let readings = Readings::new(&frame, &camera(), model.options()).unwrap();
        let placed = tracker.place(&mut model, &readings).unwrap();
        model.integrate(&readings, &placed.world_from_camera).unwrap();
        let off = pose.world_from_camera.inverse() * placed.world_from_camera;
        // A pixel is 11 mm wide there, a voxel 20 mm.
        assert!(off.translation.vector.norm() < 8.0, "{}", off.translation);
        assert!(off.rotation.angle() < 0.006, "{}", off.rotation.angle());
        assert!(placed.overlap > 0.5);
    }
}

#[test]
fn a_frame_that_cannot_be_placed_is_lost_with_its_reason_and_the_next_one_is_found() {
    let (scene, poses, volume) = walk();
    let options = volume.options().clone();
    let readings = |frame: &RgbdFrame| Readings::new(frame, &camera(), &options).unwrap();
    let mut model = Model::Cpu(volume);
    let mut tracker = Tracker::new(&TrackOptions::default()).unwrap();
    tracker.begin(&poses[0].world_from_camera);
    let covered = RgbdFrame { depth: Image::filled(160, 120, 0.0), ..wall().0 };
    let lost = why_lost(tracker.place(&mut model, &readings(&covered)));
    assert!(matches!(lost, Lost::NoSurface { n_pixels: 0, .. }), "{lost}");
    // A wall half as far away has nothing to do with the model.
    let near = RgbdFrame { depth: Image::filled(160, 120, 400.0), ..wall().0 };
    let lost = why_lost(tracker.place(&mut model, &readings(&near)));
    assert!(matches!(lost, Lost::TooFewPairs { .. }), "{lost}");
    let careful = TrackOptions { most_moved: 0.01, ..TrackOptions::default() };
    let mut timid = Tracker::new(&careful).unwrap();
    timid.begin(&poses[0].world_from_camera);
    let frame = sensor(0.0).expose_exactly(&scene, &poses[3]);
    let lost = why_lost(timid.place(&mut model, &readings(&frame)));
    assert!(matches!(lost, Lost::Jump { n_frames: 1, .. }), "{lost}");
    let frame = sensor(0.0).expose_exactly(&scene, &poses[1]);
    tracker.place(&mut model, &readings(&frame)).unwrap();
}

#[test]
fn a_wall_alone_lets_a_camera_slide_and_that_is_said() {
    let (frame, ..) = wall();
    let mut volume = Volume::new(&options(10.0)).unwrap();
    let readings = Readings::new(&frame, &camera(), volume.options()).unwrap();
    volume.integrate(&readings, &Pose::identity()).unwrap();
    let mut tracker = Tracker::new(&TrackOptions::default()).unwrap();
    tracker.begin(&Pose::identity());
    let lost = why_lost(tracker.place(&mut Model::Cpu(volume), &readings));
    let Lost::Free { motions } = &lost else { panic!("{lost}") };
    assert_eq!(motions.len(), 3, "{lost}");
    assert!(
        lost.to_string().starts_with("degenerate: what is seen allows sliding along"),
        "{lost}"
    );
}
