//! From axis values to poses.
//!
//! The *attack frame* is the frame virtual digitizing works in: y along the attack axis, away from
//! the part; x along the spindle or first lateral direction; its origin moves with the tool's
//! programmed point, except along y.

use super::{AxisKind, AxisValues, Carries, MAX_AXES, Machine};
use crate::geom::{Matrix3, Pose, Vector3};
use nalgebra::{Rotation3, Translation3, Unit, UnitQuaternion};

impl Machine {
    /// Index of the axis called `letter`.
    pub fn axis_index(&self, letter: char) -> Option<usize> {
        self.axes.iter().position(|axis| axis.letter == letter)
    }

    /// Where the part stands: `machine_from_part` at `values`.
    pub fn machine_from_part(&self, values: &AxisValues) -> Pose {
        let carried = self
            .axes
            .iter()
            .zip(values)
            .filter(|(axis, _)| axis.carries == Carries::Part && axis.follows.is_none());
        carried.fold(Pose::identity(), |pose, (axis, &word)| {
            let motion = axis.motion(word);
            pose * match axis.kind {
                AxisKind::Linear => Pose::from_parts(
                    Translation3::from(axis.direction * motion),
                    UnitQuaternion::identity(),
                ),
                AxisKind::Rotary => {
                    let turn = UnitQuaternion::from_axis_angle(
                        &Unit::new_unchecked(axis.direction),
                        motion,
                    );
                    Pose::rotation_wrt_point(turn, axis.point)
                }
            }
        })
    }

    /// Where the tool's programmed point stands in the machine frame at `values` [mm].
    pub fn tool_point(&self, values: &AxisValues) -> Vector3 {
        self.axes
            .iter()
            .zip(values)
            .filter(|(axis, _)| axis.carries == Carries::Tool && axis.follows.is_none())
            .map(|(axis, &word)| axis.direction * axis.motion(word))
            .sum()
    }

    /// The way from the part to the tool along the attack axis, in the machine frame.
    pub fn attack_direction(&self) -> Vector3 {
        let axis = &self.axes[self.attack];
        match axis.carries {
            Carries::Tool => axis.direction,
            Carries::Part => -axis.direction,
        }
    }

    /// Rotation from the machine frame to the attack frame: y is the attack direction, x stays as
    /// close to the machine's X as it can.
    pub fn attack_from_machine(&self) -> Rotation3<f64> {
        let y = self.attack_direction();
        let seed = if y.x.abs() < 0.9 { Vector3::x() } else { Vector3::y() };
        let x = (seed - y * y.dot(&seed)).normalize();
        let z = x.cross(&y);
        Rotation3::from_matrix_unchecked(Matrix3::from_rows(&[
            x.transpose(),
            y.transpose(),
            z.transpose(),
        ]))
    }

    /// Where a part point lies under the tool at `values`, with the attack axis at motion 0: the
    /// pose virtual digitizing solves the attack motion for.
    pub fn attack_from_part(&self, values: &AxisValues) -> Pose {
        let mut rest = *values;
        rest[self.attack] = self.axes[self.attack].word(0.0);
        let shift = Translation3::from(-self.tool_point(&rest));
        let rotation = UnitQuaternion::from_rotation_matrix(&self.attack_from_machine());
        Pose::from_parts(Translation3::identity(), rotation) * shift * self.machine_from_part(&rest)
    }

    /// The words of all axes at motion 0.
    pub fn at_rest(&self) -> AxisValues {
        let mut values = [0.0; MAX_AXES];
        for (value, axis) in values.iter_mut().zip(&self.axes) {
            *value = axis.word(0.0);
        }
        values
    }

    /// `values` with every following axis set from its leader.
    #[must_use]
    pub fn with_followers(&self, values: &AxisValues) -> AxisValues {
        let mut all = *values;
        for (index, axis) in self.axes.iter().enumerate().take(MAX_AXES) {
            if let Some(follow) = axis.follows {
                let lead = self.axes[follow.leader].motion(values[follow.leader]);
                all[index] = axis.word(follow.ratio * lead);
            }
        }
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Point3;
    use crate::machine::Follow;
    use std::f64::consts::FRAC_PI_2;

    /// Rotations by a quarter turn leave this much rounding on a metre.
    const EPS: f64 = 1e-9;

    /// The values of the embedded machine `name` from its `words`, all others 0 [mm and deg].
    fn at(machine: &Machine, words: &[(char, f64)]) -> AxisValues {
        let mut values = [0.0; MAX_AXES];
        for &(letter, word) in words {
            let index = machine.axis_index(letter).unwrap();
            let rotary = machine.axes[index].kind == AxisKind::Rotary;
            values[index] = if rotary { word.to_radians() } else { word };
        }
        values
    }

    /// `rows`: a rotation and, last in each row, a displacement, worked out by hand.
    fn assert_pose(pose: &Pose, rows: [[f64; 4]; 3]) {
        let matrix = pose.to_homogeneous();
        for (i, row) in rows.iter().enumerate() {
            for (j, expected) in row.iter().enumerate() {
                assert!((matrix[(i, j)] - expected).abs() < EPS, "{matrix} is not {rows:?}");
            }
        }
    }

    #[test]
    fn a_last_lathe_turns_the_part_about_x_against_the_word() {
        for name in ["last-lathe", "last-lathe-cone", "last-lathe-pair"] {
            let lathe = Machine::builtin(name).unwrap();
            let values = at(&lathe, &[('X', 30.0), ('Y', 150.0), ('A', 90.0)]);
            // c = -90 degrees: y' = z, z' = -y.
            assert_pose(
                &lathe.machine_from_part(&values),
                [[1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, -1.0, 0.0, 0.0]],
            );
            assert_eq!(lathe.tool_point(&values), Vector3::new(30.0, 150.0, 0.0));
            assert_eq!(lathe.attack_direction(), Vector3::y());
            // The attack frame is the machine's, moved to the wheel but for Y.
            assert_pose(
                &lathe.attack_from_part(&values),
                [[1.0, 0.0, 0.0, -30.0], [0.0, 0.0, 1.0, 0.0], [0.0, -1.0, 0.0, 0.0]],
            );
        }
    }

    #[test]
    fn a_last_lathe_follows_the_design_at_any_angle() {
        let lathe = Machine::builtin("last-lathe").unwrap();
        let part = Point3::new(12.0, 34.0, -5.0);
        for angle_deg in [-400.0, -30.0, 0.0, 17.0, 3600.0] {
            let turned = lathe.machine_from_part(&at(&lathe, &[('A', angle_deg)])) * part;
            // y' = y cos c - z sin c, z' = y sin c + z cos c, A = -c.
            let (sin, cos) = (-angle_deg).to_radians().sin_cos();
            let expected =
                Point3::new(part.x, part.y * cos - part.z * sin, part.y * sin + part.z * cos);
            assert!((turned - expected).norm() < EPS, "{angle_deg}: {turned} is not {expected}");
        }
    }

    #[test]
    fn a_mill_with_a_rotary_table_moves_the_part_under_the_tool() {
        let mill = Machine::builtin("mill-rotary").unwrap();
        let values = at(&mill, &[('X', 30.0), ('Y', 5.0), ('Z', 80.0), ('A', 90.0)]);
        assert_pose(
            &mill.machine_from_part(&values),
            [[1.0, 0.0, 0.0, -30.0], [0.0, 0.0, 1.0, -5.0], [0.0, -1.0, 0.0, 0.0]],
        );
        assert_eq!(mill.tool_point(&values), Vector3::new(0.0, 0.0, 80.0));
        assert_eq!(mill.attack_direction(), Vector3::z());
        // Attack x = X, y = Z, z = -Y of the machine.
        assert_pose(
            &mill.attack_from_part(&values),
            [[1.0, 0.0, 0.0, -30.0], [0.0, -1.0, 0.0, 0.0], [0.0, 0.0, -1.0, 5.0]],
        );
    }

    #[test]
    fn a_portal_mill_moves_only_the_tool() {
        let mill = Machine::builtin("mill-3axis").unwrap();
        let values = at(&mill, &[('X', 30.0), ('Y', 5.0), ('Z', 80.0)]);
        assert_eq!(mill.machine_from_part(&values), Pose::identity());
        assert_eq!(mill.tool_point(&values), Vector3::new(30.0, 5.0, 80.0));
        assert_pose(
            &mill.attack_from_part(&values),
            [[1.0, 0.0, 0.0, -30.0], [0.0, 0.0, 1.0, 0.0], [0.0, -1.0, 0.0, 5.0]],
        );
    }

    #[test]
    fn a_trunnion_tilts_the_turntable_about_its_own_height() {
        let mill = Machine::builtin("mill-5axis").unwrap();
        let values = at(&mill, &[('X', 7.0), ('Y', 8.0), ('Z', 9.0), ('A', 90.0), ('C', 90.0)]);
        // C turns the part by -90 degrees about Z: (x, y, z) -> (y, -x, z); then A by -90 degrees
        // about the line y = 0, z = 60: (x, y, z) -> (x, z - 60, 60 - y).
        assert_pose(
            &mill.machine_from_part(&values),
            [[0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, -60.0], [1.0, 0.0, 0.0, 60.0]],
        );
        assert_eq!(mill.tool_point(&values), Vector3::new(7.0, 8.0, 9.0));
        // From there to the tool but for Z, then attack x = X, y = Z, z = -Y.
        assert_pose(
            &mill.attack_from_part(&values),
            [[0.0, 1.0, 0.0, -7.0], [1.0, 0.0, 0.0, 60.0], [0.0, 0.0, -1.0, 68.0]],
        );
    }

    #[test]
    fn the_attack_frame_is_right_handed_with_y_along_the_attack_on_every_machine() {
        for name in Machine::builtin_names() {
            let machine = Machine::builtin(name).unwrap();
            let rotation = machine.attack_from_machine();
            assert!((rotation.matrix().determinant() - 1.0).abs() < EPS, "{name}");
            assert!((rotation * machine.attack_direction() - Vector3::y()).norm() < EPS, "{name}");
            assert!((rotation * Vector3::x() - Vector3::x()).norm() < EPS, "{name}");
        }
    }

    #[test]
    fn more_of_the_attack_word_takes_the_tool_away_from_the_part_on_every_machine() {
        for name in Machine::builtin_names() {
            let machine = Machine::builtin(name).unwrap();
            let letter = machine.axes[machine.attack].letter;
            let near = tool_seen_from_part(&machine, &at(&machine, &[(letter, 50.0)]));
            let far = tool_seen_from_part(&machine, &at(&machine, &[(letter, 60.0)]));
            assert!((far - near - machine.attack_direction() * 10.0).norm() < EPS, "{name}");
        }
    }

    #[test]
    fn a_positive_word_moves_the_tool_the_iso_841_way_seen_from_the_part_on_every_machine() {
        for name in Machine::builtin_names() {
            let machine = Machine::builtin(name).unwrap();
            for axis in machine.axes.iter().filter(|axis| axis.follows.is_none()) {
                let letter = axis.letter;
                let frame = iso_841_direction(letter);
                let before = at(&machine, &[]);
                match axis.kind {
                    AxisKind::Linear => {
                        let after = at(&machine, &[(letter, 10.0)]);
                        let moved = tool_seen_from_part(&machine, &after)
                            - tool_seen_from_part(&machine, &before);
                        assert!((moved - frame * 10.0).norm() < EPS, "{name} {letter}");
                    }
                    AxisKind::Rotary => {
                        let after = at(&machine, &[(letter, 90.0)]);
                        let part_from_machine = machine.machine_from_part(&after).inverse();
                        let turn = part_from_machine.rotation.scaled_axis();
                        assert!((turn - frame * FRAC_PI_2).norm() < EPS, "{name} {letter}");
                    }
                }
            }
        }
    }

    #[test]
    fn the_second_spindle_of_a_pair_turns_against_the_first() {
        let lathe = Machine::builtin("last-lathe-pair").unwrap();
        let driven = at(&lathe, &[('X', 1.0), ('Y', 2.0), ('A', 75.0), ('B', 999.0)]);
        let all = lathe.with_followers(&driven);
        assert!((all[lathe.axis_index('B').unwrap()] + 75.0_f64.to_radians()).abs() < EPS);
        assert_eq!(all[..3], driven[..3]);
        // The second spindle has its own part; it does not turn the first.
        assert_eq!(lathe.machine_from_part(&all), lathe.machine_from_part(&driven));
    }

    #[test]
    fn a_follower_copies_the_motion_and_not_the_word() {
        let mut lathe = Machine::builtin("last-lathe-pair").unwrap();
        let [a, b] = ['A', 'B'].map(|letter| lathe.axis_index(letter).unwrap());
        lathe.axes[a].zero = 0.5;
        (lathe.axes[b].zero, lathe.axes[b].sign) = (0.25, 1.0);
        lathe.axes[b].follows = lathe.axes[b].follows.map(|f| Follow { ratio: 3.0, ..f });
        let mut values = [0.0; MAX_AXES];
        values[a] = 0.7;
        // Motion of A: (0.7 - 0.5) * -1 = -0.2; of B: -0.6; word of B: 0.25 - 0.6.
        assert!((lathe.with_followers(&values)[b] + 0.35).abs() < EPS);
    }

    #[test]
    fn a_table_that_attacks_counts_as_the_tool_coming_from_the_other_side() {
        let text = Machine::builtin_text("last-lathe").unwrap();
        // The part goes down, away from the tool, as Y grows.
        let text = text.replace(
            "carries = \"tool\"\ndirection = [0, 1, 0]",
            "carries = \"part\"\ndirection = [0, -1, 0]",
        );
        let table = Machine::parse(&text, "table.toml").unwrap();
        let lathe = Machine::builtin("last-lathe").unwrap();
        assert_eq!(table.axes[table.attack].carries, Carries::Part);
        let values = at(&lathe, &[('X', 30.0), ('Y', 150.0), ('A', 33.0)]);
        assert_eq!(table.attack_direction(), lathe.attack_direction());
        let [ours, theirs] = [&table, &lathe].map(|m| m.attack_from_part(&values));
        assert!((ours.to_homogeneous() - theirs.to_homogeneous()).norm() < EPS);
        let [ours, theirs] = [&table, &lathe].map(|m| tool_seen_from_part(m, &values));
        assert!((ours - theirs).norm() < EPS);
    }

    /// The direction an axis of this letter has by ISO 841.
    fn iso_841_direction(letter: char) -> Vector3 {
        match letter {
            'X' | 'A' => Vector3::x(),
            'Y' | 'B' => Vector3::y(),
            'Z' | 'C' => Vector3::z(),
            other => panic!("no embedded machine has an axis {other}"),
        }
    }

    fn tool_seen_from_part(machine: &Machine, values: &AxisValues) -> Point3 {
        machine.machine_from_part(values).inverse() * Point3::from(machine.tool_point(values))
    }
}
