//! Turning a part on a tilted table: the constant-tilt way to five axes.
//!
//! A machine without a spindle whose table tilts can turn the part all the same: the table's last
//! rotary axis turns it, all others are held, and the tool goes along that axis' line as far as it
//! lies across the attack axis. What the line rises or falls, digitizing solves.

use super::contour::Across;
use crate::geom::Point3;
use crate::machine::{AxisKind, AxisValues, Carries, Machine};

/// The line must lie at least so far from the attack axis: the sine of 10 degrees.
const LEAST_SINE: f64 = 0.1736;

/// The line a part is turned about, as it lies under the tool.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TurnLine {
    /// The axis that turns the part.
    pub axis: usize,
    /// Where its zero lies across the attack axis [mm].
    origin: Across,
    /// A millimetre along it, across the attack axis.
    direction: Across,
    /// The height of its zero, and what it rises per millimetre [mm].
    height: [f64; 2],
}

/// Why a part cannot be turned on a table.
#[derive(Debug, thiserror::Error)]
pub enum TiltError {
    /// No axis turns the part.
    #[error("{machine} has no rotary axis that turns the part")]
    NoAxis {
        /// The machine.
        machine: String,
    },
    /// Turning it shows the tool no other side.
    #[error(
        "turning {axis} shows the tool no other side of the part while its line points {from:.0} \
         degrees off the attack axis: tilt the table by 10 degrees or more, as with --hold A=60"
    )]
    Upright {
        /// The axis that turns the part.
        axis: char,
        /// Between its line and the attack axis [deg].
        from: f64,
    },
}

impl TurnLine {
    /// The line of the innermost rotary axis under the part, all other axes at `rest`.
    pub fn of(machine: &Machine, rest: &AxisValues) -> Result<Self, TiltError> {
        let turns_part = |axis: &crate::machine::Axis| {
            axis.kind == AxisKind::Rotary && axis.carries == Carries::Part && axis.follows.is_none()
        };
        let no_axis = || TiltError::NoAxis { machine: machine.name.clone() };
        let axis = machine.axes.iter().rposition(turns_part).ok_or_else(no_axis)?;
        let turning = &machine.axes[axis];
        // The innermost axis lies still in the part's own frame.
        let pose = machine.attack_from_part(rest);
        let (origin, direction) = (pose * turning.point, pose.rotation * turning.direction);
        let line = Self {
            axis,
            origin: [origin.x, origin.z],
            direction: [direction.x, direction.z],
            height: [origin.y, direction.y],
        };
        if line.sine() < LEAST_SINE {
            let from = line.sine().asin().to_degrees();
            return Err(TiltError::Upright { axis: turning.letter, from });
        }
        Ok(line)
    }

    /// Where the tool stands across the attack axis at `station` along the line.
    pub fn at(&self, station: f64) -> Across {
        [0, 1].map(|k| self.origin[k] + station * self.direction[k])
    }

    /// The stations from which a tool reaches all of `points` as they turn, and `beyond` them
    /// across the attack axis [mm].
    ///
    /// A wall `rho` from the line leans towards the tool: its foot is met `rho` times the cotangent
    /// of the tilt earlier.
    pub fn stretch<'a>(
        &self,
        machine: &Machine,
        points: impl Iterator<Item = &'a Point3>,
        beyond: f64,
    ) -> [f64; 2] {
        let cotangent = self.height[1].abs() / self.sine();
        let beyond = beyond / self.sine();
        let [least, greatest] =
            points.fold([f64::INFINITY, f64::NEG_INFINITY], |[least, greatest], point| {
                let (station, from_line) = self.cylindrical(machine, point);
                [least.min(station - from_line * cotangent), greatest.max(station)]
            });
        [least - beyond, greatest + beyond]
    }

    /// The greatest height any of `points` reaches as they turn [mm].
    pub fn highest<'a>(&self, machine: &Machine, points: impl Iterator<Item = &'a Point3>) -> f64 {
        let heights = points.map(|point| {
            let (station, from_line) = self.cylindrical(machine, point);
            self.height[0] + station * self.height[1] + from_line * self.sine()
        });
        heights.fold(f64::NEG_INFINITY, f64::max)
    }

    /// The greatest distance of `points` from the line [mm].
    pub fn swing<'a>(&self, machine: &Machine, points: impl Iterator<Item = &'a Point3>) -> f64 {
        points.map(|point| self.cylindrical(machine, point).1).fold(0.0, f64::max)
    }

    /// How far along the line a part point lies, and how far from it [mm].
    fn cylindrical(&self, machine: &Machine, point: &Point3) -> (f64, f64) {
        let axis = &machine.axes[self.axis];
        let out = point - axis.point;
        let station = out.dot(&axis.direction);
        (station, (out - axis.direction * station).norm())
    }

    fn sine(&self) -> f64 {
        self.direction[0].hypot(self.direction[1])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tilted(angle_deg: f64) -> (Machine, AxisValues) {
        let machine = Machine::builtin("mill-5axis").unwrap();
        let mut rest = machine.at_rest();
        rest[machine.axis_index('A').unwrap()] = angle_deg.to_radians();
        (machine, rest)
    }

    #[test]
    fn a_level_table_shows_no_other_side() {
        let (machine, rest) = tilted(0.0);
        let error = TurnLine::of(&machine, &rest).unwrap_err().to_string();
        assert!(error.contains("turning C shows the tool no other side"), "{error}");
        let table = Machine::builtin("mill-3axis").unwrap();
        let error = TurnLine::of(&table, &table.at_rest()).unwrap_err().to_string();
        assert_eq!(error, "mill-3axis has no rotary axis that turns the part");
    }

    #[test]
    fn the_tool_stands_over_the_line_at_every_station() {
        for angle in [30.0, 60.0, 90.0] {
            let (machine, rest) = tilted(angle);
            let line = TurnLine::of(&machine, &rest).unwrap();
            for station in [-10.0, 0.0, 25.0] {
                let on_line = machine.attack_from_part(&rest) * Point3::new(0.0, 0.0, station);
                let [x, z] = line.at(station);
                assert!((x - on_line.x).abs() < 1e-9 && (z - on_line.z).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn no_turn_brings_a_point_higher_than_foreseen() {
        let (machine, mut rest) = tilted(50.0);
        let line = TurnLine::of(&machine, &rest).unwrap();
        let point = Point3::new(20.0, -7.0, 33.0);
        let foreseen = line.highest(&machine, std::iter::once(&point));
        let turned = (0..3600).map(|i| {
            rest[line.axis] = f64::from(i).to_radians() / 10.0;
            (machine.attack_from_part(&rest) * point).y
        });
        let highest = turned.fold(f64::NEG_INFINITY, f64::max);
        assert!(highest <= foreseen + 1e-9 && foreseen < highest + 1e-3);
    }
}
