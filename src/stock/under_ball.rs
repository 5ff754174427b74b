//! A ball end mill at work on a turned part: in each row a disc below its centre, and the strip that
//! the shank sweeps above it.

use super::disc::Disc;
use super::layout::At;
use super::shave::{Blade, Borders, Rays, Section, joined};
use super::strip::Strip;
use fearless_simd::{f64x8, prelude::*};

/// A ball end mill, and how far over its programmed point the ball's centre is.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ball {
    pub(super) radius: f64,
    pub(super) centre: f64,
}

/// A disc, and all above its diameter.
#[derive(Debug, Clone, Copy)]
pub(super) struct BallSection {
    disc: Disc,
    shank: Strip,
}

impl Blade for Ball {
    type Section = BallSection;

    #[inline(always)]
    fn half_width(&self) -> f64 {
        self.radius
    }

    #[inline(always)]
    fn section(&self, at: &At, dx: f64) -> BallSection {
        let half = (self.radius * self.radius - dx * dx).max(0.0).sqrt();
        let shank = Strip::above(at, half, self.centre);
        BallSection { disc: Disc::new(shank.point(shank.from, shank.across), half), shank }
    }
}

impl Section for BallSection {
    #[inline(always)]
    fn nearest(&self) -> Option<[f64; 2]> {
        if self.shank.from > 0.0 { self.disc.nearest() } else { self.shank.nearest() }
    }

    #[inline(always)]
    fn meet<S: Simd>(&self, simd: S, rays: &Rays<S>, ends: f64x8<S>) -> [f64x8<S>; 2] {
        joined(simd, [self.disc.meet(simd, rays, ends), self.shank.meet(simd, rays, ends)])
    }

    /// Where both borders enter below the ball's centre, all between them does.
    #[inline(always)]
    fn is_within<S: Simd>(&self, last: &Self, borders: &Borders<S>, bounds: &[f64x8<S>; 2]) -> u64 {
        let along = |side: usize| self.shank.seen(&borders.rays[side]).cos * bounds[side];
        let is_below = along(0).simd_le(self.shank.from) & along(1).simd_le(self.shank.from);
        is_below.to_bitmask() & self.disc.is_within(&last.disc, borders, bounds)
    }
}
