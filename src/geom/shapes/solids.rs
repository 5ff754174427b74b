//! Prism, stub, sphere, cuboid, and the points of a cylinder.

use crate::geom::{Aabb, Point3, PointCloud, SectionGrid, TriMesh, Vector3};
use std::f64::consts::{PI, TAU};

/// The closed prism about X from `x = 0` to `length`, its `n_sides` edges at `radius` from the
/// axis, the first of them at angle 0 (towards +Y).
pub fn prism(n_sides: usize, radius: f64, length: f64) -> TriMesh {
    tube(n_sides, radius, 0.0, length)
}

/// A clamping stub about X from `x_start` to `x_end`: a closed prism whose facets, not edges, lie
/// at `radius`, so that it is nowhere thinner than the round stub it stands for.
pub fn stub(n_sides: usize, radius: f64, x_start: f64, x_end: f64) -> TriMesh {
    tube(n_sides, radius / (PI / n_sides as f64).cos(), x_start, x_end)
}

/// A sphere of `n_rings` rings of vertices between its two poles on X, every vertex at `radius`
/// from `center`.
pub fn sphere(center: &Point3, radius: f64, n_rings: usize) -> TriMesh {
    let n_columns = 2 * (n_rings + 1);
    let mut points = Vec::with_capacity(n_rings * n_columns);
    for i_ring in 1..=n_rings {
        let polar = PI * i_ring as f64 / (n_rings + 1) as f64;
        let x = center.x - radius * polar.cos();
        let ring = ring(n_columns, radius * polar.sin(), x);
        points.extend(ring.map(|p| p + Vector3::new(0.0, center.y, center.z)));
    }
    let pole = Vector3::new(radius, 0.0, 0.0);
    capped(&SectionGrid { n_columns, points }, center - pole, center + pole)
}

/// The box itself as twelve triangles.
pub fn cuboid(aabb: &Aabb) -> TriMesh {
    let corner = |i: usize| {
        let pick = |bit: usize, k: usize| if i & bit == 0 { aabb.min[k] } else { aabb.max[k] };
        Point3::new(pick(1, 0), pick(2, 1), pick(4, 2))
    };
    // Corner i has x, y, z at their greater value where bits 1, 2, 4 are set.
    let quads =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let halves = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
    TriMesh::new((0..8).map(corner).collect(), halves.collect())
}

/// Points of the cylinder about X from `x = 0` to `length`: `n_stations` rings of `n_angles`.
pub fn cylinder_points(radius: f64, length: f64, n_stations: usize, n_angles: usize) -> PointCloud {
    let last = n_stations.saturating_sub(1).max(1) as f64;
    let stations = (0..n_stations).map(|i| length * i as f64 / last);
    let points = stations.flat_map(|x| ring(n_angles, radius, x)).collect();
    PointCloud { points, ..PointCloud::default() }
}

/// The ring of `n` points around X at `x`.
fn ring(n: usize, radius: f64, x: f64) -> impl Iterator<Item = Point3> {
    (0..n).map(move |i| {
        let (sin, cos) = (TAU * i as f64 / n as f64).sin_cos();
        Point3::new(x, radius * cos, radius * sin)
    })
}

fn tube(n_sides: usize, radius: f64, x_start: f64, x_end: f64) -> TriMesh {
    let points = ring(n_sides, radius, x_start).chain(ring(n_sides, radius, x_end)).collect();
    let grid = SectionGrid { n_columns: n_sides, points };
    capped(&grid, Point3::new(x_start, 0.0, 0.0), Point3::new(x_end, 0.0, 0.0))
}

/// The grid as a closed surface: its first ring fanned out to `first`, its last ring to `last`.
pub(super) fn capped(grid: &SectionGrid, first: Point3, last: Point3) -> TriMesh {
    let n = grid.n_columns as u32;
    let mut mesh = grid.to_mesh();
    let n_points = mesh.points.len() as u32;
    for column in 0..n {
        let (here, next) = (column, (column + 1) % n);
        mesh.triangles.push([n_points, next, here]);
        mesh.triangles.push([n_points + 1, n_points - n + here, n_points - n + next]);
    }
    mesh.points.extend([first, last]);
    mesh
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use std::collections::HashMap;

    /// Every edge is walked once each way: closed, and wound the same way throughout.
    pub(in crate::geom::shapes) fn assert_watertight(mesh: &TriMesh) {
        let mut edges = HashMap::new();
        for [a, b, c] in &mesh.triangles {
            for edge in [(a, b), (b, c), (c, a)] {
                *edges.entry(edge).or_insert(0) += 1;
            }
        }
        for (&(a, b), &n_times) in &edges {
            assert_eq!(n_times, 1, "edge {a}-{b} is walked {n_times} times the same way");
            assert!(edges.contains_key(&(b, a)), "edge {a}-{b} is open");
        }
    }

    /// Signed volume, positive where triangles are seen from outside [mm3].
    pub(in crate::geom::shapes) fn volume(mesh: &TriMesh) -> f64 {
        let tetrahedron = |i| {
            let [a, b, c] = mesh.corners(i);
            a.coords.dot(&b.coords.cross(&c.coords)) / 6.0
        };
        (0..mesh.triangles.len()).map(tetrahedron).sum()
    }

    #[test]
    fn prism_has_the_volume_of_its_formula() {
        let mesh = prism(7, 10.0, 30.0);
        assert_watertight(&mesh);
        let expected = 30.0 * 3.5 * 100.0 * (TAU / 7.0).sin();
        assert!((volume(&mesh) - expected).abs() < 1e-9 * expected);
        assert_eq!(mesh.points[0], Point3::new(0.0, 10.0, 0.0));
    }

    #[test]
    fn stub_is_nowhere_thinner_than_its_radius() {
        let mesh = stub(24, 12.0, -30.0, 5.0);
        assert_watertight(&mesh);
        for i in 0..mesh.triangles.len() {
            let normal = mesh.area_vector(i).normalize();
            let [a, ..] = mesh.corners(i);
            let distance = normal.y * a.y + normal.z * a.z;
            assert!(normal.x.abs() > 0.5 || (distance - 12.0).abs() < 1e-9, "{distance}");
        }
    }

    #[test]
    fn sphere_is_closed_and_a_little_smaller_than_the_ball() {
        let center = Point3::new(1.0, 2.0, 3.0);
        let mesh = sphere(&center, 10.0, 40);
        assert_watertight(&mesh);
        assert!(mesh.points.iter().all(|p| ((p - center).norm() - 10.0).abs() < 1e-9));
        let ratio = volume(&mesh) / (4.0 / 3.0 * PI * 1000.0);
        assert!((0.99..1.0).contains(&ratio), "{ratio}");
    }

    #[test]
    fn cuboid_is_closed_and_holds_its_volume() {
        let aabb = Aabb { min: Point3::new(-1.0, 2.0, 3.0), max: Point3::new(1.0, 5.0, 7.0) };
        let mesh = cuboid(&aabb);
        assert_watertight(&mesh);
        assert!((volume(&mesh) - 24.0).abs() < 1e-12);
    }

    #[test]
    fn cylinder_points_lie_on_the_cylinder_from_end_to_end() {
        let cloud = cylinder_points(5.0, 20.0, 11, 36);
        assert_eq!(cloud.points.len(), 11 * 36);
        assert!(cloud.points.iter().all(|p| (p.y.hypot(p.z) - 5.0).abs() < 1e-12));
        assert_eq!((cloud.aabb().min.x, cloud.aabb().max.x), (0.0, 20.0));
    }
}
