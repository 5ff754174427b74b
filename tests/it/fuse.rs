//! `horma fuse`: from the folder of a depth camera to a surface, and what it refuses.

use crate::command::horma;
use horma::compute::Gpu;
use horma::geom::{Aabb, Surface, distances_from_mesh};
use horma::io::read_surface;
use horma::io::rgbd::read_trajectory;
use std::path::{Path, PathBuf};
use std::process::Output;

/// A simulated turntable scan of the demo's last in a folder of its own, few views by a small camera.
pub(crate) struct Bench {
    folder: tempfile::TempDir,
    pub(crate) scan: String,
}

const CAMERA: &str = "width = 160\nheight = 120\nfx = 200.0\nfy = 200.0\ncx = 79.5\ncy = 59.5\n\
                      depth-scale = 5000\n";

impl Bench {
    pub(crate) fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
        std::fs::write(path("camera.toml"), CAMERA).unwrap();
        let (last, scan) = (path("last.stl"), path("scan"));
        done(&["last", "-o", &last]);
        let camera = path("camera.toml");
        let views = ["--camera", &camera, "--views", "18", "--distance", "500"];
        done(&[&["simulate-scan", &last, "-o", &scan], &views[..]].concat());
        Self { folder, scan }
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub(crate) fn name(&self, name: &str) -> String {
        self.path(name).to_str().unwrap().to_owned()
    }
}

pub(crate) fn done(arguments: &[&str]) -> Output {
    let output = horma(arguments);
    assert!(output.status.success(), "{}", stderr(&output));
    output
}

fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

pub(crate) fn refused(arguments: &[&str], code: i32, message: &str) {
    let output = horma(arguments);
    assert_eq!(output.status.code(), Some(code), "{}", stderr(&output));
    assert!(stderr(&output).contains(message), "{}", stderr(&output));
}

/// The depth pictures of a scan, in order.
fn pictures(scan: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(scan.join("depth")).unwrap();
    let mut pictures: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    pictures.sort();
    pictures
}

#[test]
fn a_turntable_scan_of_a_last_becomes_a_closed_mesh_that_cam_takes() {
    let bench = Bench::new();
    let (mesh, way) = (bench.name("fused.stl"), bench.name("way.txt"));
    let arguments = ["fuse", &bench.scan, "--truth-poses", "--voxel", "4", "-o", &mesh];
    let output = done(&[&arguments[..], &["--trajectory", &way, "--json"]].concat());
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["mesh"]["is-closed"], true, "{report}");
    assert_eq!((&report["n-fused"], &report["n-frames"]), (&36.into(), &36.into()), "{report}");
    let fused = read_surface(Path::new(&mesh), None).unwrap().surface;
    let last = read_surface(&bench.path("last.stl"), None).unwrap().surface;
    let size = |surface: &Surface| Aabb::around(surface.points()).size();
    // A pixel is 2.5 mm wide.
    assert!((size(&fused) - size(&last)).amax() < 3.0, "{} {}", size(&fused), size(&last));
    let (Surface::Mesh(fused), Surface::Mesh(last)) = (fused, last) else { panic!() };
    let mut off = distances_from_mesh(&last, &fused.points);
    off.sort_by(f64::total_cmp);
    let median = off[off.len() / 2];
    assert!(median < 0.5, "half of the vertices lie within {median} mm");
    assert_eq!(read_trajectory(Path::new(&way)).unwrap().poses().len(), 36);
    let program = bench.name("fused.ngc");
    done(&["cam", &mesh, "-m", "last-lathe", "--units", "mm", "-o", &program, "--no-certify"]);
    // What is there stays there.
    refused(&arguments, 73, "fused.stl");
}

#[test]
fn a_turntable_is_calibrated_from_its_scan_and_serves_the_next_one() {
    let bench = Bench::new();
    // One of the two turns.
    let scan = Path::new(&bench.scan);
    for list in ["depth.txt", "rgb.txt"] {
        let text = std::fs::read_to_string(scan.join(list)).unwrap();
        let is_frame = |line: &&str| !line.starts_with('#');
        let first: Vec<&str> = text.lines().filter(is_frame).take(18).collect();
        std::fs::write(scan.join(list), first.join("\n")).unwrap();
    }
    let (mesh, table) = (bench.name("part.ply"), bench.name("table.toml"));
    let fuse = ["fuse", &bench.scan, "--voxel", "4", "-o", &mesh, "--json"];
    let found = [&fuse[..], &["--turntable", "calibrate", "--write-turntable", &table]].concat();
    let report: serde_json::Value = serde_json::from_slice(&done(&found).stdout).unwrap();
    let step = report["turntable"]["step-deg"].as_f64().unwrap();
    assert!((step - 20.0).abs() < 0.05, "{report}");
    assert_eq!(report["turntable"]["verdict"], "ok", "{report}");
    let first = read_surface(Path::new(&mesh), None).unwrap().surface;
    let given = [&fuse[..], &["--turntable", &table, "--force"]].concat();
    let report: serde_json::Value = serde_json::from_slice(&done(&given).stdout).unwrap();
    assert_eq!(report["turntable"]["step-deg"].as_f64().unwrap(), step);
    let again = read_surface(Path::new(&mesh), None).unwrap().surface;
    assert_eq!(first.points().len(), again.points().len());
    let wrong = [&given[..], &["--turntable-step=-3"]].concat();
    refused(&wrong, 65, "--turntable-step is -3");
    let both = [&given[..], &["--truth-poses"]].concat();
    refused(&both, 65, "leave --poses and --truth-poses out");
    let way = [&fuse[..], &["--force", "--turntable", "no.toml"]].concat();
    refused(&way, 65, "no.toml");
}

#[test]
fn a_device_fuses_the_surface_that_the_processor_does() {
    if let Err(error) = Gpu::open(None) {
        assert!(std::env::var_os("HORMA_REQUIRE_GPU").is_none(), "{error}");
        eprintln!("skipped: {error}");
        return;
    }
    let bench = Bench::new();
    let fused = |compute: &str| {
        let mesh = bench.name(&format!("{compute}.ply"));
        let fuse = ["fuse", &bench.scan, "--truth-poses", "--voxel", "4", "-o", &mesh, "--json"];
        let output = done(&[&fuse[..], &["--compute", compute]].concat());
        let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        (report, read_surface(Path::new(&mesh), None).unwrap().surface)
    };
    let ((on_cpu, a), (on_gpu, b), (on_either, _)) = (fused("cpu"), fused("gpu"), fused("auto"));
    assert_eq!(on_cpu["compute"]["on"], "cpu");
    assert_ne!(on_gpu["compute"]["on"], "cpu");
    assert!(on_either["compute"]["why"].as_str().unwrap().contains("ms a frame on the cpu"));
    assert_eq!(on_gpu["mesh"]["is-closed"], true, "{on_gpu}");
    let (Surface::Mesh(a), Surface::Mesh(b)) = (a, b) else { panic!() };
    let mut off = distances_from_mesh(&a, &b.points);
    off.sort_by(f64::total_cmp);
    // A lattice point on the border of two pixels takes the one or the other.
    assert!(off[off.len() / 2] < 1e-3 && off[off.len() * 99 / 100] < 0.3, "{:?}", off.last());
}

#[test]
fn a_scan_by_a_model_is_a_mesh() {
    let bench = Bench::new();
    let (mesh, way) = (bench.name("part.stl"), bench.name("way.txt"));
    let camera = bench.name("camera.toml");
    let simulated = |scene: &str| {
        let walk = bench.name(scene);
        let views = ["--views", "6", "--span", "6", "--camera", &camera, "-o", &walk];
        done(&[&["simulate-scan", "--scene", scene][..], &views].concat());
        walk
    };
    let wall = simulated("plain-flat");
    let scan = ["scan", &wall, "--method", "kinfu", "--voxel", "20", "-o", &mesh];
    refused(&scan, 65, "1 of 6 frames could be placed, at least half must be");
    assert!(!Path::new(&mesh).exists());
    let walk = simulated("plain-structured");
    let scan = ["scan", &walk, "--method", "kinfu", "--voxel", "20", "-o", &mesh];
    let told = done(&[&scan[..], &["--trajectory", &way]].concat()).stdout;
    let told = String::from_utf8(told).unwrap();
    assert!(told.contains("6 of 6 fused, placed by tracking"), "{told}");
    assert!(told.contains("mm off (ATE"), "{told}");
    assert_eq!(read_trajectory(Path::new(&way)).unwrap().poses().len(), 6);
    assert!(matches!(read_surface(Path::new(&mesh), None).unwrap().surface, Surface::Mesh(_)));
    let page = bench.name("scan.html");
    // One picture less: its frame is left out.
    let mut pictures = pictures(Path::new(&walk));
    std::fs::remove_file(pictures.swap_remove(2)).unwrap();
    done(&[&scan[..], &["--force", "--report", &page]].concat());
    let page = std::fs::read_to_string(page).unwrap();
    let without = |part: &str| part.split_once('"').map(|(_, words)| words.to_owned());
    let words = page.split("base64,").filter_map(without).collect::<String>();
    let words = page.split_once("base64,").map_or("", |(head, _)| head).to_owned() + &words;
    for told in [
        "The surface",
        "From the far side",
        "1 of 6 frames are left out",
        "Error of every frame",
        "Frames and the surface",
        "Pairs of every frame",
        "<td>3</td>",
        "left out</td>",
        "Open surface",
    ] {
        assert!(words.contains(told), "{told}: {words}");
    }
    assert_eq!(page.matches("data:image/png").count(), 4);
    assert!(!words.contains("NaN") && !words.contains("inf"), "{words}");
    let turned = ["scan", &walk, "--turntable", "calibrate", "-o", "part.ply"];
    refused(&turned, 65, "give --method kinfu too");
}

/// A camera that swings to and fro, in the format of TUM's trajectories; its clock is `early`.
fn swinging(early: f64) -> String {
    let line = |i: i32| {
        let stamp = f64::from(i) / 30.0;
        let half = 0.1 * (std::f64::consts::TAU * stamp / 0.9).sin();
        // A turn about the vertical after one that lays the picture upright.
        let (turn, upright) = (half.sin_cos(), std::f64::consts::FRAC_1_SQRT_2);
        let [x, y, z, w] = [-turn.1, -turn.0, turn.0, turn.1].map(|c| c * upright);
        format!("{:.6} 0 -1.5 0 {x:.9} {y:.9} {z:.9} {w:.9}\n", stamp - early)
    };
    (0..40).map(line).collect()
}

#[test]
fn how_late_stamps_are_is_found_by_the_poses() {
    let bench = Bench::new();
    let [way, late, walk, mesh] =
        ["way.txt", "late.txt", "walk", "part.ply"].map(|n| bench.name(n));
    std::fs::write(&way, swinging(0.0)).unwrap();
    std::fs::write(&late, swinging(0.03)).unwrap();
    let camera = bench.name("camera.toml");
    let scene = ["simulate-scan", "--scene", "textured-structured", "--along", &way];
    done(&[&scene[..], &["--camera", &camera, "-o", &walk]].concat());
    let fuse = ["fuse", &walk, "--voxel", "20", "-o", &mesh, "--find-pose-delay"];
    refused(&fuse, 65, "--find-pose-delay is for the stamps of");
    refused(&[&fuse[..], &["--pose-delay", "0.1"]].concat(), 2, "cannot be used with");
    let told = done(&[&fuse[..], &["--poses", &late, "--json"]].concat()).stdout;
    let report: serde_json::Value = serde_json::from_slice(&told).unwrap();
    let delay = &report["pose-delay"];
    let found = delay["seconds"].as_f64().unwrap();
    assert!((found - 0.03).abs() < 0.003, "{delay}");
    let apart = [0, 1].map(|i| delay["apart"][i].as_f64().unwrap());
    assert!(apart[1] < 0.5 * apart[0], "{delay}");
    let told = done(&[&fuse[..], &["--poses", &late, "--force"]].concat()).stdout;
    let told = String::from_utf8(told).unwrap();
    assert!(told.contains("before the stamps"), "{told}");
}

#[test]
fn inputs_that_cannot_be_fused_are_refused_and_nothing_is_written() {
    let bench = Bench::new();
    let mesh = bench.name("out.ply");
    let scan = bench.scan.as_str();
    refused(&["fuse", "nowhere", "-o", &mesh], 65, "nowhere");
    refused(&["fuse", scan, "-o", &mesh, "--voxel", "0"], 65, "--voxel is 0");
    refused(&["fuse", scan, "-o", &mesh, "--truncation", "1"], 65, "from 2 to 64 voxels");
    refused(&["fuse", scan, "-o", &mesh, "--keep-out", "5"], 65, "--truth-poses");
    refused(&["fuse", scan, "-o", &mesh, "--poses", "no.txt"], 65, "no.txt");
    let both = ["fuse", scan, "-o", &mesh, "--poses", "no.txt", "--truth-poses"];
    refused(&both, 2, "cannot be used with");
    refused(&["fuse", scan, "-o", &bench.name("out.doc")], 73, "out.doc");
    let little = ["fuse", scan, "-o", &mesh, "--truth-poses", "--voxel", "0.2", "--memory", "5"];
    refused(&little, 65, "may take 5 MB (--memory)");
    std::fs::remove_file(Path::new(scan).join("groundtruth.txt")).unwrap();
    refused(&["fuse", scan, "-o", &mesh, "--truth-poses"], 65, "has no groundtruth.txt");
    assert!(!Path::new(&mesh).exists());
}

#[test]
fn frames_that_cannot_be_read_are_left_out_and_if_they_are_most_nothing_is_written() {
    let bench = Bench::new();
    let mesh = bench.name("fused.ply");
    let pictures = pictures(Path::new(&bench.scan));
    std::fs::write(&pictures[3], "no picture").unwrap();
    let voxel = ["--voxel", "8"];
    let arguments = [&["fuse", &bench.scan, "--truth-poses", "-o", &mesh][..], &voxel].concat();
    let told = String::from_utf8(done(&arguments).stdout).unwrap();
    assert!(told.contains("35 of 36 fused, placed as given"), "{told}");
    assert!(told.contains("skipped   frame 4: "), "{told}");
    let Surface::Mesh(fused) = read_surface(Path::new(&mesh), None).unwrap().surface else {
        panic!("a fusion is a mesh")
    };
    assert!(fused.colors.is_some(), "the frames have colours");
    for picture in &pictures {
        std::fs::write(picture, "no picture").unwrap();
    }
    std::fs::remove_file(&mesh).unwrap();
    refused(&arguments, 65, "0 of 36 frames could be placed");
    assert!(!Path::new(&mesh).exists());
}
