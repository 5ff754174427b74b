//! The principal axes laid on each other: a start for clouds that show a body all around.

use crate::geom::{Matrix3, Point3, Pose, Vector3, centroid};
use nalgebra::{Rotation3, SymmetricEigen, UnitQuaternion};

/// The four rigid motions that lay the principal axes and the centroid of `source` on those of
/// `target`. An axis has no sense: which of the four it is, only the surfaces tell.
pub(super) fn axes(source: &[Point3], target: &[Point3]) -> [Pose; 4] {
    let (from, onto) = (frame(source), frame(target));
    let signs = [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]];
    signs.map(|[a, b]| {
        let turn = onto.1 * Matrix3::from_diagonal(&Vector3::new(a, b, a * b)) * from.1.transpose();
        let turn = Rotation3::from_matrix_unchecked(turn);
        let rotation = UnitQuaternion::from_rotation_matrix(&turn);
        Pose::from_parts((onto.0.coords - rotation * from.0.coords).into(), rotation)
    })
}

/// The centroid and the axes, longest first, right-handed.
fn frame(points: &[Point3]) -> (Point3, Matrix3) {
    let middle = centroid(points);
    let squares: Matrix3 = points.iter().map(|p| (p - middle) * (p - middle).transpose()).sum();
    let eigen = SymmetricEigen::new(squares);
    let mut order = [0, 1, 2];
    order.sort_by(|&a, &b| eigen.eigenvalues[b].total_cmp(&eigen.eigenvalues[a]));
    let [x, y] = [order[0], order[1]].map(|k| eigen.eigenvectors.column(k).into_owned());
    (middle, Matrix3::from_columns(&[x, y, x.cross(&y)]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::shapes;

    #[test]
    fn one_of_the_four_is_the_motion_and_all_are_rigid() {
        let source = shapes::chiral(2000).points;
        let pose = Pose::new(Vector3::new(400.0, -30.0, 90.0), Vector3::new(2.0, -1.0, 0.7));
        let target: Vec<Point3> = source.iter().map(|p| pose * p).collect();
        let all = axes(&source, &target);
        let off =
            |found: &Pose| source.iter().map(|p| (found * p - pose * p).norm()).fold(0.0, f64::max);
        let right = all.iter().filter(|found| off(found) < 1e-6).count();
        assert_eq!(right, 1);
        for found in all {
            let matrix = found.rotation.to_rotation_matrix();
            assert!((matrix.matrix().determinant() - 1.0).abs() < 1e-9);
        }
    }
}
