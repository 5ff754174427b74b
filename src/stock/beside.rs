//! Material beside a tool: how far it reaches into what does not cut.
//!
//! Every part of a tool's body is a cylinder ([`Cylinder`]). In the plane of a row it is a disc (its
//! axle along X) or a strip (along the attack axis), both convex: a ray runs through on one stretch.
//! What of its material lies on that stretch collides. A row whose highest material ends before the
//! body begins is passed by.

use super::dexels::Stock;
use super::layout::{Kind, Layout, TILT};
use super::{Stance, StockError};
use crate::tool::{Axle, Cylinder};
use rayon::prelude::*;

/// How far out the material of each row reaches.
#[derive(Debug, Clone)]
pub struct Crests {
    rows: Vec<f64>,
    highest: f64,
}

/// A body in the plane of a row, in the frame of the rays.
#[derive(Debug, Clone, Copy)]
enum Section {
    /// Its middle in Y and Z, and its radius.
    Disc([f64; 2], f64),
    /// Along the attack direction, and across it.
    Strip([f64; 2], [f64; 2]),
}

/// A ray in the plane of its row.
struct Ray {
    from: [f64; 2],
    /// Unit vector.
    along: [f64; 2],
}

impl Stock {
    /// How far out the material of each row reaches now.
    pub fn crests(&self) -> Crests {
        let n = self.layout.n_columns();
        let crest = |ends: &[f64]| ends.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let rows: Vec<f64> = self.ends.par_chunks(n).map(crest).collect();
        let highest = crest(&rows);
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
        let at = layout.locate(stance)?;
        if at.lean.abs() > TILT {
            return Err(StockError::LeaningBody);
        }
        let [y, z] = [at.point.y, at.point.z];
        let [along, across] = at.along_and_across();
        let [from, to] = cylinder.stretch;
        let radius = cylinder.radius;
        let reach = match cylinder.axle {
            Axle::X => [at.point.x + from, at.point.x + to],
            Axle::Attack => [at.point.x - radius, at.point.x + radius],
        };
        let section = |x: f64| match cylinder.axle {
            Axle::X => Section::Disc([y, z], radius),
            Axle::Attack => {
                let half = (radius * radius - (x - at.point.x).powi(2)).max(0.0).sqrt();
                Section::Strip([along + from, along + to], [across - half, across + half])
            }
        };
        // The widest section is the nearest.
        if section(at.point.x).nearest(layout) >= crests.highest {
            return Ok(0.0);
        }
        let depth_in_row = |row: usize| {
            let section = section(layout.row_x(row));
            let crest = crests.rows[row];
            if section.nearest(layout) >= crest {
                return 0.0;
            }
            let columns = section.columns(layout, at.attack, crest);
            let ends = &self.ends[row * layout.n_columns()..][..layout.n_columns()];
            columns
                .map(|column| column.rem_euclid(layout.n_columns_signed()) as usize)
                .map(|column| {
                    let stretch = section.stretch(&Ray::of(layout, column), at.attack);
                    stretch.map_or(0.0, |[enters, leaves]| {
                        ends[column].min(leaves) - enters.max(layout.floor)
                    })
                })
                .fold(0.0, f64::max)
        };
        Ok(layout.rows_within(reach).map(depth_in_row).fold(0.0, f64::max))
    }
}

impl Section {
    /// Nothing of it is nearer to where the rays begin than this.
    fn nearest(&self, layout: &Layout) -> f64 {
        match (*self, layout.kind) {
            (Self::Disc([y, z], radius), Kind::Turned) => y.hypot(z) - radius,
            (Self::Disc([y, _], radius), Kind::Table) => y - radius,
            (Self::Strip(along, across), Kind::Turned) => away(along).hypot(away(across)),
            (Self::Strip([from, _], _), Kind::Table) => from,
        }
    }

    /// The columns that may meet it before `crest`; beyond both ends of a turn they count on.
    fn columns(
        &self,
        layout: &Layout,
        attack: [f64; 2],
        crest: f64,
    ) -> std::ops::RangeInclusive<i64> {
        let n = layout.n_columns_signed();
        let [first, step] = layout.across;
        let between = |low: f64, high: f64| {
            let low = ((low - first) / step).floor();
            let high = ((high - first) / step).ceil();
            match layout.kind {
                Kind::Turned if high - low >= n as f64 => 0..=n - 1,
                Kind::Turned => low as i64..=high as i64,
                Kind::Table => (low.max(0.0) as i64)..=(high.min((n - 1) as f64) as i64),
            }
        };
        let whole = 0..=n - 1;
        match (*self, layout.kind) {
            (Self::Disc([_, z], radius), Kind::Table) => between(z - radius, z + radius),
            (Self::Strip(_, [low, high]), Kind::Table) => between(low, high),
            (Self::Disc([y, z], radius), Kind::Turned) => {
                let distance = y.hypot(z);
                if distance <= radius {
                    return whole;
                }
                let (middle, half) = (z.atan2(y), (radius / distance).asin());
                between(middle - half, middle + half)
            }
            (Self::Strip([from, _], [low, high]), Kind::Turned) => {
                if from <= 0.0 {
                    return whole;
                }
                // A place beside the attack line is seen under the widest angle where it is nearest,
                // and under the narrowest where it is as far out as the crest.
                let widest = |across: f64, outwards: f64| {
                    let along = if across * outwards > 0.0 { from } else { from.max(crest) };
                    attack[1].atan2(attack[0]) + across.atan2(along)
                };
                between(widest(low, -1.0), widest(high, 1.0))
            }
        }
    }

    /// Where a ray enters it, and where it leaves it.
    fn stretch(&self, ray: &Ray, [cos, sin]: [f64; 2]) -> Option<[f64; 2]> {
        match *self {
            Self::Disc(middle, radius) => {
                let to = [middle[0] - ray.from[0], middle[1] - ray.from[1]];
                let nearest = to[0] * ray.along[0] + to[1] * ray.along[1];
                let half2 = radius * radius - (to[0] * to[0] + to[1] * to[1] - nearest * nearest);
                let half = (half2 >= 0.0).then(|| half2.sqrt())?;
                Some([nearest - half, nearest + half])
            }
            Self::Strip(along, across) => {
                let turned = |v: [f64; 2]| [v[0] * cos + v[1] * sin, v[1] * cos - v[0] * sin];
                let (from, way) = (turned(ray.from), turned(ray.along));
                let [a, b] =
                    [(along, 0), (across, 1)].map(|(slab, k)| within(slab, from[k], way[k]));
                let [enters, leaves] = [a[0].max(b[0]), a[1].min(b[1])];
                (enters <= leaves).then_some([enters, leaves])
            }
        }
    }
}

impl Ray {
    fn of(layout: &Layout, column: usize) -> Self {
        match layout.kind {
            Kind::Turned => {
                Self { from: [0.0; 2], along: [layout.turns[0][column], layout.turns[1][column]] }
            }
            Kind::Table => {
                let z = layout.across[0] + layout.across[1] * column as f64;
                Self { from: [0.0, z], along: [1.0, 0.0] }
            }
        }
    }
}

/// How far a stretch of numbers is from 0.
fn away([from, to]: [f64; 2]) -> f64 {
    from.max(-to).max(0.0)
}

/// On what stretch of `from + s way` a number lies within a slab; an empty one if never.
fn within(slab: [f64; 2], from: f64, way: f64) -> [f64; 2] {
    if way == 0.0 {
        let is_inside = (slab[0]..=slab[1]).contains(&from);
        return if is_inside { [f64::NEG_INFINITY, f64::INFINITY] } else { [1.0, 0.0] };
    }
    let [a, b] = slab.map(|border| (border - from) / way);
    [a.min(b), a.max(b)]
}

#[cfg(test)]
mod tests {
    use super::super::Resolution;
    use super::*;
    use crate::geom::{Aabb, Point3, Vector3};
    use crate::machine::Machine;
    use crate::tool::BodyPart;
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
