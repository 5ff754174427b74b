//! Material beside a tool: how far it reaches into what does not cut.
//!
//! Every part of a tool's body is a cylinder ([`Cylinder`]). What of a ray's material lies on the
//! stretch on which it runs through that collides. Rows and rays whose material ends before the body
//! begins are passed by.

use super::dexels::Stock;
use super::rod::{Ray, Rod};
use super::{Stance, StockError};
use crate::tool::Cylinder;

/// How far out the material of each row reaches.
#[derive(Debug, Clone)]
pub struct Crests {
    rows: Vec<f64>,
    highest: f64,
}

impl Stock {
    /// How far out the material of each row reaches now, at most.
    pub fn crests(&self) -> Crests {
        let rows = self.tops();
        let highest = rows.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        Crests { rows, highest }
    }

    /// How far material reaches into `cylinder` of a tool at `stance`, along a ray; 0 if none does.
    /// `crests` are those of this stock, or of the same with more on it [mm].
    pub fn depth_in(
        &self,
        crests: &Crests,
        stance: &Stance,
        cylinder: &Cylinder,
    ) -> Result<f64, StockError> {
        let layout = &self.layout;
        let rod = Rod::of(layout, stance, cylinder)?;
        if rod.whole().nearest(layout) >= crests.highest {
            return Ok(0.0);
        }
        let depth_in_row = |row: usize| {
            let (x, crest) = (layout.row_x(row), crests.rows[row]);
            let Some(frame) = rod.frame(x).filter(|frame| frame.nearest(layout) < crest) else {
                return 0.0;
            };
            let ends = &self.ends[row * layout.n_columns()..][..layout.n_columns()];
            frame
                .columns(layout, rod.attack, crest)
                .map(|column| column.rem_euclid(layout.n_columns_signed()) as usize)
                .map(|column| {
                    let stretch = rod.stretch(x, &Ray::of(layout, column));
                    stretch.map_or(0.0, |[enters, leaves]| {
                        ends[column].min(leaves) - enters.max(layout.floor)
                    })
                })
                .fold(0.0, f64::max)
        };
        let rows = layout.rows_within(rod.reach(crests.highest));
        Ok(rows.map(depth_in_row).fold(0.0, f64::max))
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Layout, Resolution};
    use super::*;
    use crate::geom::{Aabb, Point3, Vector3};
    use crate::machine::Machine;
    use crate::tool::{Axle, BodyPart};
    use std::f64::consts::TAU;

    fn cylinder(axle: Axle, radius: f64, stretch: [f64; 2]) -> Cylinder {
        Cylinder { part: BodyPart::Shank, axle, radius, stretch }
    }

    /// A bar of radius 30 from X 0 to 100, or a block 60 wide and as high.
    fn stock(machine: &str) -> Stock {
        let machine = Machine::builtin(machine).unwrap();
        let block = Aabb { min: Point3::new(0.0, -30.0, 0.0), max: Point3::new(100.0, 30.0, 60.0) };
        let resolution = Resolution::even(0.5);
        let layout = Layout::round(&machine, [0.0, 100.0], 30.0, resolution)
            .unwrap_or_else(|| Layout::new(&machine, &machine.at_rest(), &block, resolution));
        Stock::cylinder(layout.unwrap(), 30.0)
    }

    fn depth(stock: &Stock, stance: &Stance, cylinder: &Cylinder) -> f64 {
        stock.depth_in(&stock.crests(), stance, cylinder).unwrap()
    }

    /// The tool stands at `away` from the axis, attacking from `angle` about it.
    fn around(x: f64, away: f64, angle: f64) -> Stance {
        let attack = Vector3::new(0.0, angle.cos(), angle.sin());
        Stance { point: Point3::new(x, 0.0, 0.0) + attack * away, attack }
    }

    #[test]
    fn an_arbor_beside_a_bar_meets_it_by_what_the_distances_say() {
        let bar = stock("last-lathe");
        for angle in [0.0, 1.0, 3.1, TAU - 0.01] {
            // Radii of 30 and 20 touch at a distance of 50.
            let arbor = cylinder(Axle::X, 20.0, [-10.0, 45.0]);
            assert!((depth(&bar, &around(50.0, 47.0, angle), &arbor) - 3.0).abs() < 0.01);
            assert_eq!(depth(&bar, &around(50.0, 50.1, angle), &arbor), 0.0);
            // Past the bar's end it stands free.
            assert_eq!(depth(&bar, &around(111.0, 40.0, angle), &arbor), 0.0);
            assert!(depth(&bar, &around(109.0, 47.0, angle), &arbor) > 2.9);
        }
        let spindle = cylinder(Axle::X, 40.0, [45.0, f64::INFINITY]);
        assert!((depth(&bar, &around(20.0, 65.0, 0.0), &spindle) - 5.0).abs() < 0.01);
        assert_eq!(depth(&bar, &around(60.0, 65.0, 0.0), &spindle), 0.0);
    }

    #[test]
    fn a_shank_over_a_bar_meets_it_above_its_flutes() {
        let bar = stock("mill-rotary");
        for angle in [0.0, 1.0, 3.1, TAU - 0.01] {
            let shank = cylinder(Axle::Attack, 3.0, [13.0, 40.0]);
            // The tip 15 mm below the top: 2 mm of the shank stand in it.
            assert!((depth(&bar, &around(50.0, 15.0, angle), &shank) - 2.0).abs() < 0.02);
            assert_eq!(depth(&bar, &around(50.0, 17.1, angle), &shank), 0.0);
            // Below the axis, and right through the bar.
            let long = cylinder(Axle::Attack, 3.0, [0.0, 100.0]);
            assert!((depth(&bar, &around(50.0, -40.0, angle), &long) - 30.0).abs() < 0.02);
        }
        // A holder that reaches far to the side meets the bar beside the tool.
        let attack = Vector3::y();
        let aside = Stance { point: Point3::new(50.0, -10.0, 34.0), attack };
        let holder = cylinder(Axle::Attack, 16.0, [20.0, f64::INFINITY]);
        // It begins at Y 10 and Z 18: the corner is sqrt(10^2 + 18^2) from the axis.
        let expected = 30.0 - 424_f64.sqrt();
        assert!((depth(&bar, &aside, &holder) - expected).abs() < 0.05);
    }

    #[test]
    fn a_leaning_body_meets_what_points_within_it_say() {
        let mill = Machine::builtin("mill-5axis").unwrap();
        let block =
            Aabb { min: Point3::new(-14.0, -14.0, 0.0), max: Point3::new(14.0, 14.0, 40.0) };
        for tilt in [25.0, 60.0] {
            let mut values = mill.at_rest();
            values[mill.axis_index('A').unwrap()] = f64::to_radians(tilt);
            let axis = mill.axis_index('C').unwrap();
            let layout =
                Layout::about(&mill, &values, axis, &block, Resolution::even(2.0)).unwrap();
            let bar = Stock::cylinder(layout.clone(), 19.0);
            // Over the middle of the bar, beside it, at its ends, through its axis, and clear of it.
            for (x, turn, value) in [
                (-20.0, 0.3, 14.0),
                (-35.0, 2.0, 30.0),
                (-5.0, 4.0, 12.0),
                (-20.0, 5.5, -4.0),
                (-20.0, 1.0, 60.0),
            ] {
                let stance = layout.stance(x, turn, value);
                for (radius, stretch) in [(3.0, [5.0, 40.0]), (16.0, [9.0, f64::INFINITY])] {
                    let body = cylinder(Axle::Attack, radius, stretch);
                    let is_within = |point: Point3| {
                        let out = point - stance.point;
                        let along = out.dot(&stance.attack);
                        (stretch[0]..=stretch[1]).contains(&along)
                            && (out - stance.attack * along).norm() <= radius
                    };
                    let n_within = |row: usize, column: usize| {
                        let places = (0..380).map(|i| f64::from(i) / 20.0);
                        places.filter(|&s| is_within(layout.point(row, column, s))).count()
                    };
                    let rays = (0..layout.n_rows())
                        .flat_map(|row| (0..layout.n_columns()).map(move |column| (row, column)));
                    let sampled = rays.map(|(row, column)| n_within(row, column)).max().unwrap();
                    let found = depth(&bar, &stance, &body);
                    assert!(
                        (found - sampled as f64 / 20.0).abs() < 0.051,
                        "{found}, but {sampled} times 0.05 at {tilt}, {x}, {value}"
                    );
                }
            }
        }
    }

    #[test]
    fn on_a_table_a_body_meets_what_stands_higher() {
        let block = stock("mill-3axis");
        let at =
            |x: f64, y: f64, z: f64| Stance { point: Point3::new(x, y, z), attack: Vector3::z() };
        let holder = cylinder(Axle::Attack, 16.0, [30.0, 50.0]);
        assert!((depth(&block, &at(50.0, 0.0, 25.0), &holder) - 5.0).abs() < 1e-9);
        assert_eq!(depth(&block, &at(50.0, 0.0, 30.1), &holder), 0.0);
        // 16 mm to the side of the block it is clear.
        assert_eq!(depth(&block, &at(50.0, 46.1, 25.0), &holder), 0.0);
        assert_eq!(depth(&block, &at(116.1, 0.0, 25.0), &holder), 0.0);
        assert!(depth(&block, &at(50.0, 45.4, 25.0), &holder) > 4.9);
    }
}
