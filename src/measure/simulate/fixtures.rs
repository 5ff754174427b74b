//! What stands around the part and must not be touched: dogs, and a table.
//!
//! Dogs are bodies about the spindle axis, kept as stock that nothing is allowed to cut: a tool goes
//! as deep into them as it would cut. A table is plane, and of a convex tool the lowest place touches
//! it first.

use super::bodies::pieces;
use crate::cam::Setup;
use crate::geom::{Point3, Vector3};
use crate::machine::{AxisKind, AxisValues, Carries, Clamping, Machine, Obstacles};
use crate::stock::{Crests, Layout, Resolution, Stance, Stock, StockError, Sweep};
use crate::tool::{Axle, BodyPart, Cutter, Cylinder};
use serde::Serialize;

/// How finely dogs are looked at [mm].
const RESOLUTION: f64 = 1.0;
/// Less deep is touching: what a dog's own error, or rounding, explains [mm].
const TOUCH: f64 = 0.05;
/// A part of a tool's body is taken to be no longer [mm].
const LONG: f64 = 1000.0;
/// Directions off by no more are the same; a tool must point up by so much over a table.
const LEVEL: f64 = 1e-9;

/// What stands around a part on its machine, as far as the machine file tells its sizes.
#[derive(Debug, Clone, Default)]
pub struct Fixtures {
    dogs: Vec<Dog>,
    table: Option<Table>,
}

/// A kind of fixture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Fixture {
    /// What holds an end of a part on its spindle axis.
    Dog,
    /// What a part stands on.
    Table,
}

/// A tool, or a part of its body, in a fixture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Touch {
    pub(super) fixture: Fixture,
    /// What touches; `None` for what cuts.
    pub(super) part: Option<BodyPart>,
    /// How deep [mm].
    pub(super) depth: f64,
}

#[derive(Debug, Clone)]
struct Dog {
    stock: Stock,
    crests: Crests,
    radius: f64,
}

/// A round table, level in the part's frame.
#[derive(Debug, Clone, Copy)]
struct Table {
    /// On its top.
    middle: Point3,
    radius: f64,
}

impl Fixtures {
    /// Those around a part as it is set up.
    pub fn around(setup: &Setup, machine: &Machine) -> Result<Self, StockError> {
        let Obstacles { dogs, table_radius } = machine.obstacles;
        let mut fixtures = Self::default();
        if let Some(dogs) = dogs.filter(|_| matches!(machine.clamping, Clamping::Nibs { .. })) {
            let [heel, toe] = setup.stretch;
            for x in [[heel - dogs.length, heel], [toe, toe + dogs.length]] {
                let even = Resolution::even(RESOLUTION);
                if let Some(layout) = Layout::round(machine, x, dogs.radius, even) {
                    let stock = Stock::cylinder(layout?, dogs.radius);
                    let crests = stock.crests();
                    fixtures.dogs.push(Dog { stock, crests, radius: dogs.radius });
                }
            }
        }
        fixtures.table = table_radius.map(|radius| {
            let turning = machine.axes.iter().rfind(|axis| {
                axis.kind == AxisKind::Rotary
                    && axis.carries == Carries::Part
                    && axis.direction.cross(&Vector3::z()).norm() < LEVEL
            });
            let middle = turning.map_or_else(Point3::origin, |axis| axis.point);
            Table { middle: Point3::new(middle.x, middle.y, setup.part.min.z), radius }
        });
        Ok(fixtures)
    }

    /// What there is.
    pub fn kinds(&self) -> Vec<Fixture> {
        let dogs = (!self.dogs.is_empty()).then_some(Fixture::Dog);
        dogs.into_iter().chain(self.table.map(|_| Fixture::Table)).collect()
    }

    /// How deep the tool and each part of its body run into any of them on a move.
    pub(super) fn touched(
        &self,
        machine: &Machine,
        (cutter, cylinders): (&Cutter, &[Cylinder]),
        sweep: &Sweep,
    ) -> Result<Vec<Touch>, StockError> {
        let mut touched = Vec::new();
        let mut keep = |fixture, part, depth: f64| {
            if depth > TOUCH {
                touched.push(Touch { fixture, part, depth });
            }
        };
        if let Some(table) = &self.table {
            let lowest = |at: &AxisValues| lowest_of_cutter(machine, cutter, at);
            keep(Fixture::Table, None, table.depth_below(machine, sweep, lowest));
            for cylinder in cylinders {
                let lowest = |at: &AxisValues| lowest_of(machine, cylinder, at);
                let depth = table.depth_below(machine, sweep, lowest);
                keep(Fixture::Table, Some(cylinder.part), depth);
            }
        }
        let depth = |dog: &Dog| dog.depth_of_cutter(machine, cutter, sweep);
        let depths = self.dogs.iter().map(depth).collect::<Result<Vec<_>, _>>()?;
        keep(Fixture::Dog, None, depths.into_iter().fold(0.0, f64::max));
        for cylinder in cylinders {
            let depth = |dog: &Dog| dog.depth_of(machine, cylinder, sweep);
            let depths = self.dogs.iter().map(depth).collect::<Result<Vec<_>, _>>()?;
            keep(Fixture::Dog, Some(cylinder.part), depths.into_iter().fold(0.0, f64::max));
        }
        Ok(touched)
    }
}

impl Dog {
    /// No more than its radius: on the way through it a tool is in its middle once.
    fn depth_of_cutter(
        &self,
        machine: &Machine,
        cutter: &Cutter,
        sweep: &Sweep,
    ) -> Result<f64, StockError> {
        Ok(self.stock.depth_of(machine, cutter, sweep)?.min(self.radius))
    }

    fn depth_of(
        &self,
        machine: &Machine,
        cylinder: &Cylinder,
        sweep: &Sweep,
    ) -> Result<f64, StockError> {
        let mut depths = pieces(machine, self.radius, 0, sweep).map(|piece| {
            let stance = Stance::at(machine, &piece.sweep.to);
            self.stock.depth_in(&self.crests, &stance, cylinder)
        });
        depths.try_fold(0.0, |deepest: f64, depth| Ok(deepest.max(depth?)))
    }
}

impl Table {
    /// How deep a body whose lowest place is `lowest` goes into it on a move.
    ///
    /// What turns about the table's own axis goes neither up nor down, and what slides does so
    /// evenly: a move is as low as its ends. Over the table it may be in between alone.
    fn depth_below(
        &self,
        machine: &Machine,
        sweep: &Sweep,
        lowest: impl Fn(&AxisValues) -> Point3,
    ) -> f64 {
        let depth = |place: &Point3| self.middle.z - place.z;
        if depth(&lowest(&sweep.from)).max(depth(&lowest(&sweep.to))) <= TOUCH {
            return 0.0;
        }
        let places = pieces(machine, self.radius, 0, sweep).map(|piece| lowest(&piece.sweep.to));
        places
            .filter(|place| (place - self.middle).xy().norm() <= self.radius)
            .fold(0.0, |deepest, place| depth(&place).max(deepest))
    }
}

/// The lowest place of what cuts, over a level table, in the part's frame.
fn lowest_of_cutter(machine: &Machine, cutter: &Cutter, values: &AxisValues) -> Point3 {
    let attack_from_part = machine.attack_from_part(values).rotation;
    let up = attack_from_part * Vector3::z();
    let up = Vector3::new(up.x, up.y.max(LEVEL), up.z).normalize();
    Stance::at(machine, values).point
        + attack_from_part.inverse_transform_vector(&cutter.support(&up))
}

/// The lowest place of a part of a body.
fn lowest_of(machine: &Machine, cylinder: &Cylinder, values: &AxisValues) -> Point3 {
    let stance = Stance::at(machine, values);
    let way = match cylinder.axle {
        Axle::Attack => stance.attack,
        Axle::X => {
            let attack_from_part = machine.attack_from_part(values).rotation;
            attack_from_part.inverse_transform_vector(&Vector3::x())
        }
    };
    let [from, to] = cylinder.stretch;
    let end = if way.z >= 0.0 { from.max(-LONG) } else { to.min(LONG) };
    // Down, as far as that is square to the axis.
    let down = way * way.z - Vector3::z();
    let side = down.try_normalize(LEVEL).map_or_else(Vector3::zeros, |down| down * cylinder.radius);
    stance.point + way * end + side
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::machine::Dogs;
    use crate::tool::Profile;

    fn table(machine: &str) -> (Machine, Fixtures) {
        let machine = Machine::builtin(machine).unwrap();
        let table = Table { middle: Point3::origin(), radius: 100.0 };
        (machine, Fixtures { dogs: Vec::new(), table: Some(table) })
    }

    fn touched(
        (machine, fixtures): &(Machine, Fixtures),
        body: &[Cylinder],
        [from, to]: [AxisValues; 2],
    ) -> Vec<(Option<BodyPart>, f64)> {
        let cutter = Profile::Flat { radius: 3.0 }.cutter(0.0);
        let sweep = Sweep { from, to, engages: true };
        let touched = fixtures.touched(machine, (&cutter, body), &sweep).unwrap();
        touched.iter().map(|touch| (touch.part, (touch.depth * 1e3).round() / 1e3)).collect()
    }

    fn holder() -> Cylinder {
        let stretch = [30.0, 60.0];
        Cylinder { part: BodyPart::Holder, axle: Axle::Attack, radius: 20.0, stretch }
    }

    #[test]
    fn a_table_is_hit_as_deep_as_the_tool_goes_below_its_top_and_beside_it_not_at_all() {
        let mill = table("mill-3axis");
        let at = |x: f64, z: f64| [x, 0.0, z, 0.0, 0.0, 0.0];
        assert_eq!(touched(&mill, &[holder()], [at(50.0, 10.0), at(50.0, 0.0)]), []);
        assert_eq!(touched(&mill, &[], [at(50.0, 10.0), at(50.0, -2.0)]), [(None, 2.0)]);
        assert_eq!(touched(&mill, &[], [at(120.0, 10.0), at(120.0, -2.0)]), []);
        // Both ends beside the table, and the way across it.
        assert_eq!(touched(&mill, &[], [at(-120.0, -2.0), at(120.0, -2.0)]), [(None, 2.0)]);
    }

    #[test]
    fn a_leaning_tool_hits_the_table_with_the_edge_of_what_is_lowest() {
        let mill = table("mill-5axis");
        let mut at = mill.0.at_rest();
        at[mill.0.axis_index('A').unwrap()] = f64::to_radians(60.0);
        // Where the tip is to stand in the part's frame: 20 mm up.
        let wanted = mill.0.machine_from_part(&at) * Point3::new(10.0, 0.0, 20.0);
        for (k, letter) in ['X', 'Y', 'Z'].into_iter().enumerate() {
            let axis = mill.0.axis_index(letter).unwrap();
            at[axis] = mill.0.axes[axis].word(wanted[k]);
        }
        assert!((Stance::at(&mill.0, &at).point - Point3::new(10.0, 0.0, 20.0)).norm() < 1e-9);
        // Its axis rises by half its length; across, sin 60 of the radius goes down.
        assert_eq!(touched(&mill, &[holder()], [at, at]), []);
        let wide = Cylinder { radius: 50.0, ..holder() };
        let expected = 50.0 * 0.75_f64.sqrt() - 20.0 - 15.0;
        let [(part, depth)] = touched(&mill, &[wide], [at, at])[..] else { panic!("one touch") };
        assert_eq!(part, Some(BodyPart::Holder));
        assert!((depth - expected).abs() < 1e-3, "{depth} for {expected}");
    }

    #[test]
    fn a_wheel_over_a_dog_hits_it_where_it_comes_nearer_than_both_radii() {
        let lathe = Machine::builtin("last-lathe").unwrap();
        let dogs = Dogs { radius: 20.0, length: 60.0 };
        let lathe =
            Machine { obstacles: Obstacles { dogs: Some(dogs), ..lathe.obstacles }, ..lathe };
        let part = crate::geom::Surface::Mesh(crate::geom::shapes::prism(90, 30.0, 100.0));
        let setup = crate::cam::set_up(part, &lathe, &crate::cam::SetupOptions::default()).unwrap();
        let fixtures = Fixtures::around(&setup, &lathe).unwrap();
        assert_eq!(fixtures.kinds(), [Fixture::Dog]);
        let wheel = Profile::Wheel { major_radius: 60.0, minor_radius: 10.0 }.cutter(0.0);
        let hit = |x: f64, y: f64, body: &[Cylinder]| {
            let at = |y: f64| [x, y, 0.0, 0.0, 0.0, 0.0];
            let sweep = Sweep { from: at(200.0), to: at(y), engages: true };
            let touched = fixtures.touched(&lathe, (&wheel, body), &sweep).unwrap();
            touched.iter().map(|touch| touch.depth).fold(0.0, f64::max)
        };
        let toe = setup.stretch[1];
        for x in [-15.0, toe + 15.0] {
            assert!((hit(x, 87.0, &[]) - 3.0).abs() < 0.05, "{}", hit(x, 87.0, &[]));
            assert_eq!(hit(x, 90.1, &[]), 0.0);
        }
        // Over the part, however near, there is no dog; but its spindle may be over one.
        assert_eq!(hit(toe - 11.0, 60.0, &[]), 0.0);
        let spindle = Cylinder {
            part: BodyPart::Spindle,
            axle: Axle::X,
            radius: 75.0,
            stretch: [45.0, f64::INFINITY],
        };
        assert!((hit(toe - 11.0, 92.0, &[spindle]) - 3.0).abs() < 0.05);
    }
}
