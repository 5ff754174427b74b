//! Where the dexels of a stock stand.

use super::{Stance, StockError};
use crate::geom::{Point3, Pose, Vector3};
use crate::tool::Cutter;
use nalgebra::{Translation3, UnitQuaternion};

/// Columns that share one upper bound; see [`Row`](super::row::Row).
pub(super) const TILE: usize = 16;
/// Tiles looked at together.
pub(super) const GROUP: usize = 8;
/// A direction this far off is another one: rounding of a turned unit vector.
pub(super) const TILT: f64 = 1e-7;

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
    /// The axis that turns the part, where that is not the machine's spindle.
    pub(super) turner: Option<usize>,
    /// The angle by which tools lean towards X, as they attack [rad]; 0 on a table.
    pub(super) lean: f64,
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
    /// Unit vector of the attack direction, seen along X; along the rays on a table.
    pub(super) attack: [f64; 2],
    /// By which it leans towards X [rad]; 0 on a table.
    pub(super) lean: f64,
}

impl Resolution {
    /// The same in both directions.
    pub fn even(spacing: f64) -> Self {
        Self { along: spacing, across: spacing }
    }
}

impl At {
    /// How far the programmed point lies along the attack direction, and across it.
    #[inline(always)]
    pub(super) fn along_and_across(&self) -> [f64; 2] {
        let (y, z, [cos, sin]) = (self.point.y, self.point.z, self.attack);
        [y * cos + z * sin, z * cos - y * sin]
    }
}

impl Layout {
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

    /// True if the rays leave the axis of a table that turns, and not that of a spindle.
    pub fn is_on_turntable(&self) -> bool {
        self.turner.is_some()
    }

    /// How much earlier or later along X than at the axis a tool over it meets what lies farthest out
    /// [mm].
    pub fn lead(&self) -> f64 {
        self.top * self.lean.tan()
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
    /// the place across as numbers, not as rows and columns, in the layout's own frame. A tool that
    /// leans stands at `value` along its own axis, which meets the rays' at `x`.
    pub fn stance(&self, x: f64, across: f64, value: f64) -> Stance {
        let (point, attack) = match self.kind {
            Kind::Turned => {
                let ((sin, cos), (lean, upright)) = (across.sin_cos(), self.lean.sin_cos());
                let attack = Vector3::new(lean, upright * cos, upright * sin);
                (Point3::new(x, 0.0, 0.0) + attack * value, attack)
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
            Kind::Turned => {
                Pose::from_parts(
                    Translation3::identity(),
                    UnitQuaternion::from_axis_angle(&Vector3::z_axis(), self.lean)
                        * UnitQuaternion::from_axis_angle(&Vector3::x_axis(), -across),
                ) * Pose::translation(-x, 0.0, 0.0)
            }
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
            Kind::Turned => (attack.x.clamp(-1.0, 1.0).asin() - self.lean).abs(),
            Kind::Table => attack.angle(&Vector3::y()),
        };
        if off > TILT {
            return Err(StockError::Tilted { angle_deg: off.to_degrees() });
        }
        let length = attack.y.hypot(attack.z);
        Ok(At { point, attack: [attack.y / length, attack.z / length], lean: self.lean })
    }

    /// How far `cutter` reaches along X to either side. One that leans may reach as far as it is long.
    pub(super) fn reach_along(&self, cutter: &Cutter) -> f64 {
        if self.lean.abs() > TILT { f64::INFINITY } else { cutter.reach().x }
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
        let end = (end.max(0.0) as usize).min(self.n_rows);
        (first as usize).min(end)..end
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Aabb;
    use crate::machine::Machine;

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
