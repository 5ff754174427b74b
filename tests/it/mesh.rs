//! `horma mesh`: from a cloud in a file to a surface that can be cut, and what it refuses.

use crate::command::horma;
use crate::dropping::contacts;
use crate::jobs::small_last;
use crate::textbook::Tool;
use horma::cam::{Method, Part};
use horma::geom::{Aabb, Point3, PointCloud, Pose, Surface, TriMesh, Vector3, shapes, topology};
use horma::io::{Overwrite, read_surface, write_surface};
use horma::progress::Silent;
use horma::represent::gng::GngOptions;
use horma::represent::surface::SurfaceOptions;
use horma::tool::Profile;
use horma::workflow::mesh::{MeshJob, MeshSource, mesh};
use nalgebra::{Translation3, UnitQuaternion};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::f64::consts::TAU;
use std::path::Path;
use std::process::Output;

/// `n` points evenly over a mesh, each off it by up to `noise` along each axis.
fn scanned(mesh: &TriMesh, n: usize, noise: f64) -> PointCloud {
    let mut random = Pcg64Mcg::seed_from_u64(5);
    let mut sum = 0.0;
    let areas = (0..mesh.triangles.len()).map(|i| mesh.area_vector(i).norm());
    let sums: Vec<f64> = areas.map(|area| (sum += area, sum).1).collect();
    let points = (0..n).map(|_| {
        let at = random.random::<f64>() * sum;
        let [a, b, c] = mesh.corners(sums.partition_point(|&s| s < at).min(sums.len() - 1));
        let (mut u, mut v) = (random.random::<f64>(), random.random::<f64>());
        if u + v > 1.0 {
            (u, v) = (1.0 - u, 1.0 - v);
        }
        let off = Vector3::from_fn(|_, _| noise * (2.0 * random.random::<f64>() - 1.0));
        a + (b - a) * u + (c - a) * v + off
    });
    PointCloud { points: points.collect(), ..PointCloud::default() }
}

fn put(folder: &Path, name: &str, cloud: PointCloud) -> String {
    let path = folder.join(name);
    write_surface(&path, &Surface::Points(cloud), Overwrite::Replace).unwrap();
    path.to_str().unwrap().to_owned()
}

fn ball() -> PointCloud {
    scanned(&shapes::sphere(&Point3::origin(), 20.0, 40), 6_000, 0.02)
}

fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

#[test]
fn a_cloud_in_a_file_becomes_a_closed_surface_in_another() {
    let folder = tempfile::tempdir().unwrap();
    let cloud = put(folder.path(), "ball.ply", ball());
    let part = folder.path().join("part.stl");
    let part_name = part.to_str().unwrap();
    let arguments =
        ["mesh", &cloud, "--units", "mm", "--count", "400", "--lambda", "200", "-o", part_name];
    let output = horma(&[&arguments[..], &["--json"]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["is_closed"], true);
    assert_eq!((&report["euler"], &report["n_neurons"]), (&2.into(), &400.into()));
    assert!(report["fit"]["cloud-to-mesh"]["max"].as_f64().unwrap() < 1.0, "{report}");
    let Surface::Mesh(mesh) = read_surface(&part, None).unwrap().surface else { panic!() };
    let found = topology(&mesh);
    assert!(found.is_closed() && found.volume.is_some_and(|volume| volume > 30_000.0), "{found:?}");
    // It is there now, and stays unless it may be replaced.
    assert_eq!(horma(&arguments).status.code(), Some(73));
    let output = horma(&[&arguments[..], &["--force"]].concat());
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(
        text.starts_with("surface  closed, 796 triangles in one piece, Euler number 2"),
        "{text}"
    );
}

#[test]
fn a_network_in_a_file_has_the_surface_of_its_cloud() {
    let folder = tempfile::tempdir().unwrap();
    let cloud = put(folder.path(), "ball.ply", ball());
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let (net, part, alone) = (path("net.ply"), path("part.stl"), path("alone.stl"));
    let run = |arguments: &[&str]| {
        let output = horma(&[arguments, &["--units", "mm"]].concat());
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        String::from_utf8(output.stdout).unwrap()
    };
    let gng = ["--method", "gng", "--count", "400", "--lambda", "200"];
    run(&[&["reduce", &cloud, "-o", &net], &gng[..]].concat());
    let closed = "surface  closed, 796 triangles in one piece, Euler number 2";
    let text = run(&["mesh", &net, "--cloud", &cloud, "-o", &part]);
    assert!(text.starts_with(closed) && text.contains("from the points to the surface"), "{text}");
    let text = run(&["mesh", &net, "-o", &alone]);
    assert!(text.starts_with(closed) && !text.contains("from the points"), "{text}");
}

#[test]
fn what_cannot_become_a_surface_is_refused_with_the_reason() {
    let folder = tempfile::tempdir().unwrap();
    let cloud = put(folder.path(), "ball.ply", ball());
    let flat = ball().points.iter().map(|p| Point3::new(p.x, p.y, 1.0)).collect();
    let flat = put(folder.path(), "flat.ply", PointCloud { points: flat, ..Default::default() });
    let one = PointCloud { points: vec![Point3::origin(); 9], ..Default::default() };
    let one = put(folder.path(), "one.ply", one);
    let refused = |arguments: &[&str], output: &str, code: i32, expected: &str| {
        let path = folder.path().join(output);
        let fixed = ["--units", "mm", "-o", path.to_str().unwrap()];
        let run = horma(&[&["mesh"], arguments, &fixed].concat());
        let text = stderr(&run);
        assert_eq!(run.status.code(), Some(code), "{text}");
        assert!(text.contains(expected), "{text}");
        assert!(!path.exists());
    };
    refused(&[&cloud], "part.xyz", 65, "would hold points alone; give a name ending in .stl");
    refused(&[&cloud, "--close", "-3"], "part.stl", 2, "unexpected argument '-3'");
    refused(&[&cloud, "--close=-3"], "part.stl", 65, "--close is -3; give a length of 0 or above");
    refused(&[&cloud, "--count", "7000"], "part.stl", 65, "the cloud has only 6000 points");
    refused(&[&cloud, "--count", "1"], "part.stl", 65, "a network has at least 2");
    refused(&[&cloud, "--lambda", "0"], "part.stl", 65, "--lambda is 0");
    refused(&[&flat, "--lambda", "20"], "part.stl", 65, "in one plane span no body");
    refused(&[&one], "part.stl", 65, "in one plane span no body");
    refused(&[&cloud, "--cloud", &cloud], "part.stl", 65, "is no network, and --cloud is for one");
    refused(&["no.ply"], "part.stl", 65, "no.ply");
}

#[test]
fn a_wheel_on_the_surface_of_a_scanned_last_stands_where_it_does_on_the_last() {
    let last = small_last(120.0);
    let middle = last.aabb().center();
    let last = last.moved(&Pose::translation(-middle.x, -middle.y, -middle.z));
    // The neurons are as far apart as 20,000 on a last of 265 mm, where the bar is 0.3 mm (EXPERIMENTS.md, section 16).
    // This last is bent 2.2 times as much, and chords between neurons lie as much deeper.
    let cloud = scanned(&last, 40_000, 0.05);
    let gng = GngOptions { lambda: 300, ..GngOptions::default() };
    let source = MeshSource::Cloud { cloud: &cloud, n_neurons: Some(4_000), gng: &gng };
    let options = SurfaceOptions::default();
    let job = MeshJob { source, options: &options, notes: Vec::new() };
    let made = mesh(job, &Silent).unwrap();
    assert!(made.report.is_closed && made.report.euler == 2, "{:?}", made.report);
    let poses = helix(&last.aabb());
    let tool =
        Tool { profile: Profile::Wheel { major_radius: 60.0, minor_radius: 10.0 }, allowance: 0.0 };
    let heights = |mesh: &TriMesh| contacts(&Part::triangles(mesh), &tool, Method::Indexed, &poses);
    let both = heights(&last).into_iter().zip(heights(&made.mesh));
    let mut apart: Vec<f64> =
        both.map(|(a, b)| (a.unwrap().height - b.unwrap().height).abs()).collect();
    apart.sort_by(f64::total_cmp);
    let [middle, most] = [0.5, 0.95].map(|share| apart[(share * apart.len() as f64) as usize]);
    assert!(middle < 0.2 && most < 0.6, "{middle} {most}");
}

/// A last lathe's way around a part, a little short of its ends.
fn helix(aabb: &Aabb) -> Vec<Pose> {
    let (n_turns, n_steps) = (40, 90);
    let at = |i: usize| {
        let share = i as f64 / f64::from(n_turns * n_steps);
        let x = aabb.min.x + 1.0 + share * (aabb.size().x - 2.0);
        let turned =
            UnitQuaternion::from_axis_angle(&Vector3::x_axis(), share * TAU * f64::from(n_turns));
        Pose::from_parts(Translation3::new(-x, 0.0, 0.0), turned)
    };
    (0..(n_turns * n_steps) as usize).map(at).collect()
}
