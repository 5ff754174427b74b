//! Any tool at work on a table: rays along the attack axis.
//!
//! While the tool goes straight from one place to another, its height over a ray,
//! `T_y(s) - u(p - T(s))`, is a convex function of the way `s`: the tool is convex, so `u` is
//! concave. What a whole move leaves is its minimum, found exactly: nothing is sampled.

use super::layout::At;
use super::row::{Columns, Cut, Row};
use super::stripe::{Bite, Stripe, Turn};
use crate::geom::{Point3, Vector3};
use crate::tool::HeightFunction;
use fearless_simd::Simd;

/// The minimum is found to within this [mm].
const CLOSE: f64 = 1e-7;
/// More halvings than this cannot be needed.
const MOST_HALVINGS: usize = 60;
/// Deeper than this below the block is no rounding [mm].
const BELOW: f64 = 0.01;

/// A tool on its way from one place to another.
#[derive(Debug, Clone, Copy)]
pub(super) struct TableBite<H> {
    tool: H,
    from: Point3,
    way: Vector3,
    i_sweep: u32,
    engagement: u32,
}

impl<H: HeightFunction> TableBite<H> {
    pub(super) fn new(tool: H, [from, to]: [At; 2], i_sweep: u32, engagement: u32) -> Self {
        Self { tool, from: from.point, way: to.point - from.point, i_sweep, engagement }
    }

    /// The lowest the tool comes over the ray at (x, z), if that is below `limit`.
    fn lowest(&self, x: f64, z: f64, limit: f64) -> Option<f64> {
        let (x, z) = (x - self.from.x, z - self.from.z);
        let (dx, dz) = (-self.way.x, -self.way.z);
        let [mut low, mut high] = self.tool.clip(x, z, dx, dz)?;
        let at = |s: f64| {
            let jet = self.tool.along(x + s * dx, z + s * dz, dx, dz);
            [self.from.y + s * self.way.y - jet.value, self.way.y - jet.slope]
        };
        let middle = f64::midpoint(low, high);
        let [value, slope] = at(middle);
        // A tangent lies below a convex function.
        if value - slope.abs() * (high - low) / 2.0 >= limit {
            return None;
        }
        let [at_low, slope_low] = at(low);
        let [at_high, slope_high] = at(high);
        let mut best = at_low.min(at_high).min(value);
        // On the rim a slope may be no number: then look inside all the same.
        let is_inside = !(slope_low >= 0.0 || slope_high <= 0.0);
        if is_inside {
            let (mut place, mut slope) = (middle, slope);
            for _ in 0..MOST_HALVINGS {
                if slope.abs() * (high - low) < CLOSE {
                    break;
                }
                if slope > 0.0 {
                    high = place;
                } else {
                    low = place;
                }
                place = f64::midpoint(low, high);
                let [value, next] = at(place);
                best = best.min(value);
                slope = next;
            }
        }
        (best < limit).then_some(best)
    }

    /// Cuts one row.
    fn bite_row(&self, row: &mut Row, cut: &mut Cut) {
        let reach = self.tool.reach();
        let lowest = self.from.y + self.way.y.min(0.0) - reach.top;
        if row.highest <= lowest {
            return;
        }
        let [first, step] = row.layout.across;
        let end = self.from.z + self.way.z;
        let column = |z: f64| ((z - first) / step).clamp(-1.0, row.layout.n_columns as f64);
        let start = column(self.from.z.min(end) - reach.z).ceil().max(0.0) as usize;
        let stop = (column(self.from.z.max(end) + reach.z).floor() + 1.0) as usize;
        let columns = Columns([start..stop.min(row.layout.n_columns), 0..0]);
        if row.peak(&columns) <= lowest {
            return;
        }
        row.engage(self.engagement);
        let before = cut.removed;
        for column in columns.0[0].clone() {
            let z = first + step * column as f64;
            if let Some(lowest) = self.lowest(row.x, z, row.ends[column]) {
                cut.is_through |= lowest < row.layout.floor - BELOW;
                row.lower(column, lowest.max(row.layout.floor), cut);
            }
        }
        if cut.removed > before {
            row.renew_peaks(&columns);
        }
    }
}

impl<H: HeightFunction> Bite for TableBite<H> {
    fn reach(&self) -> [f64; 2] {
        let (reach, end) = (self.tool.reach().x, self.from.x + self.way.x);
        [self.from.x.min(end) - reach, self.from.x.max(end) + reach]
    }

    fn i_sweep(&self) -> u32 {
        self.i_sweep
    }

    #[inline(always)]
    fn bite<S: Simd>(&self, _simd: S, turn: Turn<Self>, stripe: &mut Stripe, cut: &mut Cut) {
        for i in turn.rows {
            self.bite_row(&mut stripe.row(i), cut);
        }
    }
}
