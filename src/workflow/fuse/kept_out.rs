//! Frames that are not fused but held against the surface.

use super::fusion::sparse_points;
use crate::geom::{Point3, Pose, TriMesh, distances_from_mesh};
use crate::register::tsdf::{Readings, TsdfOptions};
use rayon::prelude::*;
use serde::Serialize;

/// Farther points are of something the surface does not show, as far as the root mean square goes [mm].
const BESIDE: f64 = 50.0;

/// Every fourth reading of every fourth row is held against it.
const STEP: usize = 4;

/// Points of frames kept out.
pub(super) struct KeptOut {
    every: usize,
    voxel: f64,
    n_frames: usize,
    points: Vec<Point3>,
}

/// How far points of frames kept out lie from the surface [mm].
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct KeptOutReport {
    /// Frames kept out.
    pub n_frames: usize,
    /// Points looked at.
    pub n_points: usize,
    /// The middle distance, of all of them [mm].
    pub median: f64,
    /// Root mean square of those nearer than 50 mm [mm].
    pub rmse_within_50: f64,
    /// The share of points nearer than a voxel.
    pub share_within_voxel: f64,
}

impl KeptOut {
    pub(super) fn new(every: usize, options: &TsdfOptions) -> Self {
        Self { every, voxel: options.voxel, n_frames: 0, points: Vec::new() }
    }

    pub(super) fn wants(&self, number: usize) -> bool {
        number.is_multiple_of(self.every)
    }

    pub(super) fn add(&mut self, readings: &Readings, world_from_camera: &Pose) {
        self.n_frames += 1;
        self.points.extend(sparse_points(readings, STEP, world_from_camera));
    }

    /// Holds the points against `mesh`, which has triangles.
    pub(super) fn measured(&self, mesh: &TriMesh) -> KeptOutReport {
        let mut off = distances_from_mesh(mesh, &self.points);
        off.par_sort_unstable_by(f64::total_cmp);
        let n_points = off.len();
        let n_within = |limit: f64| off.partition_point(|d| *d < limit);
        let beside = &off[..n_within(BESIDE)];
        let square: f64 = beside.iter().map(|d| d * d).sum();
        KeptOutReport {
            n_frames: self.n_frames,
            n_points,
            median: off.get(n_points / 2).copied().unwrap_or_default(),
            rmse_within_50: (square / beside.len().max(1) as f64).sqrt(),
            share_within_voxel: n_within(self.voxel) as f64 / n_points.max(1) as f64,
        }
    }
}
