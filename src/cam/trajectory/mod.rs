//! Trajectories: every axis but the attack axis, position by position.
//!
//! On a machine with a spindle the tool runs around the part in a helix, in rings, or along it in
//! lines; a table that is tilted lets it do the same. On a table it runs over the part in raster
//! lines. Such a trajectory is a formula, not a list; only one along contours is listed.

mod drives;
mod error;
mod spacing;

use super::contour::Across;
use crate::machine::{AxisValues, Machine};
use drives::{Drive, Drives};
use spacing::MOST_POSITIONS;
use std::f64::consts::TAU;

pub use error::TrajectoryError;
pub use spacing::Spacing;

/// How the tool runs over the part.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize, clap::ValueEnum,
)]
#[serde(rename_all = "kebab-case")]
pub enum Strategy {
    /// Around the part and along it at once, as last lathes do; a full ring at either end.
    Helix,
    /// Full rings, one pitch apart.
    Rings,
    /// Lines along the spindle, back and forth, the part turned between them.
    Lines,
    /// Lines along X, back and forth, one pitch apart.
    Raster,
    /// Rings parallel to the part's outline on the table, one pitch apart, from outside inwards.
    Contour,
}

/// A trajectory on a machine.
#[derive(Debug, Clone, PartialEq)]
pub struct Trajectory<'a> {
    machine: &'a Machine,
    drives: Drives,
    /// Words of the axes no drive moves.
    rest: AxisValues,
    strategy: Strategy,
    spacing: Spacing,
    /// Ends of a line along X [mm].
    along: [f64; 2],
    /// Where a run along contours goes; empty for all others.
    contour: Vec<Across>,
}

impl<'a> Trajectory<'a> {
    /// A run of `strategy` over X from `along[0]` to `along[1]`, axes it does not drive at `rest`.
    pub fn new(
        machine: &'a Machine,
        strategy: Strategy,
        along: [f64; 2],
        spacing: Spacing,
        rest: &AxisValues,
    ) -> Result<Self, TrajectoryError> {
        let drives = Drives::of(machine, strategy, rest)?;
        let positive = [("step", spacing.step), ("points per turn", f64::from(spacing.per_turn))];
        for (what, value) in positive {
            if !(value > 0.0 && value.is_finite()) {
                return Err(TrajectoryError::NotPositive { what, value });
            }
        }
        let contour = Vec::new();
        let run = Self { machine, drives, rest: *rest, strategy, spacing, along, contour };
        let positions = run.rows() as f64 * run.per_row();
        if positions > MOST_POSITIONS {
            return Err(TrajectoryError::TooMany { positions, most: MOST_POSITIONS });
        }
        Ok(run)
    }

    /// A run through the points of `contour`, axes it does not drive at `rest`.
    pub fn through(
        machine: &'a Machine,
        contour: Vec<Across>,
        spacing: Spacing,
        rest: &AxisValues,
    ) -> Result<Self, TrajectoryError> {
        let strategy = Strategy::Contour;
        let drives = Drives::of(machine, strategy, rest)?;
        let range = |[low, high]: [f64; 2], point: &Across| [low.min(point[0]), high.max(point[0])];
        let along = contour.iter().fold([f64::INFINITY, f64::NEG_INFINITY], range);
        Ok(Self { machine, drives, rest: *rest, strategy, spacing, along, contour })
    }

    /// Number of positions.
    pub fn n_positions(&self) -> usize {
        if self.strategy == Strategy::Contour {
            return self.contour.len();
        }
        let extra = usize::from(self.strategy == Strategy::Helix);
        self.rows() * self.per_row() as usize + extra
    }

    /// The axis values of position `i`; the attack axis is left at rest.
    pub fn values(&self, i: usize) -> AxisValues {
        let per_row = self.per_row() as usize;
        let (row, place) = (i / per_row, i % per_row);
        let share = place as f64 / (per_row - 1).max(1) as f64;
        let stations = &self.spacing.stations;
        let back_and_forth = |row: usize| if row.is_multiple_of(2) { share } else { 1.0 - share };
        let on_line = |share: f64| self.along[0] + (self.along[1] - self.along[0]) * share;
        let mut values = self.rest;
        match self.strategy {
            Strategy::Helix => {
                let turns = i as f64 / f64::from(self.spacing.per_turn);
                self.go_along(&mut values, self.helix_x(turns));
                self.set(&mut values, self.drives.turn, TAU * turns);
            }
            Strategy::Rings => {
                self.go_along(&mut values, stations[row]);
                self.set(&mut values, self.drives.turn, TAU * (row as f64 + share));
            }
            Strategy::Lines => {
                let angle = TAU * row as f64 / f64::from(self.spacing.per_turn);
                self.go_along(&mut values, on_line(back_and_forth(row)));
                self.set(&mut values, self.drives.turn, angle);
            }
            Strategy::Raster => {
                self.set(&mut values, Some(self.drives.along), on_line(back_and_forth(row)));
                self.set(&mut values, self.drives.across, stations[row]);
            }
            Strategy::Contour => {
                let [x, z] = self.contour[i];
                self.set(&mut values, Some(self.drives.along), x);
                self.set(&mut values, self.drives.across, z);
            }
        }
        values
    }

    /// The machine it runs on.
    pub fn machine(&self) -> &'a Machine {
        self.machine
    }

    /// How it runs over the part.
    pub fn strategy(&self) -> Strategy {
        self.strategy
    }

    /// How far apart its positions and lines are.
    pub fn spacing(&self) -> &Spacing {
        &self.spacing
    }

    /// The stretch of X it runs over [mm].
    pub fn along(&self) -> [f64; 2] {
        self.along
    }

    /// The distance of neighbouring turns, rings or rows at position `i` [mm].
    pub fn pitch_at(&self, i: usize) -> f64 {
        let stations = &self.spacing.stations;
        let row = (i / self.per_row() as usize).clamp(1, (stations.len() - 1).max(1));
        stations.get(row).map_or(0.0, |x| x - stations[row - 1])
    }

    /// How many positions make a turn, a ring or a line.
    pub fn per_row(&self) -> f64 {
        match self.strategy {
            Strategy::Helix => f64::from(self.spacing.per_turn),
            Strategy::Rings => f64::from(self.spacing.per_turn) + 1.0,
            Strategy::Contour => self.contour.len().max(1) as f64,
            Strategy::Lines | Strategy::Raster => {
                ((self.along[1] - self.along[0]) / self.spacing.step).ceil().max(1.0) + 1.0
            }
        }
    }

    fn rows(&self) -> usize {
        match self.strategy {
            // A ring before the first station and one after the last.
            Strategy::Helix => self.spacing.stations.len() + 1,
            Strategy::Lines => self.spacing.per_turn as usize,
            Strategy::Rings | Strategy::Raster => self.spacing.stations.len(),
            Strategy::Contour => 1,
        }
    }

    /// Along a helix each turn runs from one station to the next; the first and the last stand.
    fn helix_x(&self, turns: f64) -> f64 {
        let stations = &self.spacing.stations;
        let whole = (turns.floor() as usize).min(stations.len());
        let last = stations.len() - 1;
        let (from, to) = (stations[whole.saturating_sub(1)], stations[whole.min(last)]);
        from + (to - from) * (turns - whole as f64)
    }

    /// Over `station` of the line the part turns about.
    fn go_along(&self, values: &mut AxisValues, station: f64) {
        let Some(line) = &self.drives.line else {
            self.set(values, Some(self.drives.along), station);
            return;
        };
        let [x, z] = line.at(station);
        self.set(values, Some(self.drives.along), x);
        self.set(values, self.drives.across, z);
    }

    fn set(&self, values: &mut AxisValues, drive: Option<Drive>, position: f64) {
        if let Some(Drive { axis, sense }) = drive {
            values[axis] = self.machine.axes[axis].word(sense * position);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lathe() -> Machine {
        Machine::builtin("last-lathe").unwrap()
    }

    fn spacing(pitch: f64) -> Spacing {
        Spacing { per_turn: 4, step: 1.0, stations: Spacing::even(10.0, 20.0, pitch).unwrap() }
    }

    #[test]
    fn a_helix_begins_and_ends_with_a_ring() {
        let machine = lathe();
        let run = Trajectory::new(&machine, Strategy::Helix, [10.0, 20.0], spacing(5.0), &[0.0; 6])
            .unwrap();
        // Two turns of pitch 5 between two rings.
        assert_eq!(run.n_positions(), 4 * 4 + 1);
        let x = |i: usize| run.values(i)[0];
        assert_eq!([x(0), x(4), x(6), x(8), x(12), x(16)], [10.0, 10.0, 12.5, 15.0, 20.0, 20.0]);
        // Unwound, and a part-carrying axis of sign -1 counts down as the part turns up.
        assert!((run.values(16)[2] + 4.0 * TAU).abs() < 1e-12);
    }

    #[test]
    fn rings_close_and_lines_go_back_and_forth() {
        let machine = lathe();
        let rings =
            Trajectory::new(&machine, Strategy::Rings, [10.0, 20.0], spacing(10.0), &[0.0; 6])
                .unwrap();
        assert_eq!(rings.n_positions(), 2 * 5);
        assert_eq!(rings.values(4)[2], rings.values(5)[2]);
        let lines =
            Trajectory::new(&machine, Strategy::Lines, [10.0, 20.0], spacing(10.0), &[0.0; 6])
                .unwrap();
        assert_eq!(lines.n_positions(), 4 * 11);
        assert_eq!([lines.values(10)[0], lines.values(11)[0]], [20.0, 20.0]);
    }

    #[test]
    fn a_raster_needs_an_axis_across() {
        let machine = lathe();
        let error =
            Trajectory::new(&machine, Strategy::Raster, [10.0, 20.0], spacing(5.0), &[0.0; 6])
                .unwrap_err();
        assert!(error.to_string().contains("no linear axis across X"), "{error}");
    }
}
