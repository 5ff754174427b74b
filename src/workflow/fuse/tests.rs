use super::*;
use crate::geom::{Point3, Vector3, shapes};
use crate::progress::Silent;
use crate::rgbd::Image;
use crate::rgbd::simulated::{Noise, Orbit, Scene, SimulatedSensor, Texture};

fn camera() -> Camera {
    Camera::pinhole([160, 120], [131.0, 131.0], [79.5, 59.5])
}

/// A ball on a turntable, its frames and their poses.
fn turntable() -> (Vec<RgbdFrame>, CameraTrajectory) {
    let scene = Scene::new(shapes::sphere(&Point3::origin(), 100.0, 60), Texture::default());
    let orbit = Orbit { center: Point3::origin(), axis: Vector3::z(), distance: 500.0 };
    let truth = CameraTrajectory::new(orbit.turntable(10, &[0.7, -0.7])).unwrap();
    let sensor = SimulatedSensor { camera: camera(), noise: Noise::default() };
    (sensor.frames(&scene, &truth).collect(), truth)
}

fn options() -> FuseOptions {
    let mut options = FuseOptions::default();
    options.volume.voxel = 6.0;
    options
}

fn run(
    frames: Vec<RgbdFrame>,
    placing: Placing,
    options: &FuseOptions,
) -> Result<Fused, FuseError> {
    let stamps = frames.iter().map(|frame| frame.stamp).collect();
    let frames: Vec<Result<_, SequenceError>> = frames.into_iter().map(Ok).collect();
    let (frames, notes) = (frames.into_iter(), Vec::new());
    let (camera, truth) = (camera(), None);
    fuse(FuseJob { frames, stamps, camera, placing, truth, notes, options }, &Silent)
}

#[test]
fn a_turntable_becomes_a_closed_surface_and_frames_kept_out_lie_on_it() {
    let (frames, truth) = turntable();
    let options = FuseOptions { keep_out: Some(5), ..options() };
    let fused = run(frames, Placing::Along(truth), &options).unwrap();
    let report = &fused.report;
    assert_eq!((report.n_frames, report.n_fused, report.tracked), (20, 16, false));
    assert!(report.mesh.is_closed && report.mesh.n_pieces == 1, "{:?}", report.mesh);
    assert_eq!(fused.trajectory.poses().len(), 16);
    let kept_out = report.kept_out.unwrap();
    assert_eq!(kept_out.n_frames, 4);
    assert!(kept_out.n_points > 400 && kept_out.median < 0.3, "{kept_out:?}");
    assert!(kept_out.share_within_voxel > 0.95 && kept_out.rmse_within_50 < 2.0, "{kept_out:?}");
}

#[test]
fn frames_without_pose_or_depth_are_skipped_and_told() {
    let (mut frames, truth) = turntable();
    let holes = truth.poses().iter().copied().filter(|pose| !(0.1..0.35).contains(&pose.stamp));
    let holes = CameraTrajectory::new(holes.collect()).unwrap();
    frames[15].depth = Image::filled(160, 120, 0.0);
    let fused = run(frames, Placing::Along(holes), &options()).unwrap();
    let skipped = &fused.report.skipped;
    let numbers: Vec<usize> = skipped.iter().map(|skipped| skipped.number).collect();
    assert_eq!(numbers, [5, 6, 7, 8, 9, 10, 16]);
    assert!(skipped[0].reason.starts_with("no pose within 0.05 s of its stamp, 0.133333"));
    assert!(skipped[6].reason.starts_with("no pixel has a depth"), "{}", skipped[6].reason);
}

#[test]
fn too_few_frames_make_no_surface_to_believe() {
    let (frames, _) = turntable();
    // A ball lets a camera turn about it.
    let error = run(frames, Placing::Tracked, &options()).unwrap_err();
    let FuseError::Lost { n_placed: 1, n_frames: 20, first: 2, reason } = &error else {
        panic!("{error}")
    };
    assert!(reason.starts_with("degenerate: what is seen allows turning"), "{reason}");
}

#[test]
fn frames_stamped_late_are_placed_where_they_were_taken() {
    let (mut frames, truth) = turntable();
    let fused = run(frames.clone(), Placing::Along(truth.clone()), &options()).unwrap();
    for frame in &mut frames {
        frame.stamp += 0.02;
    }
    let late = FuseOptions { pose_delay: 0.02, ..options() };
    let again = run(frames, Placing::Along(truth), &late).unwrap();
    assert_eq!((again.report.n_fused, again.mesh), (20, fused.mesh));
}

#[test]
fn pieces_in_the_air_are_dropped_and_counted() {
    let (mut frames, truth) = turntable();
    // A corner of one frame, 27 mm wide, sees something that no other does.
    for (x, y) in (0..144).map(|i| (i % 12, i / 12)) {
        frames[7].depth[(x, y)] = 300.0;
    }
    let all = FuseOptions { least_piece: Some(0.0), ..options() };
    let noisy = run(frames.clone(), Placing::Along(truth.clone()), &all).unwrap().report;
    assert!(noisy.mesh.n_pieces > 1 && noisy.n_small_pieces == 0, "{:?}", noisy.mesh);
    let large = FuseOptions { least_piece: Some(40.0), ..options() };
    let clean = run(frames, Placing::Along(truth), &large).unwrap().report;
    assert!(clean.mesh.is_closed && clean.mesh.n_pieces == 1, "{:?}", clean.mesh);
    assert_eq!(clean.n_small_pieces, noisy.mesh.n_pieces - 1);
}

#[test]
fn a_fusion_stops_on_request() {
    struct Stop;
    impl Progress for Stop {
        fn start(&self, _stage: &str, _n_units: u64) {}
        fn advance(&self, _n_units: u64) -> Result<(), Cancelled> {
            Err(Cancelled)
        }
    }
    let (frames, truth) = turntable();
    let job = FuseJob {
        stamps: truth.stamps(),
        frames: frames.into_iter().map(Ok).collect::<Vec<_>>().into_iter(),
        camera: camera(),
        placing: Placing::Along(truth.clone()),
        truth: None,
        notes: Vec::new(),
        options: &options(),
    };
    assert!(matches!(fuse(job, &Stop), Err(FuseError::Cancelled(Cancelled))));
}

#[test]
fn a_wrong_scale_and_senseless_options_are_refused() {
    let (mut frames, truth) = turntable();
    let along = || Placing::Along(truth.clone());
    for depth in frames[0].depth.pixels_mut() {
        *depth /= 1000.0;
    }
    let error = run(frames.clone(), along(), &options()).unwrap_err().to_string();
    assert!(error.starts_with("frame 1: half of the depths lie below"), "{error}");
    let told = |options: &FuseOptions, placing| {
        run(frames.clone(), placing, options).unwrap_err().to_string()
    };
    let one = FuseOptions { keep_out: Some(1), ..options() };
    assert!(told(&one, along()).starts_with("--keep-out is 1; it must be 2 or more"));
    let five = FuseOptions { keep_out: Some(5), ..options() };
    assert!(told(&five, Placing::Tracked).contains("--truth-poses"));
    let negative = FuseOptions { least_piece: Some(-1.0), ..options() };
    assert!(told(&negative, along()).starts_with("--least-piece is -1"));
    let days = FuseOptions { pose_delay: f64::NAN, ..options() };
    assert!(told(&days, along()).starts_with("--pose-delay is NaN; it must be from -1 to 1"));
    let mut far = options();
    far.volume.max_depth = 200.0;
    let error = told(&far, along());
    assert!(error.starts_with("frame 1: "), "the scale comes first: {error}");
    let (frames, truth) = turntable();
    let error = run(frames, Placing::Along(truth), &far).unwrap_err();
    assert!(matches!(error, FuseError::NoSurface { n_frames: 20 }), "{error}");
}
