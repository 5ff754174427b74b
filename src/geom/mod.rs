//! Points, poses, boxes, clouds and meshes: what every other room builds on.

mod aabb;
mod cloud;
mod delaunay;
mod downsample;
mod mesh;
mod nearest;
mod normals;
mod outliers;
mod parts;
mod pieces;
mod planes;
mod polygon;
mod sections;
pub mod shapes;
mod surface;
mod topology;
mod tree;
mod units;
mod weld;

pub use aabb::Aabb;
pub use cloud::PointCloud;
pub use delaunay::{BEYOND, Cell, DelaunayError, delaunay};
pub(crate) use downsample::centroid;
pub use downsample::{Cells, VoxelError, voxel_grid};
pub use mesh::TriMesh;
pub use nearest::{KdTree, Nearest, Neighbour, OnMesh, VoxelMap, distances_from_mesh};
pub(crate) use normals::least_direction;
pub use normals::{Tangent, is_border, normals, orient_alike, orient_towards};
pub use outliers::{OutlierFilter, OutlierKind};
pub use parts::{CloudPart, CloudParts, PartError, box_of_parts};
pub use pieces::without_small_pieces;
pub use planes::{Plane, PlaneOptions, planes};
pub use polygon::Polygons;
pub use sections::SectionGrid;
pub use surface::Surface;
pub use topology::{MeshReport, topology};
pub use tree::PatchTree;
pub(crate) use tree::{Lanes, Leaf, Node, WIDTH};
pub use units::{LengthUnit, UnitSource};
pub use weld::weld;

/// A point in space [mm].
pub type Point3 = nalgebra::Point3<f64>;
/// A direction or displacement [mm].
pub type Vector3 = nalgebra::Vector3<f64>;
/// A 3 x 3 matrix, mostly of a rotation.
pub type Matrix3 = nalgebra::Matrix3<f64>;
/// A rigid motion; name it `a_from_b`.
pub type Pose = nalgebra::Isometry3<f64>;
