//! Which motions the pairs let pass.

use crate::geom::Point3;
use crate::register::icp::{FreeMotion, free_motions};
use nalgebra::{Matrix6, SymmetricEigen, Vector3, Vector6};

/// A motion that a pair opposes by less than this on average is free: the limit of `icp`.
const FREE: f64 = 2e-3;

/// Sums over pairs from which it is told how they hold the six small motions.
#[derive(Debug, Clone, Copy)]
pub(super) struct Held {
    /// Of the products of both normals' rows, turn [rad] before shift, about the camera.
    pub(super) information: Matrix6<f64>,
    /// Of the places.
    pub(super) place: Vector3<f64>,
    /// Of their squares.
    pub(super) square: f64,
    pub(super) n: f64,
}

impl Held {
    /// A pair at `place`, with the normal that each side gives it.
    ///
    /// One normal times itself is never 0: the noise of a bare wall would seem to hold what slides along it. The
    /// noise of both is not the same, and in their product it cancels out.
    pub(super) fn add(&mut self, place: &Vector3<f64>, normals: [&Vector3<f64>; 2]) {
        let [a, b] = normals.map(|normal| {
            let turn = place.cross(normal);
            Vector6::new(turn.x, turn.y, turn.z, normal.x, normal.y, normal.z)
        });
        let product = a * b.transpose();
        self.information += (product + product.transpose()) / 2.0;
        self.place += place;
        self.square += place.norm_squared();
        self.n += 1.0;
    }

    /// The motions that are free.
    pub(super) fn free(&self) -> Vec<FreeMotion> {
        if self.n == 0.0 {
            return Vec::new();
        }
        let pivot = self.place / self.n;
        let lever = (self.square / self.n - pivot.norm_squared()).max(0.0).sqrt();
        let lever = lever.max(f64::MIN_POSITIVE);
        // (p - c) x n = p x n - c x n: the rows about the pivot, turns per lever.
        let mut to_pivot = Matrix6::identity() / lever;
        to_pivot.fixed_view_mut::<3, 3>(0, 3).copy_from(&(-pivot.cross_matrix() / lever));
        to_pivot.fixed_view_mut::<3, 3>(3, 3).copy_from(&nalgebra::Matrix3::identity());
        let about_pivot = to_pivot * (self.information / self.n) * to_pivot.transpose();
        let eigen = SymmetricEigen::new(about_pivot);
        let free: Vec<Vector6<f64>> = (0..6)
            .filter(|&k| eigen.eigenvalues[k] < FREE)
            .map(|k| eigen.eigenvectors.column(k).into())
            .collect();
        free_motions(&free, lever, &Point3::from(pivot))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};

    /// Pairs at places with normals.
    fn held(pairs: impl Iterator<Item = ([f64; 3], [f64; 3])>) -> Held {
        let mut held =
            Held { information: Matrix6::zeros(), place: Vector3::zeros(), square: 0.0, n: 0.0 };
        for (place, normal) in pairs {
            let normal = Vector3::from(normal);
            held.add(&Vector3::from(place), [&normal, &normal]);
        }
        held
    }

    #[test]
    fn a_wall_slides_and_turns_and_a_corner_holds() {
        let spots = || (0..400).map(|i| [f64::from(i % 20) - 9.5, f64::from(i / 20) - 9.5]);
        let wall = || spots().map(|[x, y]| ([50.0 * x, 50.0 * y, 1000.0], [0.0, 0.0, -1.0]));
        let free: Vec<String> = held(wall()).free().iter().map(ToString::to_string).collect();
        assert_eq!(free, ["sliding along x", "sliding along y", "turning about z"]);
        let floor = spots().map(|[x, z]| ([50.0 * x, 500.0, 1000.0 + 50.0 * z], [0.0, -1.0, 0.0]));
        let free: Vec<String> =
            held(wall().chain(floor)).free().iter().map(ToString::to_string).collect();
        assert_eq!(free, ["sliding along x"]);
        let side = spots().map(|[y, z]| ([500.0, 50.0 * y, 1000.0 + 50.0 * z], [-1.0, 0.0, 0.0]));
        let floor = spots().map(|[x, z]| ([50.0 * x, 500.0, 1000.0 + 50.0 * z], [0.0, -1.0, 0.0]));
        assert!(held(wall().chain(floor).chain(side)).free().is_empty());
    }

    #[test]
    fn noise_does_not_hold_a_wall() {
        let mut held =
            Held { information: Matrix6::zeros(), place: Vector3::zeros(), square: 0.0, n: 0.0 };
        let mut draws = rand_pcg::Pcg64Mcg::seed_from_u64(3);
        for i in 0..4000 {
            let place = Vector3::new(f64::from(i % 80) * 12.0, f64::from(i / 80) * 12.0, 1500.0);
            let mut noisy = || {
                let [x, y] = [0, 1].map(|_| draws.random_range(-0.3..0.3));
                Vector3::new(x, y, -1.0).normalize()
            };
            held.add(&place, [&noisy(), &noisy()]);
        }
        let free: Vec<String> = held.free().iter().map(ToString::to_string).collect();
        assert_eq!(free, ["sliding along x", "sliding along y", "turning about z"]);
    }
}
