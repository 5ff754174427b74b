//! Where the dexels of a stock stand.

use super::{Stance, StockError};
use crate::geom::{Aabb, Point3, Pose, Vector3};
use crate::machine::{AxisValues, Machine};
use nalgebra::{Translation3, UnitQuaternion};
use std::f64::consts::TAU;

/// Columns that share one upper bound; see [`Row`](super::row::Row).
pub(super) const TILE: usize = 16;
/// Tiles looked at together.
pub(super) const GROUP: usize = 8;
/// More dexels than this are refused: 500 MB with all that belongs to them.
const MOST_DEXELS: f64 = 2.5e7;
/// A direction this far off is another one: rounding of a turned unit vector.
const TILT: f64 = 1e-7;

/// How far apart dexels stand.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct Resolution {
    /// From station to station along X [mm].
    pub along: f64,
    /// Around the part, at the block's greatest radius; or across X on a table [mm].
    pub across: f64,
}

/// A regular bundle of rays: rows along X, columns around it or across it.
#[derive(Debug, Clone, PartialEq)]
pub struct Layout {
    pub(super) kind: Kind,
    /// X of the first row, and from row to row [mm].
    pub(super) along: [f64; 2],
    pub(super) n_rows: usize,
    /// Angle or Z of the first column, and from column to column [rad or mm].
    pub(super) across: [f64; 2],
    pub(super) n_columns: usize,
    /// Where a ray begins: 0 on the spindle axis, the block's lowest place on a table [mm].
    pub(super) floor: f64,
    /// Nothing of a block within the layout lies farther out than this [mm].
    pub(super) top: f64,
    pub(super) rays_from_part: Pose,
    /// Cosine and sine of each column's angle; empty on a table.
    pub(super) turns: [Vec<f64>; 2],
    /// Those of the first column of each tile, as many as whole groups of tiles need and one more.
    pub(super) edges: [Vec<f64>; 2],
}

/// Which way the rays run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// Away from the spindle axis, at right angles.
    Turned,
    /// Along the attack axis.
    Table,
}

/// Where a tool stands in a layout.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct At {
    pub(super) point: Point3,
    /// Angle of the attack direction about X [rad]; 0 on a table.
    pub(super) attack: f64,
}

impl Resolution {
    /// The same in both directions.
    pub fn even(spacing: f64) -> Self {
        Self { along: spacing, across: spacing }
    }
}

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
            turns: [Vec::new(), Vec::new()],
            edges: [Vec::new(), Vec::new()],
        })
    }

    /// How many rows there are along X.
    pub fn n_rows(&self) -> usize {
        self.n_rows
    }

    /// How many rays a row has.
    pub fn n_columns(&self) -> usize {
        self.n_columns
    }

    /// How many tiles a row has.
    pub(super) fn n_tiles(&self) -> usize {
        self.n_columns.div_ceil(TILE)
    }

    /// From the bounds of a row's tiles to those of the next: whole groups.
    pub(super) fn tile_stride(&self) -> usize {
        self.n_tiles().next_multiple_of(GROUP)
    }

    /// True if the rays leave a spindle axis, false if they stand on a table.
    pub fn is_turned(&self) -> bool {
        self.kind == Kind::Turned
    }

    /// How far apart the rays really stand.
    pub fn resolution(&self) -> Resolution {
        let across = match self.kind {
            Kind::Turned => self.across[1] * self.top,
            Kind::Table => self.across[1],
        };
        Resolution { along: self.along[1], across }
    }

    /// X of a row, in the layout's own frame [mm].
    pub fn row_x(&self, row: usize) -> f64 {
        self.along[0] + self.along[1] * row as f64
    }

    /// The point at `value` on a ray, in the part's frame [mm].
    pub fn point(&self, row: usize, column: usize, value: f64) -> Point3 {
        let x = self.row_x(row);
        let seen = match self.kind {
            Kind::Turned => {
                Point3::new(x, value * self.turns[0][column], value * self.turns[1][column])
            }
            Kind::Table => Point3::new(x, value, self.across[0] + self.across[1] * column as f64),
        };
        self.rays_from_part.inverse_transform_point(&seen)
    }

    /// The row and column of the ray nearest to a point of the part's frame; `None` beyond them all.
    pub fn ray_near(&self, point: &Point3) -> Option<[usize; 2]> {
        let seen = self.rays_from_part * point;
        let row = ((seen.x - self.along[0]) / self.along[1]).round();
        let column = match self.kind {
            Kind::Turned => seen.z.atan2(seen.y) / self.across[1],
            Kind::Table => (seen.z - self.across[0]) / self.across[1],
        };
        let column = match self.kind {
            Kind::Turned => column.round().rem_euclid(self.n_columns as f64),
            Kind::Table => column.round(),
        };
        let is_there = (0.0..self.n_rows as f64).contains(&row)
            && (0.0..self.n_columns as f64).contains(&column);
        is_there.then_some([row as usize, column as usize])
    }

    /// The stance of a tool that attacks along a ray, its programmed point at `value` on it; X and
    /// the place across as numbers, not as rows and columns, in the layout's own frame.
    pub fn stance(&self, x: f64, across: f64, value: f64) -> Stance {
        let (point, attack) = match self.kind {
            Kind::Turned => {
                let (sin, cos) = across.sin_cos();
                (Point3::new(x, value * cos, value * sin), Vector3::new(0.0, cos, sin))
            }
            Kind::Table => (Point3::new(x, value, across), Vector3::y()),
        };
        Stance {
            point: self.rays_from_part.inverse_transform_point(&point),
            attack: self.rays_from_part.inverse_transform_vector(&attack),
        }
    }

    /// The pose digitizing needs to bring a tool down where [`Layout::stance`] puts it.
    pub fn attack_from_part(&self, x: f64, across: f64) -> Pose {
        let here = match self.kind {
            Kind::Turned => Pose::from_parts(
                Translation3::new(-x, 0.0, 0.0),
                UnitQuaternion::from_axis_angle(&Vector3::x_axis(), -across),
            ),
            Kind::Table => Pose::translation(-x, 0.0, -across),
        };
        here * self.rays_from_part
    }

    /// The stretch of X, and of angles or Z, that the rays take up.
    pub fn extent(&self) -> [[f64; 2]; 2] {
        let end = |[from, step]: [f64; 2], n: usize| [from, from + step * n as f64];
        let n_steps = match self.kind {
            Kind::Turned => self.n_columns,
            Kind::Table => self.n_columns - 1,
        };
        [end(self.along, self.n_rows - 1), end(self.across, n_steps)]
    }

    /// The greatest distance of anything in the block from where the rays begin [mm].
    pub fn reach(&self) -> f64 {
        self.top - self.floor
    }

    /// Where `stance` is in this layout, unless the rays do not run the way it attacks.
    pub(super) fn locate(&self, stance: &Stance) -> Result<At, StockError> {
        let point = self.rays_from_part * stance.point;
        let attack = self.rays_from_part * stance.attack;
        let off = match self.kind {
            Kind::Turned => attack.x.abs().asin(),
            Kind::Table => attack.angle(&Vector3::y()),
        };
        if off > TILT {
            return Err(StockError::Tilted { angle_deg: off.to_degrees() });
        }
        let attack = match self.kind {
            Kind::Turned => attack.z.atan2(attack.y),
            Kind::Table => 0.0,
        };
        Ok(At { point, attack })
    }

    /// The number of columns, to count backwards with; there are far fewer than would not fit.
    pub(super) fn n_columns_signed(&self) -> i64 {
        i64::try_from(self.n_columns).unwrap_or(i64::MAX)
    }

    /// The rows whose X lies within `[from, to]`.
    pub(super) fn rows_within(&self, [from, to]: [f64; 2]) -> std::ops::Range<usize> {
        let first = ((from - self.along[0]) / self.along[1]).ceil().max(0.0);
        let end = ((to - self.along[0]) / self.along[1]).floor() + 1.0;
        // A cast stops at the ends of its range.
        first as usize..(end.max(0.0) as usize).min(self.n_rows)
    }

    /// What a row counts for in a sum over X [mm]: the first and the last one half.
    pub(super) fn row_weight(&self, row: usize) -> f64 {
        if row == 0 || row + 1 == self.n_rows { self.along[1] / 2.0 } else { self.along[1] }
    }

    /// What a column counts for in a sum around or across [rad or mm].
    pub(super) fn column_weight(&self, column: usize) -> f64 {
        let is_end = column == 0 || column + 1 == self.n_columns;
        if self.kind == Kind::Table && is_end { self.across[1] / 2.0 } else { self.across[1] }
    }

    /// The material of a ray that ends at `value`, per column weight [mm2 or mm].
    #[inline(always)]
    pub(super) fn content(&self, value: f64) -> f64 {
        match self.kind {
            Kind::Turned => value * value / 2.0,
            Kind::Table => value - self.floor,
        }
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

#[cfg(test)]
mod tests {
    use super::*;

    fn block() -> Aabb {
        Aabb { min: Point3::new(0.0, -30.0, -40.0), max: Point3::new(100.0, 30.0, 40.0) }
    }

    fn layout(machine: &str, resolution: f64) -> Result<Layout, StockError> {
        let machine = Machine::builtin(machine).unwrap();
        Layout::new(&machine, &machine.at_rest(), &block(), Resolution::even(resolution))
    }

    #[test]
    fn rows_stand_on_both_ends_and_rays_no_farther_apart_than_asked() {
        let turned = layout("last-lathe", 0.3).unwrap();
        assert_eq!(turned.row_x(0), 0.0);
        assert!((turned.row_x(turned.n_rows() - 1) - 100.0).abs() < 1e-12);
        let real = turned.resolution();
        assert!(real.along <= 0.3 && real.across <= 0.3, "{real:?}");
        assert!(
            (turned.point(0, turned.n_columns() / 4, 7.0) - Point3::new(0.0, 0.0, 7.0)).norm()
                < 1e-9
        );
        let flat = layout("mill-3axis", 0.3).unwrap();
        assert!((flat.reach() - 80.0).abs() < 1e-12);
        // Attack x = X, y = Z, z = -Y.
        assert!((flat.point(0, 0, 5.0) - Point3::new(0.0, 30.0, 5.0)).norm() < 1e-9);
    }

    #[test]
    fn the_end_of_a_ray_is_nearest_to_its_own_ray() {
        for machine in ["last-lathe", "mill-3axis"] {
            let layout = layout(machine, 3.0).unwrap();
            for [row, column] in [[0, 0], [7, 3], [layout.n_rows() - 1, layout.n_columns() - 1]] {
                let point = layout.point(row, column, 12.0);
                assert_eq!(layout.ray_near(&point), Some([row, column]), "{machine}");
            }
            assert_eq!(layout.ray_near(&Point3::new(900.0, 0.0, 0.0)), None);
        }
    }

    #[test]
    fn too_fine_a_resolution_is_refused_before_memory_is_taken() {
        let message = layout("last-lathe", 1e-4).unwrap_err().to_string();
        assert!(message.starts_with("a resolution of 0.0001 mm takes 3.14e12 dexels"), "{message}");
        assert!(layout("last-lathe", f64::NAN).is_err());
    }

    #[test]
    fn a_tilted_part_is_refused_by_name() {
        let mill = Machine::builtin("mill-5axis").unwrap();
        let flat = Layout::new(&mill, &mill.at_rest(), &block(), Resolution::even(1.0)).unwrap();
        let mut tilted = mill.at_rest();
        tilted[mill.axis_index('A').unwrap()] = 0.1;
        let message = flat.locate(&Stance::at(&mill, &tilted)).unwrap_err().to_string();
        assert!(message.starts_with("the tool comes at the part 5.730 degrees off"), "{message}");
    }
}
