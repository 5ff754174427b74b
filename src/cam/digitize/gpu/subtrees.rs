//! A search tree in parts that a kernel can see at once.

use crate::geom::{Node, PatchTree, WIDTH};
use std::ops::Range;

/// Roots a kernel can begin at.
pub(super) const MOST_ROOTS: usize = 4;

/// Neighbours in the tree: some of its nodes, with all that lies under them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Subtrees {
    /// The nodes to begin at, of one level.
    pub(super) roots: Vec<u32>,
    /// Levels of nodes, the roots' among them.
    pub(super) n_levels: u32,
    /// All their nodes; children are counted from the first of the whole tree.
    pub(super) nodes: Range<usize>,
    /// All their leaves.
    pub(super) leaves: Range<usize>,
}

/// The whole tree in as few parts as hold at most `most_leaves` leaves each, and at least one node.
pub(super) fn subtrees<const N: usize>(tree: &PatchTree<N>, most_leaves: usize) -> Vec<Subtrees> {
    let mut parts: Vec<Subtrees> = Vec::new();
    for &root in &tree.roots {
        divide(tree, root, tree.n_levels, most_leaves, &mut |part| match parts.last_mut() {
            Some(last) if last.takes(&part, most_leaves) => last.take(part),
            _ => parts.push(part),
        });
    }
    parts
}

/// The tree under `root` by parts that are small enough, from left to right.
fn divide<const N: usize>(
    tree: &PatchTree<N>,
    root: u32,
    n_levels: u32,
    most_leaves: usize,
    found: &mut impl FnMut(Subtrees),
) {
    let part = Subtrees::under(tree, root, n_levels);
    if part.leaves.len() <= most_leaves || n_levels == 1 {
        return found(part);
    }
    for child in children(&tree.nodes[root as usize]) {
        divide(tree, child, n_levels - 1, most_leaves, found);
    }
}

impl Subtrees {
    // A tree lies in memory depth first: what is under a node is in a row.
    fn under<const N: usize>(tree: &PatchTree<N>, root: u32, n_levels: u32) -> Self {
        let ends = |[first, last]: [u32; 2]| {
            let [first, last] = [first, last].map(|node| &tree.nodes[node as usize]);
            let (first, last) = (children(first).next(), children(last).last());
            [first.unwrap_or_default(), last.unwrap_or_default()]
        };
        let lowest = (1..n_levels).fold([root; 2], |level, _| ends(level));
        let [first, last] = ends(lowest).map(|leaf| leaf as usize);
        let nodes = root as usize..lowest[1] as usize + 1;
        Self { roots: vec![root], n_levels, nodes, leaves: first..last + 1 }
    }

    fn takes(&self, next: &Self, most_leaves: usize) -> bool {
        self.n_levels == next.n_levels
            && self.roots.len() < MOST_ROOTS
            && self.nodes.end == next.nodes.start
            && self.leaves.len() + next.leaves.len() <= most_leaves
    }

    fn take(&mut self, next: Self) {
        self.roots.extend(next.roots);
        self.nodes.end = next.nodes.end;
        self.leaves.end = next.leaves.end;
    }
}

/// Where the lanes of `node` lead that lead anywhere.
fn children(node: &Node) -> impl Iterator<Item = u32> {
    (0..WIDTH).filter(|&lane| 0.0 <= node.radius[lane]).map(|lane| node.children[lane])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::{Point3, shapes};

    #[test]
    fn the_parts_of_a_tree_are_small_and_hold_each_leaf_once() {
        let mesh = shapes::bumpy_cylinder(20_000);
        let corners: Vec<[Point3; 3]> =
            (0..mesh.triangles.len()).map(|i| mesh.corners(i)).collect();
        let tree = PatchTree::build(&corners);
        for most_leaves in [usize::MAX, 700, 100, 16, 1] {
            let parts = subtrees(&tree, most_leaves);
            // A node over leaves is not divided.
            assert!(parts.iter().all(|part| part.leaves.len() <= most_leaves.max(WIDTH)));
            assert!(parts.iter().all(|part| part.roots.len() <= MOST_ROOTS));
            assert_eq!(parts.len() == 1, most_leaves == usize::MAX);
            let mut next = 0;
            for part in &parts {
                assert_eq!(part.leaves.start, next);
                next = part.leaves.end;
                let inside = |root: &u32| part.nodes.contains(&(*root as usize));
                assert!(part.roots.iter().all(inside));
            }
            assert_eq!(next, tree.leaves.len());
        }
    }

    #[test]
    fn what_is_under_a_node_leads_to_its_own_nodes_and_leaves_alone() {
        let points: Vec<_> = (0..9_000).map(|i| [Point3::new(f64::from(i), 0.0, 0.0)]).collect();
        let tree = PatchTree::build(&points);
        for part in subtrees(&tree, 40) {
            for node in &tree.nodes[part.nodes.clone()] {
                let range = if node.is_over_leaves { &part.leaves } else { &part.nodes };
                assert!(children(node).all(|child| range.contains(&(child as usize))));
            }
        }
    }
}
