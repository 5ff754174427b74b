//! From a start to where two frames agree best: damped Gauss-Newton, from coarse pictures to fine ones.

use super::noise::Noise;
use super::normal::{Normal, cost, normal};
use super::points::Points;
use super::pyramid::{Level, Pyramid};
use super::warp::{Batch, Warp};
use super::{DenseOptions, Light, Residuals};
use crate::geom::Pose;
use crate::register::icp::{solve, taken};
use nalgebra::{Matrix6, Vector6};

/// The first damping, as a share of the greatest eigenvalue.
const DAMPING: f64 = 1e-4;
/// Dampings tried, each ten times the one before.
const TRIES: u32 = 5;
/// The cost may rise by this share of itself: that is rounding, in single precision.
const ROUNDING: f64 = 1e-6;
/// Steps that move the picture by less than this are the last ones [px of that picture].
const STILL: f64 = 0.02;
/// Fewer points fix no pose.
pub(super) const LEAST_POINTS: f64 = 40.0;
/// Neighbouring pixels err alike: so many of them tell as much as one that errs on its own.
pub(super) const ALIKE: f64 = 100.0;

/// How far a descent came.
#[derive(Debug, Clone)]
pub(super) struct Descent {
    pub(super) pose: Pose,
    pub(super) noise: Noise,
    /// What was seen in the last picture, and the normal equations there, without prior.
    pub(super) batches: Vec<Batch>,
    pub(super) normal: Normal,
    /// Cost of a residual.
    pub(super) cost: f64,
    pub(super) n_iterations: u32,
    pub(super) converged: bool,
    /// The last step moved the picture by this [px].
    pub(super) last_step: f64,
}

/// A motion that is expected, and how surely: turn before shift.
struct Prior {
    expected: Pose,
    information: Vector6<f64>,
}

/// Lays `reference` over `next` beginning at `start`, at the levels `from` (coarse) down to `to`.
pub(super) fn descend(
    [reference, next]: [&Pyramid; 2],
    start: &Pose,
    [from, to]: [usize; 2],
    options: &DenseOptions,
) -> Descent {
    let prior = Prior::new(start, options);
    let mut descent = Descent {
        pose: *start,
        noise: Noise::START,
        batches: Vec::new(),
        normal: Normal { h: Matrix6::zeros(), g: Vector6::zeros() },
        cost: f64::INFINITY,
        n_iterations: 0,
        converged: false,
        last_step: f64::INFINITY,
    };
    for i_level in (to..=from).rev() {
        let points = reference.levels[i_level].points(options.points);
        let level = Rung { points, next: &next.levels[i_level], options, prior: &prior };
        level.descend(&mut descent, i_level == from);
    }
    descent
}

/// One picture of the reference, and where it is looked for.
struct Rung<'a> {
    points: &'a Points,
    next: &'a Level,
    options: &'a DenseOptions,
    prior: &'a Prior,
}

impl Rung<'_> {
    fn descend(&self, descent: &mut Descent, is_first: bool) {
        let with_depth = self.options.residuals == Residuals::BrightnessAndDepth;
        let light = self.options.light == Light::Corrected;
        let warp = Warp::into(self.next, with_depth);
        let mut batches = std::mem::take(&mut descent.batches);
        let mut tried = Vec::new();
        warp.look(self.points, &descent.pose, &mut batches);
        descent.converged = false;
        for i_iteration in 0..=self.options.iterations {
            let is_guess = is_first && i_iteration == 0;
            descent.noise = descent.noise.fitted(&batches, light, is_guess);
            let (data, n) = cost(&batches, &descent.noise);
            descent.normal = normal(&batches, &descent.noise);
            descent.cost = data;
            if n < LEAST_POINTS || i_iteration == self.options.iterations {
                break;
            }
            let before = data * n + self.prior.cost(&descent.pose);
            let normal = self.prior.added_to(&descent.normal, &descent.pose);
            let (mut damping, mut way) = (0.0, None);
            for _ in 0..TRIES {
                let step = solve(&normal.h, &normal.g, damping, self.points.depth);
                let pose = taken(&descent.pose, &step);
                warp.look(self.points, &pose, &mut tried);
                let (data, n_now) = cost(&tried, &descent.noise);
                // Points come and go at the rim: what counts is what a residual costs.
                let after = data * n + self.prior.cost(&pose);
                let is_lower = after <= before * (1.0 + ROUNDING) && n_now >= n / 4.0;
                if is_lower {
                    descent.pose = pose;
                    std::mem::swap(&mut batches, &mut tried);
                    way = Some(self.way(&step));
                    break;
                }
                // No use in trying steps that nobody would see.
                if self.way(&step) < STILL {
                    break;
                }
                damping = if damping == 0.0 { DAMPING } else { damping * 10.0 };
            }
            descent.n_iterations += 1;
            descent.last_step = way.unwrap_or(0.0);
            if descent.last_step < STILL {
                descent.converged = true;
                break;
            }
        }
        descent.batches = batches;
    }

    /// How far a step moves the picture [px].
    fn way(&self, step: &Vector6<f64>) -> f64 {
        let turn = step.fixed_rows::<3>(0).norm();
        let shift = step.fixed_rows::<3>(3).norm();
        self.next.camera.fx * (turn + shift / self.points.depth)
    }
}

impl Prior {
    fn new(expected: &Pose, options: &DenseOptions) -> Self {
        let sure = |sigma: Option<f64>| sigma.map_or(0.0, |sigma| ALIKE / (sigma * sigma));
        let turn = sure(options.prior_turn_deg.map(f64::to_radians));
        let shift = sure(options.prior_shift);
        let information = Vector6::new(turn, turn, turn, shift, shift, shift);
        Self { expected: *expected, information }
    }

    /// The step from the left that leads from what is expected to `pose`.
    fn off(&self, pose: &Pose) -> Vector6<f64> {
        let turn = (pose.rotation * self.expected.rotation.inverse()).scaled_axis();
        let shift = pose.translation.vector - self.expected.translation.vector;
        Vector6::new(turn.x, turn.y, turn.z, shift.x, shift.y, shift.z)
    }

    fn cost(&self, pose: &Pose) -> f64 {
        let off = self.off(pose);
        0.5 * off.component_mul(&self.information).dot(&off)
    }

    fn added_to(&self, normal: &Normal, pose: &Pose) -> Normal {
        let g = normal.g + self.information.component_mul(&self.off(pose));
        Normal { h: normal.h + Matrix6::from_diagonal(&self.information), g }
    }
}
