//! Which children of a node may hold something that does harm.

use super::frame::{climb, load};
use super::plane::highest_on_move;
use super::smooth::{Course, SHARES_OVER_NODES, risen};
use super::{Limits, Sweep};
use crate::geom::Node;
use crate::tool::HeightFunction;
use fearless_simd::{f32x16, prelude::*};

/// Planes over nodes touch no farther out than this share of the tool's radius.
const SHARE: f32 = 0.9;

impl<H: HeightFunction, S: Simd, const N: usize> Sweep<'_, H, S, N> {
    /// As bits, the children under which something may do harm.
    #[inline(always)]
    pub(super) fn harmful_children(&self, node: &Node, limits: Limits) -> u64 {
        let center = load(self.simd, &node.center);
        let radius = f32x16::from_slice(self.simd, &node.radius);
        let place = self.place.of(center);
        let [x, y, z] = place;
        let [a, b, c] = &node.sides;
        let a = self.place.turned(load(self.simd, a));
        let b = self.place.turned(load(self.simd, b));
        let c = self.place.turned(load(self.simd, c));
        let velocity = self.velocity.of(center);
        let spread = self.velocity.spread(radius, self.rounding_of_velocity);
        let turn = self.acceleration.of(center);
        let turn_spread = self.acceleration.spread(radius, self.jerk);
        let mut acceleration = turn_spread;
        for axis in 0..3 {
            acceleration[axis] += turn[axis].abs();
        }
        let top_speed = velocity[1].abs() + spread[1];
        let top = y
            + a[1].abs()
            + b[1].abs()
            + c[1].abs()
            + risen(top_speed, acceleration[1])
            + self.rounding;
        let course = Course {
            x,
            z,
            rounding: self.rounding,
            half: [a[0].abs() + b[0].abs() + c[0].abs(), a[2].abs() + b[2].abs() + c[2].abs()],
            top,
            speed: [velocity[0].abs() + spread[0], velocity[2].abs() + spread[2]],
            acceleration,
        };
        let is_empty = radius.simd_lt(0.0);
        let is_harmful = !(is_empty | self.is_harmless(&course, limits, SHARES_OVER_NODES));
        if is_harmful.to_bitmask() == 0 {
            return 0;
        }

        let plane = self.plane_over(place, velocity, SHARE);
        let across = self.across(velocity);
        let zero = f32x16::splat(self.simd, 0.0);
        let out = across.of([x - plane.foot[0], zero, z - plane.foot[1]]);
        let (bend_a, bend_b, bend_c) = (across.of(a), across.of(b), across.of(c));
        // Ways are neither straight nor the same all over the box: how far across the middle's they lead.
        let aside_x = risen(spread[0], acceleration[0]);
        let aside_z = risen(spread[2], acceleration[2]);
        let aside = across.0[0].abs().mul_add(aside_z, across.0[1].abs() * aside_x);
        let farthest = out.abs() + bend_a.abs() + bend_b.abs() + bend_c.abs();
        // The long sides share what mixes them, which may leave one bending upwards. The thin side
        // only climbs; what mixes it with the others is charged in full.
        let mixed = (bend_a * bend_b).abs();
        let rise_a = (climb(plane.slope, a) - out * bend_a).abs();
        let rise_b = (climb(plane.slope, b) - out * bend_b).abs();
        let rise_c = (climb(plane.slope, c) - out * bend_c).abs();
        let mixed_c = bend_c.abs() * (bend_a.abs() + bend_b.abs());
        let over = highest_rise(rise_a, bend_a * bend_a - mixed)
            + highest_rise(rise_b, bend_b * bend_b - mixed)
            + rise_c
            + mixed_c
            + aside * farthest
            - out * out * 0.5;
        let steep = [plane.slope[0].abs(), plane.slope[1].abs()];
        let rate = climb(plane.slope, velocity).abs() + climb(steep, spread);
        let turn = climb(plane.slope, turn) + climb(steep, turn_spread);
        let bent = out.abs() * (across.0[0].abs() + across.0[1].abs());
        let height = y + plane.value + over + highest_on_move(rate, turn);
        let height = (steep[0] + steep[1] + bent + 1.0).mul_add(self.rounding, height);
        (is_harmful & !height.simd_le(limits.gouge as f32)).to_bitmask()
    }
}

/// At least the greatest value of `climb s - bend s^2 / 2` on `0 <= s <= 1`: the chords of the square
/// that it is where it bends down, which spare a division; else the value at 1.
#[inline(always)]
fn highest_rise<S: Simd>(climb: f32x16<S>, bend: f32x16<S>) -> f32x16<S> {
    let first = climb * 0.125;
    let second = climb.mul_add(0.375, bend * -0.0625);
    let third = climb.mul_add(0.625, bend * -0.1875);
    let fourth = climb.mul_add(0.875, bend * -0.375);
    let at_one = bend.mul_add(-0.5, climb);
    first.max(second).max(third).max(fourth).max(at_one)
}
