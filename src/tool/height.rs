//! A convex tool seen along the attack axis: its height function and what digitizing asks of it.
//!
//! Everything is in the attack frame with the programmed point at the origin: y along the attack
//! axis away from the part, x and z across. The tool touches a part point `(x, y, z)` when its
//! programmed point stands at `y + u(x, z)`; `u` is concave on the tool's *shadow*, a convex region
//! of the x-z plane, because the tool is convex (ARCHITECTURE section 4).

use crate::geom::Vector3;
use fearless_simd::{Simd, f32x16, mask32x16};

/// Tangent planes touch arcs no farther out than this share of their radius, unless told otherwise:
/// the slope stays finite.
const TANGENT_SHARE: f32 = 0.9;

/// The height function `u` of a convex tool.
pub trait HeightFunction: Sync {
    /// `u(x, z)`; `None` outside the shadow.
    fn height(&self, x: f64, z: f64) -> Option<f64>;

    /// `u` and its first two derivatives in `s` along `(x + s dx, z + s dz)` at `s = 0`, inside the
    /// shadow. Slopes may be infinite on the rim.
    fn along(&self, x: f64, z: f64, dx: f64, dz: f64) -> Jet;

    /// The part `[s0, s1]` of `0 <= s <= 1` for which `(x + s dx, z + s dz)` lies in the shadow.
    fn clip(&self, x: f64, z: f64, dx: f64, dz: f64) -> Option<[f64; 2]>;

    /// Where the tool's body touches a plane of unit normal `normal` (`normal.y > 0`) it comes down
    /// on: contact minus programmed point. Where a whole line or disc touches, the named rule of
    /// the tool picks one point.
    fn support(&self, normal: &Vector3) -> Vector3;

    /// The part's unit normal at a contact at `(x, z)`: the inward normal of the tool there.
    fn normal_at(&self, x: f64, z: f64) -> Vector3;

    /// Planes above `u` everywhere, touching it at points of the shadow near `(x, z)`: sixteen
    /// at once, for the bounds of the search tree.
    #[inline(always)]
    fn tangent<S: Simd>(&self, simd: S, x: f32x16<S>, z: f32x16<S>) -> Tangent<S> {
        self.tangent_within(simd, x, z, TANGENT_SHARE)
    }

    /// The same, touching arcs no farther out than this share of their radius.
    fn tangent_within<S: Simd>(
        &self,
        simd: S,
        x: f32x16<S>,
        z: f32x16<S>,
        share: f32,
    ) -> Tangent<S>;

    /// How high above the origin the lowest planes above `u` of these slopes stand: the greatest
    /// `u - slope_x x - slope_z z`. It is finite for any slope, on the rim too.
    fn lowest_plane<S: Simd>(&self, simd: S, slope_x: f32x16<S>, slope_z: f32x16<S>) -> f32x16<S>;

    /// How steep and how bent `u` is at most over those parts of sixteen rectangles that lie within
    /// `share` of the shadow's arcs.
    fn sharpness<S: Simd>(&self, simd: S, swept: &Swept<S>, share: f32) -> Sharpness<S>;

    /// Lanes whose disc of `radius` about `(x, z)` lies wholly outside the shadow.
    fn passes_by<S: Simd>(
        &self,
        simd: S,
        x: f32x16<S>,
        z: f32x16<S>,
        radius: f32x16<S>,
    ) -> mask32x16<S>;

    /// The greatest `[kx, kz]` known for which `u + kx x^2 / 2 + kz z^2 / 2` is still concave.
    fn least_bend(&self) -> [f64; 2];

    /// Half the width of the shadow along x and along z, and the greatest height [mm].
    fn reach(&self) -> Reach;
}

/// A value with its first and second derivative.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jet {
    /// The value [mm].
    pub value: f64,
    /// The first derivative.
    pub slope: f64,
    /// The second derivative, never positive for a concave function.
    pub bend: f64,
}

/// How far a tool reaches from its programmed point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reach {
    /// Half the width of the shadow along x [mm].
    pub x: f64,
    /// Half the width of the shadow along z [mm].
    pub z: f64,
    /// The greatest height `u(0, 0)` [mm].
    pub top: f64,
}

/// Sixteen planes `u = value + slope_x (x - x0) + slope_z (z - z0)`.
#[derive(Debug, Clone, Copy)]
pub struct Tangent<S: Simd> {
    /// Where the planes touch the height function, along x [mm].
    pub x0: f32x16<S>,
    /// Where the planes touch the height function, along z [mm].
    pub z0: f32x16<S>,
    /// The height there [mm].
    pub value: f32x16<S>,
    /// The slope along x.
    pub slope_x: f32x16<S>,
    /// The slope along z.
    pub slope_z: f32x16<S>,
}

/// Sixteen rectangles across the attack axis, and how far what lies in them moves.
#[derive(Debug, Clone, Copy)]
pub struct Swept<S: Simd> {
    /// The middle, along x [mm].
    pub x: f32x16<S>,
    /// The middle, along z [mm].
    pub z: f32x16<S>,
    /// Half the side along x [mm].
    pub half_x: f32x16<S>,
    /// Half the side along z [mm].
    pub half_z: f32x16<S>,
    /// The greatest motion along x, either way [mm].
    pub step_x: f32x16<S>,
    /// The greatest motion along z, either way [mm].
    pub step_z: f32x16<S>,
}

/// Where rectangles lie, and what holds for `u` over those parts of them that lie within a share of
/// the shadow's arcs.
#[derive(Debug, Clone, Copy)]
pub struct Sharpness<S: Simd> {
    /// At least `|u_x|`.
    pub slope_x: f32x16<S>,
    /// At least `|u_z|`.
    pub slope_z: f32x16<S>,
    /// At least minus the second derivative of `u` along any motion [mm].
    pub bend: f32x16<S>,
    /// Lanes that lie wholly outside the shadow.
    pub is_outside: mask32x16<S>,
    /// Lanes that lie within the share as a whole.
    pub is_within: mask32x16<S>,
    /// At least `u` on its border and everywhere beyond [mm].
    pub beyond: f32,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tool::{Cutter, Profile};
    use fearless_simd::{Level, dispatch, prelude::*};
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    /// Rounding of `f32` in a product of several factors.
    const SLACK: f64 = 1.0 + 1e-4;

    /// Every kind of tool, with and without an allowance.
    fn tools() -> impl Iterator<Item = Cutter> {
        let (radius, half_angle) = (6.0, 0.3);
        let profiles = [
            Profile::Wheel { major_radius: 60.0, minor_radius: 10.0 },
            Profile::Ball { radius },
            Profile::Flat { radius },
            Profile::Bull { radius, corner_radius: 1.5 },
            Profile::Cone { radius, half_angle },
            Profile::BallCone { radius, tip_radius: 2.0, half_angle },
        ];
        let of = |profile: Profile| [0.0, 0.7].map(|allowance| profile.cutter(allowance));
        profiles.into_iter().flat_map(of)
    }

    #[test]
    fn no_place_of_a_rectangle_is_steeper_or_more_bent_than_its_sharpness() {
        for tool in tools() {
            match tool {
                Cutter::Wheel(tool) => check_sharpness(&tool),
                Cutter::Mill(tool) => check_sharpness(&tool),
            }
        }
    }

    #[test]
    fn the_lowest_plane_of_a_slope_touches_the_tool_and_lies_above_all_of_it() {
        for tool in tools() {
            match tool {
                Cutter::Wheel(tool) => check_lowest_plane(&tool),
                Cutter::Mill(tool) => check_lowest_plane(&tool),
            }
        }
    }

    /// Against the best of many places of the shadow, its rim among them.
    fn check_lowest_plane(tool: &impl HeightFunction) {
        let mut random = Pcg64Mcg::seed_from_u64(3);
        let reach = tool.reach();
        for _ in 0..200 {
            let slope = [0; 2].map(|_| random.random_range(-3.0..3.0_f64));
            let value = dispatch!(Level::new(), simd => {
                let [x, z] = slope.map(|slope| f32x16::splat(simd, slope as f32));
                f64::from(tool.lowest_plane(simd, x, z).as_slice()[0])
            });
            let mut highest = f64::NEG_INFINITY;
            for i in 0..=100 {
                for k in 0..=100 {
                    let at = |reach: f64, i: i32| reach * (f64::from(i) / 50.0 - 1.0);
                    // Towards the rim ever closer, where heights change most.
                    let (x, z) = (at(1.0, i), at(1.0, k));
                    let closer = |share: f64| (1.0 - (1.0 - share.abs()).powi(2)).copysign(share);
                    let (x, z) = (reach.x * closer(x), reach.z * closer(z));
                    if let Some(height) = tool.height(x, z) {
                        highest = highest.max(height - slope[0] * x - slope[1] * z);
                    }
                }
            }
            assert!(highest <= value + 1e-4, "{highest} above {value} at {slope:?}");
            assert!(value <= highest + 0.02 * (reach.x + reach.z), "{value}, {highest}, {slope:?}");
        }
    }

    fn check_sharpness(tool: &impl HeightFunction) {
        let mut random = Pcg64Mcg::seed_from_u64(99);
        let reach = tool.reach();
        let mut n_within = 0;
        for _ in 0..2_000 {
            let share = [0.9, 0.995][random.random_range(0..2)];
            let [x, z] = [reach.x, reach.z].map(|reach| reach * random.random_range(-1.2..1.2));
            let [half_x, half_z] = [0; 2].map(|_| reach.x * random.random_range(0.0..0.3));
            let step = [0; 2].map(|_| random.random_range(-1.0..1.0_f64));
            let (whole, _) = sharpness(tool, [x, z, half_x, half_z], step, share);
            for _ in 0..10 {
                let [x, z] = [
                    x + half_x * random.random_range(-1.0..1.0),
                    z + half_z * random.random_range(-1.0..1.0),
                ];
                let Some(height) = tool.height(x, z) else { continue };
                let (_, is_here_within) = sharpness(tool, [x, z, 0.0, 0.0], step, share);
                assert!(!whole.is_outside, "{x}, {z} is in the shadow");
                if !is_here_within {
                    assert!(height <= whole.beyond + 1e-5, "{height} beyond at {x}, {z}");
                    continue;
                }
                n_within += 1;
                let bend = -tool.along(x, z, step[0], step[1]).bend;
                assert!(bend <= whole.bend * SLACK + 1e-9, "{bend} above {whole:?} at {x}, {z}");
                let slopes =
                    [[1.0, 0.0], [0.0, 1.0]].map(|[dx, dz]| tool.along(x, z, dx, dz).slope);
                assert!(slopes[0].abs() <= whole.slope[0] * SLACK + 1e-6, "{slopes:?}, {whole:?}");
                assert!(slopes[1].abs() <= whole.slope[1] * SLACK + 1e-6, "{slopes:?}, {whole:?}");
            }
        }
        assert!(n_within > 3_000, "{n_within}");
    }

    #[derive(Debug)]
    struct Plain {
        slope: [f64; 2],
        bend: f64,
        is_outside: bool,
        beyond: f64,
    }

    /// That of one rectangle, and whether it lies within the share.
    fn sharpness(
        tool: &impl HeightFunction,
        rectangle: [f64; 4],
        step: [f64; 2],
        share: f32,
    ) -> (Plain, bool) {
        dispatch!(Level::new(), simd => {
            let splat = |value: f64| f32x16::splat(simd, value as f32);
            let [x, z, half_x, half_z] = rectangle.map(splat);
            // What the middle loses in rounding the half-sides must hold.
            let rounding = splat(1e-5);
            let (half_x, half_z) = (half_x + rounding, half_z + rounding);
            let [step_x, step_z] = step.map(|step| splat(step.abs()));
            let swept = Swept { x, z, half_x, half_z, step_x, step_z };
            let sharpness = tool.sharpness(simd, &swept, share);
            let first = |lanes: f32x16<_>| f64::from(lanes.as_slice()[0]);
            let plain = Plain {
                slope: [first(sharpness.slope_x), first(sharpness.slope_z)],
                bend: first(sharpness.bend),
                is_outside: sharpness.is_outside.to_bitmask() & 1 == 1,
                beyond: sharpness.beyond.into(),
            };
            (plain, sharpness.is_within.to_bitmask() & 1 == 1)
        })
    }
}
