//! Writing STL.

use crate::geom::TriMesh;
use std::io::{Result, Write};

/// Writes a binary STL; the header states the unit, as [`crate::geom::LengthUnit::declared_in`]
/// reads it.
pub(in crate::io) fn write_binary(out: &mut dyn Write, mesh: &TriMesh) -> Result<()> {
    write!(out, "{:<width$}", "binary STL by horma, units mm", width = super::HEADER_SIZE)?;
    let n_triangles = u32::try_from(mesh.triangles.len())
        .map_err(|_| std::io::Error::other("an STL file cannot hold so many triangles"))?;
    out.write_all(&n_triangles.to_le_bytes())?;
    for i_triangle in 0..mesh.triangles.len() {
        let corners = mesh.corners(i_triangle).map(|corner| corner.coords);
        for vector in [normal(mesh, i_triangle)].iter().chain(&corners) {
            for &coordinate in vector {
                out.write_all(&(coordinate as f32).to_le_bytes())?;
            }
        }
        out.write_all(&[0; 2])?;
    }
    Ok(())
}

/// Writes an ASCII STL, coordinates with all their digits.
pub(in crate::io) fn write_ascii(out: &mut dyn Write, mesh: &TriMesh) -> Result<()> {
    writeln!(out, "solid horma units mm")?;
    for i_triangle in 0..mesh.triangles.len() {
        let n = normal(mesh, i_triangle);
        writeln!(out, "facet normal {} {} {}\nouter loop", n.x as f32, n.y as f32, n.z as f32)?;
        for corner in mesh.corners(i_triangle) {
            writeln!(out, "vertex {} {} {}", corner.x, corner.y, corner.z)?;
        }
        writeln!(out, "endloop\nendfacet")?;
    }
    writeln!(out, "endsolid horma")
}

/// Zero where the triangle has no area, as the format asks.
fn normal(mesh: &TriMesh, i_triangle: usize) -> crate::geom::Vector3 {
    mesh.area_vector(i_triangle).try_normalize(0.0).unwrap_or_default()
}
