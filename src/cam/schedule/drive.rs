//! What an axis can do, as plain numbers.

use crate::machine::{AxisKind, Machine};

/// How far a control that keeps its speed may round a corner: 0.01 mm is what GRBL's junction
/// deviation has by default and what G64 P0.01 asks of LinuxCNC. 0.01 degrees are as much at 57 mm.
const ROUNDING_MM: f64 = 0.01;
const ROUNDING_DEG: f64 = 0.01;

/// The drive of one axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drive {
    /// Greatest speed [mm/s or rad/s].
    pub velocity: f64,
    /// Greatest acceleration [mm/s2 or rad/s2].
    pub acceleration: f64,
    /// How far it may cut a corner short to keep its speed [mm or rad].
    pub rounding: f64,
}

/// The drives of all axes of `machine`, followers too.
pub fn drives(machine: &Machine) -> Vec<Drive> {
    let axes = machine.axes.iter().map(|axis| Drive {
        velocity: axis.velocity,
        acceleration: axis.acceleration,
        rounding: match axis.kind {
            AxisKind::Linear => ROUNDING_MM,
            AxisKind::Rotary => ROUNDING_DEG.to_radians(),
        },
    });
    axes.collect()
}
