//! A disc in the plane of a row: the section of a wheel, or of a ball's lower half.
//!
//! A ray from the axis meets it at `p -+ sqrt(p^2 - k)`, with `p` the way along the ray to the place
//! nearest the disc's centre, `k = D^2 - A^2`, `A` its radius and `D` the distance of its centre.

use super::shave::{Borders, MARGIN, Rays, Section};
use fearless_simd::{f64x8, prelude::*};

/// A disc.
#[derive(Debug, Clone, Copy)]
pub(super) struct Disc {
    centre: [f64; 2],
    radius: f64,
    /// Of its centre from the axis.
    distance: f64,
    /// The square of where the rays that touch it end.
    k: f64,
}

impl Disc {
    #[inline(always)]
    pub(super) fn new(centre: [f64; 2], radius: f64) -> Self {
        let [y, z] = centre;
        let distance = (y * y + z * z).sqrt();
        Self { centre, radius, distance, k: (distance - radius) * (distance + radius) }
    }
}

impl Section for Disc {
    #[inline(always)]
    fn nearest(&self) -> Option<[f64; 2]> {
        let share = 1.0 - self.radius / self.distance;
        (self.k > 0.0).then_some([self.centre[0] * share, self.centre[1] * share])
    }

    #[inline(always)]
    fn meet<S: Simd>(&self, simd: S, rays: &Rays<S>, _: f64x8<S>) -> [f64x8<S>; 2] {
        let p = rays.cos * self.centre[0] + rays.sin * self.centre[1];
        let q = p * p - self.k;
        let root = q.max(0.0).sqrt();
        // One that holds the axis is entered where the ray begins.
        let (entry, exit) = ((p - root).max(0.0), p + root);
        let is_met = q.simd_ge(0.0) & exit.simd_gt(0.0);
        let outside = f64x8::splat(simd, f64::INFINITY);
        [is_met.select(entry, outside), is_met.select(exit, outside)]
    }

    /// On the rim of a disc the power of a point with respect to another disc is linear in the
    /// point. Over an arc of at most half a turn it exceeds the greater of its ends by no more than
    /// the arc's height times its slope, and an arc is no higher than its chord squared over `4 A`.
    #[inline(always)]
    fn is_within<S: Simd>(&self, last: &Self, borders: &Borders<S>, bounds: &[f64x8<S>; 2]) -> u64 {
        let [first, second] = &borders.rays;
        let [[y, z], [last_y, last_z]] = [self.centre, last.centre];
        let slope = [2.0 * (y - last_y), 2.0 * (z - last_z)];
        let a = [first.cos * bounds[0], first.sin * bounds[0]];
        let b = [second.cos * bounds[1], second.sin * bounds[1]];
        let power = (a[0] * slope[0] + a[1] * slope[1]).max(b[0] * slope[0] + b[1] * slope[1]);
        let (dy, dz) = (a[0] - b[0], a[1] - b[1]);
        let steepness = (slope[0] * slope[0] + slope[1] * slope[1]).sqrt();
        let bulge = (dy * dy + dz * dz) * (steepness / (4.0 * self.radius));
        // A border that passes the disc by makes this infinite or no number: not within.
        (power + bulge).simd_le(self.k - last.k - MARGIN).to_bitmask()
    }
}
