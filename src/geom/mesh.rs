//! A triangle mesh, or a soup of triangles: nothing here asks for it to be closed or welded.

use super::{Aabb, Point3, Pose, Vector3};

/// Triangles over shared vertices. Open, unwelded and T-junction soups are welcome.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TriMesh {
    /// Vertices [mm].
    pub points: Vec<Point3>,
    /// Three indices into `points` each, counter-clockwise seen from outside where known.
    pub triangles: Vec<[u32; 3]>,
    /// Unit vertex normals, one per vertex, where the file gave them.
    pub normals: Option<Vec<Vector3>>,
    /// Vertex colours, one per vertex, where the file gave them.
    pub colors: Option<Vec<[u8; 3]>>,
}

impl TriMesh {
    /// A mesh of `points` and `triangles` without normals or colours.
    pub fn new(points: Vec<Point3>, triangles: Vec<[u32; 3]>) -> Self {
        Self { points, triangles, normals: None, colors: None }
    }

    /// The corners of triangle `i_triangle`.
    pub fn corners(&self, i_triangle: usize) -> [Point3; 3] {
        self.triangles[i_triangle].map(|i_point| self.points[i_point as usize])
    }

    /// The box around all vertices.
    pub fn aabb(&self) -> Aabb {
        Aabb::around(&self.points)
    }

    /// Half the cross product of two sides: direction of the normal, length the area [mm2].
    pub fn area_vector(&self, i_triangle: usize) -> Vector3 {
        let [a, b, c] = self.corners(i_triangle);
        (b - a).cross(&(c - a)) / 2.0
    }

    /// The mesh moved by `to_from_here`.
    #[must_use]
    pub fn moved(mut self, to_from_here: &Pose) -> Self {
        for point in &mut self.points {
            *point = to_from_here * *point;
        }
        for normal in self.normals.iter_mut().flatten() {
            *normal = to_from_here.rotation * *normal;
        }
        self
    }

    /// The mirror image in the plane y = 0, winding flipped so that outside stays outside.
    #[must_use]
    pub fn mirrored(mut self) -> Self {
        for point in &mut self.points {
            point.y = -point.y;
        }
        for normal in self.normals.iter_mut().flatten() {
            normal.y = -normal.y;
        }
        for triangle in &mut self.triangles {
            triangle.swap(1, 2);
        }
        self
    }

    /// Adds the triangles of `other` as a further piece; normals and colours are dropped unless
    /// both have them.
    pub fn append(&mut self, other: Self) {
        let offset = self.points.len() as u32;
        self.points.extend(other.points);
        self.triangles.extend(other.triangles.into_iter().map(|t| t.map(|i| i + offset)));
        self.normals = join(self.normals.take(), other.normals);
        self.colors = join(self.colors.take(), other.colors);
    }
}

fn join<T>(ours: Option<Vec<T>>, theirs: Option<Vec<T>>) -> Option<Vec<T>> {
    let (mut ours, theirs) = (ours?, theirs?);
    ours.extend(theirs);
    Some(ours)
}
