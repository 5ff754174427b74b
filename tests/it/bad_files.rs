//! Broken files are refused with a message that names the file, the place, the value and what to
//! do; whatever the bytes, nothing panics.

use crate::parts::{Folder, binary_stl, cloud, glb, painted_tetrahedron, sections, tetrahedron};
use horma::geom::{Surface, topology};
use horma::io::{Format, Overwrite, read_surface, write_surface_as};
use rand::{Rng, RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use serde_json::json;
use std::process::Command;

const FACET: [f32; 9] = [0.0, 0.0, 0.0, 60.0, 0.0, 0.0, 0.0, 60.0, 0.0];

#[track_caller]
fn assert_refused(name: &str, bytes: impl AsRef<[u8]>, message: &str) {
    let found = Folder::new().refusal(name, bytes);
    assert!(found.contains(message), "{found}");
}

#[test]
fn an_empty_file_is_refused() {
    assert_refused("part.stl", "", "the file is empty; copy or export it again");
}

#[test]
fn a_file_in_no_known_format_is_refused() {
    let message = "in no format that horma reads (STL, PLY, OBJ, glTF/GLB, PCD";
    assert_refused("part.step", "ISO-10303-21;\nHEADER;\n", message);
    assert_refused("photo.jpg", b"\xff\xd8\xff\xe0\0\x10JFIF\0", message);
    assert_refused("notes.txt", "Dear Sir or Madam,\nthe last is on its way.\n", message);
}

#[test]
fn a_missing_file_and_a_folder_are_refused_by_the_system() {
    let folder = Folder::new();
    for path in [folder.path("none.stl"), folder.path("")] {
        let error = read_surface(&path, None).unwrap_err().to_string();
        assert!(error.contains("check that the file is there and may be read"), "{error}");
    }
}

#[test]
fn a_truncated_binary_stl_is_refused() {
    let mut bytes = binary_stl("made by hand", 2, &[FACET; 2]);
    bytes.truncate(bytes.len() - 1);
    let message = "promises 2 triangles, but the 99 bytes after it hold 1 at most";
    assert_refused("part.stl", bytes, message);
    assert_refused("part.stl", [0; 20], "ends at byte 20, in the middle of the header");
}

#[test]
fn an_stl_whose_count_lies_is_refused_before_anything_is_allocated() {
    let message = "promises 4294967295 triangles, but the 50 bytes after it hold 1 at most";
    assert_refused("part.stl", binary_stl("lies", u32::MAX, &[FACET]), message);
}

#[test]
fn coordinates_that_are_no_lengths_are_refused_by_name() {
    let mut facets = [FACET; 3];
    facets[1][5] = f32::NAN;
    let bytes = binary_stl("made by hand", 3, &facets);
    assert_refused("part.stl", bytes, "coordinate z of triangle 2 is NaN; repair");
    facets[1][5] = f32::NEG_INFINITY;
    let bytes = binary_stl("made by hand", 3, &facets);
    assert_refused("part.stl", bytes, "coordinate z of triangle 2 is -inf; repair");
    let obj = "v 0 0 0\nv 1 nan 0\nv 0 1 0\nf 1 2 3\n";
    assert_refused("part.obj", obj, "coordinate y of vertex 2 is NaN");
    let far = obj.replace("nan", "1e300");
    assert_refused("part.obj", far, "coordinate y of vertex 2 is 1000000");
    assert_refused("cloud.xyz", "0 0 0\n1 1 -inf\n", "coordinate z of point 2 is -inf");
}

#[test]
fn an_obj_whose_indices_are_out_of_range_is_refused() {
    let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 4\n";
    let message = "line 5: a face names vertex 4, but there are only 3 (counted from 1)";
    assert_refused("part.obj", obj, message);
}

#[test]
fn a_ply_whose_header_lies_is_refused_before_anything_is_allocated() {
    let ply = |format: &str, vertex: &str, face: &str, rest: &str| {
        format!(
            "ply\nformat {format} 1.0\nelement vertex {vertex}\nproperty float x\nproperty float \
             y\nproperty float z\nelement face {face}\nproperty list uchar int vertex_indices\n\
             end_header\n{rest}"
        )
    };
    for format in ["ascii", "binary_little_endian", "binary_big_endian"] {
        let message = "promises 4000000000 of the element \"vertex\", but the 14 bytes";
        assert_refused("part.ply", ply(format, "4000000000", "1", "0 0 0\n1 0 0\n3\n"), message);
    }
    let points = "0 0 0\n1 0 0\n0 1 0\n";
    let message = "promises 4000000000 of the element \"face\", but the 8 bytes";
    assert_refused(
        "part.ply",
        ply("ascii", "3", "4000000000", &format!("{points}3 0 1 2\n")),
        message,
    );
    let message = "\"9.5\" is more than a \"face\" holds";
    assert_refused("part.ply", ply("ascii", "3", "1", &format!("{points}3 0 1 2 9.5\n")), message);
    let message = "ends at line 14, in the middle of the element \"face\"";
    assert_refused("part.ply", ply("ascii", "3", "2", &format!("{points}3 0 1 2\n\n")), message);
    // A list of 255 corners where the file ends.
    let binary = ply("binary_little_endian", "0", "1", "");
    let message = "in the middle of the values";
    assert_refused("part.ply", [binary.as_bytes(), &[255, 0, 0]].concat(), message);
}

fn gltf_json(count: u64, view_length: u64, buffer_length: u64) -> String {
    json!({
        "asset": { "version": "2.0" }, "scene": 0, "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 } }] }],
        "accessors": [{
            "bufferView": 0, "componentType": 5126, "count": count, "type": "VEC3",
            "min": [0, 0, 0], "max": [1, 1, 0],
        }],
        "bufferViews": [{ "buffer": 0, "byteLength": view_length }],
        "buffers": [{ "byteLength": buffer_length }],
    })
    .to_string()
}

#[test]
fn a_glb_whose_offsets_lie_is_refused() {
    let message = "accessor 0: 9 rows from byte 0 lie outside a view of 36";
    assert_refused("part.glb", glb(&gltf_json(9, 36, 36), &[0; 36]), message);
    let message = "accessor 0: its view of 72 bytes from 0 lies outside a buffer of 36";
    assert_refused("part.glb", glb(&gltf_json(3, 72, 36), &[0; 36]), message);
    let nowhere = gltf_json(3, 36, 36).replace("\"POSITION\":0", "\"POSITION\":7");
    assert_refused("part.glb", glb(&nowhere, &[0; 36]), "the JSON: positions in accessor 7 of 1");
    let message = "buffer 0: 36 bytes where 99 are promised";
    assert_refused("part.glb", glb(&gltf_json(3, 36, 99), &[0; 36]), message);
    let message = "repeats its meshes more often than a part would";
    assert_refused("part.glb", glb(&gltf_json(4_000_000_000, 36, 36), &[0; 36]), message);
    let mut bytes = glb(&gltf_json(3, 36, 36), &[0; 36]);
    bytes[15] = 0x7f;
    assert_refused("part.glb", bytes, "in the middle of the JSON chunk");
    assert_refused("part.glb", b"glTF\x01\0\0\0\x0c\0\0\0", "byte 4: version 1");
    assert_refused("part.glb", glb("{ \"asset\": ", &[]), "the JSON: ");
    let beside = gltf_json(3, 36, 36)
        .replace("\"byteLength\":36}]", "\"byteLength\":36,\"uri\":\"no.bin\"}]");
    assert_refused("part.gltf", beside, "put it beside the glTF, or export a GLB");
}

#[test]
fn a_gltf_that_hangs_in_itself_is_refused() {
    let json = gltf_json(3, 36, 36).replace("\"mesh\":0}", "\"mesh\":0,\"children\":[0]}");
    let message = "node 0: it hangs in the scene twice";
    assert_refused("part.glb", glb(&json, &[0; 36]), message);
}

#[test]
fn a_file_without_triangles_or_points_is_refused() {
    assert_refused("part.stl", binary_stl("empty", 0, &[]), "there are no triangles in it");
    assert_refused("part.stl", "solid a\nendsolid a\n", "there are no triangles in it");
    let message = "there are no triangles and no points in it";
    assert_refused("part.obj", "# nothing\no part\n", message);
    assert_refused("cloud.xyz", "nan nan nan\n", message);
}

#[test]
fn the_command_ends_with_the_code_for_bad_input_and_for_a_bad_output() {
    let folder = Folder::new();
    let run = |arguments: &[&str]| {
        let output = Command::new(env!("CARGO_BIN_EXE_horma")).args(arguments).output().unwrap();
        assert!(output.stdout.is_empty());
        (output.status.code(), String::from_utf8(output.stderr).unwrap())
    };
    let empty = folder.put("empty.stl", "");
    let (code, message) = run(&["info", empty.to_str().unwrap()]);
    assert_eq!(code, Some(65));
    assert!(message.contains("empty.stl") && message.contains("the file is empty"), "{message}");
    folder.written("part.ply", &Surface::Mesh(tetrahedron()));
    let from = folder.path("part.ply");
    let to = folder.path("no-such-folder/part.stl");
    let (code, message) = run(&["convert", from.to_str().unwrap(), to.to_str().unwrap()]);
    assert_eq!(code, Some(73));
    assert!(message.contains("does not exist; create it"), "{message}");
}

/// One small healthy file of every format.
fn healthy() -> Vec<(&'static str, Vec<u8>)> {
    let folder = Folder::new();
    let part = Surface::Mesh(painted_tetrahedron());
    let ascii_stl = folder.path("ascii.stl");
    write_surface_as(&ascii_stl, &part, Format::StlAscii, Overwrite::Refuse).unwrap();
    let points = cloud().points;
    let values: Vec<u8> = points
        .iter()
        .flat_map(|p| p.map(|x| x as f32).coords.data.0[0])
        .flat_map(f32::to_le_bytes)
        .collect();
    let pcd = |data: &str| {
        format!(
            "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH \
             4\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 4\nDATA {data}\n"
        )
        .into_bytes()
    };
    // Literal runs only: a control byte of 31 is followed by 32 bytes.
    let packed: Vec<u8> =
        values.chunks(32).flat_map(|run| [&[run.len() as u8 - 1], run].concat()).collect();
    let sizes = [packed.len() as u32, values.len() as u32].map(u32::to_le_bytes).concat();
    let glb = folder.written("part.glb", &part);
    let data = base64::Engine::encode(&base64::engine::general_purpose::STANDARD, [0; 36]);
    let uri = format!("\"byteLength\":36,\"uri\":\"data:a;base64,{data}\"}}]");
    let gltf = gltf_json(3, 36, 36).replace("\"byteLength\":36}]", &uri);
    vec![
        ("a.stl", std::fs::read(ascii_stl).unwrap()),
        ("b.stl", folder.written("b.stl", &part)),
        ("c.ply", folder.written("c.ply", &part)),
        (
            "d.ply",
            b"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
            property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n\
            0 0 0\n9 0 0\n0 9 0\n3 0 1 2\n"
                .to_vec(),
        ),
        ("e.obj", folder.written("e.obj", &part)),
        ("f.glb", glb),
        ("g.gltf", gltf.into_bytes()),
        ("h.pcd", [pcd("ascii"), b"1 2 3\n4 5 6\nnan nan nan\n7 8 9\n".to_vec()].concat()),
        ("i.pcd", [pcd("binary"), values].concat()),
        ("j.pcd", [pcd("binary_compressed"), sizes, packed].concat()),
        ("k.xyz", folder.written("k.xyz", &Surface::Points(cloud()))),
        ("l.csv", folder.written("l.csv", &Surface::Sections(sections()))),
        ("m.csv", b"x;0;120;240\n0;1,5;2;3\n10;4;5;6\n".to_vec()),
    ]
}

#[test]
fn no_truncation_and_no_flipped_byte_makes_a_reader_panic() {
    let folder = Folder::new();
    let mut random = Pcg64Mcg::seed_from_u64(20_140_707);
    for (name, bytes) in healthy() {
        let whole = read_surface(&folder.put(name, &bytes), None);
        assert!(whole.is_ok(), "{name}: {whole:?}");
        let mut n_refused = 0;
        for round in 0..600 {
            let mut broken = bytes.clone();
            if round % 2 == 0 {
                broken.truncate(random.random_range(0..bytes.len()));
            }
            for _ in 0..round % 5 {
                if !broken.is_empty() {
                    let at = random.random_range(0..broken.len());
                    broken[at] ^= 1 << (random.next_u32() % 8);
                }
            }
            match read_surface(&folder.put(name, &broken), None) {
                Ok(reading) => {
                    // What is accepted must be sound.
                    assert!(reading.surface.aabb().size().iter().all(|x| x.is_finite()), "{name}");
                    if let Some(mesh) = reading.surface.into_mesh() {
                        assert!(topology(&mesh).n_triangles > 0, "{name}");
                    }
                }
                Err(error) => {
                    assert!(error.to_string().contains(name), "{error}");
                    n_refused += 1;
                }
            }
        }
        assert!(n_refused > 100, "{name}: only {n_refused} of 600 refused");
    }
}
