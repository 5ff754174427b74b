//! `horma register`: from files to a matrix, and what it says when there is none.

use crate::command::horma;
use horma::geom::{Point3, PointCloud, Pose, Surface, Vector3, shapes};
use horma::io::{Overwrite, read_pose, write_surface};
use horma::register::coarse::CoarseOptions;
use horma::register::icp::{IcpOptions, Kernel, Metric, Verdict, align};
use horma::register::pose_graph::GraphOptions;
use horma::workflow::views::{ViewsJob, register_views};
use std::path::{Path, PathBuf};
use std::process::Output;

const MM: horma::geom::LengthUnit = horma::geom::LengthUnit::Millimetre;

/// A chiral body as points, moved.
fn scan(pose: &Pose, scale: f64) -> Surface {
    let mesh = shapes::chiral(20_000);
    let points = mesh.points.iter().map(|point| Point3::from((pose * point).coords * scale));
    Surface::Points(PointCloud { points: points.collect(), ..PointCloud::default() })
}

fn truth() -> Pose {
    Pose::new(Vector3::new(1.5, -1.0, 0.8), Vector3::new(0.02, 0.03, -0.02))
}

struct Bench(tempfile::TempDir);

impl Bench {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn put(&self, name: &str, surface: &Surface) -> String {
        let path = self.path(name);
        write_surface(&path, surface, Overwrite::Replace).unwrap();
        path.to_str().unwrap().to_owned()
    }

    fn text(&self, name: &str, text: &str) -> String {
        std::fs::write(self.path(name), text).unwrap();
        self.path(name).to_str().unwrap().to_owned()
    }
}

fn code(output: &Output) -> Option<i32> {
    output.status.code()
}

fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

fn largest_error(found: &Pose, expected: &Pose) -> f64 {
    let mesh = shapes::chiral(20_000);
    mesh.points.iter().map(|p| (found * p - expected * p).norm()).fold(0.0, f64::max)
}

#[test]
fn a_motion_between_two_files_is_found_written_and_read_back() {
    let bench = Bench::new();
    let source = bench.put("source.ply", &scan(&Pose::identity(), 1.0));
    let target = bench.put("target.ply", &scan(&truth(), 1.0));
    let (matrix, both) = (bench.path("T.txt"), bench.path("both.ply"));
    let [to, cloud] = [&matrix, &both].map(|path| path.to_str().unwrap());
    let output =
        horma(&["register", &source, &target, "-o", to, "--write-cloud", cloud, "--units", "mm"]);
    assert_eq!(code(&output), Some(0), "{}", stderr(&output));
    let told = String::from_utf8(output.stdout).unwrap();
    assert!(told.starts_with("verdict  ok\n"), "{told}");
    assert!(told.contains("units mm, as stated") && told.contains(to), "{told}");
    let found = read_pose(&matrix, horma::geom::LengthUnit::Metre).unwrap();
    assert!(largest_error(&found, &truth()) < 0.01, "{found}");
    let text = std::fs::read_to_string(&matrix).unwrap();
    assert!(text.starts_with("# target_from_source: 4 x 4, row by row; units mm\n"), "{text}");
    let merged = horma::io::read_surface(&both, None).unwrap().surface;
    let n_points = shapes::chiral(20_000).points.len();
    assert_eq!(merged.points().len(), 2 * n_points);
    // What is there stays there.
    let again = horma(&["register", &source, &target, "-o", to, "--units", "mm"]);
    assert_eq!(code(&again), Some(73), "{}", stderr(&again));
}

#[test]
fn the_matrix_is_in_the_unit_of_the_files_and_starts_from_one_like_it() {
    let bench = Bench::new();
    let source = bench.put("source.xyz", &scan(&Pose::identity(), 0.001));
    let far = Pose::translation(300.0, 0.0, 0.0) * truth();
    let target = bench.put("target.xyz", &scan(&far, 0.001));
    let init = bench.text("init.txt", "# metres\n1 0 0 0.3\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
    let output = horma(&["register", &source, &target, "--init", &init, "--units", "m", "--json"]);
    assert_eq!(code(&output), Some(0), "{}", stderr(&output));
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["verdict"], "ok");
    assert_eq!(report["unit"], "m");
    let x = report["target_from_source"][0][3].as_f64().unwrap();
    assert!((x - far.translation.x / 1000.0).abs() < 1e-5, "{x}");
    let lone = horma(&["register", &source, &target, "--units", "m", "--coarse", "none"]);
    assert_eq!(code(&lone), Some(65));
    assert!(stderr(&lone).contains("start beyond reach"), "{}", stderr(&lone));
}

#[test]
fn without_a_start_the_command_finds_one_and_says_how() {
    let bench = Bench::new();
    let source = bench.put("source.ply", &scan(&Pose::identity(), 1.0));
    let far = Pose::new(Vector3::new(200.0, -90.0, 40.0), Vector3::new(1.9, -1.2, 0.8));
    let target = bench.put("target.ply", &scan(&far, 1.0));
    for (method, from) in [
        ("auto", None),
        ("fpfh-ransac", Some("fpfh-ransac")),
        ("fpfh-gnc", Some("fpfh-gnc")),
        ("axes", Some("axes")),
    ] {
        let matrix = bench.path(&format!("{method}.txt"));
        let to = matrix.to_str().unwrap();
        let output =
            horma(&["register", &source, &target, "-o", to, "--coarse", method, "--units", "mm"]);
        assert_eq!(code(&output), Some(0), "{method}: {}", stderr(&output));
        let told = String::from_utf8(output.stdout).unwrap();
        let start = told.lines().find(|line| line.starts_with("start ")).unwrap();
        assert!(from.is_none_or(|from| start.contains(&format!(" {from}, of "))), "{start}");
        let found = read_pose(&matrix, horma::geom::LengthUnit::Millimetre).unwrap();
        assert!(largest_error(&found, &far) < 0.05, "{method}: {found}");
    }
    let json = horma(&["register", &source, &target, "--units", "mm", "--json"]);
    let report: serde_json::Value = serde_json::from_slice(&json.stdout).unwrap();
    assert!(report["n_starts"].as_u64().unwrap() > 1 && report["fit"].as_f64().unwrap() > 0.9);
    assert!(report["support"]["n_agreeing"].as_u64().unwrap() > 10, "{report}");
}

#[test]
fn a_plane_fails_with_its_free_motions_and_writes_nothing() {
    let bench = Bench::new();
    let points = (0..2500_u32)
        .map(|i| Point3::new(f64::from(i % 50) * 2.0, f64::from(i / 50) * 2.0, 0.0))
        .collect();
    let plane = Surface::Points(PointCloud { points, ..PointCloud::default() });
    let path = bench.put("plane.ply", &plane);
    let matrix = bench.path("T.txt");
    let to = matrix.to_str().unwrap();
    let output = horma(&["register", &path, &path, "-o", to, "--voxel", "2", "--units", "mm"]);
    assert_eq!(code(&output), Some(65));
    let told = stderr(&output);
    assert!(told.contains("sliding along x, sliding along y, turning about z"), "{told}");
    assert!(told.contains("nothing was written") && !matrix.exists(), "{told}");
}

#[test]
fn wrong_flags_and_broken_files_are_told_by_name() {
    let bench = Bench::new();
    let good = bench.put("good.ply", &scan(&Pose::identity(), 1.0));
    let few = bench.text("few.xyz", "0 0 0\n90 0 0\n0 90 0\n");
    let line: Vec<String> = (0..200).map(|i| format!("{i} {i} {i}\n")).collect();
    let line = bench.text("line.xyz", &line.concat());
    let broken = bench.text("broken.ply", "ply\nformat ascii 1.0\nelement vertex 5\n");
    let empty = bench.text("empty.ply", "");
    let mirror = bench.text("mirror.txt", "-1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
    let cases: &[(&[&str], i32, &str)] = &[
        (&[&good], 2, "<TARGET>"),
        (&[&good, &good, "--fine", "best"], 2, "[possible values: point-to-point, point-to-plane"),
        (&[&good, &good, "--coarse", "luck"], 2, "[possible values: none, fpfh-ransac, fpfh-gnc"),
        (&[&good, &good, "--hypotheses", "0"], 65, "--hypotheses is 0; it must be a whole number"),
        (&[&good, &good, "--feature-voxel=-1"], 65, "--feature-voxel is -1; it must be"),
        (&[&good, &good, "--kernel", "l1"], 2, "[possible values: none, huber, tukey, cauchy"),
        (&[&good, &good, "--voxel", "0"], 65, "--voxel is 0; it must be a number above 0"),
        (&[&good, &good, "--voxel", "1e-9"], 65, "are too small for a cloud of"),
        (&[&good, &good, "--levels", "0"], 65, "--levels is 0; it must be a whole number"),
        (&[&good, &good, "--reject-worst", "100"], 65, "--reject-worst is 100"),
        (
            &[&good, &good, "--final-distance", "9", "--max-distance", "2"],
            65,
            "at most --max-distance",
        ),
        (&[&good, &good, "--fine", "coloured"], 65, "the source has no colours"),
        (&[&good, &good, "--init", &mirror], 65, "is no rigid motion: it mirrors"),
        (&[&good, &good, "--init", &broken], 65, "line 1: \"ply\" is no finite number"),
        (&[&good, "missing.ply"], 65, "missing.ply"),
        (&[&good, &broken], 65, "broken.ply"),
        (&[&empty, &good], 65, "empty.ply"),
        (&[&few, &good], 65, "the source has 3 points in voxels"),
        (&[&good, &line], 65, "all points of the target lie on one line"),
        (&[&good, &good, "--write-cloud", "x.stl"], 73, "cannot hold a cloud of points"),
        (&[&good, &good, "-o", "no/such/folder/T.txt"], 73, "does not exist"),
    ];
    for (arguments, expected, words) in cases {
        let output = horma(&[&["register"][..], arguments, &["--units", "mm"]].concat());
        let told = stderr(&output);
        assert_eq!(code(&output), Some(*expected), "{arguments:?}: {told}");
        assert!(told.contains(words), "{arguments:?}: {told}");
        assert!(output.stdout.is_empty(), "{arguments:?}");
    }
}

/// The pairs of real scans whose truth is known: three disturbances of each of four.
#[test]
fn disturbed_views_of_the_bunny_come_back() {
    let Some(data) = std::env::var_os("HORMA_DATA").map(PathBuf::from) else {
        eprintln!("skipped: HORMA_DATA is not set");
        return;
    };
    let list = std::fs::read_to_string(data.join("pairs/icp.csv")).unwrap();
    let read = |name: &str| {
        let path = data.join("scans/stanford_bunny").join(format!("{name}.ply"));
        let unit = Some(horma::geom::LengthUnit::Metre);
        horma::io::read_surface(&path, unit).unwrap().surface.into_points()
    };
    let mut off = Vec::new();
    for line in list.lines().filter(|line| line.contains("bun")) {
        let (name, numbers) = line.split_once(',').unwrap();
        let numbers: Vec<f64> = numbers.split(',').map(|cell| cell.parse().unwrap()).collect();
        let mut names = name.split('-');
        let (source, target) = (read(names.next().unwrap()), read(names.next().unwrap()));
        let [start, truth] = [&numbers[..12], &numbers[12..24]].map(pose);
        let options = |fine, kernel| IcpOptions {
            voxel: Some(1.0),
            max_distance: Some(20.0),
            fine: Some(fine),
            kernel,
            ..IcpOptions::default()
        };
        let run = |options: &IcpOptions| {
            align(&source, &target, &start, options, &horma::progress::Silent).unwrap()
        };
        let gicp = run(&options(Metric::Generalised, Kernel::None));
        assert_ne!(gicp.verdict, Verdict::Failed, "{name}");
        let plane = run(&options(Metric::PointToPlane, Kernel::Tukey));
        off.push([gicp, plane].map(|found| rms(&found.target_from_source, &truth, &source)));
        // As right as the published poses.
        assert!(off.last().unwrap().iter().all(|mm| *mm < 2.0), "{name}: {off:?} mm");
    }
    assert_eq!(off.len(), 12);
    let median = |k: usize| {
        let mut all: Vec<f64> = off.iter().map(|pair| pair[k]).collect();
        all.sort_by(f64::total_cmp);
        all[6]
    };
    assert!(median(0) <= 0.10 && median(1) <= 0.3, "{} {} mm", median(0), median(1));
}

fn pose(rows: &[f64]) -> Pose {
    let rotation = nalgebra::Matrix3::from_fn(|a, b| rows[4 * a + b]);
    let shift = nalgebra::Vector3::from_fn(|a, _| rows[4 * a + 3] * 1e3);
    Pose::from_parts(shift.into(), nalgebra::UnitQuaternion::from_matrix(&rotation))
}

fn rms(a: &Pose, b: &Pose, cloud: &PointCloud) -> f64 {
    let sum: f64 = cloud.points.iter().map(|p| (a * p - b * p).norm_squared()).sum();
    (sum / cloud.points.len() as f64).sqrt()
}

/// Five views of the bunny in no order, each as its file has it: all come to lie where the published
/// poses of the pairs have them.
#[test]
fn five_views_of_the_bunny_come_to_lie_on_each_other() {
    let Some(data) = std::env::var_os("HORMA_DATA").map(PathBuf::from) else {
        eprintln!("skipped: HORMA_DATA is not set");
        return;
    };
    let names = ["chin", "bun045", "bun090", "bun315", "bun000"];
    let read = |name: &&str| {
        let path = data.join("scans/stanford_bunny").join(format!("{name}.ply"));
        let unit = Some(horma::geom::LengthUnit::Metre);
        horma::io::read_surface(&path, unit).unwrap().surface.into_points()
    };
    let clouds: Vec<PointCloud> = names.iter().map(read).collect();
    let job = ViewsJob {
        views: names.iter().map(ToString::to_string).zip(&clouds).collect(),
        unit: horma::geom::LengthUnit::Metre,
        notes: Vec::new(),
        coarse: &CoarseOptions::default(),
        fine: &IcpOptions { voxel: Some(1.0), max_distance: Some(20.0), ..IcpOptions::default() },
        graph: &GraphOptions::default(),
    };
    let (found, report) = register_views(job, &horma::progress::Silent).unwrap();
    assert_eq!((report.verdict, report.stays.as_str()), (Verdict::Ok, "bun000"));
    let residual = report.residual;
    assert!(residual.refined <= residual.chained, "{residual:?}");
    let place = |name: &str| names.iter().position(|known| *known == name).unwrap();
    let list = std::fs::read_to_string(data.join("pairs/icp.csv")).unwrap();
    let mut n_compared = 0;
    for line in list.lines().filter(|line| line.contains("bun") && line.contains("-p5,")) {
        let (name, numbers) = line.split_once(',').unwrap();
        let numbers: Vec<f64> = numbers.split(',').map(|cell| cell.parse().unwrap()).collect();
        let ends: Vec<usize> = name.split('-').take(2).map(place).collect();
        let [source, target] = [ends[0], ends[1]].map(|i| found.stays_from_view[i].unwrap());
        let off = rms(&(target.inverse() * source), &pose(&numbers[12..24]), &clouds[ends[0]]);
        // As right as the published poses, of which each pair has its own.
        assert!(off < 0.4, "{name}: {off} mm");
        n_compared += 1;
    }
    assert_eq!(n_compared, 4);
}

#[test]
fn three_files_become_one_cloud_and_a_matrix_each() {
    let bench = Bench::new();
    let [a, b, c] = [0.0, 1.0, 2.0].map(|k| {
        let pose = Pose::new(Vector3::new(40.0 * k, -9.0, 7.0 * k), Vector3::new(0.3, k, -0.4 * k));
        (bench.put(&format!("view{k}.ply"), &scan(&pose, 1.0)), pose)
    });
    let (poses, cloud) = (bench.path("poses.txt"), bench.path("all.ply"));
    let outputs = ["-o", poses.to_str().unwrap(), "--write-cloud", cloud.to_str().unwrap()];
    let scans = ["register", &a.0, &b.0, &c.0, "--units", "mm", "--voxel", "2"];
    let output = horma(&[&scans[..], &outputs].concat());
    assert_eq!(code(&output), Some(0), "{}", stderr(&output));
    let told = String::from_utf8(output.stdout.clone()).unwrap();
    assert!(told.contains("3 of 3 lie together, in the frame of view2.ply"), "{told}");
    let text = std::fs::read_to_string(&poses).unwrap();
    let blocks: Vec<&str> = text.split("# view2.ply_from_").skip(1).collect();
    assert_eq!(blocks.len(), 3, "{text}");
    for (block, known) in blocks.iter().zip([a.1, b.1, c.1]) {
        let found =
            read_pose(Path::new(&bench.text("one.txt", &format!("# {block}"))), MM).unwrap();
        let off = largest_error(&(found * known), &c.1);
        // Cells of 2 mm lie differently in each view.
        assert!(off < 0.05, "{off} mm: {block}");
    }
    let all = horma::io::read_surface(&cloud, Some(MM)).unwrap().surface.into_points();
    let one = horma::io::read_surface(Path::new(&a.0), Some(MM)).unwrap().surface.into_points();
    assert_eq!(all.points.len(), 3 * one.points.len());
    // A start is for two.
    let output = horma(&[&scans[..], &["--init", poses.to_str().unwrap()]].concat());
    assert_eq!(code(&output), Some(2), "{}", stderr(&output));
}

#[test]
fn help_names_the_stages() {
    let help = crate::command::help(&["register"]);
    for word in [
        "--coarse",
        "--fine",
        "--sampling",
        "--pairing",
        "--reject-sigma",
        "--weighting",
        "--kernel",
    ] {
        assert!(help.contains(word), "{word}");
    }
    assert!(!Path::new("T.txt").exists());
}
