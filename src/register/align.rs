//! The best rigid motion between points that are paired already.

use crate::geom::{Matrix3, Point3, Pose, Vector3};
use nalgebra::{Rotation3, UnitQuaternion};

/// The rigid motion that takes the points of `from` as near to those of `onto` as can be, in the mean
/// square. Horn (1987), by the singular values of the covariance. Of points in a line, or all in one
/// place, it is one of several.
pub fn align(from: &[Point3], onto: &[Point3]) -> Pose {
    align_weighted(from, onto, &vec![1.0; from.len()])
}

/// The same in the weighted mean square; weights are 0 or more.
pub(super) fn align_weighted(from: &[Point3], onto: &[Point3], weights: &[f64]) -> Pose {
    let total = weights.iter().sum::<f64>().max(f64::MIN_POSITIVE);
    let mean = |points: &[Point3]| {
        points.iter().zip(weights).map(|(p, w)| p.coords * *w).sum::<Vector3>() / total
    };
    let (middle, target) = (mean(from), mean(onto));
    let mut covariance = Matrix3::zeros();
    for ((a, b), w) in from.iter().zip(onto).zip(weights) {
        covariance += (b.coords - target) * (a.coords - middle).transpose() * *w;
    }
    let rotation = turn(&covariance);
    Pose::from_parts((target - rotation * middle).into(), rotation)
}

/// The turn that takes directions as near to others as can be; `covariance` is the sum of all
/// `onto * from^T`.
pub(super) fn turn(covariance: &Matrix3) -> UnitQuaternion<f64> {
    let svd = covariance.svd(true, true);
    let (u, v_t) = (svd.u.unwrap_or_default(), svd.v_t.unwrap_or_default());
    // The direction with the least to say is turned round rather than mirrored.
    let mut signs = Vector3::repeat(1.0);
    signs[svd.singular_values.imin()] = (u.determinant() * v_t.determinant()).signum();
    let turn = u * Matrix3::from_diagonal(&signs) * v_t;
    UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(turn))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn alignment_does_not_mirror() {
        let from = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1e-3]];
        let from = from.map(Point3::from);
        let mirrored = from.map(|p| Point3::new(p.x, p.y, -p.z));
        let pose = align(&from, &mirrored);
        assert!((pose.rotation.to_rotation_matrix().matrix().determinant() - 1.0).abs() < 1e-12);
        assert!(pose.rotation.angle() < 1e-2);
        let one_place = [Point3::new(1.0, 2.0, 3.0); 3];
        let pose = align(&one_place, &[Point3::origin(); 3]);
        assert!((pose * one_place[0]).coords.norm() < 1e-12, "points in one place are met");
    }
}
