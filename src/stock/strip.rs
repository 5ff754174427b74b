//! Half a strip in the plane of a row: the section of a flat end mill, and what holds that of any
//! other mill. The tool is taken to go on for ever away from the part.

use super::layout::At;
use super::shave::{Blade, Borders, MARGIN, Rays, Section};
use fearless_simd::{f64x8, prelude::*};

/// What lies `half` or less beside the line `across` along the attack direction, `from` there
/// onwards.
#[derive(Debug, Clone, Copy)]
pub(super) struct Strip {
    /// The attack direction.
    attack: [f64; 2],
    pub(super) across: f64,
    pub(super) half: f64,
    pub(super) from: f64,
}

/// A flat end mill.
#[derive(Debug, Clone, Copy)]
pub(super) struct Flat {
    pub(super) radius: f64,
}

impl Blade for Flat {
    type Section = Strip;

    #[inline(always)]
    fn half_width(&self) -> f64 {
        self.radius
    }

    #[inline(always)]
    fn section(&self, at: &At, dx: f64) -> Strip {
        Strip::above(at, (self.radius * self.radius - dx * dx).max(0.0).sqrt(), 0.0)
    }
}

impl Strip {
    /// About a tool `at` a place: `half` to either side, from `rise` over its programmed point.
    #[inline(always)]
    pub(super) fn above(at: &At, half: f64, rise: f64) -> Self {
        let [along, across] = at.along_and_across();
        Self { attack: at.attack, across, half, from: along + rise }
    }

    /// The point of the plane that lies so far along the attack direction, and across.
    #[inline(always)]
    pub(super) fn point(&self, along: f64, across: f64) -> [f64; 2] {
        let [cos, sin] = self.attack;
        [along * cos - across * sin, along * sin + across * cos]
    }

    /// Rays as the attack direction sees them: how they go along it, and across.
    #[inline(always)]
    pub(super) fn seen<S: Simd>(&self, rays: &Rays<S>) -> Rays<S> {
        let [cos, sin] = self.attack;
        Rays { cos: rays.cos * cos + rays.sin * sin, sin: rays.sin * cos - rays.cos * sin }
    }
}

impl Section for Strip {
    #[inline(always)]
    fn nearest(&self) -> Option<[f64; 2]> {
        let across = 0_f64.clamp(self.across - self.half, self.across + self.half);
        let along = self.from.max(0.0);
        (across != 0.0 || along > 0.0).then(|| self.point(along, across))
    }

    #[inline(always)]
    fn meet<S: Simd>(&self, simd: S, rays: &Rays<S>, _: f64x8<S>) -> [f64x8<S>; 2] {
        let splat = |value: f64| f64x8::splat(simd, value);
        let Rays { cos, sin } = self.seen(rays);
        // A ray along the strip: so nearly so that the sides are out of its way.
        let sin = sin.simd_eq(0.0).select(splat(f64::MIN_POSITIVE), sin);
        let cos = cos.simd_eq(0.0).select(splat(f64::MIN_POSITIVE), cos);
        let sides = [splat(self.across - self.half) / sin, splat(self.across + self.half) / sin];
        let end = splat(self.from) / cos;
        let is_outward = cos.simd_gt(0.0);
        let mut entry = sides[0].min(sides[1]).max(0.0);
        let mut exit = sides[0].max(sides[1]);
        entry = is_outward.select(entry.max(end), entry);
        exit = is_outward.select(exit, exit.min(end));
        let outside = splat(f64::INFINITY);
        let is_met = entry.simd_le(exit);
        [is_met.select(entry, outside), is_met.select(exit, outside)]
    }

    /// Where both borders enter by the end, or by the same side, all between them does, on a
    /// straight line; and a line with both ends in a convex region lies in it.
    #[inline(always)]
    fn is_within<S: Simd>(&self, last: &Self, borders: &Borders<S>, bounds: &[f64x8<S>; 2]) -> u64 {
        let place = |strip: &Self, side: usize| {
            let seen = strip.seen(&borders.rays[side]);
            [seen.cos * bounds[side], seen.sin * bounds[side]]
        };
        let holds = |side: usize| {
            let [along, across] = place(last, side);
            along.simd_ge(last.from - MARGIN) & (across - last.across).abs().simd_le(last.half)
        };
        let [a, b] = [place(self, 0), place(self, 1)];
        let by_end = a[0].max(b[0]).simd_le(self.from + MARGIN);
        let by_left = a[1].max(b[1]).simd_le(self.across - self.half + MARGIN);
        let by_right = a[1].min(b[1]).simd_ge(self.across + self.half - MARGIN);
        (holds(0) & holds(1) & (by_end | by_left | by_right)).to_bitmask()
    }
}
