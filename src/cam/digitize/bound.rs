//! How high the children of a tree node could hold the tool: a bound for eight at once.
//!
//! The height function is concave, so any of its tangent planes lies above it; the greatest value
//! of a plane over an oriented box is that at its centre plus three products (DESIGN section 3,
//! "supergradient"). Computed in `f32` and rounded up by a proved margin.

use super::view::View;
use crate::geom::{Node, PatchTree};
use crate::tool::HeightFunction;
use wide::f32x8;

/// A view and a tool, spread over eight lanes.
pub(super) struct Bounds<'a, H> {
    tool: &'a H,
    rotation: [[f32x8; 3]; 3],
    shift: [f32x8; 3],
    /// Rounding of a coordinate, with the sums it enters; times one plus the slopes it meets.
    margin: f32,
}

impl<'a, H: HeightFunction> Bounds<'a, H> {
    pub(super) fn new(tool: &'a H, view: &View, tree: &PatchTree) -> Self {
        let shift = view.rotation * tree.origin.coords + view.shift;
        let splat = |value: f64| f32x8::splat(value as f32);
        // A coordinate `r c + t` carries at most 5 roundings of its largest term, the plane's value
        // 8 more of terms no larger than the extent, the shift, the tool: 16 covers both.
        let reach = tool.reach();
        let largest = 3.0 * tree.extent + shift.amax() + reach.top.abs() + reach.z + reach.x;
        let margin = (16.0 * 0.5 * f64::from(f32::EPSILON) * largest) as f32;
        Self {
            tool,
            rotation: [0, 1, 2].map(|i| [0, 1, 2].map(|j| splat(view.rotation[(i, j)]))),
            shift: [0, 1, 2].map(|i| splat(shift[i])),
            margin,
        }
    }

    /// No primitive under a child holds the tool higher than its lane; minus infinity where the
    /// tool passes the child by.
    #[inline]
    pub(super) fn of(&self, node: &Node) -> [f32; 8] {
        let [x, y, z] = [0, 1, 2].map(|axis| {
            let [a, b, c] = self.rotation[axis];
            a * node.center[0] + b * node.center[1] + c * node.center[2] + self.shift[axis]
        });
        let plane = self.tool.tangent(x, z);
        let [row_x, row_y, row_z] = self.rotation;
        let slope =
            [0, 1, 2].map(|k| plane.slope_x * row_x[k] + row_y[k] + plane.slope_z * row_z[k]);
        let reach = node
            .half_sides
            .map(|side| (slope[0] * side[0] + slope[1] * side[1] + slope[2] * side[2]).abs());
        let at_center =
            y + plane.value + plane.slope_x * (x - plane.x0) + plane.slope_z * (z - plane.z0);
        let steepness = plane.slope_x.abs() + plane.slope_z.abs() + f32x8::ONE;
        let bound = at_center + (reach[0] + reach[1] + reach[2]) + steepness * self.margin;
        let outside = self.tool.passes_by(x, z, node.radius + self.margin);
        outside.select(f32x8::splat(f32::NEG_INFINITY), bound).to_array()
    }
}
