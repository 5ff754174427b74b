//! The plane through points, and whether they bend away from it.

use crate::geom::{Matrix3, Point3, Vector3, least_direction};

/// Noise of so many normals counts as one's, for a slope along two directions: normals are made from
/// some twenty neighbours, and so share their noise.
const SHARED: f64 = 40.0;

/// A plane through points, by least squares.
#[derive(Debug, Clone, Copy)]
pub(super) struct Fit {
    pub(super) normal: Vector3,
    pub(super) centroid: Point3,
    pub(super) covariance: Matrix3,
    pub(super) roughness: f64,
}

impl Fit {
    /// The plane that a single point and its normal say.
    pub(super) fn tangent(point: Point3, normal: Vector3) -> Self {
        Self { normal, centroid: point, covariance: Matrix3::zeros(), roughness: 0.0 }
    }

    /// The plane through `members`, of which there is one at least.
    pub(super) fn of(points: &[Point3], members: &[u32]) -> Self {
        let n = members.len() as f64;
        let first = points[members[0] as usize];
        let outs = || members.iter().map(|&i| points[i as usize] - first);
        let mean: Vector3 = outs().sum::<Vector3>() / n;
        let covariance: Matrix3 =
            outs().map(|out| (out - mean) * (out - mean).transpose()).sum::<Matrix3>() / n;
        let (least, normal) = least_direction(&covariance);
        Self { normal, centroid: first + mean, covariance, roughness: least.max(0.0).sqrt() }
    }

    /// How wide it is across its longer direction, root mean square.
    pub(super) fn width(&self) -> f64 {
        width(&self.covariance, &self.normal)
    }

    /// How far a point lies off, along the normal.
    pub(super) fn distance(&self, point: &Point3) -> f64 {
        self.normal.dot(&(point - self.centroid))
    }
}

/// The lesser of the two spreads along the plane with this normal.
pub(super) fn width(covariance: &Matrix3, normal: &Vector3) -> f64 {
    // Lifted along the normal, the least direction is the narrower one of the other two.
    let lifted = covariance + normal * normal.transpose() * covariance.trace();
    least_direction(&lifted).0.max(0.0).sqrt()
}

/// How high the waves of a surface are, root mean square, from the products of neighbours' heights:
/// noise has no sign in common with its neighbours', a wave has.
pub(super) fn wave(products: impl Iterator<Item = f64>) -> f64 {
    let (n, sum) = products.fold((0.0, 0.0), |(n, sum), product| (n + 1.0, sum + product));
    if n > 0.0 { f64::max(sum / n, 0.0).sqrt() } else { 0.0 }
}

/// How far normals turn with the place, root mean square [rad]: what a straight line through their tilts
/// says, and how much of that their noise does not explain.
pub(super) fn bend(fit: &Fit, points: &[Point3], normals: &[Vector3], members: &[u32]) -> [f64; 2] {
    let mut by_place = Matrix3::zeros();
    let (mut sum, mut squares) = (Vector3::zeros(), 0.0);
    for &i in members {
        let place = points[i as usize] - fit.centroid;
        let along = place - fit.normal * fit.normal.dot(&place);
        let cosine = normals[i as usize].dot(&fit.normal);
        let tilt = normals[i as usize] * cosine.signum() - fit.normal * cosine.abs();
        by_place += tilt * along.transpose();
        sum += tilt;
        squares += tilt.norm_squared();
    }
    let n = members.len() as f64;
    let flatten = Matrix3::identity() - fit.normal * fit.normal.transpose();
    let spread = flatten * fit.covariance * flatten;
    // Along the normal there is no spread, and across a strip there may be hardly any.
    let size = spread.trace().max(f64::MIN_POSITIVE);
    let lifted = spread + fit.normal * fit.normal.transpose() * size;
    let damped = lifted + Matrix3::from_diagonal_element(1e-9 * size);
    let Some(inverse) = damped.try_inverse() else { return [0.0; 2] };
    let slope = by_place / n * inverse;
    let turned = (slope * spread * slope.transpose()).trace().max(0.0);
    let rest = (squares / n - (sum / n).norm_squared() - turned).max(0.0);
    let by_noise = rest * (SHARED / n).min(1.0);
    [turned.sqrt(), (turned - by_noise).max(0.0).sqrt()]
}
