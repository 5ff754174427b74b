//! A step downhill: Gauss-Newton, damped (Levenberg-Marquardt) where it would go uphill.

use super::joint::Objective;
use crate::geom::{Pose, Vector3};
use nalgebra::{Matrix6, SymmetricEigen, UnitQuaternion, Vector6};

/// The first damping, as a share of the greatest eigenvalue.
const DAMPING: f64 = 1e-4;
/// Dampings tried, each ten times the one before.
const TRIES: u32 = 6;
/// Directions that hold less than this share of the best one are left alone: that is rounding.
const NOTHING: f64 = 1e-12;
/// A sum may rise by this share of itself: that is rounding.
const ROUNDING: f64 = 1e-12;

/// The step, turn before shift, that makes what is made small smaller; `None` if none does.
///
/// `radius` is the size of the cloud: it makes turns and shifts comparable.
pub(super) fn step(objective: &Objective, pose: &Pose, radius: f64) -> Option<Vector6<f64>> {
    let normal = objective.normal(pose);
    let mut damping = 0.0;
    for _ in 0..TRIES {
        let step = solve(&normal.h, &normal.g, damping, radius);
        let sum = objective.sum(&taken(pose, &step));
        if sum <= normal.cost * (1.0 + ROUNDING) {
            return Some(step);
        }
        damping = if damping == 0.0 { DAMPING } else { damping * 10.0 };
    }
    None
}

/// The pose after a step from the left: `x' = exp(w) x + v`.
pub(in crate::register) fn taken(pose: &Pose, step: &Vector6<f64>) -> Pose {
    let turn = Vector3::new(step[0], step[1], step[2]);
    let shift = Vector3::new(step[3], step[4], step[5]);
    let next = Pose::from_parts(shift.into(), UnitQuaternion::from_scaled_axis(turn)) * pose;
    // Products of many turns drift from length one.
    Pose::from_parts(next.translation, UnitQuaternion::new_normalize(next.rotation.into_inner()))
}

/// The damped solution of the normal equations `h x = -g`; nothing is done where they say nothing.
///
/// `radius` makes turns and shifts comparable.
pub(in crate::register) fn solve(
    h: &Matrix6<f64>,
    g: &Vector6<f64>,
    damping: f64,
    radius: f64,
) -> Vector6<f64> {
    let lever = 1.0 / radius;
    let scale = Vector6::new(lever, lever, lever, 1.0, 1.0, 1.0);
    let mut h = *h;
    for a in 0..6 {
        for b in 0..6 {
            h[(a, b)] *= scale[a] * scale[b];
        }
    }
    let g = g.component_mul(&scale);
    let eigen = SymmetricEigen::new(h);
    let greatest = eigen.eigenvalues.max();
    let mut step = Vector6::zeros();
    for (value, direction) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
        if *value > NOTHING * greatest {
            step -= direction * (direction.dot(&g) / (value + damping * greatest));
        }
    }
    step.component_mul(&scale)
}

#[cfg(test)]
mod tests {
    use super::super::cost::{Cost, Motion};
    use super::super::options::Metric;
    use super::super::pair::Pair;
    use super::super::tests::{options, relief};
    use super::super::view::{View, ViewOptions};
    use super::*;
    use crate::progress::Silent;
    use crate::register::icp::Role;

    /// The derivative of every metric against differences of its cost.
    #[test]
    fn the_gradient_is_the_slope_of_the_cost() {
        let with_colours = ViewOptions { with_colours: true, ..options(0.8) };
        let view = View::new(&relief(2000), Role::Source, with_colours, &Silent).unwrap();
        let pairs: Vec<Pair> = (0..view.len() as u32 - 3)
            .map(|i| Pair {
                source: i,
                target: i + 3,
                distance: 0.0,
                weight: 0.5 + f64::from(i % 3),
                is_turned: false,
            })
            .collect();
        let pose = Pose::new(Vector3::new(0.3, -0.2, 0.1), Vector3::new(0.02, 0.01, -0.03));
        for metric in [Metric::PointToPoint, Metric::PointToPlane] {
            check(&view, metric, &pairs, &pose, 1e-6);
        }
        // Here the turned normals are held while a step is found: true only where they agree.
        let same: Vec<Pair> = pairs.iter().map(|p| Pair { target: p.source, ..*p }).collect();
        let near = Pose::translation(1e-4, 2e-4, -1e-4);
        for metric in [Metric::Symmetric, Metric::Generalised, Metric::Coloured] {
            check(&view, metric, &same, &near, 0.05);
        }
    }

    fn check(view: &View, metric: Metric, pairs: &[Pair], pose: &Pose, tolerance: f64) {
        let cost = Cost { source: view, target: view, metric, colour_scale: 2.0 };
        let normal = cost.normal(&Motion::from(pose), pairs);
        let sum = cost.sum(&Motion::from(pose), pairs);
        assert!((normal.cost / sum - 1.0).abs() < 1e-12, "{metric:?}");
        for k in 0..6 {
            let mut nudge = Vector6::zeros();
            nudge[k] = 1e-6;
            let ahead = cost.sum(&Motion::from(&taken(pose, &nudge)), pairs);
            let behind = cost.sum(&Motion::from(&taken(pose, &-nudge)), pairs);
            let slope = (ahead - behind) / 4e-6;
            let error = (slope - normal.g[k]).abs() / normal.g.amax();
            assert!(error < tolerance, "{metric:?} {k}: {slope} {}", normal.g[k]);
        }
    }

    #[test]
    fn what_nothing_holds_is_not_moved() {
        let (mut h, mut g) = (Matrix6::zeros(), Vector6::zeros());
        h[(5, 5)] = 4.0;
        g[5] = -2.0;
        assert_eq!(solve(&h, &g, 0.0, 10.0), Vector6::new(0.0, 0.0, 0.0, 0.0, 0.0, 0.5));
    }
}
