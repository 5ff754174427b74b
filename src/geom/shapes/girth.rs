//! A taut tape around a body: the perimeter of the convex hull of a plane section.

use crate::geom::{Point3, TriMesh, Vector3};

/// Length of a taut tape round `mesh` in the plane through `point` with unit `normal` [mm]; zero
/// where the plane misses the mesh.
///
/// The hull, not the contour: a tape spans the hollows of shank and cone.
pub(super) fn girth(mesh: &TriMesh, point: &Point3, normal: &Vector3) -> f64 {
    let seed = if normal.z.abs() < 0.9 { Vector3::z() } else { Vector3::x() };
    let u = normal.cross(&seed).normalize();
    let v = normal.cross(&u);
    let heights: Vec<f64> = mesh.points.iter().map(|p| (p - point).dot(normal)).collect();
    let mut section = Vec::new();
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|i| i as usize);
        for (from, to) in [(a, b), (b, c), (c, a)] {
            let (below, above) = (heights[from], heights[to]);
            // Each crossing edge once: it belongs to two triangles that walk it opposite ways.
            if below < 0.0 && 0.0 <= above {
                let way = (mesh.points[to] - mesh.points[from]) * (below / (below - above));
                let crossing = mesh.points[from] + way - point;
                section.push([crossing.dot(&u), crossing.dot(&v)]);
            }
        }
    }
    perimeter(&hull(section))
}

/// The convex hull, counter-clockwise (Andrew's monotone chain).
fn hull(mut points: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let mut hull: Vec<[f64; 2]> = half_hull(points.iter().copied());
    hull.pop();
    hull.extend(half_hull(points.iter().rev().copied()));
    hull.pop();
    hull
}

fn half_hull(points: impl Iterator<Item = [f64; 2]>) -> Vec<[f64; 2]> {
    let mut chain: Vec<[f64; 2]> = Vec::new();
    for p in points {
        while let [.., a, b] = chain[..]
            && (b[0] - a[0]) * (p[1] - a[1]) <= (b[1] - a[1]) * (p[0] - a[0])
        {
            chain.pop();
        }
        chain.push(p);
    }
    chain
}

fn perimeter(polygon: &[[f64; 2]]) -> f64 {
    let next = polygon.iter().cycle().skip(1);
    polygon.iter().zip(next).map(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1])).sum()
}

#[cfg(test)]
mod tests {
    use super::super::{cuboid, prism};
    use super::*;
    use crate::geom::Aabb;

    #[test]
    fn tape_round_a_prism_is_its_perimeter() {
        let length = girth(&prism(6, 10.0, 50.0), &Point3::new(20.0, 0.0, 0.0), &Vector3::x());
        assert!((length - 60.0).abs() < 1e-9);
    }

    #[test]
    fn tape_spans_the_hollow_between_two_bodies() {
        let block = |z| Aabb { min: Point3::new(0.0, 0.0, z), max: Point3::new(9.0, 1.0, z + 1.0) };
        let mut pair = cuboid(&block(0.0));
        pair.append(cuboid(&block(4.0)));
        let length = girth(&pair, &Point3::new(5.0, 0.0, 0.0), &Vector3::x());
        assert!((length - 12.0).abs() < 1e-9);
    }

    #[test]
    fn tape_that_misses_is_zero() {
        assert_eq!(girth(&prism(6, 10.0, 50.0), &Point3::new(90.0, 0.0, 0.0), &Vector3::x()), 0.0);
    }
}
