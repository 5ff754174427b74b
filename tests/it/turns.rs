//! `horma fuse --turntable` with a part that was turned several times.

use crate::fuse::{Bench, done, refused};
use horma::geom::{Surface, distances_from_mesh};
use horma::io::read_surface;
use horma::io::rgbd::read_trajectory;
use std::path::Path;

#[test]
fn two_turns_of_a_last_are_calibrated_laid_on_each_other_and_fused() {
    let bench = Bench::new();
    let (mesh, page) = (bench.name("part.ply"), bench.name("part.html"));
    let way = bench.name("way.txt");
    let fuse = ["fuse", &bench.scan, "--turntable", "calibrate", "--turns", "2", "--voxel", "4"];
    let outputs = ["-o", &mesh, "--report", &page, "--trajectory", &way, "--json"];
    let output = done(&[&fuse[..], &outputs].concat());
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((&report["n-fused"], &report["n-frames"]), (&36.into(), &36.into()), "{report}");
    for turn in report["turns"].as_array().unwrap() {
        let step = turn["turntable"]["step-deg"].as_f64().unwrap();
        assert!((step.abs() - 20.0).abs() < 0.05, "{turn}");
        assert!(turn["lies-on-others"].as_f64().unwrap() > 0.3, "{turn}");
    }
    // The surface is in the frame of the first camera, the last in its own.
    let truth = read_trajectory(&Path::new(&bench.scan).join("groundtruth.txt")).unwrap();
    let last_from_first = truth.poses()[0].world_from_camera;
    let surface = |name: &str| read_surface(&bench.path(name), None).unwrap().surface;
    let (Surface::Mesh(part), Surface::Mesh(last)) = (surface("part.ply"), surface("last.stl"))
    else {
        panic!()
    };
    let mut off = distances_from_mesh(&last, &part.moved(&last_from_first).points);
    off.sort_by(f64::total_cmp);
    let median = off[off.len() / 2];
    assert!(median < 0.5, "half of the vertices lie within {median} mm");
    assert_eq!(read_trajectory(Path::new(&way)).unwrap().poses().len(), 36);
    let page = std::fs::read_to_string(page).unwrap();
    assert!(page.contains("<h2>Turns</h2>") && page.contains("scan, turn 2</td>"), "{page}");
}

#[test]
fn turns_that_cannot_be_are_refused_with_what_would_do() {
    let bench = Bench::new();
    let (scan, mesh) = (bench.scan.as_str(), bench.name("part.ply"));
    let refused = |more: &[&str], message: &str| {
        refused(&[&["fuse", scan, "-o", &mesh][..], more].concat(), 65, message);
    };
    refused(&[scan], "give --turntable too");
    let table = ["--turntable", "calibrate"];
    let with = |more: &[&'static str]| [&table[..], more].concat();
    refused(&with(&["--turns", "5"]), "36 frames are not 5 turns of as many each (--turns)");
    refused(&with(&["--turns", "0"]), "36 frames are not 0 turns");
    refused(&with(&["--turns", "2", "--truth-poses"]), "leave --poses and --truth-poses out");
    let write = bench.name("table.toml");
    let write = [&table[..], &["--turns", "2", "--write-turntable", &write]].concat();
    refused(&write, "a turntable of its own");
    // Half a camera.
    let other = bench.name("other");
    std::fs::create_dir(&other).unwrap();
    for name in ["depth.txt", "rgb.txt", "camera.toml"] {
        let text = std::fs::read_to_string(Path::new(scan).join(name)).unwrap();
        let text = text.replace("fx = 200", "fx = 100");
        std::fs::write(Path::new(&other).join(name), text).unwrap();
    }
    refused(&[&table[..], &[&other]].concat(), "was taken by another camera than");
    let several = ["scan", scan, &other, "-o", &mesh];
    crate::fuse::refused(&several, 65, "2 folders are given; a camera is followed through one");
    assert!(!Path::new(&mesh).exists());
}
