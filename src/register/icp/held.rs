//! What the pairs know about a small motion, and which motions they let pass.

use super::cost::{Cost, Motion};
use super::freedom::{FreeMotion, free_motions};
use super::options::Metric;
use super::pair::Pair;
use crate::geom::{Point3, Vector3, centroid};
use nalgebra::{Matrix6, SymmetricEigen, Vector6};

/// How the surfaces hold the six small motions.
pub(super) struct Held {
    /// The middle of the pairs, about the target's centre.
    pub(super) pivot: Point3,
    /// Their root mean square distance from it.
    lever: f64,
    /// How much of each direction a pair opposes on average, least first.
    pub(super) values: [f64; 6],
    /// Turn times lever, before shift.
    directions: [Vector6<f64>; 6],
    /// The mean square of what a pair opposes; turn [rad] before shift [mm].
    pub(super) information: Matrix6<f64>,
    target_center: Vector3,
}

impl Held {
    pub(super) fn new(cost: &Cost, motion: &Motion, pairs: &[Pair]) -> Self {
        let at = |pair: &Pair| motion.apply(&cost.source.points[pair.source as usize]);
        let places: Vec<Point3> = pairs.iter().map(at).collect();
        let pivot = centroid(&places);
        let n = places.len().max(1) as f64;
        let lever = (places.iter().map(|p| (p - pivot).norm_squared()).sum::<f64>() / n).sqrt();
        let lever = lever.max(f64::MIN_POSITIVE);
        let mut h = Matrix6::zeros();
        let mut add = |place: &Point3, along: &Vector3| {
            let turn = (place - pivot).cross(along) / lever;
            let row = Vector6::new(turn.x, turn.y, turn.z, along.x, along.y, along.z);
            h += row * row.transpose() / n;
        };
        for (pair, place) in pairs.iter().zip(&places) {
            let j = pair.target as usize;
            add(place, &cost.target.normals[j]);
            if let (Metric::Coloured, Some(colours)) = (cost.metric, &cost.target.colours) {
                add(place, &(colours.gradient[j] * cost.colour_scale));
            }
        }
        let eigen = SymmetricEigen::new(h);
        let mut order = [0, 1, 2, 3, 4, 5];
        order.sort_by(|&a, &b| eigen.eigenvalues[a].total_cmp(&eigen.eigenvalues[b]));
        let scale = Vector6::new(lever, lever, lever, 1.0, 1.0, 1.0);
        Self {
            pivot,
            lever,
            values: order.map(|k| eigen.eigenvalues[k].max(0.0)),
            directions: order.map(|k| eigen.eigenvectors.column(k).into()),
            information: Matrix6::from_fn(|a, b| h[(a, b)] * scale[a] * scale[b]),
            target_center: cost.target.center.coords,
        }
    }

    /// The motions that a pair opposes by as much.
    pub(super) fn motions(&self, held: std::ops::Range<f64>) -> Vec<FreeMotion> {
        let chosen: Vec<Vector6<f64>> = self
            .values
            .iter()
            .zip(&self.directions)
            .filter(|(value, _)| held.contains(*value))
            .map(|(_, direction)| *direction)
            .collect();
        free_motions(&chosen, self.lever, &(self.pivot + self.target_center))
    }
}
