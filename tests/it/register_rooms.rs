//! `horma register --coarse planes`: rooms seen from two places, and what fixes no pose.

use crate::command::horma;
use horma::geom::{LengthUnit, Point3, PointCloud, Pose, Surface, Vector3, shapes};
use horma::io::{Overwrite, read_pose, read_surface, write_surface};
use horma::progress::Silent;
use horma::register::coarse::{Coarse, CoarseOptions, align};
use horma::register::icp::{IcpOptions, Verdict};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::path::Path;

/// A corner and two sides of a rectangle [mm].
type Sheet = [[f64; 3]; 3];

/// Four and a half metres by three and a half: floor, four walls, a cupboard, a desk, a step.
const ROOM: [Sheet; 12] = [
    [[0.0; 3], [4500.0, 0.0, 0.0], [0.0, 3500.0, 0.0]],
    [[0.0; 3], [4500.0, 0.0, 0.0], [0.0, 0.0, 2500.0]],
    [[0.0; 3], [0.0, 3500.0, 0.0], [0.0, 0.0, 2500.0]],
    [[4500.0, 0.0, 0.0], [0.0, 3500.0, 0.0], [0.0, 0.0, 2500.0]],
    [[0.0, 3500.0, 0.0], [4500.0, 0.0, 0.0], [0.0, 0.0, 2500.0]],
    [[3000.0, 2800.0, 0.0], [900.0, 0.0, 0.0], [0.0, 0.0, 1700.0]],
    [[3000.0, 2800.0, 0.0], [0.0, 700.0, 0.0], [0.0, 0.0, 1700.0]],
    [[3900.0, 2800.0, 0.0], [0.0, 700.0, 0.0], [0.0, 0.0, 1700.0]],
    [[1200.0, 2500.0, 750.0], [1400.0, 0.0, 0.0], [0.0, 800.0, 0.0]],
    [[1200.0, 3300.0, 750.0], [1400.0, 0.0, 0.0], [0.0, 0.0, 450.0]],
    [[4000.0, 800.0, 300.0], [500.0, 0.0, 0.0], [0.0, 1500.0, 0.0]],
    [[4000.0, 800.0, 0.0], [0.0, 1500.0, 0.0], [0.0, 0.0, 300.0]],
];

/// Twelve metres of two walls and a floor.
const CORRIDOR: [Sheet; 3] = [
    [[-6000.0, 0.0, 0.0], [12_000.0, 0.0, 0.0], [0.0, 1600.0, 0.0]],
    [[-6000.0, 0.0, 0.0], [12_000.0, 0.0, 0.0], [0.0, 0.0, 2300.0]],
    [[-6000.0, 1600.0, 0.0], [12_000.0, 0.0, 0.0], [0.0, 0.0, 2300.0]],
];

/// What a depth camera sees of `sheets`, in its own frame: 200 x 150 rays over 86 x 70 degrees, a
/// thousandth of the way off.
fn seen(sheets: &[Sheet], world_from_camera: &Pose, seed: u64) -> PointCloud {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let mut points = Vec::new();
    for i in 0..200 * 150 {
        let (u, v) = (f64::from(i % 200) / 107.0 - 0.93, f64::from(i / 200) / 107.0 - 0.7);
        let ray = world_from_camera.rotation * Vector3::new(u, v, 1.0);
        let eye = world_from_camera.translation.vector;
        let ways = sheets.iter().filter_map(|sheet| way(sheet, &eye, &ray));
        let way = ways.fold(f64::INFINITY, f64::min);
        let noise = 1.0 + 0.001 * (random.random_range(-1.0..1.0) + random.random_range(-1.0..1.0));
        if way.is_finite() {
            points.push(Point3::new(u, v, 1.0) * (way * noise));
        }
    }
    PointCloud { points, ..PointCloud::default() }
}

/// How far along `ray` a rectangle is, if it is met.
fn way(sheet: &Sheet, eye: &Vector3, ray: &Vector3) -> Option<f64> {
    let [corner, along, up] = sheet.map(Vector3::from);
    let normal = along.cross(&up);
    let way = normal.dot(&(corner - eye)) / normal.dot(ray);
    let at = eye + ray * way - corner;
    let within = |side: Vector3| (0.0..1.0).contains(&(at.dot(&side) / side.norm_squared()));
    (way > 0.0 && within(along) && within(up)).then_some(way)
}

/// A camera at `eye` that looks at `aim`, its Y down.
fn camera(eye: [f64; 3], aim: [f64; 3]) -> Pose {
    let ahead = Vector3::from(aim) - Vector3::from(eye);
    let turn = nalgebra::UnitQuaternion::face_towards(&ahead, &-Vector3::z());
    Pose::from_parts(Vector3::from(eye).into(), turn)
}

/// Another frame for every seed, turned by up to half a turn.
fn elsewhere(seed: u64) -> Pose {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let mut vector = |size: f64| Vector3::from_fn(|_, _| random.random_range(-size..size));
    Pose::new(vector(5000.0), vector(1.0).normalize() * 3.0)
}

fn moved(cloud: &PointCloud, pose: &Pose) -> PointCloud {
    let points = cloud.points.iter().map(|point| pose * point).collect();
    PointCloud { points, ..PointCloud::default() }
}

fn put(folder: &Path, name: &str, cloud: PointCloud) -> String {
    let path = folder.join(name);
    write_surface(&path, &Surface::Points(cloud), Overwrite::Replace).unwrap();
    path.to_str().unwrap().to_owned()
}

#[test]
fn a_room_seen_from_two_places_is_laid_over_itself_by_its_planes() {
    let folder = tempfile::tempdir().unwrap();
    let [from, onto] = [
        camera([700.0, 600.0, 1500.0], [3300.0, 3000.0, 600.0]),
        camera([1900.0, 500.0, 1700.0], [3000.0, 3100.0, 600.0]),
    ];
    for seed in 1..=2 {
        let source = moved(&seen(&ROOM, &from, seed), &elsewhere(seed));
        let truth = onto.inverse() * from * elsewhere(seed).inverse();
        let points = source.points.clone();
        let source = put(folder.path(), "source.ply", source);
        let target = put(folder.path(), "target.ply", seen(&ROOM, &onto, seed + 10));
        let matrix = folder.path().join("T.txt");
        let to = matrix.to_str().unwrap();
        let args = ["--coarse", "planes", "--units", "mm", "--force", "--json", "-o", to];
        let output = horma(&[&["register", &source, &target][..], &args].concat());
        let told = String::from_utf8(output.stdout).unwrap();
        let report: serde_json::Value = serde_json::from_str(&told).unwrap();
        assert_eq!(report["verdict"], "ok", "{told}");
        assert_eq!(report["started_from"], "planes");
        assert!(report["planes"]["n_agreeing"].as_u64().unwrap() >= 5, "{}", report["planes"]);
        let pose = read_pose(&matrix, LengthUnit::Millimetre).unwrap();
        let off = points.iter().map(|p| (pose * p - truth * p).norm()).fold(0.0, f64::max);
        // A thousandth of 4 m is the noise of one point; there are thirty thousand.
        assert!(off < 1.5, "{off} mm");
    }
}

#[test]
fn a_corridor_and_a_ball_fail_with_what_is_missing() {
    let folder = tempfile::tempdir().unwrap();
    let [from, onto] =
        [-1500.0, -500.0].map(|x| camera([x, 700.0, 1500.0], [x + 3000.0, 800.0, 900.0]));
    let source = put(folder.path(), "a.ply", moved(&seen(&CORRIDOR, &from, 1), &elsewhere(4)));
    let target = put(folder.path(), "b.ply", seen(&CORRIDOR, &onto, 2));
    let ball = shapes::sphere(&Point3::origin(), 400.0, 80).points;
    let ball = put(folder.path(), "ball.ply", PointCloud { points: ball, ..PointCloud::default() });
    for (files, missing) in [
        ([&source, &target], "degenerate: the surfaces allow sliding along"),
        ([&ball, &target], "it takes two planes of either cloud that are not parallel"),
    ] {
        let args = ["register", files[0], files[1], "--coarse", "planes", "--units", "mm"];
        let output = horma(&args);
        let told = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(65), "{told}");
        assert!(told.contains(missing) && told.contains("nothing was written"), "{told}");
    }
}

#[test]
fn two_scans_of_a_street_are_found_by_their_planes_from_anywhere() {
    let Some(data) = std::env::var_os("HORMA_DATA") else {
        eprintln!("skipped: HORMA_DATA is not set");
        return;
    };
    let data = Path::new(&data);
    let cloud = |name: &str| {
        let path = data.join("scans/small_gicp_pair").join(name);
        read_surface(&path, Some(LengthUnit::Metre)).unwrap().surface.into_points()
    };
    let list = std::fs::read_to_string(data.join("pairs/icp.csv")).unwrap();
    let row = list.lines().find(|line| line.starts_with("lidar-pair,")).unwrap();
    let cells: Vec<f64> = row.split(',').skip(1).map(|cell| cell.trim().parse().unwrap()).collect();
    let (truth, ok_below) = (&cells[12..24], cells[24]);
    let source = cloud("source.ply");
    let off = |pose: &Pose, turn: &Pose, point: &Point3| {
        let there = [0, 1, 2].map(|k| {
            let row = &truth[4 * k..4 * k + 4];
            row[0] * point.x + row[1] * point.y + row[2] * point.z + 1e3 * row[3]
        });
        (pose * (turn * point) - Point3::from(there)).norm_squared()
    };
    let turned = moved(&source, &elsewhere(7));
    let coarse = CoarseOptions { coarse: Some(Coarse::Planes), ..CoarseOptions::default() };
    let fine =
        IcpOptions { voxel: Some(250.0), max_distance: Some(1000.0), ..IcpOptions::default() };
    let target = cloud("target.ply");
    let found = align(&turned, &target, None, (&coarse, &fine), &Silent).unwrap();
    let pose = &found.alignment.target_from_source;
    let sum: f64 = source.points.iter().map(|point| off(pose, &elsewhere(7), point)).sum();
    let off = (sum / source.points.len() as f64).sqrt();
    assert!(off < ok_below, "{off} mm");
    assert_eq!(found.alignment.verdict, Verdict::Ok, "{:?}", found.alignment.reasons);
    assert!(found.planes.is_some_and(|planes| planes.n_agreeing > 10), "{:?}", found.planes);
}
