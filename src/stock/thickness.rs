//! How thick a layer a tool takes.
//!
//! The material over a tool, along a ray, is what [`Cut::depth`](super::Cut::depth) tells. Over a
//! floor that is the depth of cut. At a wall it misleads: a skin of 1 mm on a wall 16 mm high is
//! 16 mm deep for a ray that runs along it, and yet the tool takes 1 mm. What a machinist calls the
//! depth there is how far the surface recedes: from each place of the new one to the nearest place
//! of the surface as it was when the engagement began. A slot is as deep as its floor lies, and a
//! wall is cut as deep as its skin was thick.
//!
//! The old surface is known at the rays alone, so that a layer is shown too thick by the way to the
//! next ray at most; and a sliver that one ray alone sees is no thicker than that.

use super::dexels::Stock;
use super::layout::Kind;
use rayon::prelude::*;

/// A layer must be thicker than another by this much to be looked at in full [mm].
const STEP: f64 = 0.01;

/// The thickest place of a layer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Layer {
    /// From where a ray ends to the nearest place of the old surface [mm].
    pub thickness: f64,
    /// The ray: row and column.
    pub ray: [usize; 2],
}

impl Stock {
    /// The thickest place of the layer that the engagement going on has taken so far; `None` if it
    /// is nowhere thicker than `over` by more than a hundredth [mm].
    pub fn thickest_layer(&self, over: f64) -> Option<Layer> {
        let rows = (0..self.layout.n_rows).into_par_iter().filter(|&row| self.is_engaged(row));
        let layers = rows.filter_map(|row| self.thickest_in_row(row, over));
        // Of two as thick, the first: the same for any number of threads.
        layers.reduce_with(|a, b| {
            let is_first =
                a.thickness > b.thickness || (a.thickness == b.thickness && a.ray < b.ray);
            if is_first { a } else { b }
        })
    }

    /// One row as it was when the engagement going on began.
    #[must_use]
    pub fn row_before(&self, row: usize) -> Self {
        let mut before = self.excerpt(row..row + 1);
        if self.is_engaged(row) {
            let n = self.layout.n_columns;
            before = Self::new(before.layout, self.before[row * n..][..n].to_vec());
        }
        before
    }

    fn is_engaged(&self, row: usize) -> bool {
        self.n_engagements > 0 && self.engaged[row] == self.n_engagements
    }

    /// Where a ray ended when the engagement going on began.
    fn was(&self, row: usize, column: usize) -> f64 {
        let ends = if self.is_engaged(row) { &self.before } else { &self.ends };
        ends[row * self.layout.n_columns + column]
    }

    fn thickest_in_row(&self, row: usize, over: f64) -> Option<Layer> {
        let n = self.layout.n_columns;
        let mut thickest: Option<Layer> = None;
        for column in 0..n {
            let least = thickest.map_or(over, |layer| layer.thickness) + STEP;
            let along = self.was(row, column) - self.ends[row * n + column];
            if along > least
                && let Some(thickness) = self.thickness_at([row, column], along, least)
            {
                thickest = Some(Layer { thickness, ray: [row, column] });
            }
        }
        thickest
    }

    /// How thick the layer is over the end of a ray, if it is thicker than `least`. It is no thicker
    /// than it is deep along the ray.
    fn thickness_at(&self, ray: [usize; 2], along: f64, least: f64) -> Option<f64> {
        if self.foot(ray, along).is_some_and(|foot| self.way_to(ray, foot) <= least) {
            return None;
        }
        let [row, _] = ray;
        let step = self.layout.along[1];
        let last = self.layout.n_rows - 1;
        let mut nearest = along;
        for offset in 0..=last {
            if offset as f64 * step >= nearest {
                break;
            }
            for side in [row.checked_sub(offset), Some(row + offset)] {
                // Beyond its ends there is no block.
                let Some(other) = side.filter(|&other| other <= last) else {
                    let to_end = row.min(last - row) as f64 * step;
                    nearest = nearest.min(to_end);
                    continue;
                };
                nearest = self.nearest_in_row(ray, other, [nearest, least]);
                if nearest <= least {
                    return None;
                }
            }
        }
        (nearest > least).then_some(nearest)
    }

    /// The least of `nearest` and the ways from the end of `ray` to the old surface along the rays
    /// of a row; looked for no more once it is `enough`.
    fn nearest_in_row(&self, ray: [usize; 2], row: usize, [mut nearest, enough]: [f64; 2]) -> f64 {
        let n = self.layout.n_columns;
        for offset in 0..=n / 2 {
            if self.aside(ray, offset) >= nearest {
                break;
            }
            let columns = match self.layout.kind {
                Kind::Turned => [Some((ray[1] + n - offset) % n), Some((ray[1] + offset) % n)],
                Kind::Table => {
                    [ray[1].checked_sub(offset), Some(ray[1] + offset).filter(|&column| column < n)]
                }
            };
            for column in columns {
                let way = match column {
                    Some(column) => self.way_to(ray, [row, column]),
                    None => self.aside(ray, ray[1].min(n - 1 - ray[1])),
                };
                nearest = nearest.min(way);
                if nearest <= enough {
                    return nearest;
                }
            }
        }
        nearest
    }

    /// How far the ray so many columns aside passes the end of `ray`, at least.
    fn aside(&self, [row, column]: [usize; 2], offset: usize) -> f64 {
        let turn = offset as f64 * self.layout.across[1];
        match self.layout.kind {
            Kind::Table => turn,
            Kind::Turned => {
                let end = self.ends[row * self.layout.n_columns + column];
                if turn < std::f64::consts::FRAC_PI_2 { end * turn.sin() } else { end }
            }
        }
    }

    /// From where `ray` ends to where another ray left the old surface, or passes it beyond that.
    fn way_to(&self, ray: [usize; 2], [row, column]: [usize; 2]) -> f64 {
        let end = self.ends[ray[0] * self.layout.n_columns + ray[1]];
        let beside = (row as f64 - ray[0] as f64) * self.layout.along[1];
        let offset = (column as f64 - ray[1] as f64) * self.layout.across[1];
        let (along, across) = match self.layout.kind {
            Kind::Turned => (end * offset.cos(), end * offset.sin()),
            Kind::Table => (end, offset),
        };
        let below = (self.was(row, column) - along).max(0.0);
        (beside * beside + across * across + below * below).sqrt()
    }

    /// The ray nearest to where the old surface should be nearest, were it as plane as it is between
    /// the neighbours of this ray: most often one look is enough.
    fn foot(&self, [row, column]: [usize; 2], along: f64) -> Option<[usize; 2]> {
        let (n_rows, n) = (self.layout.n_rows, self.layout.n_columns);
        let width = match self.layout.kind {
            Kind::Turned => self.layout.across[1] * self.was(row, column),
            Kind::Table => self.layout.across[1],
        };
        let rows = [row.checked_sub(1)?, Some(row + 1).filter(|&row| row < n_rows)?];
        let columns = match self.layout.kind {
            Kind::Turned => [(column + n - 1) % n, (column + 1) % n],
            Kind::Table => [column.checked_sub(1)?, Some(column + 1).filter(|&column| column < n)?],
        };
        let rise = self.was(rows[1], column) - self.was(rows[0], column);
        let along_slope = rise / (2.0 * self.layout.along[1]);
        let rise = self.was(row, columns[1]) - self.was(row, columns[0]);
        let across_slope = rise / (2.0 * width);
        let share = along / (1.0 + along_slope * along_slope + across_slope * across_slope);
        let place =
            |from: usize, slope: f64, step: f64| from as f64 - (slope * share / step).round();
        let foot_row = place(row, along_slope, self.layout.along[1]);
        let mut foot_column = place(column, across_slope, width);
        if self.layout.kind == Kind::Turned {
            foot_column = foot_column.rem_euclid(n as f64);
        }
        let is_there =
            (0.0..n_rows as f64).contains(&foot_row) && (0.0..n as f64).contains(&foot_column);
        is_there.then_some([foot_row as usize, foot_column as usize])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::{Aabb, Point3};
    use crate::machine::Machine;
    use crate::progress::Silent;
    use crate::stock::{Layout, Resolution, Sweep};
    use crate::tool::Profile;

    /// A block 80 by 40 and 40 high on a mill, after moves of a flat tool 6 mm wide in one
    /// engagement; what was taken at its thickest.
    fn thickest(places: &[[f64; 3]]) -> (Stock, Option<Layer>) {
        let machine = Machine::builtin("mill-3axis").unwrap();
        let block = Aabb { min: Point3::new(0.0, 0.0, 0.0), max: Point3::new(80.0, 40.0, 40.0) };
        let layout = Layout::new(&machine, &machine.at_rest(), &block, Resolution::even(0.5));
        let mut stock = Stock::cylinder(layout.unwrap(), 1.0);
        engage(&mut stock, &machine, places);
        let layer = stock.thickest_layer(0.0);
        (stock, layer)
    }

    fn engage(stock: &mut Stock, machine: &Machine, places: &[[f64; 3]]) {
        let cutter = Profile::Flat { radius: 3.0 }.cutter(0.0);
        let at = |[x, y, z]: [f64; 3]| [x, y, z, 0.0, 0.0, 0.0];
        let pairs = places.windows(2).enumerate();
        let sweeps =
            pairs.map(|(i, pair)| Sweep { from: at(pair[0]), to: at(pair[1]), engages: i == 0 });
        stock.remove(machine, &cutter, &sweeps.collect::<Vec<_>>(), &Silent).unwrap();
    }

    #[test]
    fn a_slot_is_as_thick_as_it_is_deep() {
        let (stock, layer) = thickest(&[[-10.0, 20.0, 32.0], [90.0, 20.0, 32.0]]);
        let layer = layer.unwrap();
        assert!((layer.thickness - 8.0).abs() < 1e-9, "{layer:?}");
        assert_eq!(stock.thickest_layer(7.995), None);
    }

    #[test]
    fn a_skin_on_a_high_wall_is_as_thick_as_the_skin() {
        // Along the side Y 40 of the block, 1.3 mm into it, and 25 mm down.
        let (stock, layer) = thickest(&[[-10.0, 41.7, 15.0], [90.0, 41.7, 15.0]]);
        let layer = layer.unwrap();
        assert!((0.99..1.5).contains(&layer.thickness), "{layer:?}");
        let [row, column] = layer.ray;
        assert!((stock.end(row, column).unwrap() - 15.0).abs() < 1e-9, "25 mm along the ray");
    }

    #[test]
    fn only_what_the_engagement_going_on_has_taken_counts() {
        let machine = Machine::builtin("mill-3axis").unwrap();
        let (mut stock, _) = thickest(&[[-10.0, 20.0, 32.0], [90.0, 20.0, 32.0]]);
        engage(&mut stock, &machine, &[[-10.0, 20.0, 30.0], [90.0, 20.0, 30.0]]);
        let layer = stock.thickest_layer(0.0).unwrap();
        assert!((layer.thickness - 2.0).abs() < 1e-9, "{layer:?}");
        let row = stock.row_before(layer.ray[0]);
        assert_eq!(row.end(0, layer.ray[1]), Some(32.0));
    }

    #[test]
    fn round_a_spindle_a_face_is_cut_as_deep_as_it_recedes() {
        let machine = Machine::builtin("last-lathe").unwrap();
        let layout = Layout::round(&machine, [0.0, 60.0], 30.0, Resolution::even(0.5)).unwrap();
        let mut stock = Stock::cylinder(layout.unwrap(), 30.0);
        let cutter = Profile::Wheel { major_radius: 60.0, minor_radius: 10.0 }.cutter(0.0);
        let ring = |x: f64, y: f64, engages: bool| Sweep {
            from: [x, y, 0.0, 0.0, 0.0, 0.0],
            to: [x, y, std::f64::consts::TAU, 0.0, 0.0, 0.0],
            engages,
        };
        // A groove 12 mm deep, then one beside it, 1 mm on: the flank of the nose recedes by 1 mm at
        // most, where it is upright, though rays along it lose much more.
        stock.remove(&machine, &cutter, &[ring(30.0, 88.0, true)], &Silent).unwrap();
        let groove = stock.thickest_layer(0.0).unwrap().thickness;
        assert!((groove - 12.0).abs() < 0.02, "{groove}");
        let cuts = stock.remove(&machine, &cutter, &[ring(31.0, 88.0, true)], &Silent).unwrap();
        assert!(cuts[0].depth > 4.0, "{cuts:?}");
        let skin = stock.thickest_layer(0.0).unwrap().thickness;
        assert!((0.9..1.5).contains(&skin), "{skin}");
    }
}
