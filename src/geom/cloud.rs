//! A cloud of points.

use super::{Aabb, Point3, Vector3};

/// Points with, where the scanner gave them, normals and colours (each as long as `points`).
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PointCloud {
    /// Where the points are [mm].
    pub points: Vec<Point3>,
    /// Unit normals, one per point.
    pub normals: Option<Vec<Vector3>>,
    /// Red, green, blue, one per point.
    pub colors: Option<Vec<[u8; 3]>>,
}

impl PointCloud {
    /// The box around all points.
    pub fn aabb(&self) -> Aabb {
        Aabb::around(&self.points)
    }
}
