//! `horma reduce` and `horma mean-error`: from a file to fewer points, and what they refuse.

use crate::command::horma;
use horma::geom::{CloudParts, Point3, PointCloud, Surface, shapes};
use horma::io::{Overwrite, open_cloud, read_network, read_surface, write_surface};
use serde_json::Value;
use std::path::PathBuf;
use std::process::Output;

struct Bench(tempfile::TempDir);

impl Bench {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn path(&self, name: &str) -> String {
        self.0.path().join(name).to_str().unwrap().to_owned()
    }

    /// The corners of a chiral body, coloured.
    fn cloud(&self) -> String {
        let points = shapes::chiral(8000).points;
        let colors = points.iter().map(|p| [(p.x.abs() * 2.0) as u8, 100, 7]).collect();
        self.put("cloud.ply", PointCloud { points, normals: None, colors: Some(colors) })
    }

    fn put(&self, name: &str, cloud: PointCloud) -> String {
        let path = self.path(name);
        write_surface(path.as_ref(), &Surface::Points(cloud), Overwrite::Replace).unwrap();
        path
    }
}

fn json(output: &Output) -> Value {
    assert!(output.status.success(), "{}", stderr(output));
    serde_json::from_slice(&output.stdout).unwrap()
}

fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

#[test]
fn every_method_writes_its_points_and_tells_the_error_that_mean_error_finds() {
    let bench = Bench::new();
    let cloud = bench.cloud();
    for method in ["voxel", "octree", "gng"] {
        let out = bench.path(&format!("{method}.ply"));
        let count = ["--count", "400", "--method", method, "-o", &out, "--json"];
        let report = json(&horma(&[&["reduce", &cloud], &count[..]].concat()));
        let few = read_surface(out.as_ref(), None).unwrap().surface;
        assert_eq!(report["n-representatives"], few.points().len());
        // The corners lie in rows: cells take many of them at once.
        assert!(few.points().len().abs_diff(400) <= 10, "{report}");
        let measured = json(&horma(&["mean-error", &out, &cloud, "--json"]));
        let [a, b] =
            [&report["error"]["mean"], &measured["error"]["mean"]].map(|x| x.as_f64().unwrap());
        assert!((a - b).abs() < 1e-4 * a && 0.0 < a, "{a} {b}");
    }
}

#[test]
fn a_network_keeps_its_edges_and_grows_on() {
    let bench = Bench::new();
    let cloud = bench.cloud();
    let (small, large) = (bench.path("small.ply"), bench.path("large.ply"));
    let gng = ["reduce", &cloud, "--method", "gng", "--lambda", "200"];
    json(&horma(&[&gng[..], &["--count", "100", "-o", &small, "--json"]].concat()));
    let graph = read_network(small.as_ref(), None).unwrap().unwrap();
    assert_eq!((graph.neurons.points.len(), graph.errors.len()), (100, 100));
    assert!(graph.neurons.colors.unwrap().iter().all(|color| color[1..] == [100, 7]));
    let on = ["--from", &small, "--count", "130", "--polish", "2", "-o", &large, "--json"];
    let report = json(&horma(&[&gng[..], &on].concat()));
    assert_eq!(report["learned"]["stopped"], "count");
    assert_eq!(report["learned"]["n-signals"], 31 * 200);
    let glb = bench.path("net.glb");
    json(&horma(&[&gng[..], &["--max-signals", "4000", "-o", &glb, "--json"]].concat()));
    assert!(std::fs::read(&glb).unwrap().starts_with(b"glTF"));
}

#[test]
fn the_report_for_people_says_what_was_done() {
    let bench = Bench::new();
    let (cloud, out) = (bench.cloud(), bench.path("out.xyz"));
    let done = horma(&["reduce", &cloud, "--size", "5", "-o", &out]);
    let text = String::from_utf8(done.stdout).unwrap();
    for words in ["reduced", "cells    of 5.0000 mm", "mm on average", "wrote", "units mm"] {
        assert!(text.contains(words), "{words} in {text}");
    }
}

#[test]
fn what_cannot_be_done_is_refused_with_its_reason() {
    let bench = Bench::new();
    let (cloud, out) = (bench.cloud(), bench.path("out.ply"));
    let one = bench
        .put("one.ply", PointCloud { points: vec![Point3::origin()], ..PointCloud::default() });
    let empty = bench.path("empty.xyz");
    std::fs::write(&empty, "# nothing\n").unwrap();
    for (args, code, words) in [
        (vec![cloud.as_str()], 65, "--count N or --size MM"),
        (vec![&cloud, "--size", "5", "--count", "9"], 2, "cannot be used with"),
        (vec![&cloud, "--size", "0"], 65, "0 mm has no size"),
        (vec![&cloud, "--count", "0"], 65, "at least 1"),
        (vec![&cloud, "--count", "999999"], 65, "ask for fewer"),
        (vec![&cloud, "--method", "gng"], 65, "--target-error"),
        (vec![&cloud, "--method", "gng", "--count", "0"], 65, "at least 2"),
        (vec![&cloud, "--method", "gng", "--size", "3"], 65, "--size is not for --method gng"),
        (vec![&cloud, "--count", "9", "--lambda", "5"], 65, "or give --method gng"),
        (vec![&cloud, "--count", "9", "--from", &one], 65, "is no network"),
        (vec![&cloud, "--method", "octree", "--size", "9", "--level", "40"], 65, "levels 0 to"),
        (vec![&cloud, "--method", "gng", "--count", "9", "--lambda", "0"], 65, "--lambda is 0"),
        (vec![&empty, "--size", "1"], 65, "empty.xyz"),
        (vec!["none.ply", "--size", "1"], 65, "none.ply"),
    ] {
        let done = horma(&[&["reduce", "-o", &out], &args[..]].concat());
        let text = stderr(&done);
        assert_eq!(done.status.code(), Some(code), "{args:?}: {text}");
        assert!(text.contains(words), "{words:?} in {text}");
        assert!(!PathBuf::from(&out).exists());
    }
}

#[test]
fn one_point_and_points_in_one_place_stand_for_themselves() {
    let bench = Bench::new();
    let out = bench.path("out.ply");
    for n in [1, 5] {
        let points = vec![Point3::new(1.0, 2.0, 3.0); n];
        let cloud = bench.put("same.ply", PointCloud { points, ..PointCloud::default() });
        for method in ["voxel", "octree", "gng"] {
            let args = [
                "reduce", &cloud, "--method", method, "--count", "1", "-o", &out, "--force",
                "--json",
            ];
            let args = if method == "gng" && n == 5 {
                args.map(|a| if a == "1" { "2" } else { a })
            } else {
                args
            };
            let report = json(&horma(&args));
            assert_eq!(report["n-representatives"], 1, "{method} of {n}");
            let found = open_cloud(out.as_ref(), None).unwrap();
            assert_eq!(found.n_points(), 1);
        }
    }
}
