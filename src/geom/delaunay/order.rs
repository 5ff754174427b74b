//! In which order points are inserted: near ones after another, so that the next one is found at once, but
//! first a few from everywhere, so that no order of the input is a bad one.

use crate::geom::{Aabb, Point3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// Bits of a place along one axis.
const BITS: u32 = 20;

/// The points that `is_wanted`, in rounds of half of what is left, each along a curve through all cells.
pub(super) fn insertion_order(points: &[Point3], is_wanted: impl Fn(u32) -> bool) -> Vec<u32> {
    let aabb = Aabb::around(points);
    let side = aabb.size().max().max(f64::MIN_POSITIVE);
    let cell = |x: f64, low: f64| ((x - low) / side * f64::from((1_u32 << BITS) - 1)) as u64;
    let mut random = Pcg64Mcg::seed_from_u64(1);
    let mut keyed: Vec<(u32, u64, u32)> = (0..)
        .zip(points)
        .filter(|&(i, _)| is_wanted(i))
        .map(|(i, p)| {
            // The last round holds half of the points, that before a quarter, and so on.
            let round = 64 - random.random::<u64>().leading_zeros();
            let at = [0, 1, 2].map(|k| spread(cell(p[k], aabb.min[k])));
            (round, at[0] << 2 | at[1] << 1 | at[2], i)
        })
        .collect();
    keyed.sort_unstable();
    keyed.into_iter().map(|(_, _, i)| i).collect()
}

/// The bits of `x`, each followed by two empty ones.
fn spread(x: u64) -> u64 {
    (0..BITS).fold(0, |all, bit| all | (x >> bit & 1) << (3 * bit))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_wanted_point_comes_once() {
        let points: Vec<_> = (0..1000).map(|i| Point3::new(f64::from(i), 0.0, 1.0)).collect();
        let mut order = insertion_order(&points, |i| i % 3 == 0);
        order.sort_unstable();
        assert_eq!(order, (0..1000).step_by(3).collect::<Vec<_>>());
        assert!(insertion_order(&[], |_| true).is_empty());
    }

    #[test]
    fn bits_are_spread() {
        assert_eq!(spread(0b1011), 0b1_000_001_001);
    }
}
