//! Surfaces of known form, grown from clouds drawn on them.

use super::*;
use crate::geom::shapes::{cuboid, sphere};
use crate::geom::{Aabb, MeshReport, Point3, Vector3, topology};
use crate::progress::Silent;
use crate::represent::gng::{GngOptions, GraphEdge, grow};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// Points evenly over a mesh, off it by up to `noise` along each axis.
fn drawn_on(mesh: &TriMesh, n: usize, noise: f64) -> PointCloud {
    let mut random = Pcg64Mcg::seed_from_u64(7);
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
        let off = Vector3::from_fn(|_, _| (2.0 * random.random::<f64>() - 1.0) * noise);
        a + (b - a) * u + (c - a) * v + off
    });
    PointCloud { points: points.collect(), ..PointCloud::default() }
}

fn block(max: Point3) -> TriMesh {
    cuboid(&Aabb { min: Point3::origin(), max })
}

fn torus(big: f64, small: f64) -> TriMesh {
    let (n, m) = (96, 48);
    let at = |i: usize, j: usize| {
        let (a, b) = (i as f64 / n as f64, j as f64 / m as f64);
        let (a, b) = (a * std::f64::consts::TAU, b * std::f64::consts::TAU);
        let out = big + small * b.cos();
        Point3::new(out * a.cos(), out * a.sin(), small * b.sin())
    };
    let points = (0..n).flat_map(|i| (0..m).map(move |j| at(i, j))).collect();
    let corner = |i: usize, j: usize| ((i % n) * m + j % m) as u32;
    let quad = |i, j| [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
    let quads = (0..n).flat_map(|i| (0..m).map(move |j| quad(i, j)));
    TriMesh::new(points, quads.flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect())
}

fn network(cloud: &PointCloud, n_neurons: usize) -> NeuronGraph {
    let options = GngOptions { lambda: 300, ..GngOptions::default() };
    grow(&mut &*cloud, None, Some(n_neurons), &options, &Silent).unwrap().graph
}

fn surface_of(cloud: &PointCloud, n_neurons: usize) -> (NetworkSurface, MeshReport) {
    let graph = network(cloud, n_neurons);
    let options = SurfaceOptions::default();
    let found = surface(&graph, Some(cloud), &options, &Silent).unwrap();
    assert_sound(&found.mesh);
    let report = topology(&found.mesh);
    (found, report)
}

/// Nothing non-manifold, doubled, or wound against its neighbours.
fn assert_sound(mesh: &TriMesh) {
    let report = topology(mesh);
    let MeshReport { n_non_manifold_edges, n_flipped_edges, n_duplicate_triangles, .. } = report;
    assert_eq!((n_non_manifold_edges, n_flipped_edges, n_duplicate_triangles), (0, 0, 0));
    assert_eq!((report.n_unused_points, report.n_degenerate_triangles), (0, 0));
    // One fan to a vertex: round it as many edges as faces, or one more where it lies on a rim.
    let mut rounds: Vec<Vec<[u32; 2]>> = vec![Vec::new(); mesh.points.len()];
    for &[a, b, c] in &mesh.triangles {
        for (corner, side) in [(a, [b, c]), (b, [c, a]), (c, [a, b])] {
            rounds[corner as usize].push(side);
        }
    }
    for round in rounds {
        let starts: Vec<u32> =
            round.iter().map(|s| s[0]).filter(|a| round.iter().all(|s| s[1] != *a)).collect();
        assert!(starts.len() <= 1, "a vertex on two rims");
        let mut here = starts.first().copied().unwrap_or(round[0][0]);
        let mut n = 0;
        while let Some(side) = round.iter().find(|side| side[0] == here) {
            (here, n) = (side[1], n + 1);
            if n == round.len() {
                break;
            }
        }
        assert_eq!(n, round.len(), "more than one fan in a vertex");
    }
}

fn euler(mesh: &TriMesh, report: &MeshReport) -> isize {
    let n_edges = report.n_open_edges + (3 * mesh.triangles.len() - report.n_open_edges) / 2;
    (mesh.points.len() + mesh.triangles.len()).cast_signed() - n_edges.cast_signed()
}

#[test]
fn a_ball_scanned_all_around_becomes_closed_and_holds_its_volume() {
    let cloud = drawn_on(&sphere(&Point3::origin(), 20.0, 60), 20_000, 0.05);
    let (found, report) = surface_of(&cloud, 600);
    assert!(report.is_closed());
    assert_eq!((report.n_components, euler(&found.mesh, &report)), (1, 2));
    let volume = report.volume.unwrap() / (4.0 / 3.0 * std::f64::consts::PI * 8000.0);
    assert!((0.96..1.0).contains(&volume), "{volume}");
}

#[test]
fn a_ring_keeps_its_hole() {
    let (found, report) = surface_of(&drawn_on(&torus(30.0, 9.0), 30_000, 0.0), 1000);
    assert_eq!((report.is_closed(), report.n_components), (true, 1));
    assert_eq!(euler(&found.mesh, &report), 0);
    assert!(report.volume.unwrap() > 0.0);
}

#[test]
fn half_a_ball_ends_in_one_rim_that_can_be_closed() {
    let mut cloud = drawn_on(&sphere(&Point3::origin(), 20.0, 60), 20_000, 0.02);
    cloud.points.retain(|p| p.z > 0.0);
    let (found, report) = surface_of(&cloud, 500);
    assert_eq!((report.n_components, report.is_closed()), (1, false));
    let [rim] = &rims(&found.mesh)[..] else { panic!("{:?}", rims(&found.mesh)) };
    assert!((rim.length / (std::f64::consts::TAU * 20.0) - 1.0).abs() < 0.1, "{rim:?}");
    assert!(Point3::from(rim.middle).coords.norm() < 1.5, "{rim:?}");
    let up: f64 = (0..found.mesh.triangles.len()).map(|i| found.mesh.area_vector(i).z).sum();
    assert!(up > 0.0, "it bulges outwards");
    let graph = network(&cloud, 500);
    let all = SurfaceOptions { close: Some(1e9) };
    let closed = surface(&graph, Some(&cloud), &all, &Silent).unwrap().mesh;
    assert_sound(&closed);
    assert!(topology(&closed).volume.is_some_and(|volume| volume > 0.0));
}

#[test]
fn a_box_keeps_its_sharp_edges() {
    let mesh = block(Point3::new(30.0, 20.0, 10.0));
    let (found, report) = surface_of(&drawn_on(&mesh, 30_000, 0.02), 1500);
    assert_eq!((report.is_closed(), euler(&found.mesh, &report)), (true, 2));
    let volume = report.volume.unwrap() / 6000.0;
    assert!((0.95..1.0).contains(&volume), "{volume}");
}

#[test]
fn a_thin_plate_keeps_both_faces() {
    // Neurons are 1 mm apart.
    let mesh = block(Point3::new(30.0, 20.0, 1.5));
    let (found, report) = surface_of(&drawn_on(&mesh, 40_000, 0.02), 1500);
    assert_eq!((report.is_closed(), euler(&found.mesh, &report)), (true, 2));
    let volume = report.volume.unwrap() / 900.0;
    assert!((0.85..1.0).contains(&volume), "{volume}");
}

#[test]
fn two_balls_near_each_other_stay_two() {
    let mut cloud = drawn_on(&sphere(&Point3::origin(), 10.0, 60), 15_000, 0.02);
    let other = drawn_on(&sphere(&Point3::new(22.0, 0.0, 0.0), 10.0, 60), 15_000, 0.02);
    cloud.points.extend(other.points);
    let (_, report) = surface_of(&cloud, 1000);
    assert_eq!((report.is_closed(), report.n_components), (true, 2));
    assert!((report.volume.unwrap() / 8377.6 - 0.98).abs() < 0.02, "{:?}", report.volume);
}

#[test]
fn a_ball_in_a_ball_is_a_cavity() {
    let mut cloud = drawn_on(&sphere(&Point3::origin(), 20.0, 60), 20_000, 0.02);
    cloud.points.extend(drawn_on(&sphere(&Point3::origin(), 12.0, 60), 8_000, 0.02).points);
    let (_, report) = surface_of(&cloud, 900);
    assert_eq!((report.is_closed(), report.n_components), (true, 2));
    let volume = report.volume.unwrap() / (4.0 / 3.0 * std::f64::consts::PI * (8000.0 - 1728.0));
    assert!((0.95..1.02).contains(&volume), "{volume}");
}

#[test]
fn noise_a_third_of_an_edge_wide_leaves_the_ball_closed() {
    let cloud = drawn_on(&sphere(&Point3::origin(), 20.0, 60), 40_000, 0.8);
    let (found, report) = surface_of(&cloud, 600);
    assert_eq!((report.is_closed(), euler(&found.mesh, &report)), (true, 2));
}

#[test]
fn a_wavy_sheet_stays_open_and_faces_as_its_normals_say() {
    let mut random = Pcg64Mcg::seed_from_u64(3);
    let at =
        |x: f64, y: f64| Point3::new(60.0 * x, 40.0 * y, 3.0 * (8.0 * x).sin() * (5.0 * y).cos());
    let points: Vec<_> = (0..20_000).map(|_| at(random.random(), random.random())).collect();
    let mut cloud = PointCloud { points, ..PointCloud::default() };
    for side in [1.0, -1.0] {
        cloud.normals = Some(vec![Vector3::z() * side; cloud.points.len()]);
        let (found, report) = surface_of(&cloud, 800);
        assert_eq!((report.n_components, rims(&found.mesh).len()), (1, 1));
        let up: f64 = (0..found.mesh.triangles.len()).map(|i| found.mesh.area_vector(i).z).sum();
        assert!((up * side / 2400.0 - 0.95).abs() < 0.06, "{up}");
    }
}

#[test]
fn a_network_alone_has_a_surface_too() {
    let cloud = drawn_on(&torus(30.0, 9.0), 30_000, 0.02);
    let graph = network(&cloud, 1000);
    let found = surface(&graph, None, &SurfaceOptions::default(), &Silent).unwrap();
    assert_sound(&found.mesh);
    let report = topology(&found.mesh);
    assert_eq!((report.is_closed(), euler(&found.mesh, &report)), (true, 0));
}

#[test]
fn random_networks_never_have_a_bad_edge() {
    let mut random = Pcg64Mcg::seed_from_u64(11);
    for n in [5, 20, 200, 1000] {
        let points = (0..n).map(|_| Point3::from(random.random::<[f64; 3]>())).collect();
        let neurons = PointCloud { points, ..PointCloud::default() };
        let mut edges = Vec::new();
        for _ in 0..6 * n {
            let [a, b] = [random.random_range(0..n), random.random_range(0..n)];
            if a != b {
                edges.push(GraphEdge { ends: [a.min(b), a.max(b)], age: 0 });
            }
        }
        let graph = NeuronGraph { neurons, edges, errors: Vec::new() };
        let everything = SurfaceOptions { close: Some(1e9) };
        for options in [SurfaceOptions::default(), everything] {
            match surface(&graph, None, &options, &Silent) {
                Ok(found) => assert_sound(&found.mesh),
                Err(error) => assert_eq!(error, SurfaceError::Nothing),
            }
        }
    }
}

#[test]
fn random_sides_with_random_faces_missing_still_make_a_sound_mesh() {
    let mut random = Pcg64Mcg::seed_from_u64(5);
    let mut n_crossed = 0;
    for round in 0..300 {
        let n = 5 + round % 40;
        let points: Vec<_> = (0..n).map(|_| Point3::from(random.random::<[f64; 3]>())).collect();
        let cells = delaunay(&points, &Silent).unwrap();
        let sides: Vec<bool> = cells.iter().map(|_| random.random()).collect();
        let neurons = PointCloud { points, ..PointCloud::default() };
        let graph = NeuronGraph { neurons, ..NeuronGraph::default() };
        let skin = Skin::between(&cells, &sides, &Links::of(&graph, None, &Silent).unwrap());
        let kept: Vec<bool> =
            skin.faces.iter().map(|_| round % 2 == 0 || random.random_bool(0.8)).collect();
        let mut skin = skin.only(&kept);
        let crossed = split::mesh(&skin, &graph, 0.1);
        n_crossed += usize::from(topology(&crossed).n_non_manifold_edges > 0);
        split::uncross(&mut skin);
        assert_sound(&split::mesh(&skin, &graph, 0.1));
    }
    assert!(n_crossed > 0, "the test meets what it is for");
}

#[test]
fn what_has_no_surface_is_refused() {
    let refused = |graph: &NeuronGraph| {
        surface(graph, None, &SurfaceOptions::default(), &Silent).unwrap_err().to_string()
    };
    let edge = |a, b| GraphEdge { ends: [a, b], age: 0 };
    let mut graph = network(&drawn_on(&torus(30.0, 9.0), 2000, 0.0), 50);
    graph.edges.push(edge(3, 70));
    assert!(refused(&graph).contains("joins neurons 3 and 70, but there are 50"));
    graph.edges.clear();
    assert!(refused(&graph).contains("nowhere do three neurons lie side by side"));
    graph.neurons.points.iter_mut().for_each(|p| p.z = 1.0);
    assert!(refused(&graph).contains("50 neurons in one plane"));
    graph.neurons.points[6].x = f64::NAN;
    assert!(refused(&graph).starts_with("neuron 7 of the network is at (NaN"));
    assert!(refused(&NeuronGraph::default()).contains("0 neurons in one plane"));
    let options = SurfaceOptions { close: Some(-1.0) };
    let error = surface(&graph, None, &options, &Silent).unwrap_err();
    assert_eq!(error.to_string(), "--close is -1; give a length of 0 or above");
}
