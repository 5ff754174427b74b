//! The least eigenvalue of a symmetric 3 x 3 matrix and its direction, in closed form.

use crate::geom::{Matrix3, Vector3};
use std::f64::consts::TAU;

/// The least eigenvalue of the symmetric `matrix`, and a unit vector along its eigenvector; of a
/// whole plane or space of them, any.
///
/// Eigenvalues by Smith (1961), the vector as the longest cross product of two rows of what is left
/// when the eigenvalue is taken away.
pub(crate) fn least_direction(matrix: &Matrix3) -> (f64, Vector3) {
    let mean = matrix.trace() / 3.0;
    let m = matrix - Matrix3::from_diagonal_element(mean);
    let spread = (m.norm_squared() / 6.0).sqrt();
    if spread.is_nan() || spread <= mean.abs() * 1e-14 {
        return (mean, Vector3::z());
    }
    let half_determinant = (m / spread).determinant() / 2.0;
    let angle = half_determinant.clamp(-1.0, 1.0).acos() / 3.0;
    let least = mean + 2.0 * spread * (angle + TAU / 3.0).cos();
    let rest = matrix - Matrix3::from_diagonal_element(least);
    let [a, b, c] = [0, 1, 2].map(|i| rest.row(i).transpose());
    let crossed = [a.cross(&b), b.cross(&c), c.cross(&a)];
    let longest = crossed.into_iter().max_by(|p, q| p.norm_squared().total_cmp(&q.norm_squared()));
    let direction = longest.and_then(|normal| {
        // Rows along one line: the eigenvalue is double, and anything square to them will do.
        let is_clear = normal.norm() > 1e-9 * spread * spread;
        is_clear.then(|| normal.normalize())
    });
    (least, direction.unwrap_or_else(|| square_to([a, b, c])))
}

/// A unit vector square to the longest of `rows`.
fn square_to(rows: [Vector3; 3]) -> Vector3 {
    let longest = rows.into_iter().max_by(|p, q| p.norm_squared().total_cmp(&q.norm_squared()));
    let along = longest.unwrap_or_default();
    let across = if along.x.abs() < along.y.abs() { Vector3::x() } else { Vector3::y() };
    along.cross(&across).try_normalize(0.0).unwrap_or(Vector3::z())
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Rotation3, SymmetricEigen};

    #[test]
    fn the_closed_form_agrees_with_iteration() {
        for i in 0..200 {
            let t = f64::from(i);
            let turn = Rotation3::from_euler_angles(t, 0.7 * t, 1.9 * t).into_inner();
            let values = Vector3::new(1e-4 * (1.0 + t.sin()), 1.0, 1.5 + t.cos());
            let matrix = turn * Matrix3::from_diagonal(&values) * turn.transpose();
            let (least, direction) = least_direction(&matrix);
            let expected = SymmetricEigen::new(matrix).eigenvalues.min();
            assert!((least - expected).abs() < 1e-12 * 10.0, "{i}: {least} {expected}");
            let residual = matrix * direction - direction * least;
            assert!(residual.norm() < 1e-7 && (direction.norm() - 1.0).abs() < 1e-12, "{i}");
        }
    }

    #[test]
    fn lines_balls_and_nothing_have_some_direction() {
        let along = Vector3::new(1.0, 2.0, 3.0);
        let (least, direction) = least_direction(&(along * along.transpose()));
        assert!(least.abs() < 1e-12 && direction.dot(&along).abs() < 1e-6);
        for matrix in [Matrix3::identity(), Matrix3::zeros()] {
            assert!((least_direction(&matrix).1.norm() - 1.0).abs() < 1e-12);
        }
    }
}
