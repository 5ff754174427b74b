//! How the part moves under the tool while all axes run from one position to the next.
//!
//! With the move's parameter `t` from 0 to 1 every word is linear in `t`, a linear axis shifts what
//! it carries at a constant rate and a rotary axis turns it at a constant rate. So where a part point
//! stands is a product of motions, and its derivatives follow by the product rule: the first two
//! exactly at the middle of the move, as affine functions of the point; the third bounded all over
//! it, by Leibniz' rule on lengths: `n` derivatives of a turn at rate `w` stretch a lever by `w^n`.

use crate::geom::{Matrix3, Point3, Vector3};
use crate::machine::{Axis, AxisKind, AxisValues, Carries, Machine};
use nalgebra::Rotation3;

/// Points of a search tree are rounded to `f32`, farther from the origin than this only beyond ten
/// metres [mm].
const ROUNDING: f64 = 1e-3;

/// What the part is on its machine: all a motion needs to know of its size.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lever<'a> {
    pub(super) machine: &'a Machine,
    /// The farthest point of the part from its origin [mm].
    radius: f64,
    /// The same from the centre line of the axis next to the part, if that is a rotary one [mm].
    swing: f64,
}

/// The part's motion during one move, seen from the tool.
#[derive(Debug, Clone, Copy)]
pub(super) struct Motion {
    /// Where a part point stands in the middle of the move.
    pub(super) place: Affine,
    /// How fast it moves there [mm per move].
    pub(super) velocity: Affine,
    /// How that changes there [mm per move, squared].
    pub(super) acceleration: Affine,
    /// No point's acceleration changes faster, anywhere on the move [mm per move, cubed].
    pub(super) jerk: f64,
}

/// An affine function of a point.
#[derive(Debug, Clone, Copy)]
pub(super) struct Affine {
    pub(super) linear: Matrix3,
    pub(super) shift: Vector3,
}

impl<'a> Lever<'a> {
    /// Of a part of these points.
    pub(super) fn new(machine: &'a Machine, points: impl Iterator<Item = Point3>) -> Self {
        let nearest = carrying(machine).last().filter(|(_, axis)| axis.kind == AxisKind::Rotary);
        let (mut radius, mut swing): (f64, f64) = (0.0, 0.0);
        for point in points {
            radius = radius.max(point.coords.norm());
            if let Some((_, axis)) = nearest {
                swing = swing.max(axis.direction.cross(&(point - axis.point)).norm());
            }
        }
        // What the points' own rounding may hide.
        Self { machine, radius: radius + ROUNDING, swing: swing + ROUNDING }
    }
}

impl Motion {
    /// From the words `from` to the words `to`; the attack axis stays at motion 0.
    pub(super) fn new(lever: &Lever, from: &AxisValues, to: &AxisValues) -> Self {
        let machine = lever.machine;
        let mut pose = Jet::STILL;
        for (i, axis) in carrying(machine) {
            if i != machine.attack {
                pose = pose.then(&Jet::of(axis, &axis.course(from[i], to[i])));
            }
        }
        let frame = machine.attack_from_machine().into_inner();
        let [mut place, mut velocity, mut acceleration] = pose.0;
        for (i, axis) in machine.axes.iter().enumerate() {
            if axis.carries == Carries::Tool && axis.follows.is_none() && i != machine.attack {
                let course = axis.course(from[i], to[i]);
                place.shift -= axis.direction * course.middle;
                velocity.shift -= axis.direction * course.rate;
            }
        }
        for affine in [&mut place, &mut velocity, &mut acceleration] {
            *affine = Affine { linear: frame * affine.linear, shift: frame * affine.shift };
        }
        Self { place, velocity, acceleration, jerk: jerk(lever, from, to) }
    }
}

impl Affine {
    const ZERO: Self = Self {
        linear: Matrix3::new(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
        shift: Vector3::new(0.0, 0.0, 0.0),
    };

    /// Of a point.
    pub(super) fn of(&self, point: &Point3) -> Vector3 {
        self.linear * point.coords + self.shift
    }
}

/// The axes between the machine's frame and the part, from the frame outwards.
fn carrying(machine: &Machine) -> impl DoubleEndedIterator<Item = (usize, &Axis)> {
    let axes = machine.axes.iter().enumerate();
    axes.filter(|(_, axis)| axis.carries == Carries::Part && axis.follows.is_none())
}

/// An axis' motion during a move.
struct Course {
    /// In the middle of the move [mm or rad].
    middle: f64,
    /// Over all of it [mm or rad].
    rate: f64,
    /// The greatest, either way [mm or rad].
    greatest: f64,
}

impl Axis {
    fn course(&self, from: f64, to: f64) -> Course {
        let (from, to) = (self.motion(from), self.motion(to));
        let greatest = from.abs().max(to.abs());
        Course { middle: f64::midpoint(from, to), rate: to - from, greatest }
    }
}

/// A motion in the middle of the move, with its first and second derivative.
struct Jet([Affine; 3]);

impl Jet {
    const STILL: Self = Self([
        Affine {
            linear: Matrix3::new(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0),
            shift: Vector3::new(0.0, 0.0, 0.0),
        },
        Affine::ZERO,
        Affine::ZERO,
    ]);

    fn of(axis: &Axis, course: &Course) -> Self {
        let mut jet = Self::STILL;
        match axis.kind {
            AxisKind::Linear => {
                jet.0[0].shift = axis.direction * course.middle;
                jet.0[1].shift = axis.direction * course.rate;
            }
            AxisKind::Rotary => {
                let turn = Rotation3::new(axis.direction * course.middle).into_inner();
                let spin = axis.direction.cross_matrix() * course.rate;
                let still = axis.point.coords;
                for (affine, linear) in
                    jet.0.iter_mut().zip([turn, spin * turn, spin * spin * turn])
                {
                    *affine = Affine { linear, shift: -(linear * still) };
                }
                jet.0[0].shift += still;
            }
        }
        jet
    }

    /// This motion of what `inner` has moved.
    fn then(&self, inner: &Self) -> Self {
        let [p, dp, ddp] = &self.0;
        let [q, dq, ddq] = &inner.0;
        // The outer shift belongs to the outer motion alone: to no derivative of the inner one.
        let product = |p: &Affine, q: &Affine| p.linear * q.linear;
        let carried = |p: &Affine, q: &Affine| p.linear * q.shift;
        Self([
            Affine { linear: product(p, q), shift: carried(p, q) + p.shift },
            Affine {
                linear: product(dp, q) + product(p, dq),
                shift: carried(dp, q) + carried(p, dq) + dp.shift,
            },
            Affine {
                linear: product(ddp, q) + product(dp, dq) * 2.0 + product(p, ddq),
                shift: carried(ddp, q) + carried(dp, dq) * 2.0 + carried(p, ddq) + ddp.shift,
            },
        ])
    }
}

/// The greatest third derivative of any part point's place, anywhere on the move.
fn jerk(lever: &Lever, from: &AxisValues, to: &AxisValues) -> f64 {
    let machine = lever.machine;
    let (mut radius, mut speed, mut acceleration, mut jerk) = (lever.radius, 0.0, 0.0, 0.0);
    // From the part outwards: distance from the origin, then derivatives.
    for (i_from_part, (i, axis)) in carrying(machine).rev().enumerate() {
        if i == machine.attack {
            continue;
        }
        let course = axis.course(from[i], to[i]);
        let rate = course.rate.abs();
        match axis.kind {
            AxisKind::Linear => {
                radius += course.greatest;
                speed += rate;
            }
            AxisKind::Rotary => {
                let away = axis.point.coords.norm();
                let arm = if i_from_part == 0 { lever.swing } else { radius + away };
                jerk += rate * (3.0 * acceleration + rate * (3.0 * speed + rate * arm));
                acceleration += rate * (2.0 * speed + rate * arm);
                speed += rate * arm;
                radius += 2.0 * away;
            }
        }
    }
    jerk
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::machine::MAX_AXES;
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    fn random_values(random: &mut Pcg64Mcg, size: f64) -> AxisValues {
        [0; MAX_AXES].map(|_| random.random_range(-size..size))
    }

    /// Random moves of a random point on every machine, the mill with both tables among them.
    fn on_every_machine(check: impl Fn(&Machine, &Lever, &Point3, &AxisValues, &AxisValues)) {
        let mut random = Pcg64Mcg::seed_from_u64(7);
        for name in Machine::builtin_names() {
            let machine = Machine::builtin(name).unwrap();
            for size in [0.01, 0.1, 1.0] {
                for _ in 0..40 {
                    let point = Point3::from([0; 3].map(|_| random.random_range(-80.0..80.0)));
                    let from = random_values(&mut random, 3.0);
                    let step = random_values(&mut random, size);
                    let to = std::array::from_fn(|i| from[i] + step[i]);
                    let lever = Lever::new(&machine, std::iter::once(point));
                    check(&machine, &lever, &point, &from, &to);
                }
            }
        }
    }

    fn seen(
        machine: &Machine,
        point: &Point3,
        from: &AxisValues,
        to: &AxisValues,
        t: f64,
    ) -> Vector3 {
        let values = std::array::from_fn(|i| from[i] + (to[i] - from[i]) * t);
        (machine.attack_from_part(&values) * point).coords
    }

    #[test]
    fn place_velocity_and_acceleration_are_those_of_the_poses() {
        on_every_machine(|machine, lever, point, from, to| {
            let motion = Motion::new(lever, from, to);
            let at = |t: f64| seen(machine, point, from, to, t);
            let h = 1e-3;
            let (before, middle, after) = (at(0.5 - h), at(0.5), at(0.5 + h));
            assert!((motion.place.of(point) - middle).norm() < 1e-9);
            // Central differences leave h^2 of the next derivatives, and rounding over h or h^2.
            let allowed = 1e-6 * (1.0 + motion.jerk) + 1e-9;
            let velocity = (after - before) / (2.0 * h);
            assert!((motion.velocity.of(point) - velocity).norm() < allowed);
            let acceleration = (after - middle * 2.0 + before) / (h * h);
            assert!((motion.acceleration.of(point) - acceleration).norm() < 100.0 * allowed);
        });
    }

    #[test]
    fn nowhere_on_a_move_does_the_acceleration_leave_its_bound() {
        on_every_machine(|machine, lever, point, from, to| {
            let motion = Motion::new(lever, from, to);
            let most = motion.acceleration.of(point).norm() + motion.jerk / 2.0;
            for i in 0..=20 {
                let (t, h) = (f64::from(i) / 20.0, 1e-3);
                let at = |t: f64| seen(machine, point, from, to, t);
                let there = (at(t + h) - at(t) * 2.0 + at(t - h)).norm() / (h * h);
                // The differences reach h beyond the ends.
                assert!(there <= most + 2.0 * h * motion.jerk + 1e-6, "{there} above {most}");
            }
        });
    }
}
