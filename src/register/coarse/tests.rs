//! Bodies found wherever they are, and bodies that no pose can be told of.

use super::*;
use crate::geom::{Aabb, Point3, Vector3, shapes};
use crate::progress::Silent;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// `n` points spread over a mesh at random.
fn scanned(mesh: &crate::geom::TriMesh, n: usize, seed: u64) -> PointCloud {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let corners = |t: &[u32; 3]| t.map(|i| mesh.points[i as usize]);
    let area = |t: &[u32; 3]| {
        let [a, b, c] = corners(t);
        (b - a).cross(&(c - a)).norm()
    };
    let mut sums: Vec<f64> = Vec::with_capacity(mesh.triangles.len());
    for t in &mesh.triangles {
        sums.push(sums.last().copied().unwrap_or(0.0) + area(t));
    }
    let total = sums.last().copied().unwrap();
    let place = |_| {
        let at = random.random_range(0.0..total);
        let i = sums.partition_point(|sum| *sum < at).min(sums.len() - 1);
        let [a, b, c] = corners(&mesh.triangles[i]);
        let (u, v) = (random.random_range(0.0..1.0), random.random_range(0.0..1.0));
        let (u, v): (f64, f64) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
        a + (b - a) * u + (c - a) * v
    };
    PointCloud { points: (0..n).map(place).collect(), ..PointCloud::default() }
}

fn moved(cloud: &PointCloud, pose: &Pose) -> PointCloud {
    let points = cloud.points.iter().map(|point| pose * point).collect();
    PointCloud { points, ..PointCloud::default() }
}

/// Far away and upside down.
fn far() -> Pose {
    Pose::new(Vector3::new(300.0, -150.0, 80.0), Vector3::new(1.9, -1.2, 0.8))
}

/// What lies on one side of a plane.
fn half(cloud: &PointCloud, side: &Vector3, beyond: f64) -> PointCloud {
    let points = cloud.points.iter().filter(|p| p.coords.dot(side) > beyond).copied().collect();
    PointCloud { points, ..PointCloud::default() }
}

fn run(source: &PointCloud, target: &PointCloud, method: Coarse) -> Found {
    let coarse = CoarseOptions { coarse: Some(method), ..CoarseOptions::default() };
    align(source, target, None, (&coarse, &IcpOptions::default()), &Silent).unwrap()
}

fn told(found: &Found) -> String {
    let reasons: Vec<String> = found.alignment.reasons.iter().map(ToString::to_string).collect();
    format!("{}: {}", found.alignment.verdict, reasons.join("; "))
}

fn off(found: &Found, truth: &Pose, cloud: &PointCloud) -> f64 {
    let pose = &found.alignment.target_from_source;
    cloud.points.iter().map(|p| (pose * p - truth * p).norm()).fold(0.0, f64::max)
}

#[test]
fn every_method_finds_a_body_that_is_upside_down_elsewhere() {
    let body = shapes::chiral(4000);
    let (source, target) = (scanned(&body, 5000, 1), moved(&scanned(&body, 4500, 2), &far()));
    for (method, from) in [
        (Coarse::FpfhRansac, StartedFrom::FpfhRansac),
        (Coarse::FpfhGnc, StartedFrom::FpfhGnc),
        (Coarse::Axes, StartedFrom::Axes),
    ] {
        let found = run(&source, &target, method);
        let off = off(&found, &far(), &source);
        assert!(off < 0.5, "{method:?}: {off} mm, {}", told(&found));
        assert_eq!(found.alignment.verdict, Verdict::Ok, "{method:?}: {}", told(&found));
        assert_eq!(found.started_from, from);
    }
    let found = run(&source, &target, Coarse::Auto);
    assert!(off(&found, &far(), &source) < 0.5, "{}", told(&found));
    // Where a start was given, it is believed: from here there is no way.
    let options = (&CoarseOptions::default(), &IcpOptions::default());
    let given = align(&source, &target, Some(&Pose::identity()), options, &Silent).unwrap();
    assert_eq!(given.alignment.verdict, Verdict::Failed, "{}", told(&given));
    assert_eq!((given.started_from, given.n_starts), (StartedFrom::Given, 1));
}

#[test]
fn two_views_that_share_half_of_the_body_are_found() {
    let body = shapes::chiral(4000);
    let side = |x: f64, y: f64| Vector3::new(x, y, 0.3).normalize();
    let source = half(&scanned(&body, 12_000, 1), &side(1.0, 0.2), -5.0);
    let target = half(&scanned(&body, 12_000, 2), &side(0.2, 1.0), -5.0);
    for method in [Coarse::FpfhRansac, Coarse::FpfhGnc] {
        let found = run(&source, &moved(&target, &far()), method);
        let off = off(&found, &far(), &source);
        assert!(off < 1.0, "{method:?}: {off} mm, {}", told(&found));
        assert!(found.support.is_some_and(|support| support.is_enough()));
    }
}

#[test]
fn the_identity_wins_where_the_files_have_it_right() {
    let body = shapes::chiral(4000);
    let (source, target) = (scanned(&body, 6000, 1), scanned(&body, 6000, 2));
    let options = IcpOptions::default();
    let found = run(&source, &target, Coarse::Auto);
    let alone = icp::align(&source, &target, &Pose::identity(), &options, &Silent).unwrap();
    assert_eq!(found.started_from, StartedFrom::Given);
    assert_eq!(found.alignment, alone);
}

#[test]
fn a_ball_a_tube_and_a_cube_are_not_ok_and_say_why() {
    let ball = scanned(&shapes::sphere(&Point3::new(5.0, -3.0, 8.0), 40.0, 60), 6000, 3);
    let found = run(&ball, &moved(&ball, &far()), Coarse::Auto);
    assert!(
        told(&found).starts_with("failed: degenerate: the surfaces allow turning"),
        "{}",
        told(&found)
    );
    let tube = shapes::cylinder_points(20.0, 90.0, 70, 90);
    let found = run(&tube, &moved(&tube, &far()), Coarse::Auto);
    assert_ne!(found.alignment.verdict, Verdict::Ok);
    assert!(told(&found).contains("degenerate"), "{}", told(&found));
    let corner = Point3::new(30.0, 30.0, 30.0);
    let cube = shapes::cuboid(&Aabb { min: -corner, max: corner });
    let (source, target) = (scanned(&cube, 6000, 4), moved(&scanned(&cube, 6000, 5), &far()));
    let found = run(&source, &target, Coarse::Auto);
    assert_eq!(found.alignment.verdict, Verdict::Doubtful, "{}", told(&found));
    assert!(told(&found).contains("ambiguous: a pose turned by"), "{}", told(&found));
}

#[test]
fn clouds_that_share_nothing_are_not_ok() {
    let body = shapes::chiral(4000);
    let all = scanned(&body, 12_000, 6);
    // Two sides of the body, with a gap between.
    let side = Vector3::new(0.3, 1.0, 0.2).normalize();
    let (source, target) = (half(&all, &side, 8.0), half(&all, &-side, 8.0));
    for method in [Coarse::FpfhRansac, Coarse::FpfhGnc, Coarse::Auto] {
        let found = run(&source, &moved(&target, &far()), method);
        assert_ne!(found.alignment.verdict, Verdict::Ok, "{method:?}: {}", told(&found));
        assert!(!found.alignment.reasons.is_empty());
    }
}

#[test]
fn the_pose_has_the_same_bits_for_any_number_of_threads() {
    let body = shapes::chiral(4000);
    let (source, target) = (scanned(&body, 5000, 1), moved(&scanned(&body, 4500, 2), &far()));
    let on = |n: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap();
        pool.install(|| run(&source, &target, Coarse::Auto))
    };
    assert_eq!(on(1), on(2));
}

#[test]
fn metres_and_a_place_far_away_change_nothing() {
    let body = shapes::chiral(4000);
    let (source, target) = (scanned(&body, 5000, 1), moved(&scanned(&body, 4500, 2), &far()));
    let here = run(&source, &target, Coarse::FpfhGnc).alignment.target_from_source;
    let away = Pose::translation(1e6, -4e5, 2e5);
    let shifted = run(&moved(&source, &away), &moved(&target, &away), Coarse::FpfhGnc);
    let shifted = away.inverse() * shifted.alignment.target_from_source * away;
    let metres = |cloud: &PointCloud| PointCloud {
        points: cloud.points.iter().map(|p| p / 1000.0).collect(),
        ..PointCloud::default()
    };
    let small =
        run(&metres(&source), &metres(&target), Coarse::FpfhGnc).alignment.target_from_source;
    let small = Pose::from_parts((small.translation.vector * 1000.0).into(), small.rotation);
    for other in [shifted, small] {
        let off = source.points.iter().map(|p| (here * p - other * p).norm()).fold(0.0, f64::max);
        assert!(off < 0.01, "{off} mm");
    }
}

#[test]
fn it_stops_when_asked() {
    struct Stop;
    impl Progress for Stop {
        fn start(&self, _: &str, _: u64) {}

        fn advance(&self, _: u64) -> Result<(), crate::progress::Cancelled> {
            Err(crate::progress::Cancelled)
        }
    }
    let cloud = scanned(&shapes::chiral(2000), 2000, 1);
    let options = (&CoarseOptions::default(), &IcpOptions::default());
    let error = align(&cloud, &cloud, None, options, &Stop).unwrap_err();
    assert_eq!(error, IcpError::Cancelled(crate::progress::Cancelled));
}
