//! What a part can be given as.

use super::{Aabb, PointCloud, SectionGrid, TriMesh};

/// A part as read from a file.
#[derive(Debug, Clone, PartialEq)]
pub enum Surface {
    /// Triangles, digitized exactly.
    Mesh(TriMesh),
    /// Points alone, digitized as in the thesis.
    Points(PointCloud),
    /// Ordered sections; [`SectionGrid::to_mesh`] makes them triangles.
    Sections(SectionGrid),
}

impl Surface {
    /// The box around everything.
    pub fn aabb(&self) -> Aabb {
        match self {
            Self::Mesh(mesh) => mesh.aabb(),
            Self::Points(cloud) => cloud.aabb(),
            Self::Sections(grid) => Aabb::around(&grid.points),
        }
    }
}
