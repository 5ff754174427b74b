//! What of the part could gouge during a whole move: the search tree, swept.
//!
//! A part point `p` holds the tool at `f(t) = y + u(x, z)` while it lies in the tool's shadow. Three
//! tests, sixteen nodes, triangles or pieces of a triangle side by side, tell that it does no harm
//! on the move:
//!
//! - It *passes by*: it never comes into the shadow.
//! - It runs *smoothly* ([`smooth`]): `f` bends down so little that it stays near its chord, and the
//!   chord's ends are known.
//! - It stays *low* ([`plane`]): so does a plane above the tool, chosen for the whole move.
//!
//! Which of them settles more depends on the tool: the rim of a wheel is nearly straight along its
//! way, and long moves are smooth; the way of a ball is as short as its radius, and planes that go
//! along with it tell. Triangles that none of them settles are cut into sixteen pieces, and these
//! again. Computed in `f32`, rounded up by a stated margin.

mod cut;
mod frame;
mod node;
mod plane;
mod primitive;
mod smooth;

use super::motion::{Affine, Motion};
use crate::geom::{Leaf, PatchTree, Point3};
use crate::tool::HeightFunction;
use cut::{Piece, cut, longest2, piece_of};
use fearless_simd::{f32x16, prelude::*};
use frame::Map;

/// Roundings of `f32` (half an epsilon each) that meet in one number, of at most the terms' greatest
/// size.
const ROUNDINGS: f32 = 32.0;
/// Pieces no longer than this are not cut any more [mm]: what is left to gain is less.
const SMALLEST: f32 = 0.005;
/// Cutting ends after so many groups of pieces: a shorter move settles the rest sooner.
const MOST_GROUPS: usize = 256;
/// A ceiling is to be low, however long it takes: there are few.
const MOST_GROUPS_OF_CEILING: usize = 512;

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
    /// What the last two do to a place, before the move is over [mm].
    drift: f32x16<S>,
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
    pieces: Vec<Uncut<N>>,
}

/// A triangle, or a piece of one, that may do harm.
#[derive(Debug)]
struct Uncut<const N: usize> {
    /// It holds the tool no higher above the line.
    height: f32,
    piece: Piece<N>,
}

impl<const N: usize> Default for Waiting<N> {
    fn default() -> Self {
        Self { nodes: Vec::new(), pieces: Vec::new() }
    }
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
        let jerk = motion.jerk / 2.0 + share * size(&acceleration);
        let rounding_of_velocity = share * size(&velocity);
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
            jerk: splat(jerk),
            rounding: splat(share * largest.max(place.shift.amax())),
            rounding_of_velocity: splat(rounding_of_velocity),
            drift: splat(rounding_of_velocity / 2.0 + jerk / 8.0),
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
                of_points.max(self.of_pieces(limits, &mut waiting.pieces))
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
                    let piece = self.piece(leaf, lane);
                    pieces.push(Uncut { height: height[lane], piece });
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

    /// Cuts triangles, down to the smallest pieces of the highest first: what does harm shows soon, and
    /// what lies no higher is then left alone.
    #[inline(always)]
    fn of_pieces(&self, limits: Limits, pieces: &mut Vec<Uncut<N>>) -> f32 {
        let mut harm = f32::NEG_INFINITY;
        let mut n_groups = 0;
        let most_groups = if limits.is_verdict { MOST_GROUPS } else { MOST_GROUPS_OF_CEILING };
        bring_highest_to_end(pieces);
        while let Some(uncut) = pieces.pop() {
            if uncut.height <= harm {
                continue;
            }
            if longest2(&uncut.piece) <= SMALLEST.powi(2) || n_groups == most_groups {
                harm = uncut.height;
                if limits.is_verdict {
                    break;
                }
                continue;
            }
            n_groups += 1;
            let group = cut(self.simd, &uncut.piece);
            let (height, harmful) = self.harmful_pieces(&group, limits);
            let n_before = pieces.len();
            pieces.extend(lanes(harmful).map(|lane| Uncut {
                height: height[lane].min(uncut.height),
                piece: piece_of(&group, lane),
            }));
            bring_highest_to_end(&mut pieces[n_before..]);
        }
        harm
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
}

fn bring_highest_to_end<const N: usize>(pieces: &mut [Uncut<N>]) {
    let heights = pieces.iter().map(|uncut| uncut.height).enumerate();
    if let Some((highest, _)) = heights.max_by(|(_, a), (_, b)| a.total_cmp(b)) {
        pieces.swap(highest, pieces.len() - 1);
    }
}

/// The lanes whose bits are set.
fn lanes(mut bits: u64) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lane = (bits != 0).then_some(bits.trailing_zeros() as usize);
        bits &= bits.wrapping_sub(1);
        lane
    })
}
