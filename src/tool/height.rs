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

    /// The sharp edge at which the shadow ends, if it ends at one: there planes of any slope from
    /// some on lie above the tool.
    fn rim(&self) -> Option<Rim> {
        None
    }

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

/// A sharp edge around the attack axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rim {
    /// Of the edge, which is a circle [mm].
    pub radius: f64,
    /// `u` on it [mm].
    pub height: f64,
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
mod tests;
