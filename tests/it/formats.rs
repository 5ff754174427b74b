//! Every format, there and back, and the real files.

use crate::parts::{
    Folder, assert_near, binary_stl, cloud, glb, mesh, painted_tetrahedron, real, sections,
    tetrahedron,
};
use horma::geom::{LengthUnit, Point3, Surface, UnitSource, topology};
use horma::io::{Format, Overwrite, WriteError, read_surface, write_surface, write_surface_as};
use serde_json::{Value, json};
use std::process::{Command, Output};

/// Single precision at 100 mm: half a unit in the last place of 128.
const SINGLE: f64 = 4e-6;

#[test]
fn a_mesh_comes_back_from_every_format_that_holds_one() {
    let folder = Folder::new();
    for (name, format, tolerance) in [
        ("part.stl", Format::StlBinary, SINGLE),
        ("part.ply", Format::Ply, 0.0),
        ("part.obj", Format::Obj, 0.0),
        ("part.GLB", Format::Glb, SINGLE),
    ] {
        let part = painted_tetrahedron();
        folder.written(name, &Surface::Mesh(part.clone()));
        let reading = read_surface(&folder.path(name), None).unwrap();
        assert_eq!(reading.format, format, "{name}");
        assert_eq!(reading.notes, [""; 0], "{name}");
        let (unit, from) = match format {
            Format::Glb => (LengthUnit::Metre, UnitSource::Detected),
            _ => (LengthUnit::Millimetre, UnitSource::Declared),
        };
        assert_eq!((reading.unit, reading.unit_from), (unit, from), "{name}");
        let back = mesh(reading);
        let volumes = [&back, &part].map(|mesh| topology(mesh).volume.unwrap());
        assert!((volumes[0] / volumes[1] - 1.0).abs() < 1e-6, "{name}: {volumes:?}");
        if format == Format::StlBinary {
            // An STL lists corners in the order of its triangles, and has nothing else.
            assert_eq!(topology(&back), topology(&single(&back)));
            continue;
        }
        assert_near(&back.points, &part.points, tolerance);
        assert_eq!(back.triangles, part.triangles, "{name}");
        assert_eq!(back.colors, part.colors, "{name}");
        for (found, expected) in back.normals.unwrap().iter().zip(part.normals.unwrap()) {
            assert!((found - expected).norm() < 1e-7, "{name}: {found} is not {expected}");
        }
    }
}

fn single(mesh: &horma::geom::TriMesh) -> horma::geom::TriMesh {
    let mut rounded = mesh.clone();
    for point in &mut rounded.points {
        *point = point.map(|x| f64::from(x as f32));
    }
    rounded
}

#[test]
fn an_ascii_stl_comes_back_with_all_its_digits() {
    let folder = Folder::new();
    let path = folder.path("part.stl");
    let part = Surface::Mesh(tetrahedron());
    write_surface_as(&path, &part, Format::StlAscii, Overwrite::Refuse).unwrap();
    let reading = read_surface(&path, None).unwrap();
    assert_eq!((reading.format, reading.unit_from), (Format::StlAscii, UnitSource::Declared));
    let back = mesh(reading);
    let [a, b, c] = back.corners(0);
    let p = tetrahedron().points;
    assert_eq!([a, b, c], [p[0], p[2], p[1]]);
    assert_eq!(topology(&back), topology(&tetrahedron()));
}

#[test]
fn a_cloud_comes_back_from_every_format_that_holds_one() {
    let folder = Folder::new();
    for name in ["c.ply", "c.obj", "c.glb", "c.xyz", "c.asc", "c.txt", "c.csv"] {
        let expected = cloud();
        folder.written(name, &Surface::Points(expected.clone()));
        let back = read_surface(&folder.path(name), None).unwrap().surface.into_points();
        assert_near(&back.points, &expected.points, if name == "c.glb" { SINGLE } else { 0.0 });
        assert_eq!(back.colors, expected.colors, "{name}");
        for (found, expected) in back.normals.unwrap().iter().zip(expected.normals.unwrap()) {
            assert!((found - expected).norm() < 1e-7, "{name}: {found} is not {expected}");
        }
    }
}

#[test]
fn a_section_grid_comes_back_row_by_row() {
    let folder = Folder::new();
    let grid = Surface::Sections(sections());
    folder.written("last.csv", &grid);
    let reading = read_surface(&folder.path("last.csv"), None).unwrap();
    assert_eq!((reading.format, reading.surface), (Format::Sections, grid));
}

#[test]
fn a_binary_stl_whose_header_says_solid_is_read_as_binary() {
    let facet = [0.0, 0.0, 0.0, 60.0, 0.0, 0.0, 0.0, 60.0, 0.0];
    let reading = Folder::new().read("part.stl", binary_stl("solid facet", 1, &[facet]));
    assert_eq!(reading.format, Format::StlBinary);
    assert_eq!(mesh(reading).points[1], Point3::new(60.0, 0.0, 0.0));
}

/// A triangle (0 0 0, 1 0 0, 0 1 0) and its buffer.
fn triangle_scene(nodes: &Value, buffer: &Value) -> (String, Vec<u8>) {
    let json = json!({
        "asset": { "version": "2.0" }, "scene": 0, "scenes": [{ "nodes": [0] }], "nodes": nodes,
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 } }] }],
        "accessors": [{
            "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
            "min": [0, 0, 0], "max": [1, 1, 0],
        }],
        "bufferViews": [{ "buffer": 0, "byteLength": 36 }],
        "buffers": [buffer],
    });
    let corners = [0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    (json.to_string(), corners.iter().flat_map(|x| x.to_le_bytes()).collect())
}

#[test]
fn node_transforms_are_applied_from_the_root_down() {
    // The parent turns x to y and moves; the child scales, one axis mirrored.
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let nodes = json!([
        { "translation": [10, 0, 0], "rotation": [0, 0, half, half], "children": [1] },
        { "scale": [2, 2, -2], "mesh": 0 },
    ]);
    let (json, bin) = triangle_scene(&nodes, &json!({ "byteLength": 36 }));
    let part = mesh(Folder::new().read("part.glb", glb(&json, &bin)));
    let expected = [[10.0, 0.0, 0.0], [10.0, 2.0, 0.0], [8.0, 0.0, 0.0]].map(Point3::from);
    assert_near(&part.points, &expected, 1e-6);
    assert_eq!(part.triangles, [[0, 2, 1]], "mirrored, so wound the other way");
}

#[test]
fn strips_and_fans_become_triangles_wound_alike() {
    let corners = [[0.0_f32, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    let bin = |order: [usize; 4]| -> Vec<u8> {
        order.iter().flat_map(|&i| corners[i]).flat_map(f32::to_le_bytes).collect()
    };
    let (json, _) = triangle_scene(&json!([{ "mesh": 0 }]), &json!({ "byteLength": 48 }));
    let json = json.replace("\"count\":3", "\"count\":4").replace(":36}", ":48}");
    for (mode, order) in [(5, [0, 1, 3, 2]), (6, [0, 1, 2, 3])] {
        let primitive = format!("{{\"mode\":{mode},\"attributes\"");
        let json = json.replace("{\"attributes\"", &primitive);
        let part = mesh(Folder::new().read("part.glb", glb(&json, &bin(order))));
        let areas: Vec<f64> = (0..part.triangles.len()).map(|i| part.area_vector(i).z).collect();
        assert_eq!(areas, [0.5, 0.5], "mode {mode}");
    }
}

#[test]
fn gltf_buffers_lie_beside_the_file_or_inside_it() {
    let folder = Folder::new();
    let nodes = json!([{ "mesh": 0 }]);
    let beside = json!({ "byteLength": 36, "uri": "left%20foot.bin" });
    let (json, bin) = triangle_scene(&nodes, &beside);
    folder.put("left foot.bin", &bin);
    let first = mesh(folder.read("beside.gltf", json));
    let data = base64::Engine::encode(&base64::engine::general_purpose::STANDARD, &bin);
    let uri = format!("data:application/octet-stream;base64,{data}");
    let (json, _) = triangle_scene(&nodes, &json!({ "byteLength": 36, "uri": uri }));
    let second = mesh(folder.read("inside.gltf", json));
    assert_eq!(first, second);
    assert_eq!(first.points[2], Point3::new(0.0, 1.0, 0.0));
}

#[test]
fn the_real_feet_are_told_apart_by_their_units() {
    let Some(metres) = real("lasts/find_foot/foot_template_left_metres.obj") else { return };
    let Some(mean) = real("lasts/find_foot/foot_mean_left.obj") else { return };
    let Some(wide) = real("lasts/find_foot/foot_wide_left.stl") else { return };
    for (path, unit, n_triangles, length) in [
        (metres, LengthUnit::Metre, 2_000, 269.5),
        (mean, LengthUnit::Millimetre, 128_000, 261.8),
        (wide, LengthUnit::Millimetre, 128_000, 265.9),
    ] {
        let reading = read_surface(&path, None).unwrap();
        assert_eq!((reading.unit, reading.unit_from), (unit, UnitSource::Detected));
        let report = topology(&mesh(reading.clone()));
        assert_eq!(report.n_triangles, n_triangles);
        assert!(report.is_closed() && report.volume.unwrap() > 1e6, "{report:?}");
        let found = reading.surface.aabb().size().x;
        assert!((found - length).abs() < 0.05, "{found}");
    }
}

#[test]
fn the_stanford_bunny_has_the_faults_it_is_known_for() {
    let Some(path) = real("scans/stanford_bunny/bun_zipper_res2.ply") else { return };
    let report = topology(&mesh(read_surface(&path, None).unwrap()));
    assert_eq!((report.n_open_loops, report.n_open_edges), (5, 123));
    assert_eq!((report.n_duplicate_triangles, report.n_non_manifold_edges), (87, 150));
    assert_eq!((report.n_unused_points, report.volume), (25, None));
}

#[test]
fn a_range_scan_is_a_cloud_and_its_grid_is_told() {
    let Some(path) = real("scans/stanford_bunny/bun000.ply") else { return };
    let reading = read_surface(&path, None).unwrap();
    assert_eq!(reading.surface.points().len(), 40_256);
    assert_eq!(reading.notes, ["204800 of the element \"range_grid\" left out"]);
}

fn horma(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_horma")).args(arguments).output().unwrap()
}

#[test]
fn info_tells_what_a_file_holds() {
    let folder = Folder::new();
    folder.written("part.ply", &Surface::Mesh(painted_tetrahedron()));
    let path = folder.path("part.ply");
    let output = horma(&["info", path.to_str().unwrap(), "--json"]);
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["format"], "ply");
    assert_eq!((&report["unit"], &report["unit_from"]), (&json!("mm"), &json!("declared")));
    assert_eq!(report["mesh"]["n_triangles"], 4);
    assert_eq!(report["is_closed"], true);
    assert_eq!(report["has_colors"], true);
    let output = horma(&["info", path.to_str().unwrap(), "--units", "in"]);
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.contains("in, as stated") && text.contains("2555.240 "), "{text}");
}

#[test]
fn convert_says_what_does_not_survive() {
    let folder = Folder::new();
    folder.written("part.ply", &Surface::Mesh(tetrahedron()));
    let [from, to] = ["part.ply", "part.xyz"].map(|name| folder.path(name));
    let arguments = ["convert", from.to_str().unwrap(), to.to_str().unwrap()];
    let text = String::from_utf8(horma(&arguments).stdout).unwrap();
    assert!(text.contains("4 triangles left out: only vertices written"), "{text}");
    assert_eq!(read_surface(&to, None).unwrap().surface.points(), tetrahedron().points);
    // Once more: the file is there now.
    let output = horma(&arguments);
    assert_eq!(output.status.code(), Some(73));
    assert!(String::from_utf8_lossy(&output.stderr).contains("--force"));
    assert!(horma(&[&arguments[..], &["--force"]].concat()).status.success());
}

#[test]
fn what_a_format_cannot_hold_is_refused_with_the_formats_that_can() {
    let folder = Folder::new();
    let points = Surface::Points(cloud());
    let error = write_surface(&folder.path("cloud.stl"), &points, Overwrite::Refuse).unwrap_err();
    assert!(matches!(error, WriteError::CannotHold { .. }));
    let text = error.to_string();
    assert!(text.contains("cannot hold a cloud of points; choose .ply, .obj"), "{text}");
    let error = write_surface(&folder.path("part.step"), &points, Overwrite::Refuse).unwrap_err();
    assert!(error.to_string().contains("(.stl .ply .obj .glb"), "{error}");
    assert!(!folder.path("cloud.stl").exists() && !folder.path("part.step").exists());
}
