//! The part on a device.

use super::Device;
use super::layout::{Job, Layout};
use crate::cam::digitize::part::Primitives;
use crate::cam::digitize::{Digitizer, Method};
use crate::compute::{Buffer, GpuError};
use crate::geom::{Node, PatchTree, Point3, WIDTH};
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
    /// Boxes and links of a search tree, if it is searched by one.
    pub(super) tree: Vec<Buffer>,
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
                Method::Exhaustive => in_a_row(device, points.len(), packed),
                Method::Indexed => as_tree::<L, _, 1>(device, tree, packed),
            }
        }
        (Primitives::Triangles(facets, tree), method) => {
            let packed = |i: usize| L::triangle(facets[i].corners.each_ref().map(relative));
            match method {
                Method::Exhaustive => in_a_row(device, facets.len(), packed),
                Method::Indexed => as_tree::<L, _, 3>(device, tree, packed),
            }
        }
    }
}

/// All primitives in their own order, in pieces no larger than a kernel can see.
fn in_a_row<P: Pod>(
    device: &Device,
    n_primitives: usize,
    packed: impl Fn(usize) -> P,
) -> Result<Vec<Piece>, GpuError> {
    let most = (device.binding as usize / size_of::<P>()).max(1);
    let mut pieces = Vec::new();
    for first in (0..n_primitives).step_by(most) {
        let numbers = first..(first + most).min(n_primitives);
        let packed: Vec<P> = numbers.clone().map(&packed).collect();
        pieces.push(Piece {
            job: Job { first: first as u32, ..Job::zeroed() },
            n_shares: numbers.len(),
            primitives: device.gpu.upload("part", &packed)?,
            tree: Vec::new(),
        });
    }
    Ok(pieces)
}

/// The tree with its primitives leaf by leaf. It is one piece, searched in one run; one that is too
/// large for a binding is refused by the upload.
fn as_tree<L: Layout, P: Pod, const N: usize>(
    device: &Device,
    tree: &PatchTree<N>,
    packed: impl Fn(usize) -> P,
) -> Result<Vec<Piece>, GpuError> {
    if tree.roots.is_empty() {
        return Ok(Vec::new());
    }
    let in_leaves = tree.leaves.iter().flat_map(|leaf| leaf.primitives);
    let primitives: Vec<P> = in_leaves.map(|number| packed(number as usize)).collect();
    let children: Vec<L::Child> = tree.nodes.iter().flat_map(children::<L>).collect();
    let mut links: Vec<u32> = tree.nodes.iter().flat_map(|node| node.children).collect();
    let numbers_at = links.len() as u32;
    for leaf in &tree.leaves {
        let is_there = |lane: usize| (lane as u32) < leaf.n_primitives;
        let number = |lane: usize| if is_there(lane) { leaf.primitives[lane] } else { NO_NUMBER };
        links.extend((0..WIDTH).map(number));
    }
    let mut roots = [0; 4];
    for (slot, root) in roots.iter_mut().zip(&tree.roots) {
        *slot = *root;
    }
    let n_roots = tree.roots.len() as u32;
    let job = Job { n_levels: tree.n_levels, n_roots, numbers_at, roots, ..Job::zeroed() };
    let primitives = device.gpu.upload("part", &primitives)?;
    let tree = vec![device.gpu.upload("tree", &children)?, device.gpu.upload("links", &links)?];
    Ok(vec![Piece { job, n_shares: 1, primitives, tree }])
}

fn children<L: Layout>(node: &Node) -> [L::Child; WIDTH] {
    std::array::from_fn(|lane| {
        let of = |numbers: &[[f32; WIDTH]; 3]| numbers.map(|axis| f64::from(axis[lane]));
        L::child(of(&node.center), node.radius[lane].into(), node.sides.each_ref().map(of))
    })
}
