//! Known motions undone, and scenes that no motion can be told of.

use super::*;
use crate::geom::{Point3, shapes};
use crate::progress::{Cancelled, Silent};
use std::sync::atomic::{AtomicU32, Ordering};

/// A bumpy sheet of `n` points, 60 by 40 mm, brighter and darker in waves; the same every time.
pub(super) fn relief(n: u32) -> PointCloud {
    let place = |i: u32| {
        let (u, v) = ((f64::from(i) * 0.618_034).fract(), (f64::from(i) * 0.754_878).fract());
        let bump =
            |x: f64, y: f64, r: f64| (-((u - x).powi(2) + (v - y).powi(2)) / r.powi(2)).exp();
        let height = 9.0 * bump(0.3, 0.4, 0.2) - 7.0 * bump(0.75, 0.7, 0.15)
            + 5.0 * bump(0.8, 0.2, 0.12)
            + 3.0 * (2.1 * u + 1.3 * v * v).sin();
        Point3::new(60.0 * u, 40.0 * v, height)
    };
    let points: Vec<Point3> = (0..n).map(place).collect();
    let shade = |p: &Point3| (128.0 + 100.0 * (0.4 * p.x).sin() * (0.3 * p.y).cos()) as u8;
    let colors = points.iter().map(|p| [shade(p); 3]).collect();
    PointCloud { points, normals: None, colors: Some(colors) }
}

pub(super) fn options(voxel: f64) -> ViewOptions {
    ViewOptions { voxel, neighbours: 12, with_colours: false, with_borders: false, camera: None }
}

fn moved(cloud: &PointCloud, pose: &Pose) -> PointCloud {
    let points = cloud.points.iter().map(|point| pose * point).collect();
    let normals = cloud.normals.as_ref().map(|n| n.iter().map(|n| pose.rotation * n).collect());
    PointCloud { points, normals, colors: cloud.colors.clone() }
}

/// About the middle of the relief.
fn small_motion() -> Pose {
    let middle = Pose::translation(30.0, 20.0, 0.0);
    middle
        * Pose::new(Vector3::new(0.5, -0.8, 0.6), Vector3::new(0.02, -0.03, 0.04))
        * middle.inverse()
}

/// Voxels so small that every point keeps its own: copies stay exact.
fn exact() -> IcpOptions {
    IcpOptions {
        voxel: Some(0.01),
        max_distance: Some(5.0),
        final_distance: Some(3.0),
        translation_eps: Some(1e-12),
        rotation_eps_deg: 1e-10,
        ..IcpOptions::default()
    }
}

/// How far the points end from where they should, at most [mm].
fn error(found: &Pose, expected: &Pose, cloud: &PointCloud) -> f64 {
    cloud.points.iter().map(|p| (found * p - expected * p).norm()).fold(0.0, f64::max)
}

fn run(source: &PointCloud, target: &PointCloud, options: &IcpOptions) -> Alignment {
    align(source, target, &Pose::identity(), options, &Silent).unwrap()
}

fn told(alignment: &Alignment) -> String {
    let reasons: Vec<String> = alignment.reasons.iter().map(ToString::to_string).collect();
    format!("{}: {}", alignment.verdict, reasons.join("; "))
}

#[test]
fn every_metric_undoes_a_known_motion_of_an_exact_copy() {
    let source = relief(3000);
    let truth = small_motion();
    let target = moved(&source, &truth);
    for metric in [
        Metric::PointToPoint,
        Metric::PointToPlane,
        Metric::Symmetric,
        Metric::Generalised,
        Metric::Coloured,
    ] {
        let found = run(&source, &target, &IcpOptions { fine: Some(metric), ..exact() });
        let off = error(&found.target_from_source, &truth, &source);
        // Through a centroid and back, coordinates of 60 mm: some 1e-14 mm; the eigenvectors of
        // both clouds' normals differ by 1e-8.
        assert!(off < 1e-9, "{metric:?}: {off:e} mm, {}", told(&found));
        assert_eq!(found.verdict, Verdict::Ok, "{metric:?}: {}", told(&found));
        assert!(found.rms < 1e-9 && found.overlap == [1.0; 2]);
        assert!(found.covariance().is_some());
    }
}

#[test]
fn every_stage_still_undoes_the_motion() {
    let source = relief(3000);
    let truth = small_motion();
    let target = moved(&source, &truth);
    let plane = IcpOptions { fine: Some(Metric::PointToPlane), ..exact() };
    for options in [
        IcpOptions { sampling: Sampling::Uniform, samples: 700, ..plane.clone() },
        IcpOptions { sampling: Sampling::Random, samples: 700, ..plane.clone() },
        IcpOptions { sampling: Sampling::NormalSpace, samples: 700, ..plane.clone() },
        IcpOptions { reject_sigma: Some(2.5), ..plane.clone() },
        IcpOptions { reject_worst: Some(20.0), ..plane.clone() },
        IcpOptions { reject_angle: Some(30.0), ..plane.clone() },
        IcpOptions { bi_unique: true, ..plane.clone() },
        IcpOptions { reject_borders: true, ..plane.clone() },
        IcpOptions { weighting: Weighting::Distance, ..plane.clone() },
        IcpOptions { weighting: Weighting::Normals, ..plane.clone() },
        IcpOptions { weighting: Weighting::SensorNoise, ..plane.clone() },
        IcpOptions { kernel: Kernel::Huber, ..plane.clone() },
        IcpOptions { kernel: Kernel::Tukey, ..plane.clone() },
        IcpOptions { kernel: Kernel::Cauchy, ..plane.clone() },
        IcpOptions { kernel: Kernel::GemanMcclure, ..plane.clone() },
        IcpOptions { levels: 1, ..plane.clone() },
    ] {
        let found = run(&source, &target, &options);
        let off = error(&found.target_from_source, &truth, &source);
        assert!(off < 1e-9, "{options:?}: {off:e} mm, {}", told(&found));
    }
    // The map looks three voxels far: one of a millimetre keeps the copy only roughly.
    let map = IcpOptions { pairing: Pairing::VoxelMap, voxel: Some(1.0), ..plane };
    let found = run(&source, &target, &map);
    assert!(error(&found.target_from_source, &truth, &source) < 0.1, "{}", told(&found));
}

#[test]
fn clouds_in_metres_or_a_kilometre_away_give_the_same_pose() {
    let source = relief(4000);
    let target = moved(&relief(3700), &small_motion());
    let options = IcpOptions { voxel: Some(0.8), ..IcpOptions::default() };
    let here = run(&source, &target, &options).target_from_source;
    let metres = |cloud: &PointCloud| PointCloud {
        points: cloud.points.iter().map(|p| p / 1000.0).collect(),
        ..cloud.clone()
    };
    let small = IcpOptions { voxel: Some(0.0008), ..options.clone() };
    let in_metres = run(&metres(&source), &metres(&target), &small).target_from_source;
    let away = Pose::translation(1e6, -4e5, 2e5);
    let shifted =
        align(&moved(&source, &away), &moved(&target, &away), &Pose::identity(), &options, &Silent);
    let shifted = away.inverse() * shifted.unwrap().target_from_source * away;
    let in_metres =
        Pose::from_parts((in_metres.translation.vector * 1000.0).into(), in_metres.rotation);
    for (name, other) in [("metres", in_metres), ("shifted", shifted)] {
        let off = error(&other, &here, &source);
        assert!(
            off < 1e-6 * 72.0 && here.rotation.angle_to(&other.rotation) < 1e-6,
            "{name}: {off:e}"
        );
    }
}

#[test]
fn the_pose_has_the_same_bits_for_any_number_of_threads() {
    let (source, target) = (relief(6000), moved(&relief(5500), &small_motion()));
    let robust = IcpOptions {
        voxel: Some(0.6),
        kernel: Kernel::Tukey,
        sampling: Sampling::Random,
        samples: 2500,
        bi_unique: true,
        ..IcpOptions::default()
    };
    let on = |n: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap();
        pool.install(|| run(&source, &target, &robust))
    };
    let one = on(1);
    assert_eq!(one, on(2));
    assert_eq!(one, on(3));
}

/// A grid in the plane z = 0, jittered so that no shift fits by chance.
fn plane() -> PointCloud {
    let points = relief(3000).points.iter().map(|p| Point3::new(p.x, p.y, 0.0)).collect();
    PointCloud { points, ..PointCloud::default() }
}

#[test]
fn a_plane_slides_two_ways_and_turns_about_its_normal() {
    for options in [exact(), IcpOptions { voxel: Some(0.8), ..IcpOptions::default() }] {
        for metric in [Metric::PointToPlane, Metric::Generalised, Metric::PointToPoint] {
            let options = IcpOptions { fine: Some(metric), ..options.clone() };
            let found =
                run(&plane(), &moved(&plane(), &Pose::translation(0.2, 0.1, 0.4)), &options);
            assert_eq!(
                told(&found),
                "failed: degenerate: the surfaces allow sliding along x, sliding along y, turning about z",
                "{metric:?}"
            );
            assert!(found.covariance().is_none());
            assert!((found.target_from_source * Point3::new(30.0, 20.0, 0.0)).z - 0.4 < 1e-3);
        }
    }
}

#[test]
fn a_tube_slides_and_turns_along_its_axis_and_a_ball_turns_any_way() {
    let tube = shapes::cylinder_points(12.0, 60.0, 60, 80);
    let options = IcpOptions { voxel: Some(0.6), ..IcpOptions::default() };
    let found = run(&tube, &tube, &options);
    assert_eq!(
        told(&found),
        "failed: degenerate: the surfaces allow sliding along x, turning about x"
    );
    let center = Point3::new(5.0, -3.0, 8.0);
    let ball =
        PointCloud { points: shapes::sphere(&center, 20.0, 60).points, ..PointCloud::default() };
    let found = run(&ball, &ball, &options);
    assert_eq!(
        told(&found),
        "failed: degenerate: the surfaces allow turning about x, turning about y, turning about z"
    );
    let Reason::Free(motions) = &found.reasons[0] else { panic!() };
    assert!(motions.iter().all(|motion| (motion.through - center).norm() < 0.5), "{motions:?}");
}

#[test]
fn clouds_that_do_not_meet_are_failed_with_the_reason() {
    let (here, options) = (relief(2000), IcpOptions { voxel: Some(1.0), ..IcpOptions::default() });
    let away = moved(&here, &Pose::translation(500.0, 0.0, 0.0));
    let found = run(&here, &away, &options);
    assert!(told(&found).starts_with("failed: start beyond reach"), "{}", told(&found));
    assert!(error(&found.target_from_source, &Pose::identity(), &here) < 1e-12);
    // Side by side, touching along one edge.
    let beside = moved(&here, &Pose::translation(58.5, 0.0, 0.0));
    let found = run(&here, &beside, &options);
    assert_ne!(found.verdict, Verdict::Ok, "{}", told(&found));
}

#[test]
fn a_mirror_image_is_not_ok() {
    let source = relief(4000);
    let mirrored = PointCloud {
        points: source.points.iter().map(|p| Point3::new(60.0 - p.x, p.y, p.z)).collect(),
        normals: None,
        colors: None,
    };
    let found = run(&source, &mirrored, &IcpOptions { voxel: Some(0.8), ..IcpOptions::default() });
    assert_ne!(found.verdict, Verdict::Ok, "{}", told(&found));
}

#[test]
fn too_few_iterations_are_told() {
    let options = IcpOptions { iterations: 1, levels: 1, ..exact() };
    let target = moved(&relief(2000), &small_motion());
    let found = run(&relief(2000), &target, &options);
    assert!(told(&found).contains("not converged: the last step turned"), "{}", told(&found));
}

#[test]
fn wrong_numbers_are_refused_before_any_work() {
    let cloud = relief(100);
    let wrong = IcpOptions { voxel: Some(-1.0), ..IcpOptions::default() };
    let error = align(&cloud, &cloud, &Pose::identity(), &wrong, &Silent).unwrap_err();
    assert!(error.to_string().starts_with("--voxel is -1"), "{error}");
    let nowhere = Pose::translation(f64::NAN, 0.0, 0.0);
    let error = align(&cloud, &cloud, &nowhere, &IcpOptions::default(), &Silent).unwrap_err();
    assert_eq!(error, IcpError::Start);
}

/// Asks to stop at the n-th chance.
struct StopAfter(AtomicU32);

impl Progress for StopAfter {
    fn start(&self, _: &str, _: u64) {}

    fn advance(&self, _: u64) -> Result<(), Cancelled> {
        let left = self.0.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |n| n.checked_sub(1));
        left.map(drop).map_err(|_| Cancelled)
    }
}

#[test]
fn pairing_by_the_picture_asks_for_a_camera() {
    let options = IcpOptions { pairing: Pairing::Projective, ..IcpOptions::default() };
    let cloud = relief(500);
    let error = align(&cloud, &cloud, &Pose::identity(), &options, &Silent).unwrap_err();
    assert_eq!(error, IcpError::NoCamera { role: Role::Source });
}

#[test]
fn swapped_clouds_give_the_inverse_for_every_metric() {
    let (source, target) = (relief(4000), moved(&relief(3600), &small_motion()));
    for metric in [Metric::PointToPlane, Metric::Symmetric, Metric::Generalised] {
        let options =
            IcpOptions { fine: Some(metric), kernel: Kernel::Tukey, voxel: Some(0.8), ..exact() };
        let there = run(&source, &target, &options).target_from_source;
        let back = run(&target, &source, &options).target_from_source.inverse();
        let off = error(&there, &back, &source);
        assert!(off < 1e-3, "{metric:?}: {off} mm");
    }
}

#[test]
fn it_stops_when_asked_wherever_it_is() {
    let (source, target) = (relief(3000), moved(&relief(3000), &small_motion()));
    let mut n_chances = 0;
    loop {
        let stop = StopAfter(AtomicU32::new(n_chances));
        match align(&source, &target, &Pose::identity(), &exact(), &stop) {
            Err(error) => assert_eq!(error, IcpError::Cancelled(Cancelled)),
            Ok(_) => break,
        }
        n_chances += 1;
    }
    // Chunks of normals on both sides, and every iteration.
    assert!(n_chances > 15, "{n_chances}");
}
