//! How high the children of a tree node could hold the tool: bounds for sixteen at once.
//!
//! The height function is concave: every tangent plane of it lies above all of it, and where the
//! plane touches over the contact it bounds the part's height there exactly. For a primitive the
//! plane's highest corner is the bound. Over a box more is needed: the height function stays concave
//! with a certain paraboloid taken away ([`HeightFunction::least_bend`]), so that the plane may be
//! bent down by that paraboloid. Touching over the centre of an oriented box, its greatest value is
//! tight to second order in the box's size, where a half-space or a level box is not.
//!
//! Computed in `f32` and rounded up by a stated margin.

use super::view::View;
use crate::geom::{Lanes, Leaf, Node, PatchTree};
use crate::tool::{HeightFunction, Tangent};
use fearless_simd::{f32x16, prelude::*};

/// Roundings of `f32` (half an epsilon each) that meet in one bound: six of a coordinate, seven of
/// a slope, three of their sum, each of at most the terms' greatest size.
const ROUNDINGS: f32 = 16.0;
/// Keeps a quotient from being nothing by nothing.
const TINY: f32 = 1e-30;

/// x, y and z of sixteen points or directions.
type Vectors<S> = [f32x16<S>; 3];

/// The tool over the part at one position, ready to bound any node of its tree.
pub(super) struct Bounds<'a, H, S: Simd> {
    simd: S,
    tool: &'a H,
    rotation: [Vectors<S>; 3],
    /// The tree's origin in the attack frame.
    shift: Vectors<S>,
    bend: [f32x16<S>; 2],
    /// Of a height that rises by 1 mm from one side of all terms to the other [mm].
    rounding: f32x16<S>,
}

impl<'a, H: HeightFunction, S: Simd> Bounds<'a, H, S> {
    #[inline(always)]
    pub(super) fn new<const N: usize>(
        simd: S,
        tool: &'a H,
        view: &View,
        tree: &PatchTree<N>,
    ) -> Self {
        let seen = view.see(&tree.origin);
        let reach = tool.reach();
        let largest = 2.0 * tree.extent + seen.amax() + reach.top.abs() + reach.x + reach.z;
        let m = &view.rotation;
        Self {
            simd,
            tool,
            rotation: [
                splat(simd, [m.m11, m.m12, m.m13]),
                splat(simd, [m.m21, m.m22, m.m23]),
                splat(simd, [m.m31, m.m32, m.m33]),
            ],
            shift: splat(simd, [seen.x, seen.y, seen.z]),
            bend: splat(simd, tool.least_bend()),
            rounding: f32x16::splat(simd, largest as f32 * (ROUNDINGS / 2.0 * f32::EPSILON)),
        }
    }

    /// No primitive under a child holds the tool higher than its lane; and, as bits, the lanes that
    /// reach `least` and that the tool does not pass by.
    #[inline(always)]
    pub(super) fn of_node(&self, node: &Node, least: f32) -> (Lanes, u64) {
        let [x, y, z] = self.seen(&node.center);
        let plane = self.tool.tangent(self.simd, x, z);
        let (slope, risen) = self.bent(&plane, x, z);
        let [a, b, c] = &node.sides;
        let (a, b, c) = (self.turned(a), self.turned(b), self.turned(c));
        // The long sides share what mixes them, which may leave one bending upwards. The thin side
        // only climbs; what mixes it with the others is charged in full.
        let mixed = self.bend(a, b).abs();
        let thin = climb(slope, c).abs() + self.bend(c, a).abs() + self.bend(c, b).abs();
        let rise_a = highest_rise(climb(slope, a).abs(), self.bend(a, a) - mixed);
        let rise_b = highest_rise(climb(slope, b).abs(), self.bend(b, b) - mixed);
        let [bent_x, bent_z] = slope;
        let steepness = bent_x.abs() + bent_z.abs() + steepness(&plane);
        let highest = y + plane.value + risen + thin + rise_a + rise_b;
        let bound = (steepness + 1.0).mul_add(self.rounding, highest);
        let radius = f32x16::from_slice(self.simd, &node.radius) + self.rounding;
        let outside = self.tool.passes_by(self.simd, x, z, radius);
        (*bound, (!outside & bound.simd_ge(least)).to_bitmask())
    }

    /// No primitive of the leaf holds the tool higher. By the plane that touches over the middle,
    /// which settles most leaves.
    #[inline(always)]
    pub(super) fn over_leaf<const N: usize>(&self, leaf: &Leaf<N>) -> f32 {
        let corners = self.corners(leaf);
        let (x, z) = middle(&corners);
        let plane = self.tool.tangent(self.simd, x, z);
        self.highest_corner(&plane, &corners).reduce_max()
    }

    /// No primitive of the leaf holds the tool higher than its lane; and, as bits, the lanes that
    /// reach `least` and that the tool does not pass by. By two planes: over the middle and over
    /// the likely contact.
    #[inline(always)]
    pub(super) fn of_leaf<const N: usize>(&self, leaf: &Leaf<N>, least: f32) -> (Lanes, u64) {
        let corners = self.corners(leaf);
        let (x, z) = middle(&corners);
        let plane = self.tool.tangent(self.simd, x, z);
        let mut bound = self.highest_corner(&plane, &corners);
        if 1 < N {
            let (x, z) = self.likely_contact(&plane, &corners);
            let closer = self.tool.tangent(self.simd, x, z);
            bound = bound.min(self.highest_corner(&closer, &corners));
        }
        let mut radius = self.rounding;
        for [corner_x, _, corner_z] in corners {
            radius = radius.max((corner_x - x).abs() + (corner_z - z).abs() + self.rounding);
        }
        let outside = self.tool.passes_by(self.simd, x, z, radius);
        let there = (1 << leaf.n_primitives) - 1;
        (*bound, (!outside & bound.simd_ge(least)).to_bitmask() & there)
    }

    /// The highest that `corners` lie under the plane, rounded up.
    #[inline(always)]
    fn highest_corner<const N: usize>(
        &self,
        plane: &Tangent<S>,
        corners: &[Vectors<S>; N],
    ) -> f32x16<S> {
        let mut highest = f32x16::splat(self.simd, f32::NEG_INFINITY);
        for [x, y, z] in *corners {
            highest = highest.max(plane.slope_x.mul_add(x, plane.slope_z.mul_add(z, y)));
        }
        let at_origin = plane.value - plane.slope_x.mul_add(plane.x0, plane.slope_z * plane.z0);
        (steepness(plane) + 1.0).mul_add(self.rounding, highest + at_origin)
    }

    /// Where on the sides of a triangle the bent plane is highest. A guess: wherever it is, the
    /// plane that touches there is a bound.
    #[inline(always)]
    fn likely_contact<const N: usize>(
        &self,
        plane: &Tangent<S>,
        corners: &[Vectors<S>; N],
    ) -> (f32x16<S>, f32x16<S>) {
        let mut highest = f32x16::splat(self.simd, f32::NEG_INFINITY);
        let (mut x, mut z) = (highest, highest);
        for i in 0..N {
            let ([px, py, pz], [qx, qy, qz]) = (corners[i], corners[(i + 1) % N]);
            let side = [qx - px, qy - py, qz - pz];
            let (slope, risen) = self.bent(plane, px, pz);
            let (climb, bend) = (climb(slope, side), self.bend(side, side));
            let far = (climb / bend.max(TINY)).max(0.0).min(1.0);
            let height = (climb - bend * far * 0.5).mul_add(far, risen + py);
            let is_higher = height.simd_gt(highest);
            highest = highest.max(height);
            x = is_higher.select(far.mul_add(side[0], px), x);
            z = is_higher.select(far.mul_add(side[2], pz), z);
        }
        (x, z)
    }

    /// The bent plane at `(x, z)`: its slopes, and how much it has risen from where it touches.
    #[inline(always)]
    fn bent(&self, plane: &Tangent<S>, x: f32x16<S>, z: f32x16<S>) -> ([f32x16<S>; 2], f32x16<S>) {
        let (out_x, out_z) = (x - plane.x0, z - plane.z0);
        let slope_x = plane.slope_x - self.bend[0] * out_x;
        let slope_z = plane.slope_z - self.bend[1] * out_z;
        let along_z = (plane.slope_z + slope_z) * out_z;
        let risen = (plane.slope_x + slope_x).mul_add(out_x, along_z) * 0.5;
        ([slope_x, slope_z], risen)
    }

    /// The paraboloid's quadratic form.
    #[inline(always)]
    fn bend(&self, p: Vectors<S>, q: Vectors<S>) -> f32x16<S> {
        (self.bend[0] * p[0]).mul_add(q[0], self.bend[1] * p[2] * q[2])
    }

    #[inline(always)]
    fn corners<const N: usize>(&self, leaf: &Leaf<N>) -> [Vectors<S>; N] {
        let mut corners = [self.shift; N];
        for (corner, of_all) in corners.iter_mut().zip(&leaf.corners) {
            *corner = self.seen(of_all);
        }
        corners
    }

    /// Points of the tree in the attack frame.
    #[inline(always)]
    fn seen(&self, points: &[Lanes; 3]) -> Vectors<S> {
        let [x, y, z] = self.turned(points);
        [x + self.shift[0], y + self.shift[1], z + self.shift[2]]
    }

    /// Directions of the tree in the attack frame.
    #[inline(always)]
    fn turned(&self, directions: &[Lanes; 3]) -> Vectors<S> {
        let [x, y, z] = directions;
        let x = f32x16::from_slice(self.simd, x);
        let y = f32x16::from_slice(self.simd, y);
        let z = f32x16::from_slice(self.simd, z);
        let [p, q, r] = &self.rotation;
        [
            p[0].mul_add(x, p[1].mul_add(y, p[2] * z)),
            q[0].mul_add(x, q[1].mul_add(y, q[2] * z)),
            r[0].mul_add(x, r[1].mul_add(y, r[2] * z)),
        ]
    }
}

/// Each number in all lanes. (A loop: the closure of a `map` would not be compiled for vectors.)
#[inline(always)]
fn splat<S: Simd, const N: usize>(simd: S, numbers: [f64; N]) -> [f32x16<S>; N] {
    let mut lanes = [f32x16::splat(simd, 0.0); N];
    for (lanes, number) in lanes.iter_mut().zip(numbers) {
        *lanes = f32x16::splat(simd, number as f32);
    }
    lanes
}

/// How much the part and the tool's height rise together along `side`.
#[inline(always)]
fn climb<S: Simd>(slope: [f32x16<S>; 2], side: Vectors<S>) -> f32x16<S> {
    slope[0].mul_add(side[0], slope[1].mul_add(side[2], side[1]))
}

/// At least the greatest value of `climb s - bend s^2 / 2` on `0 <= s <= 1`.
///
/// Where `climb < bend` that is `bend / 2` times the square of `climb / bend`, and a square lies
/// below its chords: here those between quarters, which spare a division. Else it is the value at 1.
#[inline(always)]
pub(in crate::cam) fn highest_rise<S: Simd>(climb: f32x16<S>, bend: f32x16<S>) -> f32x16<S> {
    let first = climb * 0.125;
    let second = climb.mul_add(0.375, bend * -0.0625);
    let third = climb.mul_add(0.625, bend * -0.1875);
    let fourth = climb.mul_add(0.875, bend * -0.375);
    let at_one = bend.mul_add(-0.5, climb);
    first.max(second).max(third).max(fourth).max(at_one)
}

#[inline(always)]
fn steepness<S: Simd>(plane: &Tangent<S>) -> f32x16<S> {
    plane.slope_x.abs() + plane.slope_z.abs()
}

#[inline(always)]
fn middle<S: Simd, const N: usize>(corners: &[Vectors<S>; N]) -> (f32x16<S>, f32x16<S>) {
    let (mut x, mut z) = (corners[0][0], corners[0][2]);
    for corner in &corners[1..] {
        (x, z) = (x + corner[0], z + corner[2]);
    }
    (x * (1.0 / N as f32), z * (1.0 / N as f32))
}

#[cfg(test)]
mod tests {
    use super::super::part::{Found, Part, Primitives};
    use super::*;
    use crate::geom::{Point3, PointCloud, Pose, TriMesh, Vector3, shapes};
    use crate::tool::{Cutter, Profile};
    use fearless_simd::{Level, dispatch};
    use nalgebra::{Translation3, UnitQuaternion};
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    const ALLOWANCES: [f64; 3] = [0.0, 0.4, 3.0];

    fn parts(random: &mut Pcg64Mcg) -> Vec<Part> {
        let bumpy = shapes::bumpy_cylinder(3_000);
        let needles = (0..1_500).map(|_| random_point(random, 60.0)).collect();
        let triangles = (0..500).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let cloud = PointCloud { points: bumpy.points.clone(), ..PointCloud::default() };
        vec![
            Part::triangles(&bumpy),
            Part::triangles(&TriMesh::new(needles, triangles)),
            Part::points(&cloud),
        ]
    }

    fn profiles() -> [Profile; 6] {
        let (radius, half_angle) = (6.0, 0.3);
        [
            Profile::Wheel { major_radius: 60.0, minor_radius: 10.0 },
            Profile::Ball { radius },
            Profile::Flat { radius },
            Profile::Bull { radius, corner_radius: 1.5 },
            Profile::Cone { radius, half_angle },
            Profile::BallCone { radius, tip_radius: 2.0, half_angle },
        ]
    }

    fn random_point(random: &mut Pcg64Mcg, size: f64) -> Point3 {
        Point3::from([0; 3].map(|_| random.random_range(-size..size)))
    }

    fn random_view(random: &mut Pcg64Mcg) -> View {
        let turn = Vector3::from([0; 3].map(|_| random.random_range(-3.0..3.0)));
        let shift = Translation3::from(random_point(random, 60.0).coords);
        View::new(&Pose::from_parts(shift, UnitQuaternion::from_scaled_axis(turn)))
    }

    #[test]
    fn no_primitive_holds_a_tool_higher_than_the_bounds_of_its_leaf_and_of_all_nodes_above() {
        let mut random = Pcg64Mcg::seed_from_u64(4_242);
        for part in parts(&mut random) {
            for (i, profile) in profiles().into_iter().enumerate() {
                for _ in 0..8 {
                    let view = random_view(&mut random);
                    match profile.cutter(ALLOWANCES[i % 3]) {
                        Cutter::Wheel(tool) => check(&part, &tool, &view),
                        Cutter::Mill(tool) => check(&part, &tool, &view),
                    }
                }
            }
        }
    }

    fn check(part: &Part, tool: &impl HeightFunction, view: &View) {
        dispatch!(Level::new(), simd => match &part.primitives {
            Primitives::Triangles(_, tree) => check_tree(simd, part, tree, tool, view),
            Primitives::Points(_, tree) => check_tree(simd, part, tree, tool, view),
        });
    }

    fn check_tree<S: Simd, const N: usize>(
        simd: S,
        part: &Part,
        tree: &PatchTree<N>,
        tool: &impl HeightFunction,
        view: &View,
    ) {
        let bounds = Bounds::new(simd, tool, view, tree);
        let height = |primitive: u32| {
            let mut best = None;
            part.try_one(simd, tool, view, primitive, &mut best);
            best.map(|found: Found| found.touch.height)
        };
        let mut n_seen = 0;
        let mut waiting: Vec<(f64, u32, u32)> =
            tree.roots.iter().map(|&root| (f64::INFINITY, tree.n_levels, root)).collect();
        while let Some((least, n_levels, index)) = waiting.pop() {
            if 0 < n_levels {
                let node = &tree.nodes[index as usize];
                let (bound, reaching) = bounds.of_node(node, f32::MIN);
                for (lane, (&child, bound)) in node.children.iter().zip(bound).enumerate() {
                    if node.radius[lane] == f32::NEG_INFINITY {
                        assert_eq!((reaching >> lane) & 1, 0, "an empty lane");
                        continue;
                    }
                    let bound = if (reaching >> lane) & 1 == 1 { bound.into() } else { f64::MIN };
                    waiting.push((least.min(bound), n_levels - 1, child));
                }
            } else {
                let leaf = &tree.leaves[index as usize];
                let over_leaf = f64::from(bounds.over_leaf(leaf));
                let (bound, reaching) = bounds.of_leaf(leaf, f32::MIN);
                let primitives = &leaf.primitives[..leaf.n_primitives as usize];
                for (lane, &primitive) in primitives.iter().enumerate() {
                    n_seen += 1;
                    let Some(height) = height(primitive) else { continue };
                    assert!((reaching >> lane) & 1 == 1, "passed by, and yet held at {height}");
                    assert!(height <= bound[lane].into(), "leaf: {height} over {}", bound[lane]);
                    assert!(height <= over_leaf, "leaf: {height} over {over_leaf}");
                    assert!(height <= least, "nodes: {height} over {least}");
                }
            }
        }
        assert_eq!(n_seen, part.n_primitives());
    }
}
