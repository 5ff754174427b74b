//! How high the children of a tree node could hold the tool: a bound for eight at once.
//!
//! The height function is concave, and so it stays with a certain paraboloid taken away
//! ([`HeightFunction::least_bend`]): any tangent plane of it, bent down by that paraboloid, lies
//! above all of it. Touching over the centre of an oriented box the bound is tight there to second
//! order in the box's size, where a half-space or a level box is not. Its greatest value over the
//! box is bounded side by side. Computed in `f32` and rounded up by a proved margin.

use super::view::View;
use crate::geom::{Lanes, Node, PatchTree, Vector3};
use crate::tool::HeightFunction;
use fearless_simd::{f32x8, prelude::*};

/// Keeps a quotient from being nothing by nothing; far below any margin [mm].
const TINY: f32 = 1e-30;
/// Roundings of `f32` that meet in one bound, each of at most the terms' greatest size.
const ROUNDINGS: f32 = 16.0;

/// The tool over the part at one position, ready to bound any node of its tree.
pub(super) struct Bounds<'a, H, S: Simd> {
    simd: S,
    tool: &'a H,
    /// Distances are taken from this point of the tree's frame, best near the contact: what lies
    /// close to it is rounded least.
    foot: [f32x8<S>; 3],
    /// The foot in the attack frame.
    seen: [f32x8<S>; 3],
    rotation: [[f32x8<S>; 3]; 3],
    bend: [f32x8<S>; 2],
    /// Rounding of what does not depend on the node [mm].
    margin: f32,
}

impl<'a, H: HeightFunction, S: Simd> Bounds<'a, H, S> {
    /// `near` is best the contact expected, in the attack frame.
    #[inline(always)]
    pub(super) fn new(simd: S, tool: &'a H, view: &View, tree: &PatchTree, near: &Vector3) -> Self {
        let splat = |value: f64| f32x8::splat(simd, value as f32);
        let foot = view.part_point(near) - tree.origin;
        // A foot that `f32` can hold needs no margin of its own.
        let foot = foot.map(|coordinate| f64::from(coordinate as f32));
        let seen = view.see(&(tree.origin + foot));
        let reach = tool.reach();
        let largest = seen.amax() + reach.top.abs() + reach.x + reach.z;
        Self {
            simd,
            tool,
            foot: [0, 1, 2].map(|k| splat(foot[k])),
            seen: [0, 1, 2].map(|k| splat(seen[k])),
            rotation: [0, 1, 2].map(|i| [0, 1, 2].map(|j| splat(view.rotation[(i, j)]))),
            bend: tool.least_bend().map(splat),
            margin: ROUNDINGS / 2.0 * f32::EPSILON * largest as f32,
        }
    }

    /// No primitive under a child holds the tool higher than its lane; minus infinity where the
    /// tool passes the child by.
    #[inline(always)]
    pub(super) fn of(&self, node: &Node) -> Lanes {
        let radius = f32x8::simd_from(self.simd, node.radius);
        let [away_x, away_y, away_z] = self.load(&node.center);
        let away = [away_x - self.foot[0], away_y - self.foot[1], away_z - self.foot[2]];
        let distance = away[0].abs() + away[1].abs() + away[2].abs() + radius;
        let rounding = distance * (ROUNDINGS * f32::EPSILON) + self.margin;
        let [x, y, z] = self.turned(away);
        let (x, y, z) = (x + self.seen[0], y + self.seen[1], z + self.seen[2]);
        let plane = self.tool.tangent(self.simd, x, z);
        // The paraboloid touches at the tangent point; developed at the box centre.
        let [bend_x, bend_z] = self.bend;
        let (out_x, out_z) = (x - plane.x0, z - plane.z0);
        let slope_x = plane.slope_x - bend_x * out_x;
        let slope_z = plane.slope_z - bend_z * out_z;
        let at_center = y
            + plane.value
            + (plane.slope_x + slope_x) * out_x * 0.5
            + (plane.slope_z + slope_z) * out_z * 0.5;
        let a = self.turned(self.load(&node.sides[0]));
        let b = self.turned(self.load(&node.sides[1]));
        let c = self.turned(self.load(&node.sides[2]));
        // What mixes two sides is charged to both, which may leave a side bending upwards.
        let (ab, bc, ca) = (self.bend(a, b).abs(), self.bend(b, c).abs(), self.bend(c, a).abs());
        let reach = self.rise([slope_x, slope_z], a, ab + ca)
            + self.rise([slope_x, slope_z], b, ab + bc)
            + self.rise([slope_x, slope_z], c, bc + ca);
        let steepness = slope_x.abs() + slope_z.abs() + plane.slope_x.abs() + plane.slope_z.abs();
        let bound = at_center + reach + (steepness + 1.0) * rounding;
        let outside = self.tool.passes_by(self.simd, x, z, radius + rounding);
        *outside.select(f32x8::splat(self.simd, f32::NEG_INFINITY), bound)
    }

    /// How much the paraboloid rises at most along `side`, either way.
    #[inline(always)]
    fn rise(&self, slope: [f32x8<S>; 2], side: [f32x8<S>; 3], mixed: f32x8<S>) -> f32x8<S> {
        let climb = (slope[0] * side[0] + side[1] + slope[1] * side[2]).abs() + TINY;
        let bend = self.bend(side, side) - mixed;
        let far = (climb / bend.max(TINY)).min(1.0);
        far * (climb - bend * far * 0.5)
    }

    /// The paraboloid's quadratic form.
    #[inline(always)]
    fn bend(&self, p: [f32x8<S>; 3], q: [f32x8<S>; 3]) -> f32x8<S> {
        self.bend[0] * p[0] * q[0] + self.bend[1] * p[2] * q[2]
    }

    #[inline(always)]
    fn load(&self, v: &[Lanes; 3]) -> [f32x8<S>; 3] {
        [
            f32x8::simd_from(self.simd, v[0]),
            f32x8::simd_from(self.simd, v[1]),
            f32x8::simd_from(self.simd, v[2]),
        ]
    }

    #[inline(always)]
    fn turned(&self, v: [f32x8<S>; 3]) -> [f32x8<S>; 3] {
        let [p, q, r] = &self.rotation;
        [
            p[0] * v[0] + p[1] * v[1] + p[2] * v[2],
            q[0] * v[0] + q[1] * v[1] + q[2] * v[2],
            r[0] * v[0] + r[1] * v[1] + r[2] * v[2],
        ]
    }
}
