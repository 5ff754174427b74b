//! The same answer by a search tree: best-first, from the last contact.

use super::bound::Bounds;
use super::part::{Found, Part};
use super::view::View;
use crate::geom::{Child, Vector3};
use crate::tool::HeightFunction;
use fearless_simd::Simd;

/// Branches that can wait at once: on each of the 11 levels of a tree of 2^32 primitives seven
/// siblings of the one gone into, and at the last level that one too.
const DEEPEST: usize = 7 * 11 + 1;

/// The highest touch of all primitives. The search starts from primitive `start`, wherever that
/// lies, and leaves the one it found there.
#[inline(always)]
pub(super) fn drop<S: Simd>(
    simd: S,
    part: &Part,
    tool: &impl HeightFunction,
    view: &View,
    start: &mut u32,
) -> Option<Found> {
    if part.n_primitives() == 0 {
        return None;
    }
    let mut best = None;
    part.try_one(tool, view, *start, &mut best);
    let near = best.map_or_else(Vector3::zeros, |best: Found| best.touch.at);
    let bounds = Bounds::new(simd, tool, view, &part.tree, &near);
    let mut waiting = [(f32::INFINITY, Child::Node(0)); DEEPEST];
    let mut n_waiting = 1;
    while n_waiting > 0 {
        n_waiting -= 1;
        let (bound, child) = waiting[n_waiting];
        if is_below(bound, best.as_ref()) {
            continue;
        }
        match child {
            Child::Primitive(primitive) => part.try_one(tool, view, primitive, &mut best),
            Child::Node(index) => {
                let node = &part.tree.nodes[index as usize];
                let first = n_waiting;
                for (bound, &child) in bounds.of(node).into_iter().zip(&node.children) {
                    if bound > f32::NEG_INFINITY && !is_below(bound, best.as_ref()) {
                        // Sorted in: the last is taken first, the most promising of the siblings.
                        let mut place = n_waiting;
                        while first < place && bound < waiting[place - 1].0 {
                            waiting[place] = waiting[place - 1];
                            place -= 1;
                        }
                        waiting[place] = (bound, child);
                        n_waiting += 1;
                    }
                }
            }
        }
    }
    if let Some(best) = &best {
        *start = best.primitive;
    }
    best
}

/// True if nothing under `bound` can reach or tie with the best.
fn is_below(bound: f32, best: Option<&Found>) -> bool {
    best.is_some_and(|best| f64::from(bound) < best.touch.height)
}
