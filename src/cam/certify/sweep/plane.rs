//! Planes above the tool, chosen for a whole move.
//!
//! A plane of slope `s` that touches `u` from above gives `f(t) <= y + s . (x, z) + c(s)` for the
//! point `p = (x, y, z)(t)`, whatever `s` is ([`HeightFunction::lowest_plane`] is `c`). What matters
//! is that one plane serves the whole move: touching where `p` is highest under the tool *on its way*,
//! it neither climbs nor falls along the way, and the bound is tight however long the move. For a
//! point that shifts by `v`, the greatest `f` is the height function of the tool swept along `-v`,
//! which is convex too, and the plane is tangent to that.

use super::Sweep;
use super::frame::{Run, Vectors, climb};
use crate::tool::HeightFunction;
use fearless_simd::{f32x16, mask32x16, prelude::*};

/// Tangents tried between the ends of a move, before the last two are mixed.
const N_SECANTS: usize = 1;
/// Keeps a quotient from being nothing by nothing.
const TINY: f32 = 1e-30;
/// A bend that is charged for is rounded down by more than its own rounding.
const LESS: f32 = 1.0 - 1e-5;

/// Sixteen planes above the height function.
#[derive(Clone, Copy)]
pub(super) struct Plane<S: Simd> {
    pub(super) slope: [f32x16<S>; 2],
    /// Over the place in the middle of the move [mm].
    pub(super) value: f32x16<S>,
    /// Where it touches, or the mean of where two touch that it is mixed of, along x and z [mm].
    pub(super) foot: [f32x16<S>; 2],
    /// How fast the place climbs under it [mm per move].
    rate: f32x16<S>,
    /// When on the move it touches over the place.
    time: f32x16<S>,
}

/// How the tool bends across sixteen moves: any plane above it may be bent down by half the square
/// of [`Across::of`], counted from the plane's foot.
pub(super) struct Across<S: Simd>(pub(super) [f32x16<S>; 2]);

impl<H: HeightFunction, S: Simd, const N: usize> Sweep<'_, H, S, N> {
    /// The plane that touches where a place is highest under the tool on its way.
    ///
    /// `f` is concave on a straight way: a secant of its slope's zero comes down from both sides, and
    /// of the tangents next to the zero that mean is taken that neither climbs nor falls.
    #[inline(always)]
    pub(super) fn plane_over(
        &self,
        place: Vectors<S>,
        velocity: Vectors<S>,
        share: f32,
    ) -> Plane<S> {
        let half = f32x16::splat(self.simd, 0.5);
        let mut before = self.touching(place, velocity, -half, share);
        let mut after = self.touching(place, velocity, half, share);
        for _ in 0..N_SECANTS {
            let time = mixed(before.level_with(&after), before.time, after.time);
            let between = self.touching(place, velocity, time, share);
            let climbs = between.rate.simd_gt(0.0);
            before = between.select(&before, climbs);
            after = after.select(&between, climbs);
        }
        before.mixed(&after)
    }

    /// The tangent plane over where a place is at `time`.
    #[inline(always)]
    fn touching(
        &self,
        [x, _, z]: Vectors<S>,
        velocity: Vectors<S>,
        time: f32x16<S>,
        share: f32,
    ) -> Plane<S> {
        let (then_x, then_z) = (time.mul_add(velocity[0], x), time.mul_add(velocity[2], z));
        let plane = self.tool.tangent_within(self.simd, then_x, then_z, share);
        let slope = [plane.slope_x, plane.slope_z];
        let risen = slope[0].mul_add(x - plane.x0, slope[1] * (z - plane.z0));
        Plane {
            slope,
            value: plane.value + risen,
            foot: [plane.x0, plane.z0],
            rate: climb(slope, velocity),
            time,
        }
    }

    /// Any plane above the tool may be bent down by `Q(d) / 2`, `Q` being the tool's least bend and
    /// `d` counted from the foot. On a way along `v` the least that is left of it, wherever on the way,
    /// is `min Q(d - s v) = kx kz (v x d)^2 / Q(v)`.
    #[inline(always)]
    pub(super) fn across(&self, velocity: Vectors<S>) -> Across<S> {
        let [kx, kz] = self.tool.least_bend();
        let (kx, kz) = (kx as f32, kz as f32);
        let [along_x, _, along_z] = velocity;
        let form = (along_x * along_x).mul_add(kx, along_z * along_z * kz);
        let share = f32x16::splat(self.simd, kx * kz * LESS) / (form + TINY);
        let share = share.sqrt();
        Across([along_x * share, along_z * share])
    }

    /// The highest that `corners` come under the plane of this slope, on the whole move.
    ///
    /// At any time the highest of a triangle under a plane is a corner; so it is on the whole move.
    #[inline(always)]
    pub(super) fn highest_corner(
        &self,
        slope: [f32x16<S>; 2],
        corners: &[Run<f32x16<S>>; N],
        rounding: f32x16<S>,
    ) -> f32x16<S> {
        let mut highest = f32x16::splat(self.simd, f32::NEG_INFINITY);
        for [place, velocity, acceleration] in *corners {
            let rate = climb(slope, velocity).abs();
            let turn = climb(slope, acceleration);
            highest = highest.max(climb(slope, place) + highest_on_move(rate, turn));
        }
        let steepness = slope[0].abs() + slope[1].abs() + 1.0;
        let value = self.tool.lowest_plane(self.simd, slope[0], slope[1]);
        steepness.mul_add(rounding + self.drift, highest + value)
    }
}

impl<S: Simd> Across<S> {
    #[inline(always)]
    pub(super) fn of(&self, way: Vectors<S>) -> f32x16<S> {
        self.0[0] * way[2] - self.0[1] * way[0]
    }
}

impl<S: Simd> Plane<S> {
    /// What share of `other` leaves of both a plane that neither climbs nor falls; all or nothing of
    /// it if both do the same.
    #[inline(always)]
    fn level_with(&self, other: &Self) -> f32x16<S> {
        (self.rate / (self.rate - other.rate).max(TINY)).max(0.0).min(1.0)
    }

    /// A mean of planes above the tool is one.
    #[inline(always)]
    fn mixed(&self, other: &Self) -> Self {
        let share = self.level_with(other);
        Self {
            slope: [
                mixed(share, self.slope[0], other.slope[0]),
                mixed(share, self.slope[1], other.slope[1]),
            ],
            value: mixed(share, self.value, other.value),
            foot: [
                mixed(share, self.foot[0], other.foot[0]),
                mixed(share, self.foot[1], other.foot[1]),
            ],
            rate: mixed(share, self.rate, other.rate),
            time: mixed(share, self.time, other.time),
        }
    }

    /// This where `mask` is set, else `other`.
    #[inline(always)]
    fn select(&self, other: &Self, mask: mask32x16<S>) -> Self {
        Self {
            slope: [
                mask.select(self.slope[0], other.slope[0]),
                mask.select(self.slope[1], other.slope[1]),
            ],
            value: mask.select(self.value, other.value),
            foot: [
                mask.select(self.foot[0], other.foot[0]),
                mask.select(self.foot[1], other.foot[1]),
            ],
            rate: mask.select(self.rate, other.rate),
            time: mask.select(self.time, other.time),
        }
    }
}

#[inline(always)]
fn mixed<S: Simd>(share: f32x16<S>, one: f32x16<S>, other: f32x16<S>) -> f32x16<S> {
    share.mul_add(other - one, one)
}

/// The greatest `rate t + turn t^2 / 2` on the move, `|t| <= 1/2`, for `rate >= 0`: at its end, or
/// before it where the way bends down.
#[inline(always)]
pub(super) fn highest_on_move<S: Simd>(rate: f32x16<S>, turn: f32x16<S>) -> f32x16<S> {
    let time = (rate / (-turn).max(TINY)).min(0.5);
    let inside = (turn * time).mul_add(0.5, rate) * time;
    inside.max(turn.mul_add(0.125, rate * 0.5))
}

#[cfg(test)]
mod tests {
    use super::*;
    use fearless_simd::{Level, dispatch};

    #[test]
    fn the_highest_of_a_parabola_on_a_move_is_that_of_its_samples() {
        for rate in [0.0, 0.1, 1.0, 3.0_f32] {
            for turn in [-8.0, -2.0, -0.1, 0.0, 0.1, 4.0_f32] {
                let highest = dispatch!(Level::new(), simd => {
                    let [rate, turn] = [rate, turn].map(|value| f32x16::splat(simd, value));
                    highest_on_move(rate, turn).as_slice()[0]
                });
                let at = |i: i16| {
                    let time = f32::from(i) / 1000.0;
                    (turn * time).mul_add(0.5, rate) * time
                };
                let sampled = (-500..=500).map(at).fold(f32::NEG_INFINITY, f32::max);
                assert!((highest - sampled).abs() < 1e-5, "{highest}, {sampled}: {rate}, {turn}");
            }
        }
    }
}
