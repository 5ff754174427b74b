//! What an edge says against two poses, and how that changes with them.
//!
//! A pose moves by a small step from the right, `pose * (exp(w), v)`, in its own frame: so the numbers
//! stay small however far away the node is. What an edge measures is off by the step from the left, turn
//! before shift, that takes the measured motion to the one between the poses; that is the step its
//! information is of.

use super::Edge;
use crate::geom::{Matrix3, Pose, Vector3};
use nalgebra::{Matrix6, UnitQuaternion, Vector6};

/// Below this angle series are exact to rounding [rad].
const TINY: f64 = 1e-4;

/// What an edge says against two poses.
#[derive(Debug, Clone, Copy)]
pub(super) struct Residual {
    pub(super) value: Vector6<f64>,
    /// How it changes with a small step of the one end, and of the other.
    pub(super) by_a: Matrix6<f64>,
    pub(super) by_b: Matrix6<f64>,
}

/// By how much `edge` is off, by poses `world_from_a` and `world_from_b`.
pub(super) fn value(edge: &Edge, world_from_a: &Pose, world_from_b: &Pose) -> Vector6<f64> {
    let off = world_from_a.inverse() * world_from_b * edge.a_from_b.inverse();
    let (turn, shift) = (off.rotation.scaled_axis(), off.translation.vector);
    Vector6::new(turn.x, turn.y, turn.z, shift.x, shift.y, shift.z)
}

/// The same, and its derivatives.
pub(super) fn residual(edge: &Edge, world_from_a: &Pose, world_from_b: &Pose) -> Residual {
    let a_from_b = world_from_a.inverse() * world_from_b;
    let value = value(edge, world_from_a, world_from_b);
    let (turn, shift) = (vector(&value, 0), vector(&value, 3));
    let to_axis = left_inverse(&turn);
    let turned = a_from_b.rotation.to_rotation_matrix().into_inner();
    // Where the measured motion puts the origin of its other end, there and back.
    let arm = edge.a_from_b.rotation.inverse() * edge.a_from_b.translation.vector;
    Residual {
        value,
        by_a: blocks(&-to_axis, &shift.cross_matrix(), &-Matrix3::identity()),
        by_b: blocks(&(to_axis * turned), &(turned * arm.cross_matrix()), &turned),
    }
}

/// A pose after a small step from the right.
pub(super) fn stepped(pose: &Pose, step: &Vector6<f64>) -> Pose {
    let turn = UnitQuaternion::from_scaled_axis(vector(step, 0));
    let next = pose * Pose::from_parts(vector(step, 3).into(), turn);
    // Products of many turns drift from length one.
    Pose::from_parts(next.translation, UnitQuaternion::new_normalize(next.rotation.into_inner()))
}

fn vector(six: &Vector6<f64>, at: usize) -> Vector3 {
    six.fixed_rows::<3>(at).into_owned()
}

/// Turns above shifts; a shift turns nothing.
fn blocks(
    turn_by_turn: &Matrix3,
    shift_by_turn: &Matrix3,
    shift_by_shift: &Matrix3,
) -> Matrix6<f64> {
    let mut all = Matrix6::zeros();
    all.fixed_view_mut::<3, 3>(0, 0).copy_from(turn_by_turn);
    all.fixed_view_mut::<3, 3>(3, 0).copy_from(shift_by_turn);
    all.fixed_view_mut::<3, 3>(3, 3).copy_from(shift_by_shift);
    all
}

/// How the axis times the angle of `exp(turn)` changes with a small turn from the left: the inverse of
/// the left Jacobian of rotations.
fn left_inverse(turn: &Vector3) -> Matrix3 {
    let (cross, angle) = (turn.cross_matrix(), turn.norm());
    let share = if angle < TINY {
        1.0 / 12.0
    } else {
        (1.0 - 0.5 * angle / (0.5 * angle).tan()) / (angle * angle)
    };
    Matrix3::identity() - cross * 0.5 + cross * cross * share
}

#[cfg(test)]
mod tests {
    use super::super::EdgeKind;
    use super::*;

    fn edge(a_from_b: Pose) -> Edge {
        Edge { a: 0, b: 1, a_from_b, information: Matrix6::identity(), kind: EdgeKind::Step }
    }

    fn pose(x: f64, turn: f64) -> Pose {
        Pose::new(Vector3::new(x, 30.0 - x, 0.3 * x), Vector3::new(0.4, -turn, 0.7 * turn))
    }

    /// Against differences, near and far from what was measured, and near half a turn off.
    #[test]
    fn derivatives_are_those_of_the_residual() {
        let (a, b) = (pose(100.0, 0.9), pose(-40.0, 0.2));
        let near = a.inverse() * b;
        for measured in [near, near * pose(3.0, 0.05), near * pose(40.0, -1.5)] {
            let edge = edge(measured);
            let found = residual(&edge, &a, &b);
            let h = 1e-5;
            for k in 0..6 {
                let mut step = Vector6::zeros();
                step[k] = h;
                let ends = |sign: f64| [stepped(&a, &(step * sign)), stepped(&b, &(step * sign))];
                let ([a1, b1], [a0, b0]) = (ends(1.0), ends(-1.0));
                let by_a = (value(&edge, &a1, &b) - value(&edge, &a0, &b)) / (2.0 * h);
                let by_b = (value(&edge, &a, &b1) - value(&edge, &a, &b0)) / (2.0 * h);
                let off =
                    (by_a - found.by_a.column(k)).amax().max((by_b - found.by_b.column(k)).amax());
                assert!(off < 1e-5, "{k}: {off}");
            }
        }
    }

    #[test]
    fn an_edge_that_fits_says_nothing() {
        let (a, b) = (pose(100.0, 0.9), pose(-40.0, 0.2));
        assert!(value(&edge(a.inverse() * b), &a, &b).norm() < 1e-12);
        // A step from the left of the measured motion is what it is off.
        let step = Vector6::new(0.01, -0.02, 0.03, 1.0, 2.0, -3.0);
        let off = crate::register::icp::taken(&(a.inverse() * b), &step);
        let found = value(&edge(a.inverse() * b), &a, &(a * off));
        assert!((found - step).norm() < 1e-12, "{found}");
    }
}
