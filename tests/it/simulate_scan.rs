//! `horma simulate-scan`: folders that read back as what was rendered.

use crate::command::horma;
use crate::parts::real;
use horma::geom::{Point3, Surface, shapes};
use horma::io::rgbd::{open_sequence, read_trajectory};
use horma::io::{Overwrite, write_surface};
use std::fs;
use std::path::{Path, PathBuf};

/// A small camera, so that a scan takes no time.
const CAMERA: &str = "width = 160\nheight = 120\nfx = 131\nfy = 131\ncx = 79.5\ncy = 59.5\n\
    depth-scale = 5000\n";

struct Bench {
    folder: tempfile::TempDir,
}

impl Bench {
    /// A folder with a ball of radius 100 and a camera.
    fn new() -> Self {
        let bench = Self { folder: tempfile::tempdir().unwrap() };
        let ball = shapes::sphere(&Point3::new(50.0, 20.0, 10.0), 100.0, 60);
        let path = bench.path("ball.ply");
        write_surface(&path, &Surface::Mesh(ball), Overwrite::Refuse).unwrap();
        fs::write(bench.path("camera.toml"), CAMERA).unwrap();
        bench
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn run(&self, arguments: &[&str]) -> (Option<i32>, String) {
        let output = std::process::Command::new(env!("CARGO_BIN_EXE_horma"))
            .arg("simulate-scan")
            .args(arguments)
            .current_dir(self.folder.path())
            .output()
            .unwrap();
        let told = [output.stdout, output.stderr].concat();
        (output.status.code(), String::from_utf8(told).unwrap())
    }
}

fn bytes_of(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let mut files = Vec::new();
    let mut waiting = vec![folder.to_owned()];
    while let Some(next) = waiting.pop() {
        for entry in fs::read_dir(next).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                waiting.push(path);
            } else {
                let name = path.strip_prefix(folder).unwrap().to_owned();
                files.push((name, fs::read(&path).unwrap()));
            }
        }
    }
    files.sort();
    files
}

const SMALL: [&str; 6] = ["--camera", "camera.toml", "--views", "6", "--distance", "500"];

#[test]
fn a_scan_reads_back_with_its_truth_and_lies_on_the_part() {
    let bench = Bench::new();
    let (code, told) = bench.run(&[&["ball.ply", "-o", "scan"], &SMALL[..]].concat());
    assert_eq!(code, Some(0), "{told}");
    assert!(told.starts_with("12 frames of 160 x 120, fx 131\n"), "{told}");
    let sequence = open_sequence(&bench.path("scan"), None).unwrap();
    assert!(sequence.notes.is_empty(), "{:?}", sequence.notes);
    let truth = sequence.truth.as_ref().unwrap();
    assert_eq!((sequence.files.len(), truth.poses().len()), (12, 12));
    let mut n_points = 0;
    for frame in sequence.frames() {
        let frame = frame.unwrap();
        frame.check_depth().unwrap();
        let pose = truth.nearest(frame.stamp).unwrap();
        assert!((pose.stamp - frame.stamp).abs() < 1e-9);
        let cloud = frame.cloud(&sequence.camera.camera).unwrap();
        for point in cloud.moved(&pose.world_from_camera).to_cloud().points {
            let radius = (point - Point3::new(50.0, 20.0, 10.0)).norm();
            // Chords of the mesh lie up to 0.13 mm inside; depth is rounded to 0.2 mm along rays that
            // are up to 1.2 times as long.
            assert!((99.7..100.13).contains(&radius), "{radius}");
            n_points += 1;
        }
    }
    assert!(n_points > 12 * 1500, "{n_points}");
    let color = sequence.read(&sequence.files[3]).unwrap().color.unwrap();
    let mut colors: Vec<_> = color.into_pixels();
    colors.sort_unstable();
    colors.dedup();
    assert!(colors.len() > 200, "a ball without colours has patches: {}", colors.len());
    assert!(fs::metadata(bench.path("scan/contact.png")).unwrap().len() > 1000);
}

#[test]
fn the_same_seed_gives_the_same_bytes_for_any_number_of_threads() {
    let bench = Bench::new();
    let scan = |name: &str, more: &[&str]| {
        let noise = ["ball.ply", "--noise", "kinect", "--path", "arc", "-o", name];
        let (code, told) = bench.run(&[&noise, &SMALL[..], more].concat());
        assert_eq!(code, Some(0), "{told}");
        bytes_of(&bench.path(name))
    };
    let one = scan("one", &["--threads", "1"]);
    assert_eq!(one.len(), 2 * 6 + 5);
    assert!(one == scan("three", &["--threads", "3"]));
    assert!(one != scan("other", &["--seed", "2"]));
}

#[test]
fn every_scene_is_seen_and_texture_is_what_it_says() {
    let bench = Bench::new();
    for (scene, is_textured, is_flat) in [
        ("textured-flat", true, true),
        ("plain-flat", false, true),
        ("textured-structured", true, false),
        ("plain-structured", false, false),
    ] {
        let small = &SMALL[..4];
        let (code, told) = bench.run(&[&["--scene", scene, "-o", scene], small].concat());
        assert_eq!(code, Some(0), "{told}");
        let sequence = open_sequence(&bench.path(scene), None).unwrap();
        let frame = sequence.frames().next().unwrap().unwrap();
        if is_flat {
            assert_eq!(frame.n_readings(), 160 * 120, "{scene}");
        }
        assert!(frame.n_readings() > 160 * 120 * 8 / 10, "{scene}: {}", frame.n_readings());
        let grey = horma::rgbd::grey(frame.color.as_ref().unwrap());
        let steps = (0..120).flat_map(|y| (1..160).map(move |x| (x, y)));
        let steep = steps.filter(|&(x, y)| (grey[(x, y)] - grey[(x - 1, y)]).abs() > 0.03).count();
        assert_eq!(steep > 2000, is_textured, "{scene}: {steep}");
    }
}

#[test]
fn a_camera_goes_along_a_given_trajectory() {
    let bench = Bench::new();
    let (code, told) = bench.run(&[&["ball.ply", "-o", "scan"], &SMALL[..]].concat());
    assert_eq!(code, Some(0), "{told}");
    let along = ["ball.ply", "-o", "again", "--along", "scan/groundtruth.txt"];
    let (code, told) = bench.run(&[&along, &SMALL[..2]].concat());
    assert_eq!(code, Some(0), "{told}");
    let read = |name: &str| read_trajectory(&bench.path(name)).unwrap();
    let pairs = read("scan/groundtruth.txt").poses().to_vec().into_iter();
    for (a, b) in pairs.zip(read("again/groundtruth.txt").poses()) {
        let off = a.world_from_camera.inverse() * b.world_from_camera;
        assert!(off.translation.vector.norm() < 1e-9);
    }
    let [first, second] = ["scan", "again"].map(|name| bytes_of(&bench.path(name).join("depth")));
    assert!(first == second);
}

#[test]
fn a_scan_is_never_written_over_what_is_no_scan() {
    let bench = Bench::new();
    let scan = |more: &[&str]| bench.run(&[&["ball.ply", "-o", "scan"], &SMALL[..], more].concat());
    assert_eq!(scan(&[]).0, Some(0));
    let (code, told) = scan(&[]);
    assert_eq!(code, Some(73));
    assert!(told.contains("\"scan\" exists already") && told.contains("--force"), "{told}");
    assert_eq!(scan(&["--force", "--seed", "5"]).0, Some(0));
    fs::write(bench.path("scan/mine.txt"), "keep").unwrap();
    let (code, told) = scan(&["--force"]);
    assert_eq!(code, Some(73));
    assert!(told.contains("it holds \"mine.txt\""), "{told}");
    assert_eq!(fs::read(bench.path("scan/mine.txt")).unwrap(), b"keep");
    let left: Vec<_> =
        fs::read_dir(bench.folder.path()).unwrap().map(|e| e.unwrap().file_name()).collect();
    assert_eq!(left.len(), 3, "nothing else is left behind: {left:?}");
}

#[test]
fn what_is_no_scan_is_told() {
    let bench = Bench::new();
    fs::write(bench.path("points.xyz"), "0 0 0\n100 0 0\n0 100 0\n").unwrap();
    fs::write(bench.path("lens.toml"), format!("{CAMERA}[distortion]\nk1 = 0.1\n")).unwrap();
    fs::write(bench.path("bad.toml"), CAMERA.replace("fx = 131", "fx = 0")).unwrap();
    for (arguments, code, message) in [
        (&["-o", "scan"][..], 2, "required"),
        (&["ball.ply"], 2, "--output <DIR>"),
        (&["ball.ply", "--scene", "plain-flat", "-o", "scan"], 2, "cannot be used with"),
        (&["--scene", "moon", "-o", "scan"], 2, "possible values: textured-flat, plain-flat"),
        (&["points.xyz", "-o", "scan"], 65, "points.xyz is a cloud of points"),
        (&["ball.ply", "--distance", "100", "-o", "scan"], 65, "let it stand farther away"),
        (&["ball.ply", "--views", "1", "-o", "scan"], 65, "--views is 1"),
        (&["ball.ply", "--elevations", "95", "-o", "scan"], 65, "--elevations is 95"),
        (&["ball.ply", "--camera", "lens.toml", "-o", "scan"], 65, "has a perfect lens"),
        (&["ball.ply", "--camera", "bad.toml", "-o", "scan"], 65, "bad.toml:3:6: fx is 0"),
        (&["ball.ply", "-o", "no/scan"], 73, "the folder \"no\" does not exist"),
        (
            &["ball.ply", "--along", "points.xyz", "-o", "scan"],
            65,
            "3 columns where there must be 8",
        ),
    ] {
        let (found, told) = bench.run(arguments);
        assert_eq!(found, Some(code), "{arguments:?}: {told}");
        assert!(told.contains(message), "{arguments:?}: {told}");
        assert!(!bench.path("scan").exists());
    }
}

#[cfg(unix)]
#[test]
fn ctrl_c_stops_a_scan_within_a_second_and_leaves_nothing() {
    use std::time::{Duration, Instant};
    let bench = Bench::new();
    let mut child = std::process::Command::new(env!("CARGO_BIN_EXE_horma"))
        .args(["simulate-scan", "ball.ply", "--views", "50000", "-o", "scan"])
        .current_dir(bench.folder.path())
        .stderr(std::process::Stdio::null())
        .stdout(std::process::Stdio::null())
        .spawn()
        .unwrap();
    let begun = Instant::now();
    // Once its temporary folder is there it is at work.
    while fs::read_dir(bench.folder.path()).unwrap().count() < 3 {
        assert!(begun.elapsed() < Duration::from_mins(1), "it never began");
        std::thread::sleep(Duration::from_millis(20));
    }
    std::thread::sleep(Duration::from_millis(300));
    let asked = Instant::now();
    let killed =
        std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status();
    assert!(killed.unwrap().success());
    assert_eq!(child.wait().unwrap().code(), Some(75));
    assert!(asked.elapsed() < Duration::from_secs(1), "{:?}", asked.elapsed());
    assert_eq!(fs::read_dir(bench.folder.path()).unwrap().count(), 2);
}

#[test]
fn a_real_walk_is_gone_before_a_scene() {
    let Some(truth) = real("rgbd/tum_fr1_rpy_fast_cut/groundtruth.txt") else { return };
    let n_poses = read_trajectory(&truth).unwrap().poses().len();
    let bench = Bench::new();
    let along = ["--scene", "plain-structured", "--along", truth.to_str().unwrap(), "-o", "scan"];
    let output = horma(
        &[
            &["simulate-scan", "--camera", bench.path("camera.toml").to_str().unwrap()][..],
            &along[..4],
            &["-o", bench.path("scan").to_str().unwrap()],
        ]
        .concat(),
    );
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(open_sequence(&bench.path("scan"), None).unwrap().files.len(), n_poses);
}
