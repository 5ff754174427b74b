//! Any other end mill at work on a turned part.
//!
//! Along a ray from the spindle axis a convex tool is entered once. With `s` the way along the ray,
//! `b` its angle from the attack direction and (ta, tw) the tool's tip along and across it,
//! `g(s) = s cos b - ta + u(dx, s sin b - tw)` is concave and not negative inside the tool, which is
//! taken to go on for ever away from the part.

use super::layout::At;
use super::shave::{Blade, Borders, Rays, Section};
use super::strip::Strip;
use crate::tool::{HeightFunction, Mill};
use fearless_simd::{f64x8, prelude::*};

/// The entry is found to within this [mm].
const CLOSE: f64 = 1e-7;
/// More halvings than this cannot be needed.
const MOST_HALVINGS: usize = 80;

/// What a row meets of a mill.
#[derive(Debug, Clone, Copy)]
pub(super) struct MillSection {
    mill: Mill,
    /// The row, beside the mill's axis.
    dx: f64,
    /// Of the programmed point, along the attack direction.
    along: f64,
    /// All of it lies in here.
    strip: Strip,
}

impl Blade for Mill {
    type Section = MillSection;

    #[inline(always)]
    fn half_width(&self) -> f64 {
        self.reach().x
    }

    #[inline(always)]
    fn section(&self, at: &At, dx: f64) -> MillSection {
        let radius = self.half_width();
        let dx = dx.clamp(-radius, radius);
        let half = (radius * radius - dx * dx).max(0.0).sqrt();
        let highest = self.height(dx, 0.0).unwrap_or(0.0);
        let [along, _] = at.along_and_across();
        MillSection { mill: *self, dx, along, strip: Strip::above(at, half, -highest) }
    }
}

impl Section for MillSection {
    #[inline(always)]
    fn nearest(&self) -> Option<[f64; 2]> {
        let on_axis = self.mill.height(self.dx, -self.strip.across);
        if on_axis.is_some_and(|u| u >= self.along) {
            return None;
        }
        Some(self.strip.nearest().unwrap_or([0.0; 2]))
    }

    #[inline(always)]
    fn bound<S: Simd>(&self, simd: S, rays: &Rays<S>) -> f64x8<S> {
        self.strip.bound(simd, rays)
    }

    #[inline(always)]
    fn meet<S: Simd>(&self, simd: S, rays: &Rays<S>, ends: f64x8<S>) -> [f64x8<S>; 2] {
        let Rays { cos, sin } = self.strip.seen(rays);
        let may_be_met = self.bound(simd, rays).simd_lt(ends).to_bitmask();
        let mut met = [f64x8::splat(simd, f64::INFINITY); 2];
        for lane in (0..cos.as_slice().len()).filter(|lane| may_be_met >> lane & 1 == 1) {
            if let Some([entry, exit]) = self.enter([cos[lane], sin[lane]], ends[lane]) {
                (met[0][lane], met[1][lane]) = (entry, exit);
            }
        }
        met
    }

    // Between two borders its rim may be of any shape.
    #[inline(always)]
    fn is_within<S: Simd>(&self, _: &Self, _: &Borders<S>, _: &[f64x8<S>; 2]) -> u64 {
        0
    }
}

impl MillSection {
    /// Where a ray enters the tool and where it leaves it, if it enters before `limit`; that it
    /// leaves is only looked into up to there.
    #[inline(never)]
    fn enter(&self, [cos, sin]: [f64; 2], limit: f64) -> Option<[f64; 2]> {
        let Strip { across, half, .. } = self.strip;
        let [from, side] = if sin == 0.0 {
            (across.abs() <= half).then_some([0.0, f64::INFINITY])?
        } else {
            let (a, b) = ((across - half) / sin, (across + half) / sin);
            [a.min(b).max(0.0), a.max(b)]
        };
        let g = |s: f64| {
            let jet = self.mill.along(self.dx, s * sin - across, 0.0, sin);
            [s * cos - self.along + jet.value, cos + jet.slope]
        };
        let end = side.min(limit);
        let [entry, exit] = positive_stretch(g, [from, end])?;
        (entry < limit).then_some([entry, if exit == end { side } else { exit }])
    }
}

/// Where a concave function is not negative between `from` and `end`: from the first such place to
/// the last. `g` gives its value and its slope.
#[inline(always)]
pub(super) fn positive_stretch(
    g: impl Fn(f64) -> [f64; 2],
    [from, end]: [f64; 2],
) -> Option<[f64; 2]> {
    if end <= from {
        return None;
    }
    let is_inside = |s: f64| g(s)[0] >= 0.0;
    let ends_inside = is_inside(end);
    let entry = if is_inside(from) {
        from
    } else {
        // `low` stays outside, before the way in. `high` is inside once `found`; until then it is a
        // place at or behind which there is no way in any more.
        let (mut low, mut high, mut found) = (from, end, ends_inside);
        for _ in 0..MOST_HALVINGS {
            if high - low < CLOSE {
                break;
            }
            let middle = f64::midpoint(low, high);
            let [value, slope] = g(middle);
            if value >= 0.0 {
                (high, found) = (middle, true);
            } else if slope > 0.0 {
                // A tangent lies over a concave function: the way in is not before its root.
                low = middle - value / slope;
            } else if found {
                low = middle;
            } else {
                high = middle;
            }
        }
        found.then_some(high)?
    };
    if ends_inside {
        return Some([entry, end]);
    }
    let (mut inside, mut outside) = (entry, end);
    while outside - inside > CLOSE {
        let middle = f64::midpoint(inside, outside);
        *(if is_inside(middle) { &mut inside } else { &mut outside }) = middle;
    }
    Some([entry, outside])
}
