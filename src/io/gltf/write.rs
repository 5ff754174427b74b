//! Writing GLB: one mesh on one node, in metres as the standard asks, single precision.

use super::{BIN_CHUNK, JSON_CHUNK, MAGIC};
use crate::geom::{Aabb, Point3, PointCloud, TriMesh, Vector3};
use crate::represent::gng::NeuronGraph;
use serde_json::{Value, json};
use std::io::{Error, Result, Write};

const FLOAT: u32 = 5126;
const UNSIGNED_BYTE: u32 = 5121;
const UNSIGNED_INT: u32 = 5125;
const POINTS: u32 = 0;
const LINES: u32 = 1;
const TRIANGLES: u32 = 4;
const METRES_PER_MM: f64 = 1e-3;

/// Writes a mesh with what normals and colours it has.
pub(in crate::io) fn write_mesh(out: &mut dyn Write, mesh: &TriMesh) -> Result<()> {
    let mut glb = Glb::default();
    glb.add_vertices(&mesh.points, mesh.normals.as_deref(), mesh.colors.as_deref());
    let bytes = mesh.triangles.as_flattened().iter().flat_map(|index| index.to_le_bytes());
    let n_indices = 3 * mesh.triangles.len();
    let indices = glb
        .add(bytes, json!({ "componentType": UNSIGNED_INT, "count": n_indices, "type": "SCALAR" }));
    glb.write(out, json!({ "mode": TRIANGLES, "indices": indices }))
}

/// Writes a cloud with what normals and colours it has.
pub(in crate::io) fn write_cloud(out: &mut dyn Write, cloud: &PointCloud) -> Result<()> {
    let mut glb = Glb::default();
    glb.add_vertices(&cloud.points, cloud.normals.as_deref(), cloud.colors.as_deref());
    glb.write(out, json!({ "mode": POINTS }))
}

/// Writes a network as lines from neuron to neuron.
pub(in crate::io) fn write_network(out: &mut dyn Write, graph: &NeuronGraph) -> Result<()> {
    let mut glb = Glb::default();
    let neurons = &graph.neurons;
    glb.add_vertices(&neurons.points, neurons.normals.as_deref(), neurons.colors.as_deref());
    let indices = graph.edges.iter().flat_map(|edge| edge.ends);
    let value =
        json!({ "componentType": UNSIGNED_INT, "count": 2 * graph.edges.len(), "type": "SCALAR" });
    let indices = glb.add(indices.flat_map(u32::to_le_bytes), value);
    glb.write(out, json!({ "mode": LINES, "indices": indices }))
}

/// The parts of a file under construction.
#[derive(Default)]
struct Glb {
    bin: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
    attributes: serde_json::Map<String, Value>,
}

impl Glb {
    fn add_vertices(
        &mut self,
        points: &[Point3],
        normals: Option<&[Vector3]>,
        colors: Option<&[[u8; 3]]>,
    ) {
        let single = |point: &Point3| (point.coords * METRES_PER_MM).map(|x| x as f32);
        let bytes = |vector: nalgebra::Vector3<f32>| {
            [vector.x, vector.y, vector.z].into_iter().flat_map(f32::to_le_bytes)
        };
        // The bounds must be those of the numbers as stored.
        let stored: Vec<Point3> = points.iter().map(|p| single(p).cast::<f64>().into()).collect();
        let aabb = Aabb::around(&stored);
        let corner = |p: Point3| [p.x as f32, p.y as f32, p.z as f32];
        let position = json!({
            "componentType": FLOAT, "count": points.len(), "type": "VEC3",
            "min": corner(aabb.min), "max": corner(aabb.max),
        });
        self.add_attribute("POSITION", points.iter().flat_map(|p| bytes(single(p))), position);
        if let Some(normals) = normals {
            let value = json!({ "componentType": FLOAT, "count": normals.len(), "type": "VEC3" });
            let all = normals.iter().flat_map(|normal| bytes(normal.map(|x| x as f32)));
            self.add_attribute("NORMAL", all, value);
        }
        if let Some(colors) = colors {
            // With alpha, because every vertex must begin at a multiple of four bytes.
            let value = json!({
                "componentType": UNSIGNED_BYTE, "normalized": true, "count": colors.len(),
                "type": "VEC4",
            });
            let all = colors.iter().flat_map(|[r, g, b]| [*r, *g, *b, 255]);
            self.add_attribute("COLOR_0", all, value);
        }
    }

    fn add_attribute(&mut self, name: &str, bytes: impl Iterator<Item = u8>, value: Value) {
        let index = self.add(bytes, value);
        self.attributes.insert(name.to_owned(), index.into());
    }

    /// Adds an accessor and its bytes, always a multiple of four; gives its index.
    fn add(&mut self, bytes: impl Iterator<Item = u8>, mut accessor: Value) -> usize {
        let offset = self.bin.len();
        self.bin.extend(bytes);
        let length = self.bin.len() - offset;
        self.views.push(json!({ "buffer": 0, "byteOffset": offset, "byteLength": length }));
        accessor["bufferView"] = (self.views.len() - 1).into();
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    fn write(self, out: &mut dyn Write, mut primitive: Value) -> Result<()> {
        primitive["attributes"] = self.attributes.into();
        let mut json = serde_json::to_vec(&json!({
            "asset": { "version": "2.0", "generator": "horma" },
            "scene": 0,
            "scenes": [{ "nodes": [0] }],
            "nodes": [{ "mesh": 0 }],
            "meshes": [{ "primitives": [primitive] }],
            "accessors": self.accessors,
            "bufferViews": self.views,
            "buffers": [{ "byteLength": self.bin.len() }],
        }))?;
        json.resize(json.len().next_multiple_of(4), b' ');
        let length = |n: usize| {
            let too_large = |_| Error::other("a GLB file cannot hold so many vertices");
            Ok::<_, Error>(u32::try_from(n).map_err(too_large)?.to_le_bytes())
        };
        out.write_all(MAGIC)?;
        out.write_all(&2_u32.to_le_bytes())?;
        out.write_all(&length(12 + 8 + json.len() + 8 + self.bin.len())?)?;
        for (kind, chunk) in [(JSON_CHUNK, &json), (BIN_CHUNK, &self.bin)] {
            out.write_all(&length(chunk.len())?)?;
            out.write_all(kind)?;
            out.write_all(chunk)?;
        }
        Ok(())
    }
}
