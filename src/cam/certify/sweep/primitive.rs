//! Which primitives of a leaf, and which pieces of a triangle, may do harm.

use super::frame::{Run, Vectors, climb, load};
use super::plane::Plane;
use super::smooth::{Course, SHARES, risen};
use super::{Limits, Sweep};
use crate::geom::{Lanes, Leaf};
use crate::tool::{HeightFunction, Rim};
use fearless_simd::{f32x16, prelude::*};

/// Planes touch nearly at the rim, where steep walls are met.
const SHARE: f32 = 0.999;
/// What is steeper lies under no plane that is worth a try.
const STEEPEST: f32 = 30.0;
/// Keeps a quotient from being nothing by nothing.
const TINY: f32 = 1e-30;

impl<H: HeightFunction, S: Simd, const N: usize> Sweep<'_, H, S, N> {
    /// No primitive holds the tool higher above the line than its lane; and, as bits, those that may
    /// do harm.
    #[inline(always)]
    pub(super) fn harmful_primitives(&self, leaf: &Leaf<N>, limits: Limits) -> (Lanes, u64) {
        let zero = f32x16::splat(self.simd, 0.0);
        let mut corners = [[[zero; 3]; 3]; N];
        for (corner, of_leaf) in corners.iter_mut().zip(&leaf.corners) {
            let point = load(self.simd, of_leaf);
            *corner = [self.place.of(point), self.velocity.of(point), self.acceleration.of(point)];
        }
        self.harmful(&corners, self.rounding, limits)
    }

    /// The same for pieces.
    #[inline(always)]
    pub(super) fn harmful_pieces(
        &self,
        pieces: &[Run<f32x16<S>>; N],
        limits: Limits,
    ) -> (Lanes, u64) {
        let mut farthest = f32x16::splat(self.simd, 0.0);
        for [[x, y, z], ..] in pieces {
            farthest = farthest.max(x.abs()).max(y.abs()).max(z.abs());
        }
        let rounding = farthest.mul_add(16.0 * f32::EPSILON, self.fine_rounding);
        self.harmful(pieces, rounding, limits)
    }

    #[inline(always)]
    fn harmful(
        &self,
        corners: &[Run<f32x16<S>>; N],
        rounding: f32x16<S>,
        limits: Limits,
    ) -> (Lanes, u64) {
        let zero = f32x16::splat(self.simd, 0.0);
        let mut middle = [[zero; 3]; 2];
        let mut speed = [self.rounding_of_velocity; 3];
        let mut acceleration = [self.jerk; 3];
        let mut top = f32x16::splat(self.simd, f32::NEG_INFINITY);
        for axis in 0..3 {
            let (mut fastest, mut most) = (zero, zero);
            for [place, velocity, turn] in corners {
                middle[0][axis] += place[axis] * (1.0 / N as f32);
                middle[1][axis] += velocity[axis] * (1.0 / N as f32);
                fastest = fastest.max(velocity[axis].abs());
                most = most.max(turn[axis].abs());
            }
            speed[axis] += fastest;
            acceleration[axis] += most;
        }
        let [[x, _, z], _] = middle;
        let mut half = [zero; 2];
        for [[corner_x, y, corner_z], ..] in corners {
            top = top.max(*y);
            half = [half[0].max((*corner_x - x).abs()), half[1].max((*corner_z - z).abs())];
        }
        let top = top + risen(speed[1], acceleration[1]) + rounding;
        let speed = [speed[0], speed[2]];
        let course = Course { x, z, rounding, half, top, speed, acceleration };
        let is_harmful = !self.is_harmless(&course, limits, SHARES);
        let above_all = top + self.tool.reach().top as f32;
        // Each plane is tried only if the ones before have left something.
        let slope = if N == 1 {
            self.plane_over(middle[0], middle[1], SHARE).slope
        } else {
            facet_slope(self.simd, corners)
        };
        let height = self.highest_corner(slope, corners, rounding);
        let height = height.min(above_all);
        let left = is_harmful & height.simd_gt(limits.gouge as f32);
        if N == 1 || left.to_bitmask() == 0 {
            return (*height, left.to_bitmask());
        }
        let first = self.plane_over(middle[0], middle[1], SHARE);
        let height = height.min(self.highest_corner(first.slope, corners, rounding));
        let left = left & height.simd_gt(limits.gouge as f32);
        if left.to_bitmask() == 0 {
            return (*height, 0);
        }
        let [contact, there] = self.likely_contact(&first, &middle, corners);
        let second = self.plane_over(contact, there, SHARE);
        let height = height.min(self.highest_corner(second.slope, corners, rounding));
        let left = left & height.simd_gt(limits.gouge as f32);
        let Some(rim) = self.tool.rim().filter(|_| left.to_bitmask() != 0) else {
            return (*height, left.to_bitmask());
        };
        let over_rim = rim_slope(rim, &middle[0], corners, limits.gouge as f32);
        let height = height.min(self.highest_corner(over_rim, corners, rounding));
        (*height, (left & height.simd_gt(limits.gouge as f32)).to_bitmask())
    }

    /// Where on the sides of triangles the bent plane is highest, and how fast it moves there. A guess:
    /// wherever it is, the plane that touches there is a bound.
    #[inline(always)]
    fn likely_contact(
        &self,
        plane: &Plane<S>,
        [middle, velocity]: &[Vectors<S>; 2],
        corners: &[Run<f32x16<S>>; N],
    ) -> [Vectors<S>; 2] {
        let across = self.across(*velocity);
        let mut highest = f32x16::splat(self.simd, f32::NEG_INFINITY);
        let mut contact = [*middle, *velocity];
        for i in 0..N {
            let ([from, from_velocity, _], [to, to_velocity, _]) =
                (corners[i], corners[(i + 1) % N]);
            let side = [to[0] - from[0], to[1] - from[1], to[2] - from[2]];
            let out = [from[0] - middle[0], from[1] - middle[1], from[2] - middle[2]];
            let (bend, bent) = (across.of(side), across.of(out));
            let rise = climb(plane.slope, side) - bend * bent;
            let bend = bend * bend;
            let far = (rise / bend.max(TINY)).max(0.0).min(1.0);
            let start = climb(plane.slope, out) - bent * bent * 0.5;
            let height = (rise - bend * far * 0.5).mul_add(far, start);
            let is_higher = height.simd_gt(highest);
            highest = highest.max(height);
            for axis in 0..3 {
                let place = far.mul_add(side[axis], from[axis]);
                let turned = to_velocity[axis] - from_velocity[axis];
                let moves = far.mul_add(turned, from_velocity[axis]);
                contact[0][axis] = is_higher.select(place, contact[0][axis]);
                contact[1][axis] = is_higher.select(moves, contact[1][axis]);
            }
        }
        contact
    }
}

/// The slope of planes over the rim that lets no corner come higher than `allowed` at either end of
/// the move, if there is one.
///
/// Over the rim lie planes of any slope outwards. The steeper, the higher they stand over what lies
/// inside, and the lower over what lies outside: each corner bounds the slope from one side.
#[inline(always)]
fn rim_slope<S: Simd, const N: usize>(
    rim: Rim,
    [x, _, z]: &Vectors<S>,
    corners: &[Run<f32x16<S>>; N],
    allowed: f32,
) -> [f32x16<S>; 2] {
    let per_rho = (*x * *x + *z * *z).sqrt().max(TINY);
    let (out_x, out_z) = (*x / per_rho, *z / per_rho);
    let (radius, height) = (rim.radius as f32, rim.height as f32 - allowed);
    let mut least = *x * 0.0;
    let mut most = least + STEEPEST;
    for [place, velocity, acceleration] in corners {
        for time in [-0.5, 0.5] {
            let at = |axis: usize| {
                let turned = acceleration[axis].mul_add(0.5 * time, velocity[axis]);
                turned.mul_add(time, place[axis])
            };
            let inside = -(at(0).mul_add(out_x, at(2) * out_z)) + radius;
            let is_inside = inside.simd_gt(0.0);
            // On the rim itself any slope, but a number, is as good.
            let inside = is_inside.select(inside.max(TINY), inside.min(-TINY));
            let slope = -(at(1) + height) / inside;
            most = is_inside.select(most.min(slope), most);
            least = is_inside.select(least, least.max(slope));
        }
    }
    // Halfway, but not much steeper than need be: roundings count per unit of slope.
    let least = least.min(STEEPEST);
    let steepness = (least + most.min(least + 1.0)) * 0.5;
    let steepness = steepness.max(0.0);
    [-steepness * out_x, -steepness * out_z]
}

/// The slope of the planes that triangles lie level under in the middle of the move: one that touches
/// the tool bounds it exactly where it touches inside the triangle. 0 for the steepest.
#[inline(always)]
fn facet_slope<S: Simd, const N: usize>(simd: S, corners: &[Run<f32x16<S>>; N]) -> [f32x16<S>; 2] {
    let [[ax, ay, az], ..] = corners[0];
    let [[bx, by, bz], ..] = corners[1 % N];
    let [[cx, cy, cz], ..] = corners[2 % N];
    let [ux, uy, uz] = [bx - ax, by - ay, bz - az];
    let [vx, vy, vz] = [cx - ax, cy - ay, cz - az];
    let (normal_x, normal_z) = (uy * vz - uz * vy, ux * vy - uy * vx);
    let normal_y = uz * vx - ux * vz;
    let sideways = normal_x.abs() + normal_z.abs();
    let is_tame = sideways.simd_lt(normal_y.abs() * STEEPEST);
    let zero = f32x16::splat(simd, 0.0);
    [is_tame.select(normal_x / normal_y, zero), is_tame.select(normal_z / normal_y, zero)]
}
