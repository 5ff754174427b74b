//! What of the part could gouge during a whole move: the search tree, swept.
//!
//! A part point `p` holds the tool at `f(t) = y + u(x, z)` while it lies in the tool's shadow. Three
//! tests, sixteen nodes, triangles or pieces of a triangle side by side, tell that it does no harm
//! on the move:
//!
//! - It *passes by*: it never comes into the shadow.
//! - It runs *smoothly*: within a share of the shadow `f'' >= -k`, and beyond, towards the rim, it
//!   is surely low. Then `f` rises above its chord by no more than `k / 8`; and the chord's ends lie
//!   no higher than the exact heights at the ends of the move, whatever `p` is, or low, where `p`
//!   comes in or goes out. `f'' = y'' + u_x x'' + u_z z'' + D2u[x', z']`, of which the first three
//!   follow from the point's acceleration and the last is the tool's own bend
//!   ([`HeightFunction::sharpness`]).
//! - It stays *low*: a plane above `u` that touches it near `p` gives `g(t) >= f(t)`, linear in where
//!   `p` stands, so that `g` never exceeds its value in the middle plus half its rate plus an eighth
//!   of its acceleration.
//!
//! The first two settle nearly all, most of it high up in the tree. Only where the part is touched
//! near the rim, where the tool's slope has no end, the third must help, and triangles there are cut
//! into sixteen pieces, and these again. Computed in `f32`, rounded up by a stated margin.

use super::motion::{Affine, Motion};
use crate::geom::{Lanes, Leaf, Node, PatchTree, Point3, WIDTH};
use crate::tool::{HeightFunction, Swept};
use fearless_simd::{f32x16, mask32x16, prelude::*};

/// Roundings of `f32` (half an epsilon each) that meet in one number, of at most the terms' greatest
/// size.
const ROUNDINGS: f32 = 32.0;
/// Rounding of a product of factors that are themselves bounds.
const SLACK: f32 = 1.0 + 1e-4;
/// Planes over nodes touch no farther out than this share of the tool's radius.
const SHARE_OVER_NODES: f32 = 0.9;
/// Over triangles they touch nearly at the rim, where steep walls are met.
const SHARE: f32 = 0.999;
/// Up to these shares of the tool's radius points may run smoothly, under a node.
const SMOOTH_SHARES_OVER_NODES: [f32; 2] = [0.995, 0.9];
/// The same on a primitive or a piece of one.
const SMOOTH_SHARES: [f32; 2] = [0.9999, 0.98];
/// How often a triangle is cut into sixteen.
const MOST_CUTS: u32 = 6;
/// Cutting ends after so many groups of pieces: a shorter move settles the rest sooner.
const MOST_GROUPS: usize = 256;

/// A ceiling is to be low, however long it takes: there are few.
const MOST_GROUPS_OF_CEILING: usize = 1024;

/// x, y and z of sixteen points or directions.
type Vectors<S> = [f32x16<S>; 3];

/// Where a corner is in the middle of the move, how fast it moves there, and how that changes.
type Run<T> = [[T; 3]; 3];

/// The corners of a triangle, or a point, seen from the tool.
type Piece<const N: usize> = [Run<f32>; N];

/// One move over the part.
pub(super) struct Sweep<'a, H, S: Simd, const N: usize> {
    simd: S,
    tool: &'a H,
    tree: &'a PatchTree<N>,
    motion: Motion,
    /// Heights count from the line that the tool runs along.
    place: Map<S>,
    velocity: Map<S>,
    acceleration: Map<S>,
    /// Of a place near the tool [mm].
    fine_rounding: f32x16<S>,
    /// Half the greatest change of the acceleration, and its rounding.
    jerk: f32x16<S>,
    /// Of a place, and of all that follows from it, per unit of slope [mm].
    rounding: f32x16<S>,
    /// Of a velocity [mm per move].
    rounding_of_velocity: f32x16<S>,
}

/// What is allowed.
#[derive(Debug, Clone, Copy)]
pub(super) struct Limits {
    /// Above the line [mm].
    pub(super) gouge: f64,
    /// What the part is above the line at the worse end of the move [mm].
    pub(super) deepest: f64,
    /// What a point's height may bend down over the move, squared [mm].
    pub(super) bend: f64,
    /// The first thing that may do harm is answer enough.
    pub(super) is_verdict: bool,
}

/// Lists that wait, kept from one move to the next.
#[derive(Debug)]
pub(super) struct Waiting<const N: usize> {
    nodes: Vec<(u32, u32)>,
    pieces: Vec<(u32, Piece<N>)>,
}

impl<const N: usize> Default for Waiting<N> {
    fn default() -> Self {
        Self { nodes: Vec::new(), pieces: Vec::new() }
    }
}

/// An affine function, sixteen times.
struct Map<S: Simd> {
    rows: [Vectors<S>; 3],
    shift: Vectors<S>,
    /// Lengths of the rows: how much each coordinate varies over a ball of radius 1.
    lengths: Vectors<S>,
}

/// Where sixteen things are in the middle of the move, and how they run.
struct Course<S: Simd> {
    x: f32x16<S>,
    z: f32x16<S>,
    /// Of `x`, `z` and `half` [mm].
    rounding: f32x16<S>,
    /// What they extend to either side [mm].
    half: [f32x16<S>; 2],
    /// Nowhere on the move they are higher above the line.
    top: f32x16<S>,
    /// Greatest speeds along x and z in the middle of the move.
    speed: [f32x16<S>; 2],
    /// Greatest accelerations along each axis, anywhere on the move.
    acceleration: Vectors<S>,
}

impl<'a, H: HeightFunction, S: Simd, const N: usize> Sweep<'a, H, S, N> {
    /// Over the part of `tree`; the tool runs from height `line[0]` to height `line[1]`.
    #[inline(always)]
    pub(super) fn new(
        simd: S,
        tool: &'a H,
        tree: &'a PatchTree<N>,
        motion: &Motion,
        line: [f64; 2],
    ) -> Self {
        let about_origin =
            |map: &Affine| Affine { linear: map.linear, shift: map.of(&tree.origin) };
        let mut place = about_origin(&motion.place);
        let mut velocity = about_origin(&motion.velocity);
        let acceleration = about_origin(&motion.acceleration);
        let reach = tool.reach();
        let largest = 2.0 * tree.extent + place.shift.amax() + reach.top.abs() + reach.x + reach.z;
        place.shift.y -= f64::midpoint(line[0], line[1]);
        velocity.shift.y -= line[1] - line[0];
        let share = f64::from(ROUNDINGS / 2.0 * f32::EPSILON);
        let near = 4.0 * (reach.top.abs() + reach.x + reach.z);
        let size = |map: &Affine| map.linear.norm() * tree.extent + map.shift.norm();
        let splat = |value: f64| f32x16::splat(simd, value as f32);
        Self {
            simd,
            tool,
            tree,
            motion: Motion { place, velocity, acceleration, ..*motion },
            place: Map::new(simd, &place),
            velocity: Map::new(simd, &velocity),
            acceleration: Map::new(simd, &acceleration),
            // The tree's corners are rounded, and what follows of them near the tool.
            fine_rounding: splat(f64::from(f32::EPSILON) * tree.extent + share * near / 4.0),
            jerk: splat(motion.jerk / 2.0 + share * size(&acceleration)),
            rounding: splat(share * largest.max(place.shift.amax())),
            rounding_of_velocity: splat(share * size(&velocity)),
        }
    }

    /// How high above the line the part may hold the tool at most, somewhere on the move, of all
    /// that cannot be told to keep within `limits`; minus infinity if there is none such.
    #[inline(never)]
    pub(super) fn harm(&self, limits: Limits, waiting: &mut Waiting<N>) -> f32 {
        self.simd.vectorize(
            #[inline(always)]
            || {
                let of_points = self.of_tree(limits, waiting);
                of_points.max(self.of_pieces(limits, waiting))
            },
        )
    }

    /// Opens nodes and leaves. Triangles that may do harm wait to be cut; points cannot be.
    #[inline(always)]
    fn of_tree(&self, limits: Limits, waiting: &mut Waiting<N>) -> f32 {
        let mut harm = f32::NEG_INFINITY;
        let Waiting { nodes, pieces } = waiting;
        pieces.clear();
        nodes.clear();
        nodes.extend(self.tree.roots.iter().map(|&root| (self.tree.n_levels, root)));
        while let Some((n_levels, index)) = nodes.pop() {
            if 0 < n_levels {
                let node = &self.tree.nodes[index as usize];
                for lane in lanes(self.harmful_children(node, limits)) {
                    nodes.push((n_levels - 1, node.children[lane]));
                }
                continue;
            }
            let leaf = &self.tree.leaves[index as usize];
            let there = (1 << leaf.n_primitives) - 1;
            let (height, harmful) = self.harmful_primitives(leaf, limits);
            for lane in lanes(harmful & there) {
                if 1 < N {
                    pieces.push((MOST_CUTS, self.piece(leaf, lane)));
                } else {
                    harm = harm.max(height[lane]);
                    if limits.is_verdict {
                        return harm;
                    }
                }
            }
        }
        harm
    }

    /// Cuts triangles until their pieces are harmless, or too small or too many.
    #[inline(always)]
    fn of_pieces(&self, limits: Limits, waiting: &mut Waiting<N>) -> f32 {
        let mut harm = f32::NEG_INFINITY;
        let mut n_groups = waiting.pieces.len();
        let most_groups = if limits.is_verdict { MOST_GROUPS } else { MOST_GROUPS_OF_CEILING };
        while let Some((n_cuts, piece)) = waiting.pieces.pop() {
            let pieces = cut(&piece);
            let (height, harmful) = self.harmful_pieces(&pieces, limits);
            let may_cut = 1 < n_cuts && n_groups < most_groups;
            for lane in lanes(harmful) {
                if may_cut {
                    n_groups += 1;
                    waiting.pieces.push((n_cuts - 1, piece_of(&pieces, lane)));
                } else {
                    harm = harm.max(height[lane]);
                    if limits.is_verdict {
                        return harm;
                    }
                }
            }
        }
        harm
    }

    /// As bits, the children under which something may do harm.
    #[inline(always)]
    fn harmful_children(&self, node: &Node, limits: Limits) -> u64 {
        let center = load(self.simd, &node.center);
        let radius = f32x16::from_slice(self.simd, &node.radius);
        let [x, y, z] = self.place.of(center);
        let [a, b, c] = &node.sides;
        let a = self.place.turned(load(self.simd, a));
        let b = self.place.turned(load(self.simd, b));
        let c = self.place.turned(load(self.simd, c));
        let velocity = self.velocity.of(center);
        let spread = self.velocity.spread(radius, self.rounding_of_velocity);
        let mut acceleration = self.acceleration.of(center);
        let varies = self.acceleration.spread(radius, self.jerk);
        for axis in 0..3 {
            acceleration[axis] = acceleration[axis].abs() + varies[axis];
        }
        let top_speed = velocity[1].abs() + spread[1];
        let top = y
            + a[1].abs()
            + b[1].abs()
            + c[1].abs()
            + risen(top_speed, acceleration[1])
            + self.rounding;
        let course = Course {
            x,
            z,
            rounding: self.rounding,
            half: [a[0].abs() + b[0].abs() + c[0].abs(), a[2].abs() + b[2].abs() + c[2].abs()],
            top,
            speed: [velocity[0].abs() + spread[0], velocity[2].abs() + spread[2]],
            acceleration,
        };
        let plane = self.tool.tangent_within(self.simd, x, z, SHARE_OVER_NODES);
        let slope = [plane.slope_x, plane.slope_z];
        let steepness = slope[0].abs() + slope[1].abs() + 1.0;
        let over = climb(slope, [x - plane.x0, y, z - plane.z0]) + plane.value;
        let risen = climb(slope, a).abs() + climb(slope, b).abs() + climb(slope, c).abs();
        let varies =
            slope[0].abs().mul_add(spread[0], slope[1].abs().mul_add(spread[2], spread[1]));
        let rate = climb(slope, velocity).abs() + varies;
        let steep = [slope[0].abs(), slope[1].abs()];
        let height = over
            + risen
            + rate * 0.5
            + climb(steep, acceleration) * 0.125
            + steepness * self.rounding;
        let is_low = height.simd_le(limits.gouge as f32);
        let is_empty = radius.simd_lt(0.0);
        let is_harmless = self.is_harmless(&course, limits, SMOOTH_SHARES_OVER_NODES);
        (!(is_empty | is_harmless | is_low)).to_bitmask()
    }

    /// No primitive holds the tool higher above the line than its lane; and, as bits, those that may
    /// do harm.
    #[inline(always)]
    fn harmful_primitives(&self, leaf: &Leaf<N>, limits: Limits) -> (Lanes, u64) {
        let zero = f32x16::splat(self.simd, 0.0);
        let mut corners = [[[zero; 3]; 3]; N];
        for (corner, of_leaf) in corners.iter_mut().zip(&leaf.corners) {
            let point = load(self.simd, of_leaf);
            *corner = [self.place.of(point), self.velocity.of(point), self.acceleration.of(point)];
        }
        self.harmful(&corners, self.rounding, limits)
    }

    /// The same for pieces.
    #[inline(always)]
    fn harmful_pieces(&self, pieces: &[Run<Lanes>; N], limits: Limits) -> (Lanes, u64) {
        let zero = f32x16::splat(self.simd, 0.0);
        let mut corners = [[[zero; 3]; 3]; N];
        let mut farthest = zero;
        for (corner, of_pieces) in corners.iter_mut().zip(pieces) {
            for i in 0..3 {
                corner[i] = load(self.simd, &of_pieces[i]);
            }
            let [x, y, z] = corner[0];
            farthest = farthest.max(x.abs()).max(y.abs()).max(z.abs());
        }
        let rounding = farthest.mul_add(8.0 * f32::EPSILON, self.fine_rounding);
        self.harmful(&corners, rounding, limits)
    }

    #[inline(always)]
    fn harmful(
        &self,
        corners: &[[Vectors<S>; 3]; N],
        rounding: f32x16<S>,
        limits: Limits,
    ) -> (Lanes, u64) {
        let zero = f32x16::splat(self.simd, 0.0);
        let mut seen = [[zero; 3]; N];
        let mut velocities = [[zero; 3]; N];
        let mut speed = [zero; 2];
        let mut acceleration = [zero; 3];
        let mut top_speed = zero;
        for i in 0..N {
            seen[i] = corners[i][0];
            velocities[i] = corners[i][1];
            speed[0] = speed[0].max(velocities[i][0].abs());
            speed[1] = speed[1].max(velocities[i][2].abs());
            top_speed = top_speed.max(velocities[i][1].abs());
            for axis in 0..3 {
                acceleration[axis] = acceleration[axis].max(corners[i][2][axis].abs() + self.jerk);
            }
        }
        speed = [speed[0] + self.rounding_of_velocity, speed[1] + self.rounding_of_velocity];
        let (x, z) = middle(&seen);
        let mut half = [zero; 2];
        let mut top = f32x16::splat(self.simd, f32::NEG_INFINITY);
        for [corner_x, y, corner_z] in seen {
            top = top.max(y);
            half = [half[0].max((corner_x - x).abs()), half[1].max((corner_z - z).abs())];
        }
        let top_speed = top_speed + self.rounding_of_velocity;
        let top = top + risen(top_speed, acceleration[1]) + rounding;
        let course = Course { x, z, rounding, half, top, speed, acceleration };
        let plane = self.tool.tangent_within(self.simd, x, z, SHARE);
        let slope = [plane.slope_x, plane.slope_z];
        let steepness = slope[0].abs() + slope[1].abs() + 1.0;
        let mut highest = f32x16::splat(self.simd, f32::NEG_INFINITY);
        for ([x, y, z], velocity) in seen.into_iter().zip(velocities) {
            let over = climb(slope, [x - plane.x0, y, z - plane.z0]);
            highest = highest.max(climb(slope, velocity).abs().mul_add(0.5, over));
        }
        let steep = [slope[0].abs(), slope[1].abs()];
        let height =
            highest + plane.value + climb(steep, acceleration) * 0.125 + steepness * rounding;
        let height = height.min(top + self.tool.reach().top as f32);
        let is_low = height.simd_le(limits.gouge as f32);
        let is_harmless = self.is_harmless(&course, limits, SMOOTH_SHARES);
        (*height, (!(is_harmless | is_low)).to_bitmask())
    }

    /// A triangle of a leaf on its own, seen from the tool before it is rounded.
    fn piece(&self, leaf: &Leaf<N>, lane: usize) -> Piece<N> {
        let Motion { place, velocity, acceleration, .. } = &self.motion;
        leaf.corners.each_ref().map(|corner| {
            let point = Point3::from([0, 1, 2].map(|axis| f64::from(corner[axis][lane])));
            [place, velocity, acceleration].map(|map| {
                let of_point = map.of(&point);
                [0, 1, 2].map(|axis| of_point[axis] as f32)
            })
        })
    }

    /// Does it pass by or run smoothly?
    #[inline(always)]
    fn is_harmless(&self, course: &Course<S>, limits: Limits, shares: [f32; 2]) -> mask32x16<S> {
        let [along, _, across] = course.acceleration;
        let step_x = along.mul_add(0.5, course.speed[0]);
        let step_z = across.mul_add(0.5, course.speed[1]);
        let swept = Swept {
            x: course.x,
            z: course.z,
            half_x: step_x.mul_add(0.5, course.half[0] + course.rounding),
            half_z: step_z.mul_add(0.5, course.half[1] + course.rounding),
            step_x,
            step_z,
        };
        let [outer, inner] = shares;
        self.is_smooth(course, &swept, limits, inner)
            | self.is_smooth(course, &swept, limits, outer)
    }

    #[inline(always)]
    fn is_smooth(
        &self,
        course: &Course<S>,
        swept: &Swept<S>,
        limits: Limits,
        share: f32,
    ) -> mask32x16<S> {
        let sharpness = self.tool.sharpness(self.simd, swept, share);
        let slope = [sharpness.slope_x, sharpness.slope_z];
        let bend = (climb(slope, course.acceleration) + sharpness.bend) * SLACK;
        let is_low_beyond = (course.top + sharpness.beyond).simd_le(limits.deepest as f32);
        let is_smooth = bend.simd_le(limits.bend as f32) & (sharpness.is_within | is_low_beyond);
        sharpness.is_outside | is_smooth
    }
}

impl<S: Simd> Map<S> {
    #[inline(always)]
    fn new(simd: S, map: &Affine) -> Self {
        let zero = f32x16::splat(simd, 0.0);
        let mut lanes = Self { rows: [[zero; 3]; 3], shift: [zero; 3], lengths: [zero; 3] };
        for i in 0..3 {
            for j in 0..3 {
                lanes.rows[i][j] = f32x16::splat(simd, map.linear[(i, j)] as f32);
            }
            lanes.shift[i] = f32x16::splat(simd, map.shift[i] as f32);
            lanes.lengths[i] = f32x16::splat(simd, map.linear.row(i).norm() as f32 * SLACK);
        }
        lanes
    }

    /// Of points.
    #[inline(always)]
    fn of(&self, points: Vectors<S>) -> Vectors<S> {
        let [x, y, z] = self.turned(points);
        [x + self.shift[0], y + self.shift[1], z + self.shift[2]]
    }

    /// Of directions.
    #[inline(always)]
    fn turned(&self, [x, y, z]: Vectors<S>) -> Vectors<S> {
        let [p, q, r] = &self.rows;
        [
            p[0].mul_add(x, p[1].mul_add(y, p[2] * z)),
            q[0].mul_add(x, q[1].mul_add(y, q[2] * z)),
            r[0].mul_add(x, r[1].mul_add(y, r[2] * z)),
        ]
    }

    /// How much each coordinate varies over balls of `radius`, and by `more`.
    #[inline(always)]
    fn spread(&self, radius: f32x16<S>, more: f32x16<S>) -> Vectors<S> {
        let [x, y, z] = self.lengths;
        [x.mul_add(radius, more), y.mul_add(radius, more), z.mul_add(radius, more)]
    }
}

#[inline(always)]
fn load<S: Simd>(simd: S, [x, y, z]: &[Lanes; 3]) -> Vectors<S> {
    [f32x16::from_slice(simd, x), f32x16::from_slice(simd, y), f32x16::from_slice(simd, z)]
}

/// How much a direction climbs together with the plane over it.
#[inline(always)]
fn climb<S: Simd>(slope: [f32x16<S>; 2], way: Vectors<S>) -> f32x16<S> {
    slope[0].mul_add(way[0], slope[1].mul_add(way[2], way[1]))
}

#[inline(always)]
fn middle<S: Simd, const N: usize>(corners: &[Vectors<S>; N]) -> (f32x16<S>, f32x16<S>) {
    let (mut x, mut z) = (corners[0][0], corners[0][2]);
    for corner in &corners[1..] {
        (x, z) = (x + corner[0], z + corner[2]);
    }
    (x * (1.0 / N as f32), z * (1.0 / N as f32))
}

/// The lanes whose bits are set.
fn lanes(mut bits: u64) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lane = (bits != 0).then_some(bits.trailing_zeros() as usize);
        bits &= bits.wrapping_sub(1);
        lane
    })
}

/// How much higher than in the middle of the move something can be elsewhere on it.
#[inline(always)]
fn risen<S: Simd>(speed: f32x16<S>, acceleration: f32x16<S>) -> f32x16<S> {
    acceleration.mul_add(0.125, speed * 0.5)
}

fn piece_of<const N: usize>(pieces: &[Run<Lanes>; N], lane: usize) -> Piece<N> {
    std::array::from_fn(|corner| {
        std::array::from_fn(|i| std::array::from_fn(|axis| pieces[corner][i][axis][lane]))
    })
}

/// A triangle as sixteen, halved four times across its longest side: pieces of a needle are no
/// needles. A point is sixteen times itself.
fn cut<const N: usize>(piece: &Piece<N>) -> [Run<Lanes>; N] {
    let mut pieces = [*piece; WIDTH];
    let mut n = 1;
    while n < WIDTH {
        for i in 0..n {
            [pieces[i], pieces[n + i]] = halves(&pieces[i]);
        }
        n *= 2;
    }
    let mut lanes = [[[[0.0; WIDTH]; 3]; 3]; N];
    for (lane, piece) in pieces.iter().enumerate() {
        for corner in 0..N {
            for k in 0..9 {
                lanes[corner][k / 3][k % 3][lane] = piece[corner][k / 3][k % 3];
            }
        }
    }
    lanes
}

fn halves<const N: usize>(piece: &Piece<N>) -> [Piece<N>; 2] {
    let mut longest = (-1.0, [0, 0]);
    for i in 0..N {
        let j = (i + 1) % N;
        let ([from, ..], [to, ..]) = (piece[i], piece[j]);
        let length2 = (0..3).map(|axis| (to[axis] - from[axis]).powi(2)).sum::<f32>();
        if longest.0 < length2 {
            longest = (length2, [i, j]);
        }
    }
    let [i, j] = longest.1;
    let mut middle = piece[i];
    for k in 0..9 {
        middle[k / 3][k % 3] = f32::midpoint(piece[i][k / 3][k % 3], piece[j][k / 3][k % 3]);
    }
    let mut halves = [*piece; 2];
    (halves[0][j], halves[1][i]) = (middle, middle);
    halves
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_triangle_is_its_sixteen_pieces_and_they_are_no_needles() {
        let corner = |x: f32, y: f32| [[x, y, 1.0], [2.0 * x, 0.0, y], [0.0; 3]];
        let whole = [corner(0.0, 0.0), corner(4.0, 0.0), corner(0.0, 1.0)];
        let pieces = cut(&whole);
        let mut area = 0.0;
        let mut middles = Vec::new();
        for lane in 0..WIDTH {
            let [a, b, c] = piece_of(&pieces, lane);
            let [u, v] = [b, c].map(|end| [end[0][0] - a[0][0], end[0][1] - a[0][1]]);
            assert!(u[0].abs().max(v[0].abs()) <= 1.0, "{u:?}, {v:?}");
            area += (u[0] * v[1] - u[1] * v[0]).abs() / 2.0;
            middles.push([0, 1].map(|k| (a[0][k] + b[0][k] + c[0][k]).to_bits()));
            for corner in [a, b, c] {
                let [x, y, _] = corner[0];
                assert!(0.0 <= x && 0.0 <= y && x + 4.0 * y <= 4.0);
                assert_eq!(corner[1], [2.0 * x, 0.0, y]);
            }
        }
        middles.sort_unstable();
        middles.dedup();
        assert_eq!((area, middles.len()), (2.0, WIDTH));
    }
}
