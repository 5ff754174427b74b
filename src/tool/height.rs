//! A convex tool seen along the attack axis: its height function and what digitizing asks of it.
//!
//! Everything is in the attack frame with the programmed point at the origin: y along the attack
//! axis away from the part, x and z across. The tool touches a part point `(x, y, z)` when its
//! programmed point stands at `y + u(x, z)`; `u` is concave on the tool's *shadow*, a convex region
//! of the x-z plane, because the tool is convex (ARCHITECTURE section 4).

use crate::geom::Vector3;
use fearless_simd::{Simd, f32x16, mask32x16};

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
    fn tangent<S: Simd>(&self, simd: S, x: f32x16<S>, z: f32x16<S>) -> Tangent<S>;

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
