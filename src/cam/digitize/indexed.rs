//! The same answer by a search tree, level by level, from the last contact.
//!
//! The last contact's primitive already holds the tool nearly as high as the answer, so that the
//! order of the search hardly matters (best first saves no tenth of it). What matters is that the
//! processor need not wait for one bound before it begins the next: the nodes of a level are opened
//! in a row and their survivors listed without branching. Where many leaves survive, one try of the
//! most promising primitive spares looking into most of the others.

use super::bound::Bounds;
use super::list::List;
use super::part::{Found, Part, Primitives};
use super::view::View;
use crate::geom::{Lanes, PatchTree};
use crate::tool::HeightFunction;
use fearless_simd::Simd;

/// More nodes than this on one level, and the start was a poor one: ten are usual.
const CROWD: usize = 64;
/// More leaves than this, and the best is raised before they are looked into.
const MANY: usize = 6;

/// What one search leaves to the next: where it ended, and its lists.
#[derive(Debug, Default)]
pub(in crate::cam) struct Memory {
    last: u32,
    nodes: List<u32>,
    next: List<u32>,
    /// With their bounds.
    leaves: List<(f32, u32)>,
    /// With their bounds.
    primitives: List<(f32, u32)>,
}

/// The highest touch of all primitives. Where the last search ended decides the time, never the
/// answer.
#[inline(always)]
pub(in crate::cam) fn drop<S: Simd>(
    simd: S,
    part: &Part,
    tool: &impl HeightFunction,
    view: &View,
    memory: &mut Memory,
) -> Option<Found> {
    match &part.primitives {
        Primitives::Triangles(_, tree) => {
            let bounds = Bounds::new(simd, tool, view, tree);
            Search { simd, part, tree, tool, view, bounds, memory }.run()
        }
        Primitives::Points(_, tree) => {
            let bounds = Bounds::new(simd, tool, view, tree);
            Search { simd, part, tree, tool, view, bounds, memory }.run()
        }
    }
}

struct Search<'a, H, S: Simd, const N: usize> {
    simd: S,
    part: &'a Part,
    tree: &'a PatchTree<N>,
    tool: &'a H,
    view: &'a View,
    bounds: Bounds<'a, H, S>,
    memory: &'a mut Memory,
}

impl<H: HeightFunction, S: Simd, const N: usize> Search<'_, H, S, N> {
    #[inline(always)]
    fn run(&mut self) -> Option<Found> {
        if self.part.n_primitives() == 0 {
            return None;
        }
        let Self { simd, part, tool, view, .. } = *self;
        let try_one = |primitive, best: &mut _| part.try_one(simd, tool, view, primitive, best);
        let mut best = None;
        let mut start = self.memory.last;
        try_one(start, &mut best);
        if !self.list_nodes(floor(best.as_ref()), CROWD) {
            start = self.likely();
            try_one(start, &mut best);
            self.list_nodes(floor(best.as_ref()), usize::MAX);
        }
        self.list_leaves(floor(best.as_ref()));
        if MANY < self.memory.leaves.items().len() {
            self.list_primitives(floor(best.as_ref()), 1);
            if let Some(&(_, primitive)) = self.memory.primitives.drain().first() {
                start = primitive;
                try_one(start, &mut best);
            }
        }
        self.list_primitives(floor(best.as_ref()), usize::MAX);
        for &(bound, primitive) in self.memory.primitives.drain() {
            if primitive != start && floor(best.as_ref()) <= bound {
                try_one(primitive, &mut best);
            }
        }
        if let Some(best) = &best {
            self.memory.last = best.primitive;
        }
        best
    }

    /// Lists as [`Memory::nodes`] the leaves under nodes that may reach `least`; false if on the way
    /// there were more than `most` nodes on a level.
    #[inline(never)]
    fn list_nodes(&mut self, least: f32, most: usize) -> bool {
        self.simd.vectorize(
            #[inline(always)]
            || {
                let Memory { nodes, next, .. } = self.memory;
                nodes.clear();
                for &root in &self.tree.roots {
                    nodes.push_if(true, root);
                }
                for _ in 0..self.tree.n_levels {
                    for &index in nodes.drain() {
                        let node = &self.tree.nodes[index as usize];
                        let (_, reaching) = self.bounds.of_node(node, least);
                        next.push_lanes(
                            reaching,
                            #[inline(always)]
                            |lane| node.children[lane],
                        );
                    }
                    std::mem::swap(nodes, next);
                    if most < nodes.items().len() {
                        return false;
                    }
                }
                true
            },
        )
    }

    /// Of those leaves lists the ones that may reach `least`, the most promising first.
    #[inline(never)]
    fn list_leaves(&mut self, least: f32) {
        self.simd.vectorize(
            #[inline(always)]
            || {
                let Memory { nodes, leaves, .. } = self.memory;
                leaves.clear();
                for &index in nodes.drain() {
                    let bound = self.bounds.over_leaf(&self.tree.leaves[index as usize]);
                    leaves.push_if(least <= bound, (bound, index));
                }
                leaves.bring_highest_to_front();
            },
        );
    }

    /// Lists the primitives of the first `n` leaves that may reach `least`, the most promising
    /// first: once it has been tried, most others need not be.
    #[inline(never)]
    fn list_primitives(&mut self, least: f32, n: usize) {
        self.simd.vectorize(
            #[inline(always)]
            || {
                let Memory { leaves, primitives, .. } = self.memory;
                for &(bound, index) in leaves.items().iter().take(n) {
                    if bound < least {
                        continue;
                    }
                    let leaf = &self.tree.leaves[index as usize];
                    let (bound, reaching) = self.bounds.of_leaf(leaf, least);
                    primitives.push_lanes(
                        reaching,
                        #[inline(always)]
                        |lane| (bound[lane], leaf.primitives[lane]),
                    );
                }
                primitives.bring_highest_to_front();
            },
        );
    }

    /// A primitive to start from where the last contact is no help: at every node down the tree
    /// the child of the highest bound.
    #[inline(never)]
    fn likely(&self) -> u32 {
        self.simd.vectorize(
            #[inline(always)]
            || {
                let mut top = (f32::NEG_INFINITY, 0);
                for &root in &self.tree.roots {
                    let (bound, child) = self.highest_child(root);
                    if top.0 <= bound {
                        top = (bound, child);
                    }
                }
                for _ in 1..self.tree.n_levels {
                    top = self.highest_child(top.1);
                }
                let leaf = &self.tree.leaves[top.1 as usize];
                let (bound, reaching) = self.bounds.of_leaf(leaf, f32::MIN);
                leaf.primitives[highest(&bound, reaching)]
            },
        )
    }

    #[inline(always)]
    fn highest_child(&self, node: u32) -> (f32, u32) {
        let node = &self.tree.nodes[node as usize];
        let (bound, reaching) = self.bounds.of_node(node, f32::MIN);
        let lane = highest(&bound, reaching);
        (bound[lane], node.children[lane])
    }
}

/// The lane of the highest bound among those `reaching`; the first if there is none.
#[inline(always)]
fn highest(bound: &Lanes, reaching: u64) -> usize {
    let mut top = (f32::NEG_INFINITY, 0);
    for (lane, &bound) in bound.iter().enumerate() {
        if (reaching >> lane) & 1 == 1 && top.0 < bound {
            top = (bound, lane);
        }
    }
    top.1
}

/// The best height rounded down: nothing under a bound below it can reach or tie.
#[inline(always)]
fn floor(best: Option<&Found>) -> f32 {
    let Some(best) = best else { return f32::MIN };
    let near = best.touch.height as f32;
    if f64::from(near) <= best.touch.height { near } else { near.next_down() }
}
