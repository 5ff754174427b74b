//! Any tool at work on a table: rays along the attack axis.
//!
//! While the tool goes straight from one place to another, its height over a ray,
//! `T_y(s) - u(p - T(s))`, is a convex function of the way `s`: the tool is convex, so `u` is
//! concave. What a whole move leaves is its minimum, found exactly: nothing is sampled. For a ball
//! or a flat end it has a closed form; for others that of a flat end around them says which rays
//! are worth a search.

use super::layout::At;
use super::row::{Columns, Cut, Row};
use super::stripe::{Bite, Stripe, Turn};
use super::trace::{End, Trace};
use crate::geom::{Point3, Vector3};
use crate::tool::HeightFunction;
use fearless_simd::{f64x8, prelude::*};

/// Rays taken side by side.
const LANES: usize = 8;
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
    trace: Trace,
    /// The trace is that of the tool, not of an end around it.
    is_exact: bool,
    from: Point3,
    way: Vector3,
    i_sweep: u32,
    engagement: u32,
}

impl<H: HeightFunction> TableBite<H> {
    /// On its way between two places. A tool that is nothing but `end` is known by that.
    pub(super) fn new(
        (tool, end): (H, Option<End>),
        [from, to]: [At; 2],
        i_sweep: u32,
        engagement: u32,
    ) -> Self {
        let (from, way) = (from.point, to.point - from.point);
        let reach = tool.reach();
        let around = End::Flat { radius: reach.x.hypot(reach.z), rise: -reach.top };
        let trace = Trace::new(end.unwrap_or(around), &from, &way);
        Self { tool, trace, is_exact: end.is_some(), from, way, i_sweep, engagement }
    }

    /// The lowest the tool comes over the ray at (x, z), if that is below `limit`.
    #[inline(never)]
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
    #[inline(always)]
    fn bite_row<S: Simd>(&self, simd: S, row: &mut Row, cut: &mut Cut) {
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
        let before = cut.removed;
        let lanes: [f64; LANES] = std::array::from_fn(|lane| step * lane as f64);
        let lanes = f64x8::from_slice(simd, &lanes);
        for start in columns.0[0].clone().step_by(LANES) {
            let z = lanes + (first + step * start as f64);
            let traced = self.trace.lowest(simd, row.x, z);
            let n_lanes = (columns.0[0].end - start).min(LANES);
            for lane in 0..n_lanes {
                let end = row.ends[start + lane];
                if traced[lane] < end
                    && let Some(lowest) = self.exact(row.x, z[lane], traced[lane], end)
                {
                    row.engage(self.engagement);
                    cut.is_through |= lowest < row.layout.floor - BELOW;
                    row.lower(start + lane, lowest.max(row.layout.floor), cut);
                }
            }
        }
        if cut.removed > before {
            row.renew_peaks(&columns);
        }
    }

    /// The lowest over a ray that ends at `end`, above its trace, if that is lower.
    #[inline(always)]
    fn exact(&self, x: f64, z: f64, traced: f64, end: f64) -> Option<f64> {
        if self.is_exact { Some(traced) } else { self.lowest(x, z, end) }
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
    fn bite<S: Simd>(&self, simd: S, turn: Turn<Self>, stripe: &mut Stripe, cut: &mut Cut) {
        for i in turn.rows {
            self.bite_row(simd, &mut stripe.row(i), cut);
        }
    }
}
