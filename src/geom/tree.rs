//! A search tree over small primitives (triangles or points), eight children to a node.
//!
//! Every child is wrapped in an oriented box whose thin side looks along the mean normal of what it
//! holds, so that a plane's greatest value over it is its value at the centre plus three products,
//! tight to second order in the child's size (DESIGN section 3). Boxes are kept in `f32`, rounded
//! outwards; the primitives themselves stay in `f64` with whoever asks.

use super::{Aabb, Matrix3, Point3, Vector3};
use nalgebra::SymmetricEigen;
use rayon::prelude::*;
use wide::f32x8;

/// Primitives in one leaf, at most.
const LEAF: usize = 2;
/// Below this many primitives a subtree is built by one thread.
const SERIAL: usize = 4096;
/// A box half-side in `f32` grows by this share, and by this share of the centre's distance: more
/// than the rounding of centre and sides together (2^-24 each, three coordinates).
const ROUND_OUT: f64 = 5e-7;

/// The tree: its nodes, and the order in which its leaves list the primitives.
#[derive(Debug, Clone)]
pub struct PatchTree {
    /// Nodes; the first is the root.
    pub(crate) nodes: Vec<Node>,
    /// Primitive at each place of leaf order.
    pub(crate) order: Vec<u32>,
    /// Boxes are relative to this point.
    pub(crate) origin: Point3,
    /// No coordinate of any box reaches farther from `origin` than this [mm].
    pub(crate) extent: f64,
}

/// Eight children side by side; lanes without a child have a radius of minus infinity.
#[derive(Debug, Clone)]
pub(crate) struct Node {
    /// Box centres, x, y and z.
    pub(crate) center: [f32x8; 3],
    /// Three half-sides of the boxes, each x, y and z.
    pub(crate) half_sides: [[f32x8; 3]; 3],
    /// Radii of the balls about the centres that hold the boxes.
    pub(crate) radius: f32x8,
    /// What each lane leads to.
    pub(crate) children: [Child; 8],
}

/// Where a lane of a node leads.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Child {
    /// Index of a node, or of the first primitive in leaf order.
    pub(crate) index: u32,
    /// Primitives in the leaf; 0 marks an inner node.
    pub(crate) n_primitives: u32,
}

impl PatchTree {
    /// A tree over `primitives`, each given by its corners. The same input gives the same tree,
    /// whatever the number of threads.
    pub fn build<const N: usize>(primitives: &[[Point3; N]]) -> Self {
        let corners = primitives.iter().flatten();
        let aabb = Aabb::around(corners);
        let origin = if aabb.is_empty() { Point3::origin() } else { aabb.center() };
        let builder = Builder { primitives, origin };
        let mut order: Vec<u32> = (0..primitives.len() as u32).collect();
        let nodes = builder.subtree(&mut order, 0);
        Self { nodes, order, origin, extent: aabb.size().norm() / 2.0 }
    }
}

struct Builder<'a, const N: usize> {
    primitives: &'a [[Point3; N]],
    origin: Point3,
}

impl<const N: usize> Builder<'_, N> {
    /// Nodes over `order`, root first, child indices relative to the slice; `first` is where
    /// `order` starts in leaf order.
    fn subtree(&self, order: &mut [u32], first: usize) -> Vec<Node> {
        let groups = self.split(order);
        let mut node = Node::EMPTY;
        let mut jobs = Vec::new();
        let mut start = first;
        for (lane, group) in groups.into_iter().filter(|group| !group.is_empty()).enumerate() {
            node.set_box(lane, &self.oriented_box(group));
            let n_primitives = group.len();
            if n_primitives <= LEAF {
                let n = n_primitives as u32;
                node.children[lane] = Child { index: start as u32, n_primitives: n };
            } else {
                jobs.push((lane, start, group));
            }
            start += n_primitives;
        }
        let build =
            |(lane, start, group): (usize, usize, &mut [u32])| (lane, self.subtree(group, start));
        let subtrees: Vec<(usize, Vec<Node>)> = if SERIAL < start - first {
            jobs.into_par_iter().map(build).collect()
        } else {
            jobs.into_iter().map(build).collect()
        };
        let mut nodes = vec![node];
        for (lane, mut subtree) in subtrees {
            let offset = nodes.len() as u32;
            nodes[0].children[lane] = Child { index: offset, n_primitives: 0 };
            for node in &mut subtree {
                node.shift(offset);
            }
            nodes.append(&mut subtree);
        }
        nodes
    }

    /// Eight groups of near equal size, by three rounds of halving along the longest side.
    fn split<'o>(&self, order: &'o mut [u32]) -> Vec<&'o mut [u32]> {
        let mut groups = vec![order];
        for _ in 0..3 {
            groups = groups.into_iter().flat_map(|group| self.halve(group)).collect();
        }
        groups
    }

    fn halve<'o>(&self, group: &'o mut [u32]) -> [&'o mut [u32]; 2] {
        if group.len() <= LEAF {
            return [group, &mut []];
        }
        let centers = group.iter().map(|&i| self.center(i));
        let aabb = centers.fold(Aabb::EMPTY, |aabb, center| aabb.with(&center));
        let axis = aabb.size().imax();
        let middle = (group.len() / 2).next_multiple_of(LEAF).min(group.len() - 1);
        // The primitive's number decides between equal centres: the tree must not depend on luck.
        group.select_nth_unstable_by(middle, |&a, &b| {
            self.center(a)[axis].total_cmp(&self.center(b)[axis]).then(a.cmp(&b))
        });
        group.split_at_mut(middle).into()
    }

    fn center(&self, i_primitive: u32) -> Point3 {
        let corners = &self.primitives[i_primitive as usize];
        corners.iter().map(|corner| corner.coords).sum::<Vector3>().unscale(N as f64).into()
    }

    /// The box around `group` along its principal directions.
    fn oriented_box(&self, group: &[u32]) -> OrientedBox {
        let corners = || group.iter().flat_map(|&i| &self.primitives[i as usize]);
        let n = (group.len() * N) as f64;
        let mean: Vector3 = corners().map(|p| p - self.origin).sum::<Vector3>() / n;
        let mut spread = Matrix3::zeros();
        for corner in corners() {
            let out = corner - self.origin - mean;
            spread += out * out.transpose();
        }
        let axes = SymmetricEigen::try_new(spread, f64::EPSILON, 64)
            .map_or_else(Matrix3::identity, |eigen| eigen.eigenvectors);
        let mut aabb = Aabb::EMPTY;
        for corner in corners() {
            aabb = aabb.with(&axes.tr_mul(&(corner - self.origin)).into());
        }
        OrientedBox { center: axes * aabb.center().coords, axes, half: aabb.size() / 2.0 }
    }
}

/// A box by its centre, the directions of its sides (columns) and half their lengths.
struct OrientedBox {
    center: Vector3,
    axes: Matrix3,
    half: Vector3,
}

impl Node {
    const EMPTY: Self = Self {
        center: [f32x8::ZERO; 3],
        half_sides: [[f32x8::ZERO; 3]; 3],
        radius: f32x8::new([f32::NEG_INFINITY; 8]),
        children: [Child { index: 0, n_primitives: 0 }; 8],
    };

    fn set_box(&mut self, lane: usize, oriented: &OrientedBox) {
        let grow = ROUND_OUT * (oriented.center.norm() + oriented.half.norm());
        let half = oriented.half.add_scalar(grow);
        for axis in 0..3 {
            self.center[axis].as_mut_array()[lane] = oriented.center[axis] as f32;
            for side in 0..3 {
                let reach = oriented.axes[(axis, side)] * half[side];
                self.half_sides[side][axis].as_mut_array()[lane] = reach as f32;
            }
        }
        self.radius.as_mut_array()[lane] = (half.norm() * (1.0 + ROUND_OUT)) as f32;
    }

    fn shift(&mut self, offset: u32) {
        for child in self.children.iter_mut().filter(|child| child.n_primitives == 0) {
            child.index += offset;
        }
    }
}
