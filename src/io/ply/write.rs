//! Writing PLY, binary little endian. Positions are doubles, so that nothing is lost.

use crate::geom::{PointCloud, TriMesh, Vector3};
use crate::represent::gng::NeuronGraph;
use std::io::{Result, Write};

/// Writes a mesh with what normals and colours it has.
pub(in crate::io) fn write_mesh(out: &mut dyn Write, mesh: &TriMesh) -> Result<()> {
    let vertices = Vertices {
        points: &mesh.points,
        normals: mesh.normals.as_deref(),
        colors: mesh.colors.as_deref(),
        errors: None,
    };
    vertices.write_header(out)?;
    writeln!(out, "element face {}", mesh.triangles.len())?;
    writeln!(out, "property list uchar uint vertex_indices\nend_header")?;
    vertices.write(out)?;
    for triangle in &mesh.triangles {
        out.write_all(&[3])?;
        for index in triangle {
            out.write_all(&index.to_le_bytes())?;
        }
    }
    Ok(())
}

/// Writes a cloud with what normals and colours it has.
pub(in crate::io) fn write_cloud(out: &mut dyn Write, cloud: &PointCloud) -> Result<()> {
    let vertices = Vertices {
        points: &cloud.points,
        normals: cloud.normals.as_deref(),
        colors: cloud.colors.as_deref(),
        errors: None,
    };
    vertices.write_header(out)?;
    writeln!(out, "end_header")?;
    vertices.write(out)
}

/// Writes a network: its neurons as vertices with their errors, its edges with their ages.
pub(in crate::io) fn write_network(out: &mut dyn Write, graph: &NeuronGraph) -> Result<()> {
    let vertices = Vertices {
        points: &graph.neurons.points,
        normals: graph.neurons.normals.as_deref(),
        colors: graph.neurons.colors.as_deref(),
        errors: Some(&graph.errors),
    };
    vertices.write_header(out)?;
    writeln!(out, "element edge {}", graph.edges.len())?;
    writeln!(out, "property int vertex1\nproperty int vertex2\nproperty uint age\nend_header")?;
    vertices.write(out)?;
    for edge in &graph.edges {
        for number in [edge.ends[0], edge.ends[1], edge.age] {
            out.write_all(&number.to_le_bytes())?;
        }
    }
    Ok(())
}

struct Vertices<'a> {
    points: &'a [crate::geom::Point3],
    normals: Option<&'a [Vector3]>,
    colors: Option<&'a [[u8; 3]]>,
    errors: Option<&'a [f64]>,
}

impl Vertices<'_> {
    fn write_header(&self, out: &mut dyn Write) -> Result<()> {
        writeln!(out, "ply\nformat binary_little_endian 1.0\ncomment by horma, units mm")?;
        writeln!(out, "element vertex {}", self.points.len())?;
        let mut properties = vec![("double", ["x", "y", "z"])];
        properties.extend(self.normals.map(|_| ("float", ["nx", "ny", "nz"])));
        properties.extend(self.colors.map(|_| ("uchar", ["red", "green", "blue"])));
        for (kind, names) in properties {
            for name in names {
                writeln!(out, "property {kind} {name}")?;
            }
        }
        if self.errors.is_some() {
            writeln!(out, "property double error")?;
        }
        Ok(())
    }

    fn write(&self, out: &mut dyn Write) -> Result<()> {
        for (i_point, point) in self.points.iter().enumerate() {
            for coordinate in point.iter() {
                out.write_all(&coordinate.to_le_bytes())?;
            }
            if let Some(normals) = self.normals {
                for coordinate in &normals[i_point] {
                    out.write_all(&(*coordinate as f32).to_le_bytes())?;
                }
            }
            if let Some(colors) = self.colors {
                out.write_all(&colors[i_point])?;
            }
            if let Some(errors) = self.errors {
                out.write_all(&errors[i_point].to_le_bytes())?;
            }
        }
        Ok(())
    }
}
