//! Which axes a trajectory moves, and which way.

use super::{Strategy, TrajectoryError};
use crate::cam::tilt::TurnLine;
use crate::machine::{Axis, AxisKind, AxisValues, Carries, MAX_AXES, Machine};

/// Which axes a trajectory moves, and which way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Drives {
    /// Along the attack frame's x.
    pub(super) along: Drive,
    /// Along the attack frame's z.
    pub(super) across: Option<Drive>,
    /// The part's turn about X, or about `line`.
    pub(super) turn: Option<Drive>,
    /// The line of a tilted table, which lies along neither `along` nor `across`.
    pub(super) line: Option<TurnLine>,
}

/// An axis, and its motion per unit of what it drives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Drive {
    pub(super) axis: usize,
    pub(super) sense: f64,
}

impl Drives {
    /// Those `strategy` needs, where the axes that it does not drive stand at `rest`.
    pub(super) fn of(
        machine: &Machine,
        strategy: Strategy,
        rest: &AxisValues,
    ) -> Result<Self, TrajectoryError> {
        let frame = machine.attack_from_machine();
        let linear = |toward: usize| {
            let free = |(index, axis): &(usize, &Axis)| {
                *index != machine.attack
                    && axis.kind == AxisKind::Linear
                    && axis.follows.is_none()
                    && (frame * axis.direction)[toward].abs() > 0.999
            };
            let (axis, found) = machine.axes.iter().enumerate().take(MAX_AXES).find(free)?;
            let sense = (frame * found.direction)[toward].signum();
            // Moving the part is moving the tool the other way.
            let sense = if found.carries == Carries::Part { -sense } else { sense };
            Some(Drive { axis, sense })
        };
        let turn = machine.spindle.map(|axis| {
            let sense = machine.axes[axis].direction.x.signum();
            Drive { axis, sense }
        });
        let missing =
            |axis| TrajectoryError::NoAxis { machine: machine.name.clone(), strategy, axis };
        let along = linear(0).ok_or_else(|| missing("linear axis along X"))?;
        let across = linear(2);
        match strategy {
            Strategy::Raster | Strategy::Contour if across.is_none() => {
                Err(missing("linear axis across X and the attack axis"))
            }
            Strategy::Helix | Strategy::Rings | Strategy::Lines if turn.is_none() => {
                let tilt = |source| TrajectoryError::Tilt { strategy, source };
                let line = TurnLine::of(machine, rest).map_err(tilt)?;
                if across.is_none() {
                    return Err(missing("linear axis across X and the attack axis"));
                }
                let turn = Some(Drive { axis: line.axis, sense: 1.0 });
                Ok(Self { along, across, turn, line: Some(line) })
            }
            _ => Ok(Self { along, across, turn, line: None }),
        }
    }
}
