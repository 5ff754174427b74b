//! What is told of each frame that made the surface.

use super::Fusion;
use super::fusion::sparse_points;
use crate::geom::{Point3, Pose, TriMesh, distances_from_mesh};
use crate::register::tsdf::Readings;
use crate::rgbd::StampedPose;
use serde::Serialize;

/// Readings of a frame that are held against the surface at most, where there is no need of all.
const SAMPLE: usize = 1000;

/// A frame that is in the surface.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct FusedFrame {
    /// Counted from 1.
    pub number: usize,
    /// When it was taken [s].
    pub stamp: f64,
    /// The share of it that lay on what the frames before it had made; if it was placed by that.
    pub overlap: Option<f64>,
    /// How far its readings lie from the surface that all frames made, in the median [mm]: its noise, and
    /// by how much it contradicts the others.
    pub apart: f64,
    /// How far its camera is off the truth, the whole way laid over the true one; if that is known and
    /// frames were placed by tracking [mm].
    pub off: Option<f64>,
}

/// Some readings of a frame, kept until there is a surface.
pub(super) struct Sample {
    number: usize,
    overlap: Option<f64>,
    points: Vec<Point3>,
}

impl Sample {
    pub(super) fn new(
        number: usize,
        overlap: Option<f64>,
        readings: &Readings,
        world_from_camera: &Pose,
    ) -> Self {
        let n_pixels = readings.pixels.width() * readings.pixels.height();
        let step = n_pixels.div_ceil(SAMPLE).isqrt().max(4);
        Self { number, overlap, points: sparse_points(readings, step, world_from_camera) }
    }
}

impl Fusion {
    /// What is told of the frames in `mesh`, which has triangles.
    pub(super) fn frames(&self, mesh: &TriMesh) -> Vec<FusedFrame> {
        let points: Vec<Point3> =
            self.samples.iter().flat_map(|sample| sample.points.iter().copied()).collect();
        let apart = distances_from_mesh(mesh, &points);
        let mut rest = apart.as_slice();
        let frame = |(sample, pose): (&Sample, &StampedPose)| {
            let (own, after) = rest.split_at(sample.points.len());
            rest = after;
            let Sample { number, overlap, .. } = *sample;
            let (stamp, apart) = (pose.stamp, median(own.to_vec()));
            FusedFrame { number, stamp, overlap, apart, off: None }
        };
        self.samples.iter().zip(&self.fused).map(frame).collect()
    }
}

/// The middle one; 0 of none.
fn median(mut numbers: Vec<f64>) -> f64 {
    let middle = numbers.len() / 2;
    if numbers.is_empty() { 0.0 } else { *numbers.select_nth_unstable_by(middle, f64::total_cmp).1 }
}
