//! The same surface in four times as many triangles.

use crate::geom::TriMesh;
use std::collections::HashMap;

/// Cuts every triangle into four at the midpoints of its sides. The surface stays what it was,
/// flat facets included; only the count grows. Normals and colours are dropped.
pub fn subdivide(mesh: &TriMesh) -> TriMesh {
    let mut points = mesh.points.clone();
    let mut midpoints = HashMap::with_capacity(mesh.triangles.len() * 3 / 2);
    let mut triangles = Vec::with_capacity(mesh.triangles.len() * 4);
    for &[a, b, c] in &mesh.triangles {
        let [ab, bc, ca] = [(a, b), (b, c), (c, a)].map(|(from, to)| {
            *midpoints.entry((from.min(to), from.max(to))).or_insert_with(|| {
                points.push(nalgebra::center(&points[from as usize], &points[to as usize]));
                points.len() as u32 - 1
            })
        });
        triangles.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
    }
    TriMesh::new(points, triangles)
}

#[cfg(test)]
mod tests {
    use super::super::solids::{
        prism,
        tests::{assert_watertight, volume},
    };
    use super::*;

    #[test]
    fn subdividing_keeps_the_body_and_makes_four_triangles_of_one() {
        let coarse = prism(5, 10.0, 20.0);
        let fine = subdivide(&coarse);
        assert_eq!(fine.triangles.len(), 4 * coarse.triangles.len());
        assert_watertight(&fine);
        assert!((volume(&fine) - volume(&coarse)).abs() < 1e-9);
        // Euler: a closed mesh of F triangles has F / 2 + 2 vertices, so midpoints are shared.
        assert_eq!(fine.points.len(), fine.triangles.len() / 2 + 2);
    }
}
