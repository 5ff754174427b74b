//! One Gauss-Newton step of a frame towards a view of the model.
//!
//! Point to plane (Chen and Medioni, 1992), pairs by projection (Blais and Levine, 1995).

use super::frame::FrameLevel;
use super::held::Held;
use super::{ModelView, Seen};
use crate::geom::Pose;
use nalgebra::{Matrix6, Vector3, Vector6};
use rayon::prelude::*;

/// What is a pair, and what it counts for.
#[derive(Debug, Clone, Copy)]
pub(super) struct Gate {
    /// Points farther apart are none [mm].
    pub(super) distance: f64,
    /// Cosine of what normals may enclose.
    pub(super) cosine: f64,
}

/// The sums of one step.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sums {
    hessian: Matrix6<f64>,
    gradient: Vector6<f64>,
    /// How the pairs hold the pose.
    pub(super) held: Held,
}

/// The noise of depth: at hand, and a metre away [mm]; there it grows with depth squared.
const NOISE: [f64; 2] = [1.0, 1.5];
/// Pairs lose weight from this many standard deviations on.
const DOUBTFUL: f64 = 3.0;
/// Nor before this share of the distance of the gate.
const DOUBTFUL_SHARE: f64 = 0.1;
/// Rows of pixels summed one after the other: the sums have the same bits for any number of threads.
const ROWS: usize = 8;

impl Sums {
    /// Over the pixels of `level`, placed by `model_from_frame`.
    pub(super) fn over(
        level: &FrameLevel,
        model: &ModelView,
        model_from_frame: &Pose,
        gate: Gate,
    ) -> Self {
        let chunks = level.pixels.pixels().par_chunks(ROWS * level.camera.width.max(1));
        let parts: Vec<Self> = chunks
            .map(|pixels| {
                let mut sums = Self::none();
                for seen in pixels.iter().filter(|seen| seen.point[2] > 0.0) {
                    sums.add(seen, model, model_from_frame, gate);
                }
                sums
            })
            .collect();
        parts.iter().fold(Self::none(), Self::and)
    }

    /// The small motion of the frame that brings the pairs together; `None` if they do not hold it.
    pub(super) fn motion(&self) -> Option<Pose> {
        let solution = self.hessian.cholesky()?.solve(&-self.gradient);
        let [turn, shift] = [0, 3].map(|k| solution.fixed_rows::<3>(k).into_owned());
        solution.iter().all(|c| c.is_finite()).then(|| {
            let rotation = nalgebra::UnitQuaternion::from_scaled_axis(turn);
            Pose::from_parts(shift.into(), rotation)
        })
    }

    fn none() -> Self {
        let held =
            Held { information: Matrix6::zeros(), place: Vector3::zeros(), square: 0.0, n: 0.0 };
        Self { hessian: Matrix6::zeros(), gradient: Vector6::zeros(), held }
    }

    fn and(mut self, other: &Self) -> Self {
        self.hessian += other.hessian;
        self.gradient += other.gradient;
        self.held.information += other.held.information;
        self.held.place += other.held.place;
        self.held.square += other.held.square;
        self.held.n += other.held.n;
        self
    }

    fn add(&mut self, seen: &Seen, model: &ModelView, model_from_frame: &Pose, gate: Gate) {
        let point = model_from_frame * vector(seen.point);
        let turned = model_from_frame.rotation * vector(seen.normal).coords;
        let Some(partner) = partner(&point, model) else { return };
        let (place, normal) = (vector(partner.point), vector(partner.normal).coords);
        let between = point - place;
        // Comparisons that NaN fails.
        let is_pair =
            between.norm_squared() < gate.distance.powi(2) && turned.dot(&normal) > gate.cosine;
        if !is_pair {
            return;
        }
        let residual = normal.dot(&between);
        let metres = point.z / 1000.0;
        let sigma = NOISE[0] + NOISE[1] * metres * metres;
        // Geman and McClure.
        let doubtful = (DOUBTFUL * sigma).max(DOUBTFUL_SHARE * gate.distance);
        let robust = 1.0 / (1.0 + (residual / doubtful).powi(2)).powi(2);
        let weight = robust / (sigma * sigma);
        let turn = point.coords.cross(&normal);
        let row = Vector6::new(turn.x, turn.y, turn.z, normal.x, normal.y, normal.z);
        self.hessian += row * row.transpose() * weight;
        self.gradient += row * (weight * residual);
        self.held.add(&point.coords, [&normal, &turned]);
    }
}

/// What the model shows where `point` would be seen.
fn partner<'a>(point: &crate::geom::Point3, model: &'a ModelView) -> Option<&'a Seen> {
    let [u, v] = model.camera.project(point).filter(|pixel| model.camera.sees(*pixel))?;
    // Whole numbers are the middles of pixels; what is seen is not below -0.5.
    let seen = model.pixels.get((u + 0.5) as usize, (v + 0.5) as usize)?;
    (seen.point[2] > 0.0).then_some(seen)
}

fn vector(numbers: [f32; 3]) -> crate::geom::Point3 {
    crate::geom::Point3::from(numbers.map(f64::from))
}
