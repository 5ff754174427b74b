//! Simulated walks, whose truth is exact.

use super::*;
use crate::geom::Vector3;
use crate::progress::Silent;
use crate::register::icp::Verdict;
use crate::register::odometry::{FrameRole, Method, OdometryOptions};
use crate::rgbd::Image;
use crate::rgbd::simulated::{BuiltinScene, NoiseKind, Orbit, SimulationOptions};
use crate::workflow::simulate_scan::{SimulateScanJob, SimulatedScan, Subject, simulate_scan};

/// Half as fine as a Kinect.
const CAMERA: Camera = Camera::pinhole([320, 240], [262.5, 262.5], [159.5, 119.5]);

fn walk(scene: BuiltinScene, noise: NoiseKind) -> SimulatedScan {
    let options = SimulationOptions { views: 8, span: 12.0, noise, ..SimulationOptions::default() };
    let subject = Subject::Scene(scene);
    simulate_scan(SimulateScanJob { subject, camera: CAMERA, along: None, options: &options })
        .unwrap()
}

fn options(method: Method) -> ScanOptions {
    let odometry = OdometryOptions { method, ..OdometryOptions::default() };
    ScanOptions { voxel: Some(10.0), odometry, ..ScanOptions::default() }
}

fn scanned(
    walk: &SimulatedScan,
    options: &ScanOptions,
    change: impl Fn(usize, RgbdFrame) -> Result<RgbdFrame, SequenceError>,
) -> Result<Scanned, ScanError> {
    let job = ScanJob {
        name: "walk".into(),
        camera: CAMERA,
        stamps: walk.truth.stamps(),
        truth: Some(&walk.truth),
        notes: Vec::new(),
        options,
    };
    scan(|| walk.frames().enumerate().map(|(i, frame)| change(i, frame)), &job, &Silent)
}

#[test]
fn every_method_follows_a_camera_before_texture_and_structure() {
    let walk = walk(BuiltinScene::TexturedStructured, NoiseKind::Kinect);
    for method in [Method::Dvo, Method::Visual, Method::VisualIcp, Method::RgbdIcp, Method::Icp] {
        let found = scanned(&walk, &options(method), |_, frame| Ok(frame)).unwrap();
        let report = &found.report;
        assert_eq!(report.counts.skipped, 0, "{method:?}: {:?}", report.reasons());
        let off = report.against_truth.as_ref().unwrap();
        // The camera goes 300 mm at 1.5 m, where a pixel is 6 mm and the depth is off by as much.
        assert!(off.ate_mm.rmse < 8.0, "{method:?}: {} mm", off.ate_mm.rmse);
        assert!(found.cloud.points.len() > 1000);
        assert_eq!(found.cloud.normals.as_ref().unwrap().len(), found.cloud.points.len());
        assert!(found.cloud.colors.is_some());
    }
}

#[test]
fn features_follow_where_surfaces_cannot_and_surfaces_where_features_cannot() {
    let flat = walk(BuiltinScene::TexturedFlat, NoiseKind::None);
    for method in [Method::Visual, Method::RgbdIcp] {
        let found = scanned(&flat, &options(method), |_, frame| Ok(frame)).unwrap();
        assert_eq!(found.report.counts.skipped, 0, "{method:?}: {:?}", found.report.reasons());
        let off = found.report.against_truth.unwrap().ate_mm.rmse;
        assert!(off < 10.0, "{method:?}: {off} mm");
    }
    let failed = scanned(&flat, &options(Method::Icp), |_, frame| Ok(frame)).unwrap();
    assert_eq!(failed.report.verdict, Verdict::Failed);
    assert!(failed.report.reasons()[0].0.contains("degenerate"), "{:?}", failed.report.reasons());
    let plain = walk(BuiltinScene::PlainStructured, NoiseKind::None);
    for method in [Method::Icp, Method::RgbdIcp] {
        let found = scanned(&plain, &options(method), |_, frame| Ok(frame)).unwrap();
        assert_eq!(found.report.counts.skipped, 0, "{method:?}: {:?}", found.report.reasons());
    }
}

#[test]
fn a_bare_wall_is_refused_by_every_method() {
    let bare = walk(BuiltinScene::PlainFlat, NoiseKind::Kinect);
    for method in [Method::Dvo, Method::Visual, Method::VisualIcp, Method::RgbdIcp, Method::Icp] {
        let found = scanned(&bare, &options(method), |_, frame| Ok(frame)).unwrap();
        assert_eq!(found.report.verdict, Verdict::Failed, "{method:?}");
        assert_eq!(found.report.counts.skipped, 7, "all but the first");
        assert!(found.report.frames[1..].iter().all(|frame| !frame.reasons.is_empty()));
    }
}

#[test]
fn frames_that_hold_nothing_are_skipped_and_the_rest_is_followed() {
    let walk = walk(BuiltinScene::TexturedStructured, NoiseKind::None);
    let found = scanned(&walk, &options(Method::Visual), |i, frame| match i {
        2 => {
            let depth = Image::filled(CAMERA.width, CAMERA.height, 0.0);
            Ok(RgbdFrame { depth, ..frame })
        }
        3 => Err(SequenceError { number: 4, problem: "depth/4.png: not found".into() }),
        4 => Ok(RgbdFrame { depth: frame.depth.map(|depth| depth / 1000.0), ..frame }),
        _ => Ok(frame),
    });
    let found = found.unwrap();
    let roles: Vec<bool> =
        found.report.frames.iter().map(|frame| frame.role == FrameRole::Skipped).collect();
    assert_eq!(roles, [false, false, true, true, true, false, false, false]);
    let told = |i: usize| found.report.frames[i].reasons.concat();
    assert!(told(2).contains("no pixel has a depth"), "{}", told(2));
    assert!(told(3).contains("frame 4: depth/4.png"), "{}", told(3));
    assert!(told(4).contains("depth scale"), "{}", told(4));
    assert_eq!(found.report.verdict, Verdict::Doubtful);
    assert_eq!(found.trajectory.poses().len(), 5);
    assert!(found.report.against_truth.unwrap().ate_mm.rmse < 8.0);
}

/// Along an arc and back beside it: what is seen at the end was seen at the beginning.
#[test]
fn a_walk_that_comes_back_is_closed_and_gathered_again() {
    let orbit = Orbit { center: Point3::origin(), axis: Vector3::z(), distance: 1500.0 };
    let (there, back) = (orbit.hand_held(9, 0.5, 5), orbit.hand_held(9, 0.5, 9));
    let poses = there.iter().chain(back.iter().rev()).enumerate();
    let along = poses.map(|(i, pose)| StampedPose { stamp: i as f64 / 10.0, ..*pose }).collect();
    let simulated = SimulationOptions { noise: NoiseKind::Kinect, ..SimulationOptions::default() };
    let walk = simulate_scan(SimulateScanJob {
        subject: Subject::Scene(BuiltinScene::TexturedStructured),
        camera: CAMERA,
        along: Some(CameraTrajectory::new(along).unwrap()),
        options: &simulated,
    });
    let walk = walk.unwrap();
    // Every frame a key frame, as on a longer walk.
    let mut options = options(Method::Dvo);
    options.odometry.key_overlap = 1.0;
    let found = scanned(&walk, &options, |_, frame| Ok(frame)).unwrap();
    let loops = found.report.loops.as_ref().unwrap();
    assert!(loops.n_closed >= 2, "{:?}", loops.tried);
    let (before, after) = (found.report.ate_before_loops_mm, found.report.against_truth.unwrap());
    assert!(after.ate_mm.rmse < before.unwrap().max(1.0), "{before:?} {}", after.ate_mm.rmse);
    assert!(found.report.frames.iter().all(|frame| frame.off.is_some_and(|off| off < 10.0)));
    options.loops.no_loops = true;
    let without = scanned(&walk, &options, |_, frame| Ok(frame)).unwrap();
    assert_eq!((without.report.loops, without.report.ate_before_loops_mm), (None, None));
    // The same surface, gathered at poses that hardly differ.
    let [n, n_without] = [found.cloud.points.len(), without.cloud.points.len()].map(|n| n as f64);
    assert!((n / n_without - 1.0).abs() < 0.1, "{n} {n_without}");
}

#[test]
fn any_number_of_threads_makes_the_same_scan() {
    let walk = walk(BuiltinScene::TexturedStructured, NoiseKind::Kinect);
    let make = |n_threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads).build().unwrap();
        pool.install(|| scanned(&walk, &options(Method::Visual), |_, frame| Ok(frame)).unwrap())
    };
    assert_eq!(make(1), make(3));
}

#[test]
fn numbers_that_mean_nothing_are_refused_by_flag() {
    let walk = walk(BuiltinScene::PlainFlat, NoiseKind::None);
    let bad = ScanOptions { voxel: Some(-1.0), ..options(Method::Visual) };
    let error = scanned(&walk, &bad, |_, frame| Ok(frame)).unwrap_err().to_string();
    assert!(error.starts_with("--voxel is -1"), "{error}");
    let mut bad = options(Method::Visual);
    bad.filter.outlier_neighbours = 0;
    let error = scanned(&walk, &bad, |_, frame| Ok(frame)).unwrap_err().to_string();
    assert!(error.starts_with("--outlier-neighbours is 0"), "{error}");
}

#[test]
fn motions_that_add_up_to_much_are_doubtful_unless_a_loop_holds_them() {
    let frame = |open: f64| FrameReport {
        stamp: open,
        verdict: Verdict::Ok,
        role: FrameRole::Placed,
        reasons: Vec::new(),
        overlap: None,
        open: Some(open),
        off: None,
    };
    let report = |open: f64| {
        let frames = vec![frame(0.0), frame(open), frame(open / 2.0)];
        ScanReport::new("walk".into(), &options(Method::Visual), frames, Vec::new())
    };
    let mut little = report(11.0);
    little.doubt_drift(600.0);
    assert_eq!((little.verdict, little.drift, little.doubts.len()), (Verdict::Ok, 11.0, 0));
    let mut much = report(21.0);
    much.doubt_drift(600.0);
    assert_eq!((much.verdict, much.drift), (Verdict::Doubtful, 21.0));
    assert!(much.doubts[0].contains("may be 21 mm astray, 3.5 %"), "{:?}", much.doubts);
    let mut held = report(21.0);
    let (n_closed, n_dropped, n_refused, moved) = (1, 0, 0, 3.0);
    held.loops = Some(LoopsReport { n_closed, n_dropped, n_refused, moved, tried: Vec::new() });
    held.doubt_drift(600.0);
    assert_eq!((held.verdict, held.drift, held.doubts.len()), (Verdict::Ok, 21.0, 0));
}
