//! A search tree over small primitives (triangles or points), eight children to a node.
//!
//! Every child is wrapped in an oriented box whose thin side looks along the mean normal of what it
//! holds, so that what a tool can reach over it is bounded to second order in the child's size
//! (ARCHITECTURE section 4). Boxes are kept in `f32`, rounded outwards; the primitives themselves stay in
//! `f64`, in their own order, with whoever asks.

use super::{Aabb, Matrix3, Point3, Vector3};
use nalgebra::SymmetricEigen;
use rayon::prelude::*;

/// Children of a node, bounded side by side.
pub(crate) const WIDTH: usize = 8;
/// One number for each child.
pub(crate) type Lanes = [f32; WIDTH];
/// Below this many primitives a subtree is built by one thread.
const SERIAL: usize = 4096;
/// A half-side grows by this share of itself, of its neighbours and of the centre's distance: more
/// than the rounding to `f32` of all of them together (2^-24 each, three coordinates).
const ROUND_OUT: f64 = 5e-7;

/// The tree, by its nodes.
#[derive(Debug, Clone)]
pub struct PatchTree {
    /// The first is the root.
    pub(crate) nodes: Vec<Node>,
    /// Boxes are relative to this point.
    pub(crate) origin: Point3,
}

/// Eight children side by side; lanes without a child have a radius of minus infinity.
#[derive(Debug, Clone)]
#[repr(align(32))]
pub(crate) struct Node {
    /// Box centres, x, y and z.
    pub(crate) center: [Lanes; 3],
    /// Three half-sides of the boxes, each x, y and z; the last is the thin one.
    pub(crate) sides: [[Lanes; 3]; 3],
    /// Radii of the balls about the centres that hold the boxes.
    pub(crate) radius: Lanes,
    /// What each lane leads to.
    pub(crate) children: [Child; WIDTH],
}

/// Where a lane of a node leads.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Child {
    /// A node, by its place among the nodes.
    Node(u32),
    /// A primitive, by its number.
    Primitive(u32),
}

impl PatchTree {
    /// A tree over `primitives`, each given by its corners. The same input gives the same tree,
    /// whatever the number of threads.
    pub fn build<const N: usize>(primitives: &[[Point3; N]]) -> Self {
        let aabb = Aabb::around(primitives.iter().flatten());
        let origin = if aabb.is_empty() { Point3::origin() } else { aabb.center() };
        let builder = Builder { primitives, origin };
        let mut numbers: Vec<u32> = (0..primitives.len() as u32).collect();
        let nodes = builder.subtree(&mut numbers);
        Self { nodes, origin }
    }
}

struct Builder<'a, const N: usize> {
    primitives: &'a [[Point3; N]],
    origin: Point3,
}

impl<const N: usize> Builder<'_, N> {
    /// Nodes over `group`, root first, child indices relative to the slice.
    fn subtree(&self, group: &mut [u32]) -> Vec<Node> {
        let is_small = group.len() < SERIAL;
        let mut node = Node::EMPTY;
        let mut jobs = Vec::new();
        let groups = self.split(group).into_iter().filter(|group| !group.is_empty());
        for (lane, group) in groups.enumerate() {
            node.set_box(lane, &self.oriented_box(group));
            match *group {
                [primitive] => node.children[lane] = Child::Primitive(primitive),
                _ => jobs.push((lane, group)),
            }
        }
        let build = |(lane, group): (usize, &mut [u32])| (lane, self.subtree(group));
        let subtrees: Vec<(usize, Vec<Node>)> = if is_small {
            jobs.into_iter().map(build).collect()
        } else {
            jobs.into_par_iter().map(build).collect()
        };
        let mut nodes = vec![node];
        for (lane, mut subtree) in subtrees {
            let offset = nodes.len() as u32;
            nodes[0].children[lane] = Child::Node(offset);
            for node in &mut subtree {
                node.shift(offset);
            }
            nodes.append(&mut subtree);
        }
        nodes
    }

    /// At most eight groups by three rounds of halving along the longest side, so that all but the
    /// last few subtrees are full: half-empty nodes cost as much as full ones.
    fn split<'o>(&self, group: &'o mut [u32]) -> Vec<&'o mut [u32]> {
        let mut full = 1;
        while WIDTH * full < group.len() {
            full *= WIDTH;
        }
        let mut groups = vec![group];
        for _ in 0..3 {
            groups = groups.into_iter().flat_map(|group| self.halve(group, full)).collect();
        }
        groups
    }

    /// Two groups, the first a multiple of `full` primitives.
    fn halve<'o>(&self, group: &'o mut [u32], full: usize) -> [&'o mut [u32]; 2] {
        if group.len() <= full {
            return [group, &mut []];
        }
        let centers = group.iter().map(|&i| self.center(i));
        let aabb = centers.fold(Aabb::EMPTY, |aabb, center| aabb.with(&center));
        let axis = aabb.size().imax();
        let middle = group.len().div_ceil(full) / 2 * full;
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
        let corners =
            || group.iter().flat_map(|&i| &self.primitives[i as usize]).map(|p| p - self.origin);
        let mean = corners().sum::<Vector3>() / (group.len() * N) as f64;
        let mut spread = Matrix3::zeros();
        for out in corners().map(|corner| corner - mean) {
            spread += out * out.transpose();
        }
        let axes = patch_axes(&spread);
        let along = corners().map(|corner| Point3::from(axes.tr_mul(&corner)));
        let aabb = along.fold(Aabb::EMPTY, |aabb, corner| aabb.with(&corner));
        OrientedBox { center: axes * aabb.center().coords, axes, half: aabb.size() / 2.0 }
    }
}

/// The thinnest direction of `spread` last; the first along x as far as that allows, since x is
/// what tools and machines are aligned with.
fn patch_axes(spread: &Matrix3) -> Matrix3 {
    let eigen = SymmetricEigen::try_new(*spread, f64::EPSILON, 64);
    let normal: Vector3 = eigen
        .map_or(Vector3::z(), |eigen| eigen.eigenvectors.column(eigen.eigenvalues.imin()).into());
    let seed = if normal.x.abs() < 0.9 { Vector3::x() } else { Vector3::y() };
    let along = (seed - normal * normal.dot(&seed)).normalize();
    Matrix3::from_columns(&[along, normal.cross(&along), normal])
}

/// A box by its centre, the directions of its sides (columns) and half their lengths.
struct OrientedBox {
    center: Vector3,
    axes: Matrix3,
    half: Vector3,
}

impl Node {
    const EMPTY: Self = Self {
        center: [[0.0; WIDTH]; 3],
        sides: [[[0.0; WIDTH]; 3]; 3],
        radius: [f32::NEG_INFINITY; WIDTH],
        children: [Child::Primitive(0); WIDTH],
    };

    fn set_box(&mut self, lane: usize, oriented: &OrientedBox) {
        let grow = ROUND_OUT * (oriented.center.norm() + oriented.half.norm());
        let half = oriented.half.add_scalar(grow);
        let set = |slot: &mut Lanes, value: f64| slot[lane] = value as f32;
        for axis in 0..3 {
            set(&mut self.center[axis], oriented.center[axis]);
            for side in 0..3 {
                set(&mut self.sides[side][axis], oriented.axes[(axis, side)] * half[side]);
            }
        }
        set(&mut self.radius, half.norm() * (1.0 + ROUND_OUT));
    }

    fn shift(&mut self, offset: u32) {
        for child in &mut self.children {
            if let Child::Node(index) = child {
                *index += offset;
            }
        }
    }
}
