//! Where a surface lies and how it spreads.

use crate::geom::{Matrix3, Point3, Surface, Vector3};
use nalgebra::{SymmetricEigen, Unit};

/// Where a surface lies and how it spreads.
pub(super) struct Spread {
    pub(super) centroid: Point3,
    covariance: Matrix3,
}

impl Spread {
    /// Of triangles by area, of points by number; `None` of nothing.
    pub(super) fn of(surface: &Surface) -> Option<Self> {
        match surface {
            Surface::Mesh(mesh) => {
                let weighted = |i: usize| (mesh.corners(i), mesh.area_vector(i).norm());
                Self::of_weighted((0..mesh.triangles.len()).map(weighted))
            }
            _ => Self::of_weighted(surface.points().iter().map(|&p| ([p; 3], 1.0))),
        }
    }

    // Over a triangle of corners a, b, c about any origin the mean of p p^T is
    // (a a^T + b b^T + c c^T + (a + b + c)(a + b + c)^T) / 12.
    fn of_weighted(pieces: impl Iterator<Item = ([Point3; 3], f64)> + Clone) -> Option<Self> {
        let sum = |corners: [Vector3; 3]| corners[0] + corners[1] + corners[2];
        let total: f64 = pieces.clone().map(|(_, weight)| weight).sum();
        if total <= 0.0 {
            return None;
        }
        let mean = |corners: [Point3; 3]| sum(corners.map(|p| p.coords)) / 3.0;
        let moment: Vector3 = pieces.clone().map(|(corners, weight)| mean(corners) * weight).sum();
        let centroid = moment / total;
        let covariance = pieces.fold(Matrix3::zeros(), |covariance, (corners, weight)| {
            let out = corners.map(|p| p.coords - centroid);
            let squares: Matrix3 = out.iter().map(|v| v * v.transpose()).sum();
            let all = sum(out);
            covariance + (squares + all * all.transpose()) * (weight / total / 12.0)
        });
        Some(Self { centroid: centroid.into(), covariance })
    }

    /// The direction of greatest extent, pointing the way its largest coordinate grows.
    pub(super) fn principal_axis(&self) -> Vector3 {
        let eigen = SymmetricEigen::new(self.covariance);
        let axis: Vector3 = eigen.eigenvectors.column(eigen.eigenvalues.imax()).into();
        let axis = Unit::new_normalize(axis).into_inner();
        axis * axis[axis.iamax()].signum()
    }
}
