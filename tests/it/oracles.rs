//! Our readers and writers against those of others.

use crate::parts::{Folder, assert_near, cloud, mesh, painted_tetrahedron, real, tetrahedron};
use horma::geom::{Point3, Surface};
use horma::io::{Format, Overwrite, read_surface, write_surface_as};
use ply_rs_bw::parser::Parser;
use ply_rs_bw::ply::{DefaultElement, Encoding, Ply, Property};
use ply_rs_bw::writer::Writer;
use std::io::Cursor;

fn parsed_ply(bytes: &[u8]) -> Ply<DefaultElement> {
    Parser::new().read_ply(&mut Cursor::new(bytes)).unwrap()
}

#[test]
fn ply_rs_reads_what_we_write() {
    let part = painted_tetrahedron();
    let ply = parsed_ply(&Folder::new().written("part.ply", &Surface::Mesh(part.clone())));
    let vertex = &ply.payload["vertex"][1];
    assert_eq!(vertex["x"], Property::Double(part.points[1].x));
    assert_eq!(vertex["nx"], Property::Float(1.0));
    assert_eq!(vertex["blue"], Property::UChar(128));
    assert_eq!(ply.payload["face"][3]["vertex_indices"], Property::ListUInt(vec![2, 0, 3]));
}

#[test]
fn we_read_all_three_encodings_that_ply_rs_writes() {
    let folder = Folder::new();
    let part = painted_tetrahedron();
    let mut ply = parsed_ply(&folder.written("part.ply", &Surface::Mesh(part.clone())));
    for encoding in [Encoding::Ascii, Encoding::BinaryLittleEndian, Encoding::BinaryBigEndian] {
        ply.header.encoding = encoding;
        let mut bytes = Vec::new();
        Writer::new().write_ply(&mut bytes, &mut ply).unwrap();
        let back = mesh(folder.read("theirs.ply", &bytes));
        assert_eq!((back.points, back.triangles), (part.points.clone(), part.triangles.clone()));
        assert_eq!(back.colors, part.colors);
    }
}

#[test]
fn stl_io_reads_both_kinds_that_we_write() {
    let folder = Folder::new();
    let part = Surface::Mesh(tetrahedron());
    for format in [Format::StlBinary, Format::StlAscii] {
        let path = folder.path("part.stl");
        write_surface_as(&path, &part, format, Overwrite::Replace).unwrap();
        let theirs = stl_io::read_stl(&mut std::fs::File::open(&path).unwrap()).unwrap();
        assert_eq!((theirs.vertices.len(), theirs.faces.len()), (4, 4));
        let ours = mesh(read_surface(&path, None).unwrap());
        for (face, i) in theirs.faces.iter().zip(0..) {
            let theirs = face.vertices.map(|i| {
                let vertex = theirs.vertices[i];
                Point3::new(vertex[0].into(), vertex[1].into(), vertex[2].into())
            });
            assert_near(&ours.corners(i), &theirs, 4e-6);
            let normal = ours.area_vector(i).normalize();
            let z: f64 = face.normal[2].into();
            assert!((normal.z - z).abs() < 1e-6, "{normal} against {z}");
        }
    }
}

#[test]
fn tobj_reads_what_we_write() {
    let part = painted_tetrahedron();
    let bytes = Folder::new().written("part.obj", &Surface::Mesh(part.clone()));
    let options = tobj::LoadOptions { triangulate: true, single_index: true, ..Default::default() };
    let none = |_: &std::path::Path| tobj::load_mtl_buf(&mut Cursor::new(""));
    let (models, _) = tobj::load_obj_buf(&mut Cursor::new(bytes), &options, none).unwrap();
    let theirs = &models[0].mesh;
    // It numbers vertices in the order of the faces.
    let order = [0, 2, 1, 3].map(|i| part.points[i]);
    let found: Vec<Point3> = theirs
        .positions
        .chunks_exact(3)
        .map(|p| Point3::new(p[0].into(), p[1].into(), p[2].into()))
        .collect();
    assert_near(&found, &order, 4e-6);
    assert_eq!(theirs.indices, [0, 1, 2, 0, 2, 3, 2, 1, 3, 1, 0, 3]);
    assert_eq!(theirs.normals.len(), 12);
    assert!((theirs.vertex_color[0] - 1.0).abs() < 1e-6);
}

#[test]
fn gltf_accepts_what_we_write() {
    let part = painted_tetrahedron();
    let bytes = Folder::new().written("part.glb", &Surface::Mesh(part.clone()));
    let gltf = gltf::Gltf::from_slice(&bytes).unwrap();
    let primitive = gltf.document.meshes().next().unwrap().primitives().next().unwrap();
    let reader = primitive.reader(|_| gltf.blob.as_deref());
    let points: Vec<Point3> = reader
        .read_positions()
        .unwrap()
        .map(|p| Point3::from(p.map(|metres| f64::from(metres) * 1000.0)))
        .collect();
    assert_near(&points, &part.points, 8e-6);
    let indices: Vec<u32> = reader.read_indices().unwrap().into_u32().collect();
    assert_eq!(indices, part.triangles.as_flattened());
    let colors: Vec<[u8; 3]> = reader.read_colors(0).unwrap().into_rgb_u8().collect();
    assert_eq!(Some(colors), part.colors);
    let bounds = primitive.bounding_box();
    assert!((f64::from(bounds.max[0]) - 0.1007).abs() < 1e-8, "{bounds:?}");
}

#[test]
fn we_read_all_three_encodings_that_pcd_rs_writes() {
    use pcd_rs::{DataKind, DynRecord, DynWriter, Field, Schema, ValueKind, WriterInit};
    let folder = Folder::new();
    let expected = cloud();
    for data_kind in [DataKind::Ascii, DataKind::Binary, DataKind::BinaryCompressed] {
        let schema = [
            ("x", ValueKind::F64, 1),
            ("_", ValueKind::U8, 3),
            ("y", ValueKind::F64, 1),
            ("z", ValueKind::F64, 1),
            ("rgb", ValueKind::U32, 1),
        ];
        let n_points = expected.points.len() as u64;
        let init = WriterInit {
            width: n_points,
            height: 1,
            viewpoint: pcd_rs::ViewPoint::default(),
            data_kind,
            schema: Some(Schema::from_iter(schema)),
            version: None,
        };
        let path = folder.path("theirs.pcd");
        let mut writer: DynWriter<_> = init.create(&path).unwrap();
        for (point, [r, g, b]) in expected.points.iter().zip(expected.colors.clone().unwrap()) {
            let fields = vec![
                Field::F64(vec![point.x]),
                Field::U8(vec![0; 3]),
                Field::F64(vec![point.y]),
                Field::F64(vec![point.z]),
                Field::U32(vec![u32::from_be_bytes([0, r, g, b])]),
            ];
            writer.push(&DynRecord(fields)).unwrap();
        }
        writer.finish().unwrap();
        let reading = read_surface(&path, None).unwrap();
        assert!(reading.notes[0].contains("taken as millimetres"), "{:?}", reading.notes);
        let back = reading.surface.into_points();
        assert_eq!(back.points, expected.points, "{data_kind:?}");
        assert_eq!(back.colors, expected.colors, "{data_kind:?}");
    }
}

#[test]
fn a_real_compressed_scan_has_the_points_pcd_rs_finds() {
    let Some(path) = real("scans/pcl_pairwise/capture0001.pcd") else { return };
    let theirs: Vec<Point3> = pcd_rs::DynReader::open(&path)
        .unwrap()
        .map(|record| record.unwrap().to_xyz::<f32>().unwrap())
        .filter(|point| !point[0].is_nan())
        .map(|point| Point3::from(point.map(|metres| f64::from(metres) * 1000.0)))
        .collect();
    let reading = read_surface(&path, None).unwrap();
    assert_eq!(reading.notes[0], "57553 points with NaN left out");
    assert_eq!(reading.surface.points(), theirs);
}
