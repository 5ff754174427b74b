//! The lines of the last as functions of the station, and the sections they make.
//!
//! All figures are drawn for a last of 265 mm and scaled to the length asked for; a station `u`
//! runs from 0 at the heel to 1 at the toe.

use super::{lines::Lines, parameters::Sizes};
use crate::geom::{Point3, SectionGrid, Vector3};
use std::f64::consts::PI;

/// Length of the drawing [mm].
const DRAWN: f64 = 265.0;
/// Feather edge at heel and toe: the body bulges over both [mm].
const FEATHER: [f64; 2] = [5.0, 262.5];
/// Ridge over heel and toe [mm].
const RIDGE: [f64; 2] = [24.0, 248.0];
/// The cone top falls this much towards the heel [mm per mm].
const CONE_SLOPE: f64 = 0.07;

/// A last of certain sizes and fullness.
pub(super) struct Form {
    /// Factor on widths and on the height of the forepart: what the ball girth is fitted with.
    pub(super) fullness: f64,
    sizes: Sizes,
    cone_front: [f64; 2],
    lines: Lines,
}

/// One leaning cross-section: its two feather points, its ridge point, and the handles between.
struct Section {
    /// Lateral, then medial.
    sides: [SideCurve; 2],
    /// How deep the bottom bulges below the feather points [mm].
    crown: f64,
}

/// A cubic Bezier curve from the feather edge (first) to the ridge (last).
#[derive(Clone, Copy)]
struct SideCurve([Point3; 4]);

impl Form {
    /// The form of `sizes` with the given fullness.
    pub(super) fn new(sizes: &Sizes, fullness: f64) -> Self {
        let drawn = |size: f64| size * DRAWN / sizes.length;
        let heel = drawn(sizes.heel_height);
        let spring = drawn(sizes.toe_spring);
        let cone = [drawn(sizes.cone_length), drawn(sizes.cone_height)];
        let u_cone = (cone[0] - RIDGE[0]) / (RIDGE[1] - RIDGE[0]);
        let lines = Lines::new(heel, spring, [u_cone, cone[1]], fullness);
        Self { fullness, sizes: sizes.clone(), cone_front: cone, lines }
    }

    /// The body as sections from heel to toe. The first and the last are folded flat, so that the
    /// grid closes once its equal points are welded.
    pub(super) fn sections(&self) -> SectionGrid {
        let cells = self.cells();
        let n_stations = (1.2 * cells).ceil() as usize;
        let mut points = Vec::new();
        for i in 0..=n_stations {
            // Stations crowd where heel and toe turn round.
            let u = (1.0 - (PI * i as f64 / n_stations as f64).cos()) / 2.0;
            points.extend(self.section(u).ring(self.cone_front, cells));
        }
        let n_columns = points.len() / (n_stations + 1);
        self.scale(&mut points);
        SectionGrid { n_columns, points }
    }

    /// The columns of the lateral and the medial feather edge in those sections.
    pub(super) fn feather_columns(&self) -> [usize; 2] {
        let [n_side, n_top, _] = cell_counts(self.cells());
        [0, 2 * n_side + n_top]
    }

    /// Stick length [mm].
    pub(super) fn length(&self) -> f64 {
        self.sizes.length
    }

    fn cells(&self) -> f64 {
        self.sizes.length / self.sizes.resolution
    }

    /// To the length asked for, exactly, and down to the ground.
    fn scale(&self, points: &mut [Point3]) {
        let (x_min, x_max) = extent(points.iter().map(|p| p.x));
        let (z_min, _) = extent(points.iter().map(|p| p.z));
        let scale = self.sizes.length / DRAWN;
        for p in points {
            let x = (p.x - x_min) / (x_max - x_min) * self.sizes.length;
            *p = Point3::new(x, p.y * scale, (p.z - z_min) * scale);
        }
    }

    fn section(&self, u: f64) -> Section {
        let side = |sign: f64| {
            let feather = self.feather(u, sign);
            let outward = self.outward(u, sign);
            let ridge_x = lerp(RIDGE, u);
            let ridge_y = self.fullness * (self.lines.middle.at(u) + self.lines.ridge_offset.at(u));
            let ridge = Point3::new(ridge_x, ridge_y, self.lines.ridge.at(u));
            let bulge = self.lines.bulge[usize::from(sign < 0.0)].at(u) * self.fullness;
            let slope = self.lines.ridge.slope(u) / (RIDGE[1] - RIDGE[0]);
            let dome = outward * (self.lines.dome.at(u) * self.fullness);
            SideCurve([
                feather,
                feather + outward * bulge + Vector3::z() * self.lines.rise.at(u),
                ridge + dome + Vector3::z() * (slope * dome.x),
                ridge,
            ])
        };
        Section { sides: [side(1.0), side(-1.0)], crown: self.lines.crown.at(u) * self.rounding(u) }
    }

    /// The feather edge on the lateral (`sign` 1) or medial side (-1).
    fn feather(&self, u: f64, sign: f64) -> Point3 {
        let width = if sign > 0.0 { &self.lines.lateral } else { &self.lines.medial };
        let rounding = self.rounding(u);
        let y = self.lines.middle.at(u) + sign * width.at(u) * rounding;
        Point3::new(
            lerp(FEATHER, u),
            self.fullness * y,
            self.lines.bottom.at(u) + self.lines.crown.at(u) * rounding,
        )
    }

    /// What heel and toe leave of the width: a half circle behind, a longer bow in front.
    fn rounding(&self, u: f64) -> f64 {
        let bow = |t: f64, power: f64| (1.0 - (1.0 - t.clamp(0.0, 1.0)).powf(power)).sqrt();
        bow(u / 0.2, 3.0) * bow((1.0 - u) / 0.34, self.sizes.toe_roundness)
    }

    /// Square to the feather edge in plan, away from the body.
    fn outward(&self, u: f64, sign: f64) -> Vector3 {
        // Exactly the same from both sides, or the folded sections would not close.
        if u == 0.0 {
            return -Vector3::x();
        }
        if u == 1.0 {
            return Vector3::x();
        }
        // By station angle, not by u: there the outline is smooth round heel and toe.
        let angle = (1.0 - 2.0 * u).acos();
        let at = |angle: f64| self.feather((1.0 - angle.cos()) / 2.0, sign);
        let along = at((angle + 1e-5).min(PI)) - at((angle - 1e-5).max(0.0));
        Vector3::new(-sign * along.y, sign * along.x, 0.0).normalize()
    }
}

impl Section {
    /// The closed line round the section: up the lateral side, over the top, down the medial side
    /// and back along the bottom.
    fn ring(&self, cone_front: [f64; 2], cells: f64) -> Vec<Point3> {
        let [n_side, n_top, n_bottom] = cell_counts(cells);
        let [lateral, medial] = self.sides;
        let sawn = [lateral, medial].map(|side| side.height_reached(cone_front));
        let top = [lateral.at(sawn[0]), medial.at(sawn[1])];
        let share = |i: usize, n: usize| i as f64 / n as f64;
        let up = (0..n_side).map(|i| lateral.at(sawn[0] * share(i, n_side)));
        let over = (0..n_top).map(|i| top[0] + (top[1] - top[0]) * share(i, n_top));
        let down = (0..n_side).map(|i| medial.at(sawn[1] * share(n_side - i, n_side)));
        let back = (0..n_bottom).map(|i| self.bottom(share(i, n_bottom)));
        up.chain(over).chain(down).chain(back).collect()
    }

    /// The bottom from the medial (0) to the lateral feather point (1).
    fn bottom(&self, share: f64) -> Point3 {
        let [lateral, medial] = self.sides.map(|side| side.0[0]);
        let depth = self.crown * (1.0 - (2.0 * share - 1.0).powi(2));
        medial + (lateral - medial) * share - Vector3::z() * depth
    }
}

impl SideCurve {
    fn at(&self, t: f64) -> Point3 {
        let s = 1.0 - t;
        let weights = [s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t];
        let sum = self.0.iter().zip(weights).map(|(p, w)| p.coords * w);
        Point3::from(sum.sum::<Vector3>())
    }

    /// Where the curve passes the plane of the cone top; 1 if its ridge stays below.
    fn height_reached(&self, [x_front, z_front]: [f64; 2]) -> f64 {
        let above = |t: f64| {
            let p = self.at(t);
            p.z - z_front - CONE_SLOPE * (p.x - x_front)
        };
        if above(1.0) <= 0.0 {
            return 1.0;
        }
        let (mut below, mut over) = (0.0, 1.0);
        for _ in 0..60 {
            let middle = f64::midpoint(below, over);
            if above(middle) < 0.0 { below = middle } else { over = middle }
        }
        over
    }
}

/// Columns of a section on each side, over the top and along the bottom, for a length of `cells`.
fn cell_counts(cells: f64) -> [usize; 3] {
    [0.22, 0.04, 0.2].map(|share| (share * cells).ceil() as usize)
}

fn lerp([from, to]: [f64; 2], share: f64) -> f64 {
    from + (to - from) * share
}

fn extent(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)))
}
