//! Where a tool stands, as the part sees it.

use crate::geom::{Point3, Vector3};
use crate::machine::{AxisValues, Machine};

/// Where a tool stands, in the part's frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stance {
    /// The tool's programmed point: the centre of a wheel, the tip of other tools [mm].
    pub point: Point3,
    /// Unit vector from the part to the tool along the attack axis.
    pub attack: Vector3,
}

impl Stance {
    /// Where the tool of `machine` stands at `values`.
    pub fn at(machine: &Machine, values: &AxisValues) -> Self {
        let part_from_machine = machine.machine_from_part(values).inverse();
        Self {
            point: part_from_machine * Point3::from(machine.tool_point(values)),
            attack: part_from_machine * machine.attack_direction(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turned_part_sees_the_tool_go_round_it_the_other_way() {
        let lathe = Machine::builtin("last-lathe").unwrap();
        // A = 90 degrees is c = -90: what lies at z' = -y of the part comes under the tool.
        let stance = Stance::at(&lathe, &[30.0, 150.0, 90_f64.to_radians(), 0.0, 0.0, 0.0]);
        assert!((stance.point - Point3::new(30.0, 0.0, 150.0)).norm() < 1e-9, "{stance:?}");
        assert!((stance.attack - Vector3::z()).norm() < 1e-9, "{stance:?}");
    }
}
