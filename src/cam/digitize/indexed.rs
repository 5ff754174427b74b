//! The same answer by a search tree: best-first, from the last contact.

use super::bound::Bounds;
use super::part::{Found, Part};
use super::view::View;
use crate::geom::Child;
use crate::tool::HeightFunction;

/// Branches that can wait at once: seven siblings on each of more levels than a tree of 2^32
/// primitives has.
const DEEPEST: usize = 7 * 16;

/// The highest touch of all primitives. The search starts from the primitive at `start` in leaf
/// order, wherever that lies, and leaves the one it found there.
pub(super) fn drop(
    part: &Part,
    tool: &impl HeightFunction,
    view: &View,
    start: &mut u32,
) -> Option<Found> {
    let mut best = None;
    if part.n_primitives() == 0 {
        return None;
    }
    part.try_place(tool, view, *start, &mut best);
    let bounds = Bounds::new(tool, view, &part.tree);
    let mut waiting = Vec::with_capacity(DEEPEST);
    let root = Child { index: 0, n_primitives: 0 };
    waiting.push((f32::INFINITY, root));
    while let Some((bound, child)) = waiting.pop() {
        if is_below(bound, best.as_ref()) {
            continue;
        }
        if child.n_primitives > 0 {
            for place in child.index..child.index + child.n_primitives {
                part.try_place(tool, view, place, &mut best);
            }
            continue;
        }
        let node = &part.tree.nodes[child.index as usize];
        let first = waiting.len();
        for (bound, &child) in bounds.of(node).into_iter().zip(&node.children) {
            if bound > f32::NEG_INFINITY && !is_below(bound, best.as_ref()) {
                waiting.push((bound, child));
            }
        }
        // The last is taken first: the most promising of the siblings.
        waiting[first..].sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    }
    if let Some(best) = &best {
        *start = best.place;
    }
    best
}

/// True if nothing under `bound` can reach or tie with the best.
fn is_below(bound: f32, best: Option<&Found>) -> bool {
    best.is_some_and(|best| f64::from(bound) < best.touch.height)
}
