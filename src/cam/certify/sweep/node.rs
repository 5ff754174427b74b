//! Which children of a node may hold something that does harm.

use super::frame::{climb, load};
use super::plane::highest_on_move;
use super::smooth::{Course, SHARES_OVER_NODES, risen};
use super::{Limits, Sweep};
use crate::cam::digitize::highest_rise;
use crate::geom::Node;
use crate::tool::HeightFunction;
use fearless_simd::{f32x16, prelude::*};

/// Planes over nodes touch no farther out than this share of the tool's radius.
const SHARE: f32 = 0.9;

impl<H: HeightFunction, S: Simd, const N: usize> Sweep<'_, H, S, N> {
    /// As bits, the children under which something may do harm.
    #[inline(always)]
    pub(super) fn harmful_children(&self, node: &Node, limits: Limits) -> u64 {
        let center = load(self.simd, &node.center);
        let radius = f32x16::from_slice(self.simd, &node.radius);
        let place = self.place.of(center);
        let [x, y, z] = place;
        let [a, b, c] = &node.sides;
        let a = self.place.turned(load(self.simd, a));
        let b = self.place.turned(load(self.simd, b));
        let c = self.place.turned(load(self.simd, c));
        let velocity = self.velocity.of(center);
        let spread = self.velocity.spread(radius, self.rounding_of_velocity);
        let turn = self.acceleration.of(center);
        let turn_spread = self.acceleration.spread(radius, self.jerk);
        let mut acceleration = turn_spread;
        for axis in 0..3 {
            acceleration[axis] += turn[axis].abs();
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
        let is_empty = radius.simd_lt(0.0);
        let is_harmful = !(is_empty | self.is_harmless(&course, limits, SHARES_OVER_NODES));
        if is_harmful.to_bitmask() == 0 {
            return 0;
        }

        let plane = self.plane_over(place, velocity, SHARE);
        let across = self.across(velocity);
        let zero = f32x16::splat(self.simd, 0.0);
        let out = across.of([x - plane.foot[0], zero, z - plane.foot[1]]);
        let (bend_a, bend_b, bend_c) = (across.of(a), across.of(b), across.of(c));
        // Ways are neither straight nor the same all over the box: how far across the middle's they lead.
        let aside_x = risen(spread[0], acceleration[0]);
        let aside_z = risen(spread[2], acceleration[2]);
        let aside = across.0[0].abs().mul_add(aside_z, across.0[1].abs() * aside_x);
        let farthest = out.abs() + bend_a.abs() + bend_b.abs() + bend_c.abs();
        // The long sides share what mixes them, which may leave one bending upwards. The thin side
        // only climbs; what mixes it with the others is charged in full.
        let mixed = (bend_a * bend_b).abs();
        let rise_a = (climb(plane.slope, a) - out * bend_a).abs();
        let rise_b = (climb(plane.slope, b) - out * bend_b).abs();
        let rise_c = (climb(plane.slope, c) - out * bend_c).abs();
        let mixed_c = bend_c.abs() * (bend_a.abs() + bend_b.abs());
        let over = highest_rise(rise_a, bend_a * bend_a - mixed)
            + highest_rise(rise_b, bend_b * bend_b - mixed)
            + rise_c
            + mixed_c
            + aside * farthest
            - out * out * 0.5;
        let steep = [plane.slope[0].abs(), plane.slope[1].abs()];
        let rate = climb(plane.slope, velocity).abs() + climb(steep, spread);
        let turn = climb(plane.slope, turn) + climb(steep, turn_spread);
        let bent = out.abs() * (across.0[0].abs() + across.0[1].abs());
        let height = y + plane.value + over + highest_on_move(rate, turn);
        let height = (steep[0] + steep[1] + bent + 1.0).mul_add(self.rounding, height);
        (is_harmful & !height.simd_le(limits.gouge as f32)).to_bitmask()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cam::certify::motion::{Lever, Motion};
    use crate::geom::{PatchTree, Point3, Vector3, WIDTH, shapes};
    use crate::machine::{AxisKind, AxisValues, Machine};
    use crate::tool::Mill;
    use fearless_simd::{Level, dispatch};
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    /// Corners, middles of sides and faces, and the centre of the box in one lane.
    fn places(tree: &PatchTree<3>, node: &Node, lane: usize) -> Vec<Point3> {
        let vector =
            |lanes: &[[f32; WIDTH]; 3]| Vector3::from([0, 1, 2].map(|i| lanes[i][lane].into()));
        let [a, b, c] = node.sides.each_ref().map(vector);
        let shares = |i: i32| [i % 3, i / 3 % 3, i / 9].map(|share| f64::from(share - 1));
        let place =
            |[p, q, r]: [f64; 3]| tree.origin + vector(&node.center) + a * p + b * q + c * r;
        (0..27).map(|i| place(shares(i))).collect()
    }

    /// On long moves, so that boxes turn a lot.
    #[test]
    fn no_place_of_a_box_comes_higher_on_a_move_than_the_bent_plane_over_it_says() {
        let mut random = Pcg64Mcg::seed_from_u64(17);
        let mesh = shapes::bumpy_cylinder(3_000);
        let primitives: Vec<_> = (0..mesh.triangles.len()).map(|i| mesh.corners(i)).collect();
        let tree = PatchTree::build(&primitives);
        let boxes = tree.nodes.iter().flat_map(|node| (0..WIDTH).map(move |l| (node, l)));
        let boxes: Vec<_> = boxes
            .filter(|(node, lane)| 0.0 <= node.radius[*lane])
            .map(|(node, lane)| (node, lane, places(&tree, node, lane)))
            .collect();
        let machine = Machine::builtin("mill-rotary").unwrap();
        let lever = Lever::new(&machine, boxes.iter().flat_map(|(.., places)| places).copied());
        let ball = Mill::straight(0.0, 6.0, 0.0);
        let mut n_checked = 0;
        for _ in 0..60 {
            let mut ends = [machine.at_rest(); 2];
            for (i, axis) in machine.axes.iter().enumerate().filter(|(i, _)| *i != machine.attack) {
                let is_linear = axis.kind == AxisKind::Linear;
                let [place, step] = if is_linear { [30.0, 6.0] } else { [3.0, 0.7] };
                ends[0][i] = place * random.random_range(-1.0..2.0);
                ends[1][i] = ends[0][i] + step * random.random_range(-1.0..1.0);
            }
            let motion = Motion::new(&lever, &ends[0], &ends[1]);
            let poses: Vec<_> = (0..=16)
                .map(|i| {
                    let at =
                        |k: usize| ends[0][k] + (ends[1][k] - ends[0][k]) * f64::from(i) / 16.0;
                    machine.attack_from_part(&AxisValues::from(std::array::from_fn(at)))
                })
                .collect();
            for (node, lane, places) in &boxes {
                let seen =
                    places.iter().flat_map(|place| poses.iter().map(move |pose| pose * place));
                let held = seen.filter_map(|at| Some(at.y + ball.height(at.x, at.z)?));
                let Some(highest) = held.reduce(f64::max) else { continue };
                // Nothing is told by how it bends, or by being low beyond: only by the plane.
                let limits = Limits {
                    gouge: highest - 1e-3,
                    deepest: f64::NEG_INFINITY,
                    bend: -1.0,
                    is_verdict: true,
                };
                let harmful = dispatch!(Level::new(), simd => {
                    Sweep::new(simd, &ball, &tree, &motion, [0.0; 2]).harmful_children(node, limits)
                });
                assert!(harmful >> lane & 1 == 1, "{highest} mm is thought too high");
                n_checked += 1;
            }
        }
        assert!(n_checked > 300, "{n_checked}");
    }

    /// Its middle passes by outside the ball; the end that the ball comes to is turned towards it.
    #[test]
    fn a_long_box_that_turns_aside_on_its_way_is_not_taken_to_pass_where_its_middle_does() {
        let half = 46.0;
        let corner = |x: f64, y: f64| Point3::new(x, y, 0.0);
        let needle = [corner(-half, -0.01), corner(half, -0.01), corner(0.0, 0.01)];
        let tree = PatchTree::build(&[needle]);
        let places = places(&tree, &tree.nodes[0], 0);
        let machine = Machine::builtin("mill-5axis").unwrap();
        let lever = Lever::new(&machine, places.iter().copied());
        let [x, y, c] = ['X', 'Y', 'C'].map(|letter| machine.axis_index(letter).unwrap());
        let ball = Mill::straight(0.0, 6.0, 0.0);
        let mut n_met = 0;
        for beside in [10.0, -10.0] {
            let at = |share: f64| {
                let mut words = machine.at_rest();
                (words[x], words[y], words[c]) = (share * half, beside, share * 0.1);
                words
            };
            let motion = Motion::new(&lever, &at(-1.0), &at(1.0));
            let poses = (-20..=20).map(|i| machine.attack_from_part(&at(f64::from(i) / 20.0)));
            let seen = poses.flat_map(|pose| places.iter().map(move |place| pose * place));
            let held = seen.filter_map(|at| Some(at.y + ball.height(at.x, at.z)?));
            let Some(highest) = held.reduce(f64::max) else { continue };
            let gouge = highest - 1e-3;
            let deepest = f64::NEG_INFINITY;
            let limits = Limits { gouge, deepest, bend: -1.0, is_verdict: true };
            let harmful = dispatch!(Level::new(), simd => {
                let sweep = Sweep::new(simd, &ball, &tree, &motion, [0.0; 2]);
                sweep.harmful_children(&tree.nodes[0], limits)
            });
            assert_eq!(harmful, 1, "{highest} mm is thought too high, {beside} mm beside");
            n_met += 1;
        }
        assert_eq!(n_met, 1);
    }
}
