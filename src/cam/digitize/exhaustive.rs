//! The reference: every primitive is tried at every position. Morell (2014), algorithm 3.
//!
//! It rejects by the tool's slab along x and by height against the best so far, as any careful
//! program would; `benches/digitize.rs` measures [`indexed`](super::indexed) against this.

use super::part::{Found, Part, Primitives};
use super::view::View;
use crate::geom::Point3;
use crate::tool::HeightFunction;
use fearless_simd::Simd;

/// The highest touch of all primitives.
#[inline(always)]
pub(super) fn drop<S: Simd>(
    simd: S,
    part: &Part,
    tool: &impl HeightFunction,
    view: &View,
) -> Option<Found> {
    let mut best = None;
    match &part.primitives {
        Primitives::Triangles(facets, _) => {
            for (primitive, facet) in facets.iter().enumerate() {
                if may_touch(tool, view, &facet.corners, best.as_ref()) {
                    part.try_one(simd, tool, view, primitive as u32, &mut best);
                }
            }
        }
        Primitives::Points(points, _) => {
            for (primitive, point) in points.iter().enumerate() {
                if may_touch(tool, view, &[*point], best.as_ref()) {
                    part.try_one(simd, tool, view, primitive as u32, &mut best);
                }
            }
        }
    }
    best
}

#[inline(always)]
fn may_touch<const N: usize>(
    tool: &impl HeightFunction,
    view: &View,
    corners: &[Point3; N],
    best: Option<&Found>,
) -> bool {
    let reach = tool.reach();
    let range = |axis| {
        let seen = corners.map(|corner| view.coordinate(axis, &corner));
        seen.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &at| {
            (at.min(low), at.max(high))
        })
    };
    let (low, high) = range(0);
    if high < -reach.x || reach.x < low {
        return false;
    }
    best.is_none_or(|best| best.touch.height <= range(1).1 + reach.top)
}
