//! One turn for many motions.

use super::Turntable;
use crate::geom::{Matrix3, Point3, Pose, Vector3};

/// Rounds in which motions that do not fit lose their weight.
const ROUNDS: usize = 8;

/// The turn about one axis, without a shift along it, that `motions` have most in common; `None` if they
/// do not turn. Of the axis' points it names the one nearest to `middle`.
///
/// A motion that takes points `off` elsewhere than the turn does, at a distance of `lever` from
/// `middle`, counts for the less the more `off` is above the median (Geman and `McClure`).
pub(super) fn fit(motions: &[Pose], middle: &Point3, lever: f64) -> Option<Turntable> {
    let mut weights = vec![1.0; motions.len()];
    let mut found = None;
    for _ in 0..ROUNDS {
        let turntable = weighted(motions, &weights, middle)?;
        let off: Vec<f64> =
            motions.iter().map(|motion| off(motion, &turntable, middle, lever)).collect();
        let scale = median(&off).max(1e-9 * lever);
        weights = off.iter().map(|off| (1.0 + (off / scale).powi(2)).powi(-2)).collect();
        found = Some(turntable);
    }
    found
}

/// How far points about `middle` are from where the turntable's step would take them: root mean square.
pub(super) fn off(motion: &Pose, turntable: &Turntable, middle: &Point3, lever: f64) -> f64 {
    let step = turntable.turned(1.0);
    let shift = (motion * middle - step * middle).norm();
    let turn = motion.rotation.angle_to(&step.rotation);
    shift.hypot(turn * lever)
}

fn weighted(motions: &[Pose], weights: &[f64], middle: &Point3) -> Option<Turntable> {
    let turns: Vec<Vector3> = motions.iter().map(|motion| motion.rotation.scaled_axis()).collect();
    let all = turns.iter().zip(weights).map(|(turn, weight)| turn * *weight).sum::<Vector3>();
    let axis = all.try_normalize(1e-12)?;
    let total: f64 = weights.iter().sum();
    let step = all.dot(&axis) / total;
    // A point of the axis stays where it is: (I - R) c = t; along the axis that says nothing.
    let along = axis * axis.transpose();
    let mut squares = along * total;
    let mut products = along * middle.coords * total;
    for (motion, weight) in motions.iter().zip(weights) {
        let leaves = Matrix3::identity() - motion.rotation.to_rotation_matrix().matrix();
        squares += leaves.transpose() * leaves * *weight;
        products += leaves.transpose() * motion.translation.vector * *weight;
    }
    let through = Point3::from(squares.cholesky()?.solve(&products));
    through.iter().all(|c| c.is_finite()).then_some(Turntable { axis, through, step })
}

/// The middle one; 0 of none.
pub(super) fn median(numbers: &[f64]) -> f64 {
    let mut sorted = numbers.to_vec();
    let middle = sorted.len() / 2;
    if sorted.is_empty() { 0.0 } else { *sorted.select_nth_unstable_by(middle, f64::total_cmp).1 }
}
