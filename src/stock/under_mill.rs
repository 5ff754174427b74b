//! An end mill at work on a turned part.
//!
//! Along a ray from the spindle axis a convex tool is entered once. With `s` the way along the ray,
//! `b` its angle from the attack direction and (ta, tw) the tool's tip along and across it,
//! `g(s) = s cos b - ta + u(dx, s sin b - tw)` is concave and not negative inside the tool, which is
//! taken to go on for ever away from the part.

use super::layout::At;
use super::row::{Columns, Cut, Row};
use super::stripe::{Bite, Stripe, Turn};
use crate::tool::{HeightFunction, Mill};
use fearless_simd::Simd;

/// The entry is found to within this [mm].
const CLOSE: f64 = 1e-7;
/// More halvings than this cannot be needed.
const MOST_HALVINGS: usize = 80;

/// A mill at one place.
#[derive(Debug, Clone, Copy)]
pub(super) struct MillBite {
    mill: Mill,
    radius: f64,
    x: f64,
    /// Of the tip from the axis, along and across the attack direction.
    along: f64,
    across: f64,
    /// The attack direction's angle about X.
    attack: f64,
    i_sweep: u32,
    engagement: u32,
}

impl MillBite {
    pub(super) fn new(mill: Mill, at: &At, i_sweep: u32, engagement: u32) -> Self {
        let (sin, cos) = at.attack.sin_cos();
        Self {
            mill,
            radius: mill.reach().x,
            x: at.point.x,
            along: at.point.y * cos + at.point.z * sin,
            across: at.point.z * cos - at.point.y * sin,
            attack: at.attack,
            i_sweep,
            engagement,
        }
    }

    /// The rays that may meet the tool below `peak`, where it is `half` wide to either side and
    /// begins `lowest` from the axis.
    fn columns(&self, row: &Row, half: f64, lowest: f64, peak: f64) -> Columns {
        if lowest <= 0.0 {
            return Columns::around(row.layout, 0.0, std::f64::consts::PI);
        }
        let widest = (peak * peak - lowest * lowest).max(0.0).sqrt();
        // The angle to a place beside the attack line is widest where it is lowest, unless it lies
        // on the other side of the line, where it is so at the peak.
        let angle = |across: f64, outward: f64| {
            let across = across.clamp(-widest, widest);
            let along = if across * outward > 0.0 {
                lowest
            } else {
                (peak * peak - across * across).max(lowest * lowest).sqrt()
            };
            self.attack + across.atan2(along)
        };
        Columns::between(
            row.layout,
            angle(self.across - half, -1.0),
            angle(self.across + half, 1.0),
        )
    }

    /// Where the ray enters the tool, and where it leaves it through the side, if it enters before
    /// `limit`.
    fn enter(&self, dx: f64, half: f64, turn: [f64; 2], limit: f64) -> Option<[f64; 2]> {
        let [cos, sin] = turn;
        let [from, exit] = if sin == 0.0 {
            (self.across.abs() <= half).then_some([0.0, f64::INFINITY])?
        } else {
            let (a, b) = ((self.across - half) / sin, (self.across + half) / sin);
            [a.min(b).max(0.0), a.max(b)]
        };
        let inside =
            |s: f64| self.mill.height(dx, s * sin - self.across).map(|u| s * cos - self.along + u);
        let (mut low, mut high) = (from, exit.min(limit));
        if high <= low {
            return None;
        }
        if inside(low).is_some_and(|g| g >= 0.0) {
            return Some([low, exit]);
        }
        // `low` stays outside, before the tool. `high` is inside once `found`; until then it is a
        // place at or behind which the tool is not entered any more.
        let mut found = inside(high).is_some_and(|g| g >= 0.0);
        for _ in 0..MOST_HALVINGS {
            if high - low < CLOSE {
                break;
            }
            let middle = f64::midpoint(low, high);
            let jet = self.mill.along(dx, middle * sin - self.across, 0.0, sin);
            let (g, slope) = (middle * cos - self.along + jet.value, cos + jet.slope);
            if g >= 0.0 {
                (high, found) = (middle, true);
            } else if slope > 0.0 {
                // A tangent lies over a concave function: the way in is not before its root.
                low = middle - g / slope;
            } else if found {
                low = middle;
            } else {
                high = middle;
            }
        }
        (found && high < limit).then_some([high, exit])
    }

    /// Cuts one row.
    fn bite_row(&self, row: &mut Row, cut: &mut Cut) {
        let dx = row.x - self.x;
        let half = (self.radius * self.radius - dx * dx).max(0.0).sqrt();
        let Some(height) = self.mill.height(dx, 0.0) else { return };
        let lowest = self.along - height;
        if row.highest <= lowest {
            return;
        }
        let on_axis = self.mill.height(dx, -self.across).is_some_and(|u| u >= self.along);
        if on_axis {
            row.clear(self.engagement, cut);
            return;
        }
        let wide = self.columns(row, half, lowest, row.highest);
        let peak = row.peak(&wide);
        if peak <= lowest {
            return;
        }
        let columns = self.columns(row, half, lowest, peak);
        row.engage(self.engagement);
        let before = cut.removed;
        for column in columns.0.iter().flat_map(Clone::clone) {
            let (sin, cos) = (column as f64 * row.layout.across[1] - self.attack).sin_cos();
            let end = row.ends[column];
            match self.enter(dx, half, [cos, sin], end) {
                Some([_, exit]) if exit < end => cut.n_overhangs += 1,
                Some([entry, _]) => row.lower(column, entry, cut),
                None => {}
            }
        }
        if cut.removed > before {
            row.renew_peaks(&columns);
        }
    }
}

impl Bite for MillBite {
    fn reach(&self) -> [f64; 2] {
        [self.x - self.radius, self.x + self.radius]
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
