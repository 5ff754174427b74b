//! A search tree over small primitives (triangles or points), sixteen children to a node.
//!
//! Every child is wrapped in an oriented box whose thin side looks along the mean normal of what it
//! holds, so that what a tool can reach over it is bounded to second order in the child's size
//! (ARCHITECTURE section 4). Leaves hold the corners of sixteen primitives side by side. Boxes are
//! kept in `f32`, rounded outwards, corners in `f32` as they round; the primitives themselves stay
//! in `f64`, in their own order, with whoever asks.

use super::{Aabb, Matrix3, Point3, Vector3};
use nalgebra::SymmetricEigen;
use rayon::prelude::*;

/// Children of a node and primitives of a leaf, bounded side by side.
pub(crate) const WIDTH: usize = 16;
/// One number for each child.
pub(crate) type Lanes = [f32; WIDTH];
/// Trees side by side at most, instead of one more level above them.
const MOST_ROOTS: usize = 4;
/// Below this many primitives a subtree is built by one thread.
const SERIAL: usize = 4096;
/// A half-side grows by this share of itself, of its neighbours and of the centre's distance: more
/// than the rounding to `f32` of all of them together (2^-24 each, three coordinates).
const ROUND_OUT: f64 = 5e-7;

/// The tree over primitives of `N` corners, by its nodes and leaves.
#[derive(Debug, Clone)]
pub struct PatchTree<const N: usize> {
    /// The nodes to begin at; none if there are no primitives.
    pub(crate) roots: Vec<u32>,
    /// Levels of nodes above the leaves, which are all equally deep.
    pub(crate) n_levels: u32,
    /// All nodes.
    pub(crate) nodes: Vec<Node>,
    /// All leaves, all equally deep.
    pub(crate) leaves: Vec<Leaf<N>>,
    /// Boxes and corners are relative to this point.
    pub(crate) origin: Point3,
    /// No corner lies farther from `origin` than this [mm].
    pub(crate) extent: f64,
}

/// Sixteen children side by side; lanes without a child have a radius of minus infinity.
#[derive(Debug, Clone)]
#[repr(align(64))]
pub(crate) struct Node {
    /// Box centres, x, y and z.
    pub(crate) center: [Lanes; 3],
    /// Three half-sides of the boxes, each x, y and z; the last is the thin one.
    pub(crate) sides: [[Lanes; 3]; 3],
    /// Radii of the balls about the centres that hold the boxes.
    pub(crate) radius: Lanes,
    /// Where each lane leads: places among the leaves or among the nodes.
    pub(crate) children: [u32; WIDTH],
    /// Which of the two.
    pub(crate) is_over_leaves: bool,
}

/// Sixteen primitives side by side. Lanes without one repeat others.
#[derive(Debug, Clone)]
#[repr(align(64))]
pub(crate) struct Leaf<const N: usize> {
    /// The corners, each x, y and z, to the nearest `f32`.
    pub(crate) corners: [[Lanes; 3]; N],
    /// The primitives' numbers.
    pub(crate) primitives: [u32; WIDTH],
    /// How many there are.
    pub(crate) n_primitives: u32,
}

impl<const N: usize> PatchTree<N> {
    /// A tree over `primitives`, each given by its corners. The same input gives the same tree,
    /// whatever the number of threads.
    pub fn build(primitives: &[[Point3; N]]) -> Self {
        let aabb = Aabb::around(primitives.iter().flatten());
        let origin = if aabb.is_empty() { Point3::origin() } else { aabb.center() };
        let builder = Builder::new(primitives, origin);
        let mut capacity = WIDTH * WIDTH;
        let mut n_levels = 1;
        while MOST_ROOTS * capacity < primitives.len() {
            capacity *= WIDTH;
            n_levels += 1;
        }
        let mut numbers: Vec<u32> = (0..primitives.len() as u32).collect();
        let groups = builder.split(&mut numbers, capacity, MOST_ROOTS);
        let trees: Vec<_> =
            groups.into_par_iter().map(|group| builder.subtree(group, capacity)).collect();
        let mut whole = Subtree { root: 0, nodes: vec![], leaves: vec![] };
        let roots = trees.into_iter().map(|tree| whole.append(tree)).collect();
        let Subtree { nodes, leaves, .. } = whole;
        Self { roots, n_levels, nodes, leaves, origin, extent: aabb.size().norm() / 2.0 }
    }
}

/// A part of the tree on its own, counting from 0.
struct Subtree<const N: usize> {
    /// A place among the nodes; among the leaves if there are no nodes.
    root: u32,
    nodes: Vec<Node>,
    leaves: Vec<Leaf<N>>,
}

impl<const N: usize> Subtree<N> {
    /// Takes `other` in; where its root lies now.
    fn append(&mut self, mut other: Self) -> u32 {
        let (n_nodes, n_leaves) = (self.nodes.len() as u32, self.leaves.len() as u32);
        for node in &mut other.nodes {
            let offset = if node.is_over_leaves { n_leaves } else { n_nodes };
            for child in &mut node.children {
                *child += offset;
            }
        }
        let root = other.root + if other.nodes.is_empty() { n_leaves } else { n_nodes };
        self.nodes.append(&mut other.nodes);
        self.leaves.append(&mut other.leaves);
        root
    }
}

struct Builder<'a, const N: usize> {
    primitives: &'a [[Point3; N]],
    centers: Vec<Point3>,
    origin: Point3,
}

impl<'a, const N: usize> Builder<'a, N> {
    fn new(primitives: &'a [[Point3; N]], origin: Point3) -> Self {
        let center = |corners: &[Point3; N]| {
            let sum = corners.iter().map(|corner| corner.coords).sum::<Vector3>();
            Point3::from(sum.unscale(N as f64))
        };
        Self { primitives, centers: primitives.iter().map(center).collect(), origin }
    }

    /// The tree over `group`, as deep as one of `capacity` primitives.
    fn subtree(&self, group: &mut [u32], capacity: usize) -> Subtree<N> {
        if capacity <= WIDTH {
            return Subtree { root: 0, nodes: vec![], leaves: vec![self.leaf(group)] };
        }
        let is_small = group.len() < SERIAL;
        let below = capacity / WIDTH;
        let groups = self.split(group, below, WIDTH);
        let build = |group: &mut [u32]| (self.oriented_box(group), self.subtree(group, below));
        let children: Vec<_> = if is_small {
            groups.into_iter().map(build).collect()
        } else {
            groups.into_par_iter().map(build).collect()
        };
        let node = Node { is_over_leaves: below <= WIDTH, ..Node::EMPTY };
        let mut tree = Subtree { root: 0, nodes: vec![node], leaves: vec![] };
        for (lane, (oriented, child)) in children.into_iter().enumerate() {
            let place = tree.append(child);
            tree.nodes[0].children[lane] = place;
            tree.nodes[0].set_box(lane, &oriented);
        }
        tree
    }

    fn leaf(&self, group: &[u32]) -> Leaf<N> {
        let mut leaf = Leaf {
            corners: [[[0.0; WIDTH]; 3]; N],
            primitives: [0; WIDTH],
            n_primitives: group.len() as u32,
        };
        for (lane, &primitive) in group.iter().cycle().take(WIDTH).enumerate() {
            leaf.primitives[lane] = primitive;
            for (corner, slot) in self.primitives[primitive as usize].iter().zip(&mut leaf.corners)
            {
                let [x, y, z] = slot;
                let out = corner - self.origin;
                (x[lane], y[lane], z[lane]) = (out.x as f32, out.y as f32, out.z as f32);
            }
        }
        leaf
    }

    /// At most `most` groups (a power of two) of at most `full` primitives, by halving along the
    /// longest side; all but the last few are full: half-empty nodes cost as much as full ones.
    fn split<'o>(&self, group: &'o mut [u32], full: usize, most: usize) -> Vec<&'o mut [u32]> {
        if group.is_empty() || most <= 1 {
            return if group.is_empty() { vec![] } else { vec![group] };
        }
        let [first, second] = self.halve(group, full);
        let mut groups = self.split(first, full, most / 2);
        groups.append(&mut self.split(second, full, most / 2));
        groups
    }

    /// Two groups, the first a multiple of `full` primitives.
    fn halve<'o>(&self, group: &'o mut [u32], full: usize) -> [&'o mut [u32]; 2] {
        if group.len() <= full {
            return [group, &mut []];
        }
        let center = |i: u32| &self.centers[i as usize];
        let axis = Aabb::around(group.iter().map(|&i| center(i))).size().imax();
        let middle = group.len().div_ceil(full) / 2 * full;
        // The primitive's number decides between equal centres: the tree must not depend on luck.
        group.select_nth_unstable_by(middle, |&a, &b| {
            center(a)[axis].total_cmp(&center(b)[axis]).then(a.cmp(&b))
        });
        group.split_at_mut(middle).into()
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
        children: [0; WIDTH],
        is_over_leaves: false,
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
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::shapes;

    /// The leaf's primitives, each with all boxes above it.
    fn walk(tree: &PatchTree<3>, visit: &mut impl FnMut(u32, &[(&Node, usize)])) {
        let mut waiting: Vec<_> = tree.roots.iter().map(|&root| (root, vec![])).collect();
        while let Some((index, above)) = waiting.pop() {
            if above.len() < tree.n_levels as usize {
                let node = &tree.nodes[index as usize];
                for lane in (0..WIDTH).filter(|&lane| node.radius[lane] >= 0.0) {
                    let above = above.iter().copied().chain([(node, lane)]).collect();
                    waiting.push((node.children[lane], above));
                }
            } else {
                let leaf = &tree.leaves[index as usize];
                for &primitive in &leaf.primitives[..leaf.n_primitives as usize] {
                    visit(primitive, &above);
                }
            }
        }
    }

    /// How far outside the box of one lane `point` lies, in half-sides: 1 on its surface.
    fn outside(node: &Node, lane: usize, point: &Vector3) -> f64 {
        let at = |v: &[Lanes; 3]| Vector3::from([0, 1, 2].map(|axis| f64::from(v[axis][lane])));
        let out = point - at(&node.center);
        let sides = node.sides.each_ref().map(at);
        sides.iter().map(|side| (out.dot(side) / side.norm_squared()).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn every_primitive_lies_in_one_leaf_and_inside_all_boxes_above_it() {
        for n_triangles in [12, 300, 5_000] {
            let mesh = shapes::bumpy_cylinder(n_triangles);
            let primitives: Vec<_> = (0..mesh.triangles.len()).map(|i| mesh.corners(i)).collect();
            let tree = PatchTree::build(&primitives);
            let mut n_visits = vec![0; primitives.len()];
            walk(&tree, &mut |primitive, above| {
                n_visits[primitive as usize] += 1;
                for corner in primitives[primitive as usize].map(|corner| corner - tree.origin) {
                    for &(node, lane) in above {
                        assert!(outside(node, lane, &corner) <= 1.0);
                    }
                }
            });
            assert_eq!(n_visits, vec![1; primitives.len()]);
        }
    }

    #[test]
    fn of_nothing_has_no_roots() {
        let tree = PatchTree::<3>::build(&[]);
        assert!(tree.roots.is_empty() && tree.nodes.is_empty() && tree.leaves.is_empty());
    }

    #[test]
    fn is_the_same_for_any_number_of_threads() {
        let mesh = shapes::bumpy_cylinder(20_000);
        let primitives: Vec<_> = (0..mesh.triangles.len()).map(|i| mesh.corners(i)).collect();
        let build = |n_threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads).build().unwrap();
            format!("{:?}", pool.install(|| PatchTree::build(&primitives)))
        };
        assert!(build(1) == build(3));
    }
}
