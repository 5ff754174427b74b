//! Parts, files and folders that the tests of file formats share.

use horma::geom::{LengthUnit, Point3, PointCloud, SectionGrid, Surface, TriMesh, Vector3};
use horma::io::{Fault, Overwrite, Reading, read_surface, write_surface};
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// An irregular tetrahedron about 100 mm long, without any symmetry, wound outwards.
pub(crate) fn tetrahedron() -> TriMesh {
    let points = [[0.1, 0.2, 0.3], [100.7, 1.5, -2.25], [30.0, 70.125, 4.0], [25.0, 20.0, 60.5]];
    let points: Vec<Point3> = points.into_iter().map(Point3::from).collect();
    TriMesh::new(points, vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
}

/// The same with normals and colours.
pub(crate) fn painted_tetrahedron() -> TriMesh {
    let normals = [[0.0, -0.6, -0.8], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.6, 0.8]];
    TriMesh {
        normals: Some(normals.into_iter().map(Vector3::from).collect()),
        colors: Some(vec![[255, 0, 1], [2, 3, 128], [7, 77, 200], [0, 0, 0]]),
        ..tetrahedron()
    }
}

/// Its vertices alone.
pub(crate) fn cloud() -> PointCloud {
    Surface::Mesh(painted_tetrahedron()).into_points()
}

/// Three stations of four points.
pub(crate) fn sections() -> SectionGrid {
    let point = |i: i32| {
        let angle = f64::from(i % 4) * std::f64::consts::FRAC_PI_2;
        let radius = 20.0 + f64::from(i) / 3.0;
        Point3::new(f64::from(i / 4) * 50.0, radius * angle.cos(), radius * angle.sin())
    };
    SectionGrid { n_columns: 4, points: (0..12).map(point).collect() }
}

/// A folder that goes when the test ends.
pub(crate) struct Folder(TempDir);

impl Folder {
    pub(crate) fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// Puts `bytes` into the file `name`.
    pub(crate) fn put(&self, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
        let path = self.path(name);
        std::fs::write(&path, bytes).unwrap();
        path
    }

    /// Writes `surface` as `name` and gives the bytes.
    pub(crate) fn written(&self, name: &str, surface: &Surface) -> Vec<u8> {
        write_surface(&self.path(name), surface, Overwrite::Replace).unwrap();
        std::fs::read(self.path(name)).unwrap()
    }

    /// Puts `bytes` into `name` and reads them as millimetres.
    pub(crate) fn read(&self, name: &str, bytes: impl AsRef<[u8]>) -> Reading {
        read_surface(&self.put(name, bytes), Some(LengthUnit::Millimetre)).unwrap()
    }

    /// Puts `bytes` into `name` and gives the message they are refused with.
    pub(crate) fn refusal(&self, name: &str, bytes: impl AsRef<[u8]>) -> String {
        let error = read_surface(&self.put(name, bytes), None).unwrap_err();
        assert!(!matches!(error.fault, Fault::System(_)), "{error}");
        assert!(error.to_string().contains(name), "the file is named: {error}");
        error.to_string()
    }
}

/// A file of the real data, or nothing, said on stderr, where they are not at hand.
pub(crate) fn real(name: &str) -> Option<PathBuf> {
    let Some(folder) = std::env::var_os("HORMA_DATA") else {
        eprintln!("skipped: HORMA_DATA does not tell where {name} is");
        return None;
    };
    Some(Path::new(&folder).join(name))
}

/// The mesh in a reading.
pub(crate) fn mesh(reading: Reading) -> TriMesh {
    match reading.surface {
        Surface::Mesh(mesh) => mesh,
        other => panic!("a {} where a mesh must be", other.kind()),
    }
}

/// Fails unless the points agree one by one within `tolerance` [mm].
pub(crate) fn assert_near(found: &[Point3], expected: &[Point3], tolerance: f64) {
    assert_eq!(found.len(), expected.len());
    for (i, (a, b)) in found.iter().zip(expected).enumerate() {
        assert!((a - b).norm() <= tolerance, "point {i}: {a} is not {b}");
    }
}

/// A GLB out of its two chunks.
pub(crate) fn glb(json: &str, bin: &[u8]) -> Vec<u8> {
    let mut json = json.as_bytes().to_vec();
    json.resize(json.len().next_multiple_of(4), b' ');
    let total = 12 + 8 + json.len() + 8 + bin.len();
    let mut bytes = b"glTF\x02\0\0\0".to_vec();
    bytes.extend((total as u32).to_le_bytes());
    for (kind, chunk) in [(b"JSON", json.as_slice()), (b"BIN\0", bin)] {
        bytes.extend((chunk.len() as u32).to_le_bytes());
        bytes.extend(kind);
        bytes.extend(chunk);
    }
    bytes
}

/// A binary STL that claims `count` triangles before these `facets`, nine coordinates each.
pub(crate) fn binary_stl(header: &str, count: u32, facets: &[[f32; 9]]) -> Vec<u8> {
    let mut bytes = format!("{header:<80}").into_bytes();
    bytes.extend(count.to_le_bytes());
    for facet in facets {
        bytes.extend([0; 12]);
        bytes.extend(facet.iter().flat_map(|coordinate| coordinate.to_le_bytes()));
        bytes.extend([0; 2]);
    }
    bytes
}
