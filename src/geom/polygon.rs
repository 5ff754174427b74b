//! Polygons of any number of corners, as PLY and OBJ hold them, cut into triangles.

use super::{Point3, TriMesh, Vector3};

/// Faces over shared vertices, one after the other.
#[derive(Debug, Clone, Default)]
pub struct Polygons {
    corners: Vec<u32>,
    /// Where each face ends in `corners`.
    ends: Vec<usize>,
}

impl Polygons {
    /// Adds a face; what has fewer than three corners has no surface and is left out.
    pub fn push(&mut self, corners: &[u32]) {
        if corners.len() >= 3 {
            self.corners.extend_from_slice(corners);
            self.ends.push(self.corners.len());
        }
    }

    /// True if nothing was added.
    pub fn is_empty(&self) -> bool {
        self.ends.is_empty()
    }

    /// The faces as triangles over `points`, in order, winding kept. Every corner must be one of
    /// the points.
    pub fn into_mesh(self, points: Vec<Point3>) -> TriMesh {
        let mut triangles =
            Vec::with_capacity(self.corners.len().saturating_sub(2 * self.ends.len()));
        let mut start = 0;
        for end in self.ends {
            match self.corners[start..end] {
                [a, b, c] => triangles.push([a, b, c]),
                ref polygon => clip_ears(polygon, &points, &mut triangles),
            }
            start = end;
        }
        TriMesh::new(points, triangles)
    }
}

/// Cuts one ear after the other off `polygon`: convex corners whose triangle holds no other corner.
///
/// A polygon without an ear left (it crosses itself, or has no area) is closed by a fan, so that
/// nothing of it is lost. Meisters, *Polygons have ears* (1975). O(n^2) a polygon and more for a
/// bad one, so beyond 1,000 corners it is a fan from the start.
fn clip_ears(polygon: &[u32], points: &[Point3], triangles: &mut Vec<[u32; 3]>) {
    let at = |i: u32| points[i as usize];
    let normal = newell_normal(polygon, points);
    let mut rest = polygon.to_vec();
    while rest.len() > 3 && polygon.len() <= 1_000 {
        let n = rest.len();
        let ear = (0..n).find(|&i| {
            let [a, b, c] = [rest[(i + n - 1) % n], rest[i], rest[(i + 1) % n]];
            let triangle = [at(a), at(b), at(c)];
            turn(&triangle, &normal) > 0.0
                && rest
                    .iter()
                    .map(|&i| at(i))
                    // A corner in the same place (a slit to a hole runs there and back) is no bar.
                    .filter(|p| !triangle.contains(p))
                    .all(|p| !is_inside(&p, &triangle, &normal))
        });
        let Some(i) = ear else { break };
        triangles.push([rest[(i + n - 1) % n], rest[i], rest[(i + 1) % n]]);
        rest.remove(i);
    }
    triangles.extend(rest.windows(2).skip(1).map(|pair| [rest[0], pair[0], pair[1]]));
}

/// Twice the area vector of a polygon, planar or nearly so.
fn newell_normal(polygon: &[u32], points: &[Point3]) -> Vector3 {
    let origin = points[polygon[0] as usize];
    let arm = |i: u32| points[i as usize] - origin;
    polygon.windows(2).map(|pair| arm(pair[0]).cross(&arm(pair[1]))).sum()
}

fn turn([a, b, c]: &[Point3; 3], normal: &Vector3) -> f64 {
    (b - a).cross(&(c - b)).dot(normal)
}

fn is_inside(p: &Point3, [a, b, c]: &[Point3; 3], normal: &Vector3) -> bool {
    [[a, b], [b, c], [c, a]].iter().all(|[from, to]| turn(&[**from, **to, *p], normal) >= 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cut(outline: &[[f64; 2]]) -> TriMesh {
        let points = outline.iter().map(|&[x, y]| Point3::new(x, y, 0.0)).collect();
        let corners: Vec<u32> = (0..outline.len() as u32).collect();
        let mut polygons = Polygons::default();
        polygons.push(&corners);
        polygons.into_mesh(points)
    }

    fn areas(mesh: &TriMesh) -> Vec<f64> {
        (0..mesh.triangles.len()).map(|i| mesh.area_vector(i).z).collect()
    }

    #[test]
    fn a_square_becomes_two_triangles_wound_like_it() {
        let mesh = cut(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
        assert_eq!(areas(&mesh), [0.5, 0.5]);
    }

    #[test]
    fn a_hollow_polygon_is_filled_without_covering_the_hollow() {
        // An L with the reflex corner fourth: a fan from corner 0 would turn triangles over.
        let outline = [[0.0, 2.0], [0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0]];
        let arrow = [[0.0, 0.0], [2.0, -1.0], [0.5, 0.0], [2.0, 1.0]];
        for (outline, area) in [(&outline[..], 3.0), (&arrow[..], 0.5)] {
            let areas = areas(&cut(outline));
            assert_eq!(areas.len(), outline.len() - 2);
            assert!(areas.iter().all(|area| *area > 0.0), "{areas:?}");
            assert!((areas.iter().sum::<f64>() - area).abs() < 1e-12, "{areas:?}");
        }
    }

    #[test]
    fn a_square_with_a_hole_on_a_slit_keeps_the_hole() {
        let outline = [
            [0.0, 0.0],
            [4.0, 0.0],
            [4.0, 4.0],
            [0.0, 4.0],
            [0.0, 0.0],
            [1.0, 1.0],
            [1.0, 3.0],
            [3.0, 3.0],
            [3.0, 1.0],
            [1.0, 1.0],
        ];
        let areas = areas(&cut(&outline));
        assert!(areas.iter().all(|area| *area >= 0.0), "{areas:?}");
        assert!((areas.iter().sum::<f64>() - 12.0).abs() < 1e-12, "{areas:?}");
    }

    #[test]
    fn a_polygon_without_area_still_gives_its_triangles() {
        let mesh = cut(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [3.0, 0.0], [0.0, 0.0]]);
        assert_eq!(mesh.triangles.len(), 3);
    }

    #[test]
    fn lines_and_points_are_no_faces() {
        let mut polygons = Polygons::default();
        polygons.push(&[0, 1]);
        polygons.push(&[]);
        assert!(polygons.is_empty());
    }
}
