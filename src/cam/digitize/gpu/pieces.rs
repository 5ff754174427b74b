//! The part on a device.

use super::Device;
use super::layout::{Job, Layout};
use super::subtrees::{MOST_ROOTS, Subtrees, subtrees};
use crate::cam::digitize::part::Primitives;
use crate::cam::digitize::{Digitizer, Method};
use crate::compute::{Buffer, GpuError};
use crate::geom::{Leaf, Node, PatchTree, Point3, WIDTH};
use bytemuck::{Pod, Zeroable};

/// The number of a lane of a leaf without a primitive.
const NO_NUMBER: u32 = u32::MAX;

/// What a kernel can see at once.
pub(super) struct Piece {
    /// What each run over it is told, but for its steps and its share.
    pub(super) job: Job,
    /// Into how many shares it can be divided.
    pub(super) n_shares: usize,
    pub(super) primitives: Buffer,
    /// What they are called; of a search tree its boxes and links.
    pub(super) others: Vec<Buffer>,
}

/// The part of `digitizer` about `centre`, as its method needs it.
pub(super) fn pieces<L: Layout>(
    digitizer: &Digitizer,
    device: &Device,
    centre: Point3,
) -> Result<Vec<Piece>, GpuError> {
    let relative = |point: &Point3| (point - centre).into();
    match (&digitizer.part.primitives, digitizer.method) {
        (Primitives::Points(points, tree), method) => {
            let packed = |i: usize| L::point(relative(&points[i]));
            match method {
                Method::Exhaustive => in_a_row(device, tree, packed),
                Method::Indexed => as_tree::<L, _, 1>(device, tree, packed),
            }
        }
        (Primitives::Triangles(facets, tree), method) => {
            let packed = |i: usize| L::triangle(facets[i].corners.each_ref().map(relative));
            match method {
                Method::Exhaustive => in_a_row(device, tree, packed),
                Method::Indexed => as_tree::<L, _, 3>(device, tree, packed),
            }
        }
    }
}

/// All primitives, neighbours together as the tree has them, in pieces no larger than a kernel can see.
fn in_a_row<P: Pod, const N: usize>(
    device: &Device,
    tree: &PatchTree<N>,
    packed: impl Fn(usize) -> P,
) -> Result<Vec<Piece>, GpuError> {
    let in_leaf = |leaf: &Leaf<N>| leaf.primitives.into_iter().take(leaf.n_primitives as usize);
    let numbers: Vec<u32> = tree.leaves.iter().flat_map(in_leaf).collect();
    let most = (device.binding as usize / size_of::<P>()).max(1);
    let piece = |numbers: &[u32]| {
        let primitives: Vec<P> = numbers.iter().map(|&number| packed(number as usize)).collect();
        Ok(Piece {
            job: Job::zeroed(),
            n_shares: numbers.len(),
            primitives: device.gpu.upload("part", &primitives)?,
            others: vec![device.gpu.upload("numbers", numbers)?],
        })
    };
    numbers.chunks(most).map(piece).collect()
}

/// The tree with its primitives leaf by leaf, in pieces no larger than a kernel can see.
fn as_tree<L: Layout, P: Pod, const N: usize>(
    device: &Device,
    tree: &PatchTree<N>,
    packed: impl Fn(usize) -> P,
) -> Result<Vec<Piece>, GpuError> {
    // Primitives take the most room: of boxes there are a fifteenth as many.
    let parts = subtrees(tree, device.binding as usize / (WIDTH * size_of::<P>()));
    parts.iter().map(|part| subtree::<L, P, N>(device, tree, part, &packed)).collect()
}

fn subtree<L: Layout, P: Pod, const N: usize>(
    device: &Device,
    tree: &PatchTree<N>,
    part: &Subtrees,
    packed: &impl Fn(usize) -> P,
) -> Result<Piece, GpuError> {
    let (nodes, leaves) = (&tree.nodes[part.nodes.clone()], &tree.leaves[part.leaves.clone()]);
    let (first_node, first_leaf) = (part.nodes.start as u32, part.leaves.start as u32);
    let in_leaves = leaves.iter().flat_map(|leaf| leaf.primitives);
    let primitives: Vec<P> = in_leaves.map(|number| packed(number as usize)).collect();
    let children: Vec<L::Child> = nodes.iter().flat_map(children::<L>).collect();
    let mut links = Vec::with_capacity((nodes.len() + leaves.len()) * WIDTH);
    for node in nodes {
        let first = if node.is_over_leaves { first_leaf } else { first_node };
        // Lanes without a child lead to place 0 of the whole tree, and are never followed.
        links.extend(node.children.map(|child| child.saturating_sub(first)));
    }
    let numbers_at = links.len() as u32;
    for leaf in leaves {
        let is_there = |lane: usize| (lane as u32) < leaf.n_primitives;
        let number = |lane: usize| if is_there(lane) { leaf.primitives[lane] } else { NO_NUMBER };
        links.extend((0..WIDTH).map(number));
    }
    let mut roots = [0; MOST_ROOTS];
    for (slot, root) in roots.iter_mut().zip(&part.roots) {
        *slot = *root - first_node;
    }
    let n_roots = part.roots.len() as u32;
    let job = Job { n_levels: part.n_levels, n_roots, numbers_at, roots, ..Job::zeroed() };
    let primitives = device.gpu.upload("part", &primitives)?;
    let others = vec![device.gpu.upload("tree", &children)?, device.gpu.upload("links", &links)?];
    Ok(Piece { job, n_shares: 1, primitives, others })
}

fn children<L: Layout>(node: &Node) -> [L::Child; WIDTH] {
    std::array::from_fn(|lane| {
        let of = |numbers: &[[f32; WIDTH]; 3]| numbers.map(|axis| f64::from(axis[lane]));
        L::child(of(&node.center), node.radius[lane].into(), node.sides.each_ref().map(of))
    })
}
