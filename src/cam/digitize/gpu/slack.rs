//! How far a device's numbers may be off, and which way the safe side is.

use super::LEAST_SLACK;
use super::layout::Layout;
use crate::cam::digitize::View;
use crate::cam::digitize::part::{Part, Primitives};
use crate::geom::Point3;
use crate::tool::{Cutter, HeightFunction, Reach};
use std::marker::PhantomData;

/// Rounding units of a coordinate, of a point on a triangle, and of the sums they enter.
const OF_COORDINATES: f64 = 24.0;
/// Of what is computed of the tool's shape.
const OF_SHAPE: f64 = 128.0;
/// Of a plane over the tool, for each unit of its steepness and one more.
const OF_PLANES: f64 = 96.0;

/// What all steps of a job have in common of it.
pub(super) struct Slack<L> {
    /// The part is sent relative to this point.
    pub(super) centre: Point3,
    /// No corner lies farther from it [mm].
    extent: f64,
    /// The size of the tool [mm].
    tool: f64,
    layout: PhantomData<L>,
}

/// The slack of one step.
#[derive(Debug, Clone, Copy)]
pub(super) struct StepSlack {
    /// How far points are drawn inwards or pushed outwards [mm].
    pub(super) across: f64,
    /// What is added or taken away along the attack axis [mm].
    pub(super) along: f64,
    /// What is added to a plane for each unit of its steepness and one more [mm].
    pub(super) plane: f64,
    /// The greatest length that enters a number [mm].
    pub(super) far: f64,
}

impl<L: Layout> Slack<L> {
    pub(super) fn new(part: &Part, cutter: &Cutter) -> Self {
        let (centre, extent) = match &part.primitives {
            Primitives::Triangles(_, tree) => (tree.origin, tree.extent),
            Primitives::Points(_, tree) => (tree.origin, tree.extent),
        };
        let Reach { x, z, top } = cutter.reach();
        let at_rim = match cutter {
            Cutter::Wheel(_) => None,
            Cutter::Mill(mill) => mill.height(mill.radius, 0.0),
        };
        let tool = x + z + top.abs() + at_rim.unwrap_or_default().abs();
        Self { centre, extent, tool, layout: PhantomData }
    }

    /// Of the step that sees the part so.
    pub(super) fn of(&self, view: &View) -> StepSlack {
        // The CPU's own roundings are of the coordinates as they are, not about the centre.
        let far = self.extent + self.centre.coords.norm() + view.shift.norm();
        let coordinates = OF_COORDINATES * L::ROUNDING * far;
        let shape = OF_SHAPE * L::ROUNDING * self.tool;
        StepSlack {
            across: coordinates + shape,
            along: (coordinates + shape).max(LEAST_SLACK),
            plane: (OF_PLANES * L::ROUNDING * (2.0 * far + self.tool)).max(LEAST_SLACK),
            far: far + self.tool,
        }
    }
}
