//! Which points of a cloud lie nearest to a place, and how far a mesh is from it.
//!
//! [`KdTree`] answers at any distance; [`VoxelMap`] only looks into the cells around a place, which
//! is quicker to build. Both keep coordinates in `f32` about the middle of the cloud: points whose
//! distances differ by less than a ten-millionth of the cloud's size may be taken for each other.

mod kd_tree;
mod on_mesh;
mod search;
mod voxel_map;

pub use kd_tree::KdTree;
pub use on_mesh::{OnMesh, distances_from_mesh};
pub use voxel_map::VoxelMap;

use super::Point3;

/// A point found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Neighbour {
    /// Its place in the cloud.
    pub index: u32,
    /// How far off it is [mm].
    pub distance: f64,
}

/// What finds the nearest points of a cloud.
pub trait Nearest: Sync {
    /// The nearest point and the next after it, as far as they are nearer than `within`.
    ///
    /// Of points equally far off one is chosen by rule: the same input gives the same answer. The
    /// next one tells how far a place may move before another point could become the nearest.
    fn two_nearest(&self, place: &Point3, within: f64) -> [Option<Neighbour>; 2];

    /// The nearest point, if it is nearer than `within`.
    fn nearest(&self, place: &Point3, within: f64) -> Option<Neighbour> {
        self.two_nearest(place, within)[0]
    }

    /// What lies farther off than this is never found [mm].
    fn reach(&self) -> f64 {
        f64::INFINITY
    }
}
