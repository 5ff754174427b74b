//! How far a point is from a mesh: a descent through the tree over its triangles.

use crate::geom::tree::{Lanes, Node, PatchTree, WIDTH};
use crate::geom::{Point3, TriMesh, Vector3};
use rayon::prelude::*;

/// Boxes are kept and measured in `f32`: a box is passed by only if it is farther off by this [mm].
const SLACK: f32 = 1e-3;

/// How far each of `points` lies from `mesh` [mm]; infinitely far from one without triangles.
pub fn distances_from_mesh(mesh: &TriMesh, points: &[Point3]) -> Vec<f64> {
    let on_mesh = OnMesh::new(mesh, mesh.triangles.len());
    points.par_iter().map(|point| on_mesh.distance(point, f64::INFINITY)).collect()
}

/// A mesh ready to be measured against.
pub struct OnMesh {
    triangles: Vec<[Point3; 3]>,
    tree: PatchTree<3>,
}

impl OnMesh {
    /// A tree over the first `n_triangles` triangles of `mesh`.
    pub fn new(mesh: &TriMesh, n_triangles: usize) -> Self {
        let triangles: Vec<_> = (0..n_triangles).map(|i| mesh.corners(i)).collect();
        let tree = PatchTree::build(&triangles);
        Self { triangles, tree }
    }

    /// The distance of `point` from the nearest triangle, if that is less than `limit`; else `limit`.
    pub fn distance(&self, point: &Point3, limit: f64) -> f64 {
        let out = point - self.tree.origin;
        let seen = [out.x as f32, out.y as f32, out.z as f32];
        let mut best = limit;
        let mut waiting: Vec<(f32, u32, bool)> =
            self.tree.roots.iter().map(|&root| (0.0, root, false)).collect();
        while let Some((bound, index, is_leaf)) = waiting.pop() {
            if f64::from(bound) >= best {
                continue;
            }
            if is_leaf {
                let leaf = &self.tree.leaves[index as usize];
                for &i in &leaf.primitives[..leaf.n_primitives as usize] {
                    let nearest = on_triangle(point, &self.triangles[i as usize]);
                    best = best.min((point - nearest).norm());
                }
                continue;
            }
            let node = &self.tree.nodes[index as usize];
            let bounds = distances(node, seen);
            let first = waiting.len();
            let children = bounds.into_iter().zip(node.children).zip(node.radius);
            for ((bound, child), radius) in children {
                if radius >= 0.0 && f64::from(bound) < best {
                    waiting.push((bound, child, node.is_over_leaves));
                }
            }
            // The nearest is looked into first.
            waiting[first..].sort_unstable_by(|a, b| b.0.total_cmp(&a.0));
        }
        best
    }
}

/// Lower bounds of the distances of sixteen boxes.
fn distances(node: &Node, point: [f32; 3]) -> Lanes {
    let mut squares = [0.0_f32; WIDTH];
    for side in &node.sides {
        for lane in 0..WIDTH {
            let out = [0, 1, 2].map(|k| point[k] - node.center[k][lane]);
            let along = [0, 1, 2].map(|k| side[k][lane]);
            let dot = out[0] * along[0] + out[1] * along[1] + out[2] * along[2];
            let length2 = along[0] * along[0] + along[1] * along[1] + along[2] * along[2];
            // A side without length gives no number; `max` makes that 0.
            let beyond = ((dot.abs() - length2) / length2.sqrt()).max(0.0);
            squares[lane] += beyond * beyond;
        }
    }
    squares.map(|square| square.sqrt() - SLACK)
}

/// The point of a triangle nearest to `p`, by the regions of its corners and sides.
fn on_triangle(p: &Point3, [a, b, c]: &[Point3; 3]) -> Point3 {
    let (ab, ac) = (b - a, c - a);
    let normal: Vector3 = ab.cross(&ac);
    let area2 = normal.norm_squared();
    if area2 > 0.0 {
        let out = p - a;
        // Barycentric coordinates of the foot point on the plane.
        let v = out.cross(&ac).dot(&normal) / area2;
        let w = ab.cross(&out).dot(&normal) / area2;
        if v >= 0.0 && w >= 0.0 && v + w <= 1.0 {
            return a + ab * v + ac * w;
        }
    }
    let sides = [on_segment(p, a, b), on_segment(p, b, c), on_segment(p, c, a)];
    let [first, second, third] = sides.map(|q| ((p - q).norm_squared(), q));
    let nearer = |x: (f64, Point3), y: (f64, Point3)| if y.0 < x.0 { y } else { x };
    nearer(nearer(first, second), third).1
}

fn on_segment(p: &Point3, a: &Point3, b: &Point3) -> Point3 {
    let way = b - a;
    let length2 = way.norm_squared();
    let share = if length2 > 0.0 { ((p - a).dot(&way) / length2).clamp(0.0, 1.0) } else { 0.0 };
    a + way * share
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::shapes;

    #[test]
    fn the_tree_finds_the_same_distance_as_trying_every_triangle() {
        let mesh = shapes::bumpy_cylinder(2_000);
        let nearest = OnMesh::new(&mesh, mesh.triangles.len());
        for i in 0..200_u32 {
            let t = f64::from(i);
            let point = Point3::new(t * 0.7 - 20.0, 50.0 * (t * 0.9).cos(), 45.0 * (t * 1.3).sin());
            let all = nearest.triangles.iter().map(|t| (point - on_triangle(&point, t)).norm());
            let expected = all.fold(f64::INFINITY, f64::min);
            assert_eq!(nearest.distance(&point, f64::INFINITY), expected, "{point}");
            assert_eq!(nearest.distance(&point, expected / 2.0), expected / 2.0);
        }
    }

    #[test]
    fn facet_side_and_corner_of_a_triangle_are_told_apart() {
        let corners = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]].map(Point3::from);
        let near = |x: f64, y: f64, z: f64| on_triangle(&Point3::new(x, y, z), &corners);
        assert_eq!(near(1.0, 1.0, 5.0), Point3::new(1.0, 1.0, 0.0));
        assert_eq!(near(2.0, -3.0, 1.0), Point3::new(2.0, 0.0, 0.0));
        assert_eq!(near(-1.0, -1.0, 1.0), Point3::origin());
        assert!((near(4.0, 4.0, 0.0) - Point3::new(2.0, 2.0, 0.0)).norm() < 1e-12);
    }
}
