//! Rooms found by their planes, and rooms that no pose can be told of.

use super::super::matching::between;
use super::*;
use crate::geom::{PointCloud, Pose, shapes};
use crate::progress::Silent;
use crate::register::coarse::{Coarse, CoarseOptions, Found, StartedFrom, align};
use crate::register::icp::{IcpOptions, Reason, Role, Verdict, ViewOptions};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// Root mean square noise of a point along every axis [mm].
const NOISE: f64 = 4.0;
/// Between points, on the mean [mm].
const APART: f64 = 25.0;

/// A corner and two sides of a rectangle [mm].
type Sheet = [[f64; 3]; 3];

/// Points on rectangles, one to a square, anywhere in it and with noise.
fn scanned(sheets: &[Sheet], seed: u64) -> Vec<Point3> {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let mut points = Vec::new();
    for [corner, along, up] in sheets.iter().map(|sheet| sheet.map(Vector3::from)) {
        let n = (along.norm() * up.norm() / APART.powi(2)) as usize;
        for _ in 0..n {
            let (u, v) = (random.random_range(0.0..1.0), random.random_range(0.0..1.0));
            let mut normal = || (0..12).map(|_| random.random_range(0.0..1.0)).sum::<f64>() - 6.0;
            let noise = Vector3::from_fn(|_, _| NOISE * normal());
            points.push(Point3::from(corner + along * u + up * v + noise));
        }
    }
    points
}

/// Four metres by three: floor, three walls, a cupboard, a table, a step and a board that leans.
fn room() -> Vec<Sheet> {
    vec![
        [[0.0; 3], [4000.0, 0.0, 0.0], [0.0, 3000.0, 0.0]],
        [[0.0; 3], [4000.0, 0.0, 0.0], [0.0, 0.0, 2500.0]],
        [[0.0; 3], [0.0, 3000.0, 0.0], [0.0, 0.0, 2500.0]],
        [[4000.0, 0.0, 0.0], [0.0, 3000.0, 0.0], [0.0, 0.0, 2500.0]],
        [[1700.0, 600.0, 0.0], [800.0, 0.0, 0.0], [0.0, 0.0, 1800.0]],
        [[1700.0, 0.0, 0.0], [0.0, 600.0, 0.0], [0.0, 0.0, 1800.0]],
        [[2500.0, 0.0, 0.0], [0.0, 600.0, 0.0], [0.0, 0.0, 1800.0]],
        [[1500.0, 1300.0, 750.0], [1200.0, 0.0, 0.0], [0.0, 700.0, 0.0]],
        [[1300.0, 2300.0, 300.0], [1500.0, 0.0, 0.0], [0.0, 700.0, 0.0]],
        [[1300.0, 2300.0, 0.0], [1500.0, 0.0, 0.0], [0.0, 0.0, 300.0]],
        [[1000.0, 100.0, 0.0], [600.0, 0.0, 0.0], [0.0, -100.0, 900.0]],
    ]
}

fn corridor() -> Vec<Sheet> {
    let long = [9000.0, 0.0, 0.0];
    vec![
        [[0.0; 3], long, [0.0, 1500.0, 0.0]],
        [[0.0; 3], long, [0.0, 0.0, 2200.0]],
        [[0.0, 1500.0, 0.0], long, [0.0, 0.0, 2200.0]],
    ]
}

fn cloud(points: impl IntoIterator<Item = Point3>) -> PointCloud {
    PointCloud { points: points.into_iter().collect(), ..PointCloud::default() }
}

fn moved(points: &[Point3], pose: &Pose) -> PointCloud {
    cloud(points.iter().map(|point| pose * point))
}

/// Elsewhere, and turned by as much as can be, another way for every seed.
fn far(seed: u64) -> Pose {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let axis = Vector3::from_fn(|_, _| random.random_range(-1.0..1.0)).normalize();
    Pose::new(Vector3::new(3000.0, -1500.0, 800.0), axis * random.random_range(1.0..3.1))
}

fn run(source: &PointCloud, target: &PointCloud) -> Found {
    let coarse = CoarseOptions { coarse: Some(Coarse::Planes), ..CoarseOptions::default() };
    align(source, target, None, (&coarse, &IcpOptions::default()), &Silent).unwrap()
}

fn told(found: &Found) -> String {
    let reasons: Vec<String> = found.alignment.reasons.iter().map(ToString::to_string).collect();
    format!("{}: {} {:?}", found.alignment.verdict, reasons.join("; "), found.planes)
}

fn walls(source: &PointCloud, target: &PointCloud) -> Walls {
    let options = ViewOptions {
        voxel: 30.0,
        neighbours: 20,
        with_colours: false,
        with_borders: false,
        camera: None,
    };
    let view = |cloud| View::new(cloud, Role::Source, options, &Silent).unwrap();
    Walls::new([&view(source), &view(target)], 100.0, &Silent).unwrap()
}

#[test]
fn two_views_of_a_room_that_share_its_middle_are_found_from_anywhere() {
    let [all, again] = [1, 2].map(|seed| scanned(&room(), seed));
    for seed in 1..=4 {
        let source = cloud(all.iter().filter(|p| p.x < 2900.0).copied());
        let target: Vec<Point3> = again.iter().filter(|p| p.x > 1100.0).copied().collect();
        let found = run(&source, &moved(&target, &far(seed)));
        let pose = &found.alignment.target_from_source;
        let off = |p: &Point3| (pose * p - far(seed) * p).norm();
        let off = source.points.iter().map(off).fold(0.0, f64::max);
        // Noise of 4 mm on some ten thousand points; the voxels are 20 mm.
        assert!(off < 5.0, "seed {seed}: {off} mm, {}", told(&found));
        assert_eq!(found.alignment.verdict, Verdict::Ok, "{}", told(&found));
        assert_eq!(found.started_from, StartedFrom::Planes);
        assert!(found.planes.is_some_and(|planes| planes.is_enough()), "{}", told(&found));
    }
}

#[test]
fn a_corridor_slides_and_is_not_believed() {
    let [all, again] = [3, 4].map(|seed| scanned(&corridor(), seed));
    let source = cloud(all.into_iter().filter(|p| p.x < 6000.0));
    let target: Vec<Point3> = again.into_iter().filter(|p| p.x > 3000.0).collect();
    let found = run(&source, &moved(&target, &far(5)));
    assert_eq!(found.alignment.verdict, Verdict::Failed, "{}", told(&found));
    assert!(told(&found).contains("the surfaces allow sliding"), "{}", told(&found));
}

#[test]
fn a_cube_is_found_and_told_to_fit_other_ways() {
    let side = [[1200.0, 0.0, 0.0], [0.0, 1200.0, 0.0], [0.0, 0.0, 1200.0]];
    let sheets: Vec<Sheet> = (0..3)
        .flat_map(|k| {
            let (mut opposite, u, v) = ([0.0; 3], side[(k + 1) % 3], side[(k + 2) % 3]);
            opposite[k] = 1200.0;
            [[[0.0; 3], u, v], [opposite, u, v]]
        })
        .collect();
    let [source, target] = [6, 7].map(|seed| scanned(&sheets, seed));
    let found = run(&cloud(source), &moved(&target, &far(6)));
    assert_eq!(found.alignment.verdict, Verdict::Doubtful, "{}", told(&found));
    let is_ambiguous = |reason: &Reason| matches!(reason, Reason::Ambiguous { .. });
    assert!(found.alignment.reasons.iter().any(is_ambiguous), "{}", told(&found));
}

#[test]
fn too_few_planes_are_counted_and_there_is_a_remedy() {
    let ball = shapes::sphere(&Point3::origin(), 400.0, 60).points;
    let wall = scanned(&room()[..1], 8);
    for (source, target, counts) in [
        (&ball, &wall, "the source has 0 planes, the target 1"),
        (&wall, &wall, "the source has 1 planes, the target 1"),
    ] {
        let found = run(&cloud(source.iter().copied()), &moved(target, &far(7)));
        assert_eq!(found.alignment.verdict, Verdict::Failed);
        assert!(told(&found).contains(counts), "{}", told(&found));
        assert!(told(&found).contains("choose a smaller --voxel or another --coarse"));
        assert_eq!(found.n_starts, 0);
    }
}

#[test]
fn planes_hold_a_room_but_no_corridor() {
    let hold = |sheets: &[Sheet]| {
        let cloud = cloud(scanned(sheets, 9));
        walls(&cloud, &cloud).hold()
    };
    assert!(hold(&room()) && !hold(&corridor()) && !hold(&room()[..2]));
}

#[test]
fn known_sides_leave_a_quarter_of_the_turns() {
    let patch = |normal: Vector3| Patch {
        normal,
        middle: Point3::origin(),
        covariance: Matrix3::identity(),
        area: 1.0,
        tilt: 1e-4,
        off: 1.0,
    };
    let two = [patch(Vector3::x()), patch(Vector3::y())];
    assert_eq!(turns::turns(&two, &two, false).len(), 8);
    assert_eq!(turns::turns(&two, &two, true).len(), 2);
    let leaning = patch(Vector3::new(1.0, 1.0, 0.0).normalize());
    assert_eq!(turns::turns(&two, &[two[0], leaning], false).len(), 0);
    assert_eq!(turns::turns(&two[..1], &two, false).len(), 0);
}

#[test]
fn the_best_hypothesis_of_exact_planes_is_the_pose() {
    let source = cloud(scanned(&room(), 11));
    let target = moved(&source.points, &far(8));
    let walls = walls(&source, &target);
    let [middle, onto] = [&source, &target].map(|cloud| crate::geom::centroid(&cloud.points));
    let truth = Pose::from_parts((far(8) * middle - onto).into(), far(8).rotation);
    let found = walls.hypotheses();
    // The voxels of both lie otherwise in the points.
    let off = between(&found[0].pose, &truth, 1500.0);
    assert!(off < 3.0, "{off} mm");
    assert!(found.is_sorted_by(|a, b| a.score >= b.score));
}

#[test]
fn evidence_tells_the_pose_from_one_that_lays_only_a_corner_on_a_corner() {
    let source = cloud(scanned(&room(), 12));
    let walls = walls(&source, &source);
    let right = PlaneSupport::of(&Pose::identity(), &walls, 3000.0);
    assert!(right.is_enough() && right.n_agreeing == right.n_planes[0], "{right:?}");
    // Floor on floor, wall on wall, and the far wall where the near one was.
    let wrong = PlaneSupport::of(&Pose::translation(4000.0, 0.0, 0.0), &walls, 3000.0);
    assert!(!wrong.is_enough() && wrong.n_agreeing <= 4, "{wrong:?}");
}

#[test]
fn starts_have_the_same_bits_for_any_number_of_threads() {
    let source = cloud(scanned(&room(), 13));
    let target = moved(&scanned(&room(), 14), &far(9));
    let on = |n: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap();
        pool.install(|| run(&source, &target))
    };
    assert_eq!(on(1), on(3));
}
