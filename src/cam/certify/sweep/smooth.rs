//! Does it pass by, or run smoothly?
//!
//! Within a share of the shadow `f'' >= -k`, and beyond, towards the rim, it is surely low. Then `f`
//! rises above its chord by no more than `k / 8`; and the chord's ends lie no higher than the exact
//! heights at the ends of the move, whatever the point is, or low, where it comes in or goes out.
//! `f'' = y'' + u_x x'' + u_z z'' + D2u[x', z']`, of which the first three follow from the point's
//! acceleration and the last is the tool's own bend ([`HeightFunction::sharpness`]).

use super::frame::{SLACK, Vectors, climb};
use super::{Limits, Sweep};
use crate::tool::{HeightFunction, Swept};
use fearless_simd::{f32x16, mask32x16, prelude::*};

/// Up to these shares of the tool's radius points may run smoothly, under a node.
pub(super) const SHARES_OVER_NODES: [f32; 2] = [0.995, 0.9];
/// The same on a primitive or a piece of one.
pub(super) const SHARES: [f32; 2] = [0.9999, 0.98];

/// Where sixteen things are in the middle of the move, and how they run.
pub(super) struct Course<S: Simd> {
    pub(super) x: f32x16<S>,
    pub(super) z: f32x16<S>,
    /// Of `x`, `z` and `half` [mm].
    pub(super) rounding: f32x16<S>,
    /// What they extend to either side [mm].
    pub(super) half: [f32x16<S>; 2],
    /// Nowhere on the move they are higher above the line.
    pub(super) top: f32x16<S>,
    /// Greatest speeds along x and z in the middle of the move.
    pub(super) speed: [f32x16<S>; 2],
    /// Greatest accelerations along each axis, anywhere on the move.
    pub(super) acceleration: Vectors<S>,
}

impl<H: HeightFunction, S: Simd, const N: usize> Sweep<'_, H, S, N> {
    /// Does it pass by or run smoothly?
    #[inline(always)]
    pub(super) fn is_harmless(
        &self,
        course: &Course<S>,
        limits: Limits,
        shares: [f32; 2],
    ) -> mask32x16<S> {
        let [along, _, across] = course.acceleration;
        let step_x = along.mul_add(0.5, course.speed[0]);
        let step_z = across.mul_add(0.5, course.speed[1]);
        let swept = Swept {
            x: course.x,
            z: course.z,
            half_x: step_x.mul_add(0.5, course.half[0] + course.rounding),
            half_z: step_z.mul_add(0.5, course.half[1] + course.rounding),
            step_x,
            step_z,
        };
        let [outer, inner] = shares;
        self.is_smooth(course, &swept, limits, inner)
            | self.is_smooth(course, &swept, limits, outer)
    }

    #[inline(always)]
    fn is_smooth(
        &self,
        course: &Course<S>,
        swept: &Swept<S>,
        limits: Limits,
        share: f32,
    ) -> mask32x16<S> {
        let sharpness = self.tool.sharpness(self.simd, swept, share);
        let slope = [sharpness.slope_x, sharpness.slope_z];
        let bend = (climb(slope, course.acceleration) + sharpness.bend) * SLACK;
        let is_low_beyond = (course.top + sharpness.beyond).simd_le(limits.deepest as f32);
        let is_smooth = bend.simd_le(limits.bend as f32) & (sharpness.is_within | is_low_beyond);
        sharpness.is_outside | is_smooth
    }
}

/// How much higher than in the middle of the move something can be elsewhere on it.
#[inline(always)]
pub(super) fn risen<S: Simd>(speed: f32x16<S>, acceleration: f32x16<S>) -> f32x16<S> {
    acceleration.mul_add(0.125, speed * 0.5)
}
