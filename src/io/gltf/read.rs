//! From a glTF scene to one surface.

use super::accessor::rows;
use super::{BIN_CHUNK, JSON_CHUNK, MAGIC, buffers};
use crate::geom::{Point3, PointCloud, Surface, TriMesh, Vector3};
use crate::io::fault::{Fault, Place};
use crate::io::raw::{Raw, counted};
use crate::io::source::Source;
use gltf::json::Root;
use gltf::json::validation::Checked;
use gltf::mesh::{Mode, Semantic};
use nalgebra::{Matrix3, Matrix4};
use std::path::Path;

/// Reads a GLB; further buffers lie in `folder`.
pub(in crate::io) fn read_glb(source: &mut Source<'_>, folder: &Path) -> Result<Raw, Fault> {
    let header: [u8; 12] = source.bytes("the header of a GLB")?;
    let word = |at: usize| {
        u32::from_le_bytes([header[at], header[at + 1], header[at + 2], header[at + 3]])
    };
    if header[..4] != *MAGIC || word(4) != 2 {
        let problem = format!("version {} of the container, where 2 must be", word(4));
        return Err(Fault::malformed(Place::Byte(4), problem));
    }
    let json = read_chunk(source, *JSON_CHUNK, "the JSON chunk")?;
    let bin = match source.remaining() {
        // Less than a chunk's header is padding.
        0..8 => None,
        _ => Some(read_chunk(source, *BIN_CHUNK, "the binary chunk")?),
    };
    read_scene(&json, bin, folder)
}

/// Reads a glTF as JSON; its buffers are in it or in `folder`.
pub(in crate::io) fn read_json(source: &mut Source<'_>, folder: &Path) -> Result<Raw, Fault> {
    let json = source.block(source.remaining(), "the JSON")?;
    read_scene(&json, None, folder)
}

fn read_chunk(source: &mut Source<'_>, kind: [u8; 4], what: &str) -> Result<Vec<u8>, Fault> {
    let place = source.byte_place();
    let length = u32::from_le_bytes(source.bytes(what)?);
    let found: [u8; 4] = source.bytes(what)?;
    if found != kind {
        let found = String::from_utf8_lossy(&found).into_owned();
        return Err(Fault::malformed(place, format!("a chunk {found:?} where {what} must be")));
    }
    source.block(length.into(), what)
}

fn read_scene(json: &[u8], bin: Option<Vec<u8>>, folder: &Path) -> Result<Raw, Fault> {
    let document = document(json)?;
    let buffers = buffers::load(&document, bin, folder)?;
    // Instances multiply what the file holds; beyond this it is a bomb and no part.
    let n_bytes = json.len() + buffers.iter().map(Vec::len).sum::<usize>();
    let mut scene = Scene { room: n_bytes.saturating_mul(16), ..Scene::new(&buffers) };
    let roots: Vec<_> = match document.default_scene().or_else(|| document.scenes().next()) {
        Some(scene) => scene.nodes().collect(),
        None => document.nodes().collect(),
    };
    let mut waiting: Vec<_> =
        roots.into_iter().map(|node| (node, Matrix4::identity())).rev().collect();
    let mut is_seen = vec![false; document.nodes().len()];
    while let Some((node, world_from_parent)) = waiting.pop() {
        if std::mem::replace(&mut is_seen[node.index()], true) {
            let place = Place::Thing("node", node.index() as u64);
            return Err(Fault::malformed(place, "it hangs in the scene twice"));
        }
        let parent_from_node = Matrix4::from(node.transform().matrix()).cast::<f64>();
        let world_from_node = world_from_parent * parent_from_node;
        for primitive in node.mesh().iter().flat_map(gltf::Mesh::primitives) {
            scene.take(&primitive, &world_from_node)?;
        }
        let children: Vec<_> = node.children().collect();
        waiting.extend(children.into_iter().rev().map(|child| (child, world_from_node)));
    }
    Ok(Raw { metres_are_customary: true, ..scene.finish() })
}

/// The JSON, every index in it checked.
fn document(json: &[u8]) -> Result<gltf::Document, Fault> {
    let bad = |problem: String| Fault::malformed(Place::Part("the JSON"), problem);
    let json = json.strip_prefix(b"\xef\xbb\xbf").unwrap_or(json);
    let root: Root = serde_json::from_slice(json).map_err(|error| bad(error.to_string()))?;
    // The crate's own check looks this accessor up before it has checked that it is there.
    let n_accessors = root.accessors.len();
    let primitives = root.meshes.iter().flat_map(|mesh| &mesh.primitives);
    let positions = Checked::Valid(Semantic::Positions);
    let lost = primitives
        .filter_map(|primitive| primitive.attributes.get(&positions))
        .find(|accessor| accessor.value() >= n_accessors);
    if let Some(accessor) = lost {
        return Err(bad(format!("positions in accessor {} of {n_accessors}", accessor.value())));
    }
    gltf::Document::from_json(root).map_err(|error| bad(error.to_string()))
}

/// What has been read so far.
struct Scene<'a> {
    buffers: &'a [Vec<u8>],
    mesh: TriMesh,
    cloud: PointCloud,
    n_lines: usize,
    /// How many more vertices and triangles are believed.
    room: usize,
}

impl<'a> Scene<'a> {
    fn new(buffers: &'a [Vec<u8>]) -> Self {
        let (mesh, cloud) = (TriMesh::default(), PointCloud::default());
        Self { buffers, mesh, cloud, n_lines: 0, room: 0 }
    }

    fn take(
        &mut self,
        primitive: &gltf::Primitive<'_>,
        world_from_node: &Matrix4<f64>,
    ) -> Result<(), Fault> {
        if matches!(primitive.mode(), Mode::Lines | Mode::LineLoop | Mode::LineStrip) {
            self.n_lines += 1;
            return Ok(());
        }
        let vertices = self.vertices(primitive, world_from_node)?;
        if primitive.mode() == Mode::Points {
            let TriMesh { points, normals, colors, .. } = vertices;
            let mut all = TriMesh {
                normals: self.cloud.normals.take(),
                colors: self.cloud.colors.take(),
                ..TriMesh::new(std::mem::take(&mut self.cloud.points), Vec::new())
            };
            join(&mut all, TriMesh { normals, colors, ..TriMesh::new(points, Vec::new()) });
            self.cloud =
                PointCloud { points: all.points, normals: all.normals, colors: all.colors };
            return Ok(());
        }
        let mut triangles = self.triangles(primitive, vertices.points.len())?;
        // A mirroring node turns the winding over.
        if world_from_node.fixed_view::<3, 3>(0, 0).determinant() < 0.0 {
            for triangle in &mut triangles {
                triangle.swap(1, 2);
            }
        }
        join(&mut self.mesh, TriMesh { triangles, ..vertices });
        Ok(())
    }

    /// Positions, normals and colours, in the world.
    fn vertices(
        &mut self,
        primitive: &gltf::Primitive<'_>,
        world_from_node: &Matrix4<f64>,
    ) -> Result<TriMesh, Fault> {
        let place = Place::Thing("mesh primitive", primitive.index() as u64);
        let accessor = primitive
            .get(&Semantic::Positions)
            .ok_or_else(|| Fault::malformed(place, "it has no positions"))?;
        self.spend(accessor.count(), place)?;
        let points: Vec<Point3> = rows::<3>(&accessor, self.buffers)?
            .into_iter()
            .map(|position| world_from_node.transform_point(&Point3::from(position)))
            .collect();
        let turn: Matrix3<f64> = world_from_node.fixed_view::<3, 3>(0, 0).into();
        let normals = match (primitive.get(&Semantic::Normals), turn.try_inverse()) {
            (Some(accessor), Some(inverse)) => {
                let rows = rows::<3>(&accessor, self.buffers)?;
                let turn = inverse.transpose();
                Some(rows.into_iter().map(|normal| turn * Vector3::from(normal)).collect())
            }
            _ => None,
        };
        let colors = match primitive.get(&Semantic::Colors(0)) {
            Some(accessor) => Some(
                rows::<3>(&accessor, self.buffers)?
                    .into_iter()
                    .map(|color| color.map(|share| (share * 255.0).round() as u8))
                    .collect(),
            ),
            None => None,
        };
        let is_short = |n: Option<usize>| n.is_some_and(|n| n != points.len());
        if is_short(normals.as_ref().map(Vec::len)) || is_short(colors.as_ref().map(Vec::len)) {
            let problem = "its positions, normals and colours are not equally many";
            return Err(Fault::malformed(place, problem));
        }
        Ok(TriMesh { normals, colors, ..TriMesh::new(points, Vec::new()) })
    }

    fn triangles(
        &mut self,
        primitive: &gltf::Primitive<'_>,
        n_points: usize,
    ) -> Result<Vec<[u32; 3]>, Fault> {
        let place = Place::Thing("mesh primitive", primitive.index() as u64);
        let order: Vec<u32> = match primitive.indices() {
            Some(accessor) => {
                self.spend(accessor.count(), place)?;
                rows::<1>(&accessor, self.buffers)?.into_iter().map(|[i]| i as u32).collect()
            }
            None => (0..n_points as u32).collect(),
        };
        if let Some(&index) = order.iter().find(|index| **index as usize >= n_points) {
            return Err(Fault::NoSuchPoint {
                place,
                index: index.into(),
                n_points,
                counted_from: 0,
            });
        }
        Ok(match primitive.mode() {
            Mode::TriangleStrip => order
                .windows(3)
                .enumerate()
                // Every other one is wound the other way.
                .map(|(i, w)| if i % 2 == 0 { [w[0], w[1], w[2]] } else { [w[1], w[0], w[2]] })
                .collect(),
            Mode::TriangleFan => {
                order.windows(2).skip(1).map(|pair| [order[0], pair[0], pair[1]]).collect()
            }
            _ => {
                order.chunks_exact(3).map(|corners| [corners[0], corners[1], corners[2]]).collect()
            }
        })
    }

    fn spend(&mut self, n: usize, place: Place) -> Result<(), Fault> {
        self.room = self.room.checked_sub(n).ok_or_else(|| {
            Fault::malformed(place, "the scene repeats its meshes more often than a part would")
        })?;
        Ok(())
    }

    fn finish(self) -> Raw {
        let mut notes = Vec::new();
        if self.n_lines > 0 {
            notes.push(format!("{} left out", counted(self.n_lines, "set of lines")));
        }
        let surface = if self.mesh.triangles.is_empty() {
            Surface::Points(self.cloud)
        } else {
            if !self.cloud.points.is_empty() {
                let n = counted(self.cloud.points.len(), "point");
                notes.push(format!("{n} beside the triangles left out"));
            }
            Surface::Mesh(self.mesh)
        };
        Raw { notes, ..Raw::new(surface) }
    }
}

/// Appends a piece; the first one brings its normals and colours along.
fn join(all: &mut TriMesh, piece: TriMesh) {
    if all.points.is_empty() {
        *all = piece;
    } else {
        all.append(piece);
    }
}
