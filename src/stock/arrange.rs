//! Rays through a block: about a spindle, about the axis of a table that turns, or along the tool.

use super::StockError;
use super::layout::{GROUP, Kind, Layout, Resolution, TILE, TILT};
use crate::geom::{Aabb, Point3, Pose, Vector3};
use crate::machine::{AxisValues, Machine, Mount};
use nalgebra::{Translation3, UnitQuaternion};
use std::f64::consts::{PI, TAU};

/// More dexels than this are refused: 500 MB with all that belongs to them.
const MOST_DEXELS: f64 = 2.5e7;
impl Layout {
    /// Rays through all of `block`, a box in the part's frame, for `machine` with its rotary axes as
    /// in `values` (which matters on a table only).
    pub fn new(
        machine: &Machine,
        values: &AxisValues,
        block: &Aabb,
        resolution: Resolution,
    ) -> Result<Self, StockError> {
        Self::check(block, resolution)?;
        match machine.spindle {
            Some(spindle) => {
                let axis = &machine.axes[spindle].point;
                let out = |corner: Point3| (corner.y - axis.y).hypot(corner.z - axis.z);
                let radius = corners(block).map(out).into_iter().fold(0.0, f64::max);
                Self::turned(axis, [block.min.x, block.max.x], radius, resolution)
            }
            None => Self::on_table(machine, values, block, resolution),
        }
    }

    /// Rays through a round block about the spindle axis of `machine`, from `x[0]` to `x[1]`; `None`
    /// on a machine without a spindle.
    pub fn round(
        machine: &Machine,
        x: [f64; 2],
        radius: f64,
        resolution: Resolution,
    ) -> Option<Result<Self, StockError>> {
        let axis = &machine.axes[machine.spindle?].point;
        let block = Aabb {
            min: Point3::new(x[0], axis.y - radius, axis.z - radius),
            max: Point3::new(x[1], axis.y + radius, axis.z + radius),
        };
        let checked = Self::check(&block, resolution);
        Some(checked.and_then(|()| Self::turned(axis, x, radius, resolution)))
    }

    /// Rays through all of `block`, a box in the part's frame, away from the line of `axis`: the
    /// innermost rotary axis under the part, which turns while all others are as in `values`. The
    /// tool may lean along it, if it is an end mill.
    pub fn about(
        machine: &Machine,
        values: &AxisValues,
        axis: usize,
        block: &Aabb,
        resolution: Resolution,
    ) -> Result<Self, StockError> {
        Self::check(block, resolution)?;
        let turning = &machine.axes[axis];
        let turn = UnitQuaternion::rotation_between(&turning.direction, &Vector3::x())
            .unwrap_or_else(|| UnitQuaternion::from_axis_angle(&Vector3::y_axis(), PI));
        let line = turn * turning.point;
        // X counts from where the machine has its own zero.
        let rays_from_part = Pose::from_parts(Translation3::new(0.0, -line.y, -line.z), turn);
        let part_from_machine = machine.machine_from_part(values).inverse();
        let attack = turn * (part_from_machine * machine.attack_direction());
        let lean = attack.x.clamp(-1.0, 1.0).asin();
        if machine.mount != Mount::Along && lean.abs() > TILT {
            return Err(StockError::Tilted { angle_deg: lean.to_degrees() });
        }
        let seen = corners(block).map(|corner| rays_from_part * corner);
        let x = Aabb::around(&seen);
        let radius = seen.iter().map(|corner| corner.y.hypot(corner.z)).fold(0.0, f64::max);
        let round = Self::turned(&Point3::origin(), [x.min.x, x.max.x], radius, resolution)?;
        Ok(Self { rays_from_part, turner: Some(axis), lean, ..round })
    }

    fn check(block: &Aabb, resolution: Resolution) -> Result<(), StockError> {
        for value in [resolution.along, resolution.across] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(StockError::Resolution { value });
            }
        }
        let size = block.size();
        if block.is_empty() || !size.iter().all(|side| side.is_finite()) || size.min() <= 0.0 {
            return Err(StockError::Empty);
        }
        Ok(())
    }

    fn turned(
        axis: &Point3,
        [from, to]: [f64; 2],
        top: f64,
        resolution: Resolution,
    ) -> Result<Self, StockError> {
        let n_columns = (TAU * top / resolution.across).ceil().max(1.0);
        let n_rows = rows(from, to, resolution.along);
        fits(n_rows * n_columns, resolution)?;
        let n_columns = (n_columns as usize).next_multiple_of(TILE);
        let step = TAU / n_columns as f64;
        let (sin, cos): (Vec<f64>, Vec<f64>) =
            (0..n_columns).map(|column| (step * column as f64).sin_cos()).unzip();
        let n_edges = (n_columns / TILE).next_multiple_of(GROUP) + 1;
        let edges = [&cos, &sin]
            .map(|turns| (0..n_edges).map(|tile| turns[tile * TILE % n_columns]).collect());
        Ok(Self {
            kind: Kind::Turned,
            along: [from, (to - from) / (n_rows - 1.0)],
            n_rows: n_rows as usize,
            across: [0.0, step],
            n_columns,
            floor: 0.0,
            top,
            rays_from_part: Pose::translation(0.0, -axis.y, -axis.z),
            turner: None,
            lean: 0.0,
            turns: [cos, sin],
            edges,
        })
    }

    fn on_table(
        machine: &Machine,
        values: &AxisValues,
        block: &Aabb,
        resolution: Resolution,
    ) -> Result<Self, StockError> {
        let turn = UnitQuaternion::from_rotation_matrix(&machine.attack_from_machine())
            * machine.machine_from_part(values).rotation;
        let rays_from_part = Pose::from_parts(Translation3::identity(), turn);
        let seen = Aabb::around(&corners(block).map(|corner| rays_from_part * corner));
        let n_rows = rows(seen.min.x, seen.max.x, resolution.along);
        let n_columns = rows(seen.min.z, seen.max.z, resolution.across);
        fits(n_rows * n_columns, resolution)?;
        Ok(Self {
            kind: Kind::Table,
            along: [seen.min.x, (seen.max.x - seen.min.x) / (n_rows - 1.0)],
            n_rows: n_rows as usize,
            across: [seen.min.z, (seen.max.z - seen.min.z) / (n_columns - 1.0)],
            n_columns: n_columns as usize,
            floor: seen.min.y,
            top: seen.max.y,
            rays_from_part,
            turner: None,
            lean: 0.0,
            turns: [Vec::new(), Vec::new()],
            edges: [Vec::new(), Vec::new()],
        })
    }
}

fn corners(block: &Aabb) -> [Point3; 8] {
    std::array::from_fn(|i| {
        let pick = |bit: usize, k: usize| if i & bit == 0 { block.min[k] } else { block.max[k] };
        Point3::new(pick(1, 0), pick(2, 1), pick(4, 2))
    })
}

/// Rows at both ends and between them, no farther apart than `step`.
fn rows(from: f64, to: f64, step: f64) -> f64 {
    // A length that is a whole number of steps, but for rounding, takes no step more.
    ((to - from) / step - 1e-9).ceil().max(1.0) + 1.0
}

fn fits(dexels: f64, resolution: Resolution) -> Result<(), StockError> {
    if dexels <= MOST_DEXELS {
        return Ok(());
    }
    let resolution = resolution.along.min(resolution.across);
    Err(StockError::TooMany { resolution, dexels, most: MOST_DEXELS })
}
