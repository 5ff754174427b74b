//! An end mill that leans along the axis a part is turned about: the constant tilt of a table.
//!
//! The plane of a row cuts it aslant. With `w` the row's way beside the tip, `a` and `b` a place of
//! the row along and across the attack direction as seen along X, a place lies
//! `t = w sin + a cos` along the tool that leans by so much, and `n = w cos - a sin` and `b` beside
//! its axis. On a ray all three are linear. What is a cylinder of the tool is met where `n^2 + b^2`
//! is no more than its radius squared, the roots of a quadratic; what is a ball is a disc as under
//! any other tool; and of other ends `t + u(n, b)` is concave and not negative inside.

use super::disc::Disc;
use super::layout::At;
use super::shave::{Blade, Borders, Rays, Section, joined};
use super::strip::Strip;
use super::trace::End;
use super::under_mill::positive_stretch;
use crate::tool::{HeightFunction, Mill};
use fearless_simd::{f64x8, prelude::*};

/// A leaning mill.
#[derive(Debug, Clone, Copy)]
pub(super) struct LeaningMill {
    pub(super) mill: Mill,
    /// What it is, if it is nothing else.
    pub(super) end: Option<End>,
    /// Nothing lies farther out [mm].
    pub(super) top: f64,
}

/// What a row meets of it.
#[derive(Debug, Clone, Copy)]
pub(super) struct LeaningSection {
    tip: Tip,
    /// The cylinder above the tip, or around it.
    tube: Tube,
    /// All of it lies in here.
    strip: Strip,
    /// The axis lies in the tool.
    is_through: bool,
}

/// What lies below the tube, or what of the tube is tool.
#[derive(Debug, Clone, Copy)]
enum Tip {
    /// All of the tube, and no more.
    Flat,
    /// A ball, where the row meets it.
    Ball(Option<Disc>),
    /// Whatever the height function says.
    Other(Mill),
}

/// A cylinder that goes on for ever away from the part.
#[derive(Debug, Clone, Copy)]
struct Tube {
    /// The part's axis, in this row: `t`, `n` and `b`.
    axis: [f64; 3],
    /// Cosine and sine of the lean.
    lean: [f64; 2],
    radius: f64,
    /// Where it begins along the tool.
    from: f64,
}

impl LeaningMill {
    /// Where its end is, along the tool: above the programmed point, or below it if it is grown.
    fn foot(&self) -> f64 {
        -self.mill.reach().top
    }
}

impl Blade for LeaningMill {
    type Section = LeaningSection;

    fn half_width(&self) -> f64 {
        self.mill.reach().x
    }

    /// From the edge of its end to where it is beyond all material.
    fn stretch(&self, at: &At) -> [f64; 2] {
        let ([along, _], (sin, cos)) = (at.along_and_across(), at.lean.sin_cos());
        let (radius, foot) = (self.half_width(), self.foot());
        let end = ((self.top - along + radius * sin.abs()) / cos).max(foot);
        let [a, b] = [foot, end].map(|t| at.point.x + t * sin);
        [a.min(b) - radius * cos, a.max(b) + radius * cos]
    }

    /// Where the edge of its end comes nearest to the part.
    fn middle(&self, at: &At) -> f64 {
        let (sin, cos) = at.lean.sin_cos();
        at.point.x + self.foot() * sin + self.half_width() * cos * sin.signum()
    }

    #[inline(always)]
    fn section(&self, at: &At, dx: f64) -> LeaningSection {
        let (sin, cos) = at.lean.sin_cos();
        let [along, across] = at.along_and_across();
        let (radius, foot) = (self.half_width(), self.foot());
        // Above its end, and to one side of its axis as far as its radius.
        let by_end = (foot - dx * sin) / cos;
        let by_side = (dx * sin.signum() * cos - radius) / sin.abs();
        let axis = [dx * sin - along * cos, dx * cos + along * sin, -across];
        let [t, n, b] = axis;
        let mut tube = Tube { axis, lean: [cos, sin], radius, from: foot };
        let tip = match self.end {
            Some(End::Flat { .. }) => Tip::Flat,
            Some(End::Ball { radius, centre }) => {
                tube.from = centre;
                let aside = dx - centre * sin;
                let half2 = radius * radius - aside * aside;
                let [y, z] = Strip::above(at, 0.0, 0.0).point(along + centre * cos, across);
                Tip::Ball((half2 > 0.0).then(|| Disc::new([y, z], half2.sqrt())))
            }
            None => Tip::Other(self.mill),
        };
        LeaningSection {
            tip,
            tube,
            strip: Strip::above(at, radius, by_end.max(by_side)),
            is_through: self.mill.height(n, b).is_some_and(|u| t + u >= 0.0),
        }
    }
}

impl Tube {
    /// Where rays, as the attack direction sees them, enter and leave it; infinite where they do not.
    #[inline(always)]
    fn meet<S: Simd>(&self, simd: S, Rays { cos, sin }: &Rays<S>) -> [f64x8<S>; 2] {
        let splat = |value: f64| f64x8::splat(simd, value);
        let ([t, n, b], [upright, aslant]) = (self.axis, self.lean);
        let (cos, sin) = (*cos, *sin);
        let n_way = cos * -aslant;
        let square = n_way * n_way + sin * sin;
        let middle = n_way * -n - sin * b;
        let power = n * n + b * b - self.radius * self.radius;
        let q = middle * middle - square * power;
        let root = q.max(0.0).sqrt();
        let climb = cos * upright;
        // A ray along its end: so nearly so that the end is out of its way.
        let climb = climb.simd_eq(0.0).select(splat(f64::MIN_POSITIVE), climb);
        let end = splat(self.from - t) / climb;
        let is_outward = climb.simd_gt(0.0);
        let entry = ((middle - root) / square).max(0.0);
        let exit = (middle + root) / square;
        let entry = is_outward.select(entry.max(end), entry);
        let exit = is_outward.select(exit, exit.min(end));
        let is_met = q.simd_ge(0.0) & entry.simd_le(exit);
        let outside = splat(f64::INFINITY);
        [is_met.select(entry, outside), is_met.select(exit, outside)]
    }
}

impl Section for LeaningSection {
    #[inline(always)]
    fn nearest(&self) -> Option<[f64; 2]> {
        (!self.is_through).then(|| self.strip.nearest().unwrap_or([0.0; 2]))
    }

    #[inline(always)]
    fn bound<S: Simd>(&self, simd: S, rays: &Rays<S>) -> f64x8<S> {
        self.strip.bound(simd, rays)
    }

    #[inline(always)]
    fn meet<S: Simd>(&self, simd: S, rays: &Rays<S>, ends: f64x8<S>) -> [f64x8<S>; 2] {
        let seen = self.strip.seen(rays);
        let tube = self.tube.meet(simd, &seen);
        match &self.tip {
            Tip::Flat | Tip::Ball(None) => tube,
            Tip::Ball(Some(disc)) => joined(simd, [disc.meet(simd, rays, ends), tube]),
            Tip::Other(mill) => {
                let mut met = [f64x8::splat(simd, f64::INFINITY); 2];
                let may_be_met = tube[0].simd_lt(ends).to_bitmask();
                for lane in (0..ends.as_slice().len()).filter(|lane| may_be_met >> lane & 1 == 1) {
                    let ray = [seen.cos[lane], seen.sin[lane]];
                    let within = [tube[0][lane], tube[1][lane]];
                    if let Some([entry, exit]) = self.tube.enter(mill, ray, within, ends[lane]) {
                        (met[0][lane], met[1][lane]) = (entry, exit);
                    }
                }
                met
            }
        }
    }

    // A row cuts it in an ellipse, and its sections lie one beside the other.
    #[inline(always)]
    fn is_within<S: Simd>(&self, _: &Self, _: &Borders<S>, _: &[f64x8<S>; 2]) -> u64 {
        0
    }
}

impl Tube {
    /// Where a ray enters the mill in it and leaves it, if it enters before `limit`; the ray is in
    /// the tube on the stretch `[from, to]`.
    #[inline(never)]
    fn enter(
        &self,
        mill: &Mill,
        [cos, sin]: [f64; 2],
        [from, to]: [f64; 2],
        limit: f64,
    ) -> Option<[f64; 2]> {
        let ([t, n, b], [upright, aslant]) = (self.axis, self.lean);
        let g = |s: f64| {
            let jet = mill.along(n - s * cos * aslant, b + s * sin, -cos * aslant, sin);
            [t + s * cos * upright + jet.value, cos * upright + jet.slope]
        };
        let end = to.min(limit);
        let [entry, exit] = positive_stretch(g, [from, end])?;
        (entry < limit).then_some([entry, if exit == end { to } else { exit }])
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Layout, Resolution, Stance, Stock};
    use crate::geom::{Aabb, Point3, Vector3};
    use crate::machine::{AxisValues, Machine};
    use crate::progress::Silent;
    use crate::stock::Sweep;
    use crate::tool::{Cutter, HeightFunction, Profile};

    /// A round block of radius 20 and 40 mm high on the five-axis mill, its cradle held at an angle.
    fn block(tilt_deg: f64, resolution: f64) -> (Machine, AxisValues, Stock) {
        let mill = Machine::builtin("mill-5axis").unwrap();
        let mut values = mill.at_rest();
        values[mill.axis_index('A').unwrap()] = f64::to_radians(tilt_deg);
        let axis = mill.axis_index('C').unwrap();
        // Half as wide: the corners of the box are on the rim.
        let half = 20.0 / 2_f64.sqrt();
        let aabb = Aabb { min: Point3::new(-half, -half, 0.0), max: Point3::new(half, half, 40.0) };
        let layout = Layout::about(&mill, &values, axis, &aabb, Resolution::even(resolution));
        let stock = Stock::cylinder(layout.unwrap(), 20.0);
        (mill, values, stock)
    }

    #[test]
    fn a_leaning_ball_takes_every_ray_down_to_its_own_surface() {
        for tilt in [30.0, 60.0] {
            let (_, _, mut stock) = block(tilt, 1.0);
            let (radius, lean) = (5.0, f64::to_radians(90.0 - tilt));
            let layout = stock.layout().clone();
            // Its tip 3 mm below the surface, 20 mm up.
            let along = 17.0 / lean.cos();
            let up = layout.stance(0.0, 0.0, along).point.z;
            let stance = layout.stance(20.0 - up, 0.7, along);
            assert!((stance.point.z - 20.0).abs() < 1e-9, "{stance:?}");
            let middle = stance.point + stance.attack * radius;
            assert!((stance.attack.z.abs() - lean.sin()).abs() < 1e-9, "{stance:?}");
            let cutter = Profile::Ball { radius }.cutter(0.0);
            let before = stock.clone();
            stock.remove_at(&cutter, &[stance], &Silent).unwrap();
            let mut n_cut = 0;
            for row in 0..layout.n_rows() {
                for column in 0..layout.n_columns() {
                    let [end, old] = [&stock, &before].map(|s| s.end(row, column).unwrap());
                    let off = |value: f64| {
                        let out: Vector3 = layout.point(row, column, value) - middle;
                        let up = out.dot(&stance.attack).max(0.0);
                        (out - stance.attack * up).norm() - radius
                    };
                    if end < old {
                        n_cut += 1;
                        assert!(off(end).abs() < 1e-5, "{} at {row}, {column}", off(end));
                    } else {
                        assert!(off(end) > -1e-6, "{} is left at {row}, {column}", off(end));
                    }
                }
            }
            assert!(n_cut > 50, "{n_cut}");
        }
    }

    #[test]
    fn any_leaning_mill_takes_every_ray_down_to_where_its_height_function_says() {
        let profiles = [
            Profile::Flat { radius: 4.0 },
            Profile::Bull { radius: 5.0, corner_radius: 1.5 },
            Profile::BallCone { radius: 5.0, tip_radius: 1.0, half_angle: 0.3 },
        ];
        let tilts = [25.0, 60.0, 80.0].into_iter();
        for (tilt, profile) in tilts.flat_map(|tilt| profiles.map(|profile| (tilt, profile))) {
            let (_, _, mut stock) = block(tilt, 1.0);
            let layout = stock.layout().clone();
            let cutter = profile.cutter(0.0);
            let Cutter::Mill(mill) = cutter else { panic!("no mill") };
            let before = stock.clone();
            // The tip so far up, and so far from the axis: in the side, at the end, and deep.
            let stance = |height: f64, turn: f64, away: f64| {
                let along = away / f64::to_radians(90.0 - tilt).cos();
                let up = layout.stance(0.0, 0.0, along).point.z;
                layout.stance(height - up, turn, along)
            };
            let stances =
                [stance(20.0, 0.4, 16.0), stance(38.5, 2.6, 15.0), stance(8.0, 4.7, 11.0)];
            stock.remove_at(&cutter, &stances, &Silent).unwrap();
            // How far a place lies inside the tool, on its own axis' way or to its side.
            let inside = |place: &Point3| {
                let depths = stances.iter().map(|stance| {
                    let out: Vector3 = place - stance.point;
                    let along = out.dot(&stance.attack);
                    let aside = (out - stance.attack * along).norm();
                    let height = mill.height(aside.min(mill.reach().x), 0.0).unwrap();
                    (along + height).min(mill.reach().x - aside)
                });
                depths.fold(f64::NEG_INFINITY, f64::max)
            };
            let mut n_cut = 0;
            for row in 0..layout.n_rows() {
                for column in 0..layout.n_columns() {
                    let [end, old] = [&stock, &before].map(|s| s.end(row, column).unwrap_or(0.0));
                    let depth = inside(&layout.point(row, column, end));
                    if end < old {
                        n_cut += 1;
                        let is_on = depth.abs() < 1e-5 || end == 0.0;
                        assert!(is_on, "{profile} at {tilt}: {depth} at {row}, {column}");
                    } else {
                        assert!(depth < 1e-6, "{profile} at {tilt}: {depth} left");
                    }
                }
            }
            assert!(n_cut > 40, "{profile} at {tilt}: {n_cut}");
        }
    }

    #[test]
    fn a_leaning_flat_mill_turned_around_leaves_the_cone_of_its_side() {
        let (mill, mut values, mut stock) = block(60.0, 0.5);
        let layout = stock.layout().clone();
        let [a, c] = ['A', 'C'].map(|letter| mill.axis_index(letter).unwrap());
        assert!((values[a].to_degrees() - 60.0).abs() < 1e-9);
        // Where the machine must stand for the tip to be 20 cos 30 mm from the axis.
        let wanted = layout.stance(15.0, 0.0, 20.0);
        let turn = |values: &AxisValues| Stance::at(&mill, values).attack;
        let start = (0..3600)
            .map(|i| f64::from(i) / 3600.0 * std::f64::consts::TAU)
            .min_by(|x, y| {
                let off = |c_word: &f64| {
                    let mut values = values;
                    values[c] = *c_word;
                    (turn(&values) - wanted.attack).norm()
                };
                off(x).total_cmp(&off(y))
            })
            .unwrap();
        values[c] = start;
        let machine_point = mill.machine_from_part(&values) * wanted.point;
        let rest = mill.tool_point(&mill.at_rest());
        for (k, letter) in ['X', 'Y', 'Z'].into_iter().enumerate() {
            let axis = mill.axis_index(letter).unwrap();
            values[axis] = mill.at_rest()[axis] + machine_point[k] - rest[k];
        }
        assert!((Stance::at(&mill, &values).point - wanted.point).norm() < 0.1);
        let mut to = values;
        to[c] += std::f64::consts::TAU;
        let cutter = Profile::Flat { radius: 4.0 }.cutter(0.0);
        let sweep = Sweep { from: values, to, engages: true };
        stock.remove(&mill, &cutter, &[sweep], &Silent).unwrap();
        // The flat end turns into a cone about C: along the ray at a height, 30 degrees of lean.
        let lean = f64::to_radians(30.0);
        let point = Stance::at(&mill, &values).point;
        let (up, away) = (point.z, point.x.hypot(point.y));
        for dx in [-2.0, 0.0, 2.0] {
            let row = ((up + dx) / layout.resolution().along).round() as usize;
            let x = layout.row_x(row);
            let sign = wanted.attack.z.signum();
            let expected = away - (x - up) * sign * lean.tan();
            for column in (0..layout.n_columns()).step_by(17) {
                let end = stock.end(row, column).unwrap();
                assert!((end - expected).abs() < 0.05, "{end} for {expected} at {x}");
            }
        }
    }
}
