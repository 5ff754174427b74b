//! How far points lie from a mesh.

use super::{KdTree, Neighbour};
use crate::geom::{Point3, TriMesh, Vector3};
use rayon::prelude::*;

/// Vertices around a point whose triangles are looked at.
const N_AROUND: usize = 6;

/// How far each of `points` lies from the surface of `mesh` [mm]; infinitely far from one without
/// triangles.
///
/// The nearest place is looked for in the triangles at the nearest six vertices. That is the nearest of
/// all where neighbouring triangles are about as large as each other, as those of scans are; a mesh of
/// few long triangles and many small ones may lie nearer than is told.
pub fn distances_from_mesh(mesh: &TriMesh, points: &[Point3]) -> Vec<f64> {
    let near = Near::new(mesh);
    points.par_iter().map_init(Vec::new, |found, point| near.distance(point, found)).collect()
}

/// The mesh, made ready to be asked.
struct Near<'a> {
    mesh: &'a TriMesh,
    tree: KdTree,
    /// Triangles by their vertices: those of vertex `i` are `at[i]..at[i + 1]` of `fans`.
    at: Vec<usize>,
    fans: Vec<u32>,
}

impl<'a> Near<'a> {
    fn new(mesh: &'a TriMesh) -> Self {
        let mut at = vec![0; mesh.points.len() + 1];
        for &i in mesh.triangles.iter().flatten() {
            at[i as usize + 1] += 1;
        }
        for i in 0..mesh.points.len() {
            at[i + 1] += at[i];
        }
        let mut next = at.clone();
        let mut fans = vec![0; 3 * mesh.triangles.len()];
        for (triangle, number) in mesh.triangles.iter().zip(0_u32..) {
            for &i in triangle {
                fans[next[i as usize]] = number;
                next[i as usize] += 1;
            }
        }
        Self { mesh, tree: KdTree::build(&mesh.points), at, fans }
    }

    fn distance(&self, point: &Point3, found: &mut Vec<Neighbour>) -> f64 {
        found.clear();
        self.tree.k_nearest(point, N_AROUND, f64::INFINITY, found);
        let fan = |i: usize| &self.fans[self.at[i]..self.at[i + 1]];
        let triangles = found.iter().flat_map(|vertex| fan(vertex.index as usize));
        let distances =
            triangles.map(|&t| from_triangle(point, self.mesh.corners(t as usize)).norm());
        distances.fold(f64::INFINITY, f64::min)
    }
}

/// From the nearest place of a triangle to `point`: before one of its regions, each an edge, a corner
/// or its inside (Ericson, Real-Time Collision Detection, 5.1.5).
fn from_triangle(point: &Point3, [a, b, c]: [Point3; 3]) -> Vector3 {
    let normal = (b - a).cross(&(c - a));
    let is_before =
        |from: &Point3, to: &Point3| (to - from).cross(&(point - from)).dot(&normal) >= 0.0;
    let square = normal.norm_squared();
    if square > 0.0 && is_before(&a, &b) && is_before(&b, &c) && is_before(&c, &a) {
        return normal * (normal.dot(&(point - a)) / square);
    }
    let from_edge = |from: &Point3, to: &Point3| {
        let along = to - from;
        let share = along.dot(&(point - from)) / along.norm_squared().max(f64::MIN_POSITIVE);
        point - (from + along * share.clamp(0.0, 1.0))
    };
    let [mut nearest, second, third] = [from_edge(&a, &b), from_edge(&b, &c), from_edge(&c, &a)];
    for other in [second, third] {
        if other.norm_squared() < nearest.norm_squared() {
            nearest = other;
        }
    }
    nearest
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::shapes;

    #[test]
    fn a_point_is_as_far_from_a_triangle_as_from_its_plane_edge_or_corner() {
        let corners = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]].map(Point3::from);
        for (point, distance) in [
            ([1.0, 1.0, 3.0], 3.0),
            ([2.0, -2.0, 0.0], 2.0),
            ([-3.0, -4.0, 0.0], 5.0),
            ([4.0, 4.0, 0.0], 8.0_f64.sqrt()),
            ([1.0, 1.0, 0.0], 0.0),
        ] {
            let found = from_triangle(&Point3::from(point), corners).norm();
            assert!((found - distance).abs() < 1e-12, "{point:?}: {found}");
        }
    }

    #[test]
    fn a_ball_is_near_on_both_sides() {
        let mesh = shapes::sphere(&Point3::origin(), 100.0, 60);
        let near = Near::new(&mesh);
        for direction in [[1.0, 2.0, 2.0], [-2.0, 1.0, 2.0], [0.6, 0.0, -0.8]] {
            let direction = Vector3::from(direction).normalize();
            for radius in [90.0, 100.0, 130.0] {
                let found = near.distance(&Point3::from(direction * radius), &mut Vec::new());
                // A facet 5 mm wide stays behind by 0.03 mm and a little more.
                assert!((found - (radius - 100.0_f64).abs()).abs() < 0.15, "{radius}: {found}");
            }
        }
    }
}
