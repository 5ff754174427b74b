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
