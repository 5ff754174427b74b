//! What a part can be given as.

use super::{Aabb, Point3, PointCloud, SectionGrid, TriMesh};

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
    /// What it is, in a word.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Mesh(_) => "mesh",
            Self::Points(_) => "cloud of points",
            Self::Sections(_) => "grid of sections",
        }
    }

    /// The points it is made of: vertices, cloud or section points.
    pub fn points(&self) -> &[Point3] {
        match self {
            Self::Mesh(mesh) => &mesh.points,
            Self::Points(cloud) => &cloud.points,
            Self::Sections(grid) => &grid.points,
        }
    }

    /// Multiplies every coordinate by `factor`.
    #[must_use]
    pub fn scaled(mut self, factor: f64) -> Self {
        let points = match &mut self {
            Self::Mesh(mesh) => &mut mesh.points,
            Self::Points(cloud) => &mut cloud.points,
            Self::Sections(grid) => &mut grid.points,
        };
        for point in points {
            *point *= factor;
        }
        self
    }

    /// The surface as triangles; `None` if it is points alone.
    pub fn into_mesh(self) -> Option<TriMesh> {
        match self {
            Self::Mesh(mesh) => Some(mesh),
            Self::Points(_) => None,
            Self::Sections(grid) => Some(grid.to_mesh()),
        }
    }

    /// Only the points, with their normals and colours.
    pub fn into_points(self) -> PointCloud {
        match self {
            Self::Mesh(TriMesh { points, normals, colors, .. }) => {
                PointCloud { points, normals, colors }
            }
            Self::Points(cloud) => cloud,
            Self::Sections(grid) => PointCloud { points: grid.points, ..PointCloud::default() },
        }
    }
}
