//! An end mill that leans along the axis a part is turned about: the constant tilt of a table.
//!
//! As under an upright mill a ray from the axis enters a convex tool once, but the plane of a row
//! cuts the tool aslant. With `t` the attack direction, which leans by `lean` towards X, `e` square to
//! it in the plane of X, and `r` the way from the tip to the place `s` along the ray,
//! `g(s) = r.t + u(r.e, r.z)` is concave and not negative inside the tool.

use super::layout::At;
use super::row::{Columns, Cut, Row};
use super::stripe::{Bite, Stripe, Turn};
use crate::tool::{HeightFunction, Mill};
use fearless_simd::Simd;

/// The entry is found to within this [mm].
const CLOSE: f64 = 1e-7;
/// More halvings than this cannot be needed.
const MOST_HALVINGS: usize = 80;

/// A leaning mill at one place.
#[derive(Debug, Clone, Copy)]
pub(super) struct LeaningMillBite {
    mill: Mill,
    radius: f64,
    x: f64,
    /// Of the tip from the axis, along and across the direction the mill attacks from around it.
    along: f64,
    across: f64,
    /// That direction's angle about X.
    attack: f64,
    /// Cosine and sine of the lean.
    lean: [f64; 2],
    reach: [f64; 2],
    i_sweep: u32,
    engagement: u32,
}

/// A line through the tool's own frame: along it, and across it both ways; value and slope in `s`.
struct Line {
    along: [f64; 2],
    across: [[f64; 2]; 2],
}

impl LeaningMillBite {
    /// `top` is how far out material may lie.
    pub(super) fn new(mill: Mill, at: &At, top: f64, i_sweep: u32, engagement: u32) -> Self {
        let (lean_sin, lean_cos) = at.lean.sin_cos();
        let [along, across] = at.along_and_across();
        let (radius, x) = (mill.reach().x, at.point.x);
        // Farther up its own axis the tool is beyond all material.
        let length = ((top - along + radius * lean_sin.abs()) / lean_cos).max(0.0);
        let end = x + length * lean_sin;
        Self {
            mill,
            radius,
            x,
            along,
            across,
            attack: at.attack[1].atan2(at.attack[0]),
            lean: [lean_cos, lean_sin],
            reach: [x.min(end) - radius * lean_cos, x.max(end) + radius * lean_cos],
            i_sweep,
            engagement,
        }
    }

    /// The least distance of the tool from the axis, along the attack direction, `dx` beside its tip;
    /// as if its end were flat. `None` where it does not reach.
    fn lowest(&self, dx: f64) -> Option<f64> {
        let [cos, sin] = [self.lean[0], self.lean[1].abs()];
        let ahead = dx * self.lean[1].signum();
        // The farther on the leaning side of its axis, the lower; but not below its end.
        let aside = (ahead / cos).min(self.radius);
        (aside >= -self.radius)
            .then(|| self.along + (ahead - aside * cos) / sin * cos - aside * sin)
    }

    /// The rays that may meet the tool from `lowest` on and before `peak`.
    fn columns(&self, row: &Row, lowest: f64, peak: f64) -> Columns {
        if lowest <= 0.0 {
            return Columns::around(row.layout, 0.0, std::f64::consts::PI);
        }
        // A place beside the attack line is seen under the widest angle where it is nearest, and
        // under the narrowest where it is as far out as the peak.
        let angle = |across: f64, outward: f64| {
            let along = if across * outward > 0.0 { lowest } else { peak.max(lowest) };
            self.attack + across.atan2(along)
        };
        Columns::between(
            row.layout,
            angle(self.across - self.radius, -1.0),
            angle(self.across + self.radius, 1.0),
        )
    }

    /// The ray at an angle from the attack direction, as the tool sees it.
    fn line(&self, dx: f64, [cos, sin]: [f64; 2]) -> Line {
        let [lean_cos, lean_sin] = self.lean;
        Line {
            along: [dx * lean_sin - self.along * lean_cos, cos * lean_cos],
            across: [[dx * lean_cos + self.along * lean_sin, -cos * lean_sin], [-self.across, sin]],
        }
    }

    /// Where the ray enters the tool, and where it leaves it, if it enters before `limit`.
    fn enter(&self, line: &Line, limit: f64) -> Option<[f64; 2]> {
        let [[x, dx], [z, dz]] = line.across;
        let [from, to] = self.mill.clip(x, z, dx * limit, dz * limit)?;
        let exit = if to < 1.0 { to * limit } else { f64::INFINITY };
        let at = |s: f64| {
            let jet = self.mill.along(x + s * dx, z + s * dz, dx, dz);
            [line.along[0] + s * line.along[1] + jet.value, line.along[1] + jet.slope]
        };
        let (mut low, mut high) = (from * limit, to * limit);
        if high <= low {
            return None;
        }
        if at(low)[0] >= 0.0 {
            return Some([low, exit]);
        }
        // As under an upright mill: `low` stays outside, `high` is inside once `found`.
        let mut found = at(high)[0] >= 0.0;
        for _ in 0..MOST_HALVINGS {
            if high - low < CLOSE {
                break;
            }
            let middle = f64::midpoint(low, high);
            let [value, slope] = at(middle);
            if value >= 0.0 {
                (high, found) = (middle, true);
            } else if slope > 0.0 {
                // A tangent lies over a concave function: the way in is not before its root.
                low = middle - value / slope;
            } else if found {
                low = middle;
            } else {
                high = middle;
            }
        }
        (found && high < limit).then_some([high, exit])
    }

    /// Cuts one row.
    fn bite_row(&self, row: &mut Row, cut: &mut Cut) {
        let dx = row.x - self.x;
        let Some(lowest) = self.lowest(dx) else { return };
        if row.highest <= lowest {
            return;
        }
        let Line { along, across: [x, z] } = self.line(dx, [1.0, 0.0]);
        if self.mill.height(x[0], z[0]).is_some_and(|u| along[0] + u >= 0.0) {
            row.clear(self.engagement, cut);
            return;
        }
        let peak = row.peak(&self.columns(row, lowest, row.highest));
        if peak <= lowest {
            return;
        }
        let columns = self.columns(row, lowest, peak);
        row.engage(self.engagement);
        let before = cut.removed;
        for column in columns.0.iter().flat_map(Clone::clone) {
            let (sin, cos) = (column as f64 * row.layout.across[1] - self.attack).sin_cos();
            let end = row.ends[column];
            if end <= row.layout.floor {
                continue;
            }
            match self.enter(&self.line(dx, [cos, sin]), end) {
                Some([_, exit]) if exit < end => cut.n_overhangs += 1,
                Some([entry, _]) => row.lower(column, entry, cut),
                None => {}
            }
        }
        if cut.removed > before {
            row.renew_peaks(&columns);
        }
    }
}

impl Bite for LeaningMillBite {
    fn reach(&self) -> [f64; 2] {
        self.reach
    }

    fn i_sweep(&self) -> u32 {
        self.i_sweep
    }

    #[inline(always)]
    fn bite<S: Simd>(&self, _simd: S, turn: Turn<Self>, stripe: &mut Stripe, cut: &mut Cut) {
        for i in turn.rows {
            self.bite_row(&mut stripe.row(i), cut);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Layout, Resolution, Stance, Stock};
    use crate::geom::{Aabb, Point3, Vector3};
    use crate::machine::{AxisValues, Machine};
    use crate::progress::Silent;
    use crate::stock::Sweep;
    use crate::tool::Profile;

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
