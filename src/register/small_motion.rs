//! Small rigid motions as six numbers: a turn [rad] before a shift [mm].
//!
//! A step `(w, v)` is the motion `x' = exp(w) x + v`; taken *from the left* of a pose it moves what the
//! pose has brought into place. What is known of a pose is the information (the inverse covariance) of
//! such a step.

use crate::geom::{Matrix3, Pose};
use nalgebra::Matrix6;

/// What carries a step through `a_from_b`: taken from the left of `b_from_c`, it is the step
/// `adjoint * step` from the left of `a_from_c`.
pub(super) fn adjoint(a_from_b: &Pose) -> Matrix6<f64> {
    let turn: Matrix3 = a_from_b.rotation.to_rotation_matrix().into_inner();
    let mut all = Matrix6::zeros();
    all.fixed_view_mut::<3, 3>(0, 0).copy_from(&turn);
    all.fixed_view_mut::<3, 3>(3, 3).copy_from(&turn);
    let lever = a_from_b.translation.vector.cross_matrix() * turn;
    all.fixed_view_mut::<3, 3>(3, 0).copy_from(&lever);
    all
}

/// What is known of `b_from_a` when `information` is known of `a_from_b`: the same, seen from the other
/// end.
pub(super) fn information_of_inverse(information: &Matrix6<f64>, a_from_b: &Pose) -> Matrix6<f64> {
    let carry = adjoint(a_from_b);
    carry.transpose() * information * carry
}

/// Minus the differential entropy of a pose, but for a constant: half the logarithm of the determinant
/// of its information.
pub(super) fn surety(information: &Matrix6<f64>) -> f64 {
    0.5 * information.determinant().max(f64::MIN_POSITIVE).ln()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Vector3;
    use crate::register::icp::taken;
    use nalgebra::Vector6;

    fn pose() -> Pose {
        Pose::new(Vector3::new(300.0, -200.0, 900.0), Vector3::new(0.4, -0.7, 0.2))
    }

    fn is_near(one: &Pose, other: &Pose) -> bool {
        let off = one.inverse() * other;
        off.translation.vector.norm() < 1e-4 && off.rotation.angle() < 1e-8
    }

    #[test]
    fn a_step_carried_through_a_pose_is_the_same_step() {
        let step = Vector6::new(1e-5, -2e-5, 3e-5, 0.02, 0.01, -0.03);
        let rest = Pose::new(Vector3::new(5.0, 6.0, 7.0), Vector3::new(0.1, 0.2, 0.3));
        let before = pose() * taken(&rest, &step);
        let after = taken(&(pose() * rest), &(adjoint(&pose()) * step));
        assert!(is_near(&before, &after));
    }

    #[test]
    fn a_step_of_a_pose_is_as_surely_known_seen_from_the_other_end() {
        let spread = Matrix6::from_fn(|i, j| 0.1 * ((i * 5 + j * 3) % 7) as f64 - 0.2);
        let information = spread.transpose() * spread + Matrix6::identity();
        let step = Vector6::new(2e-5, 1e-5, -1e-5, 0.01, -0.02, 0.03);
        // The step of the inverse that this step of the pose is.
        let other = -adjoint(&pose().inverse()) * step;
        let inverse = taken(&pose(), &step).inverse();
        assert!(is_near(&inverse, &taken(&pose().inverse(), &other)));
        let there = step.dot(&(information * step));
        let back = other.dot(&(information_of_inverse(&information, &pose()) * other));
        assert!((there / back - 1.0).abs() < 1e-9, "{there} {back}");
    }
}
