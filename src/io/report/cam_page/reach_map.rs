//! The part unrolled, or seen from above, with how far the tool stays off it everywhere.

use super::super::{Grid, Image, Labels, Picture, heat_map};
use crate::cam::{Place, ReachReport};
use crate::workflow::cam::SetupReport;
use std::f64::consts::TAU;

/// Width by height of a map: that of the plot it fills.
const ASPECT: f64 = 1.75;
/// Places per cell, about: fewer leave holes, more blur.
const PLACES_A_CELL: f64 = 2.0;
/// The most cells across; finer ones are no more than pixels.
const MOST_COLUMNS: f64 = 240.0;
/// Seen from above, gaps between places are this many cells wide at most; beyond lies the table.
const WIDEST_GAP: usize = 2;

/// A tool less than this off the surface is taken to touch it [mm].
const TOUCHES: f64 = 0.02;
/// This share of the places the tool stays off lies within the scale.
const SHARE_WITHIN: f64 = 0.9;
/// Fewer places than this make no picture.
const FEWEST_PLACES: usize = 500;

/// The map, unless it would show nothing: all is reached, or the triangles are too few.
pub(super) fn picture(
    reach: &ReachReport,
    setup: &SetupReport,
) -> std::io::Result<Option<Picture>> {
    let is_turned = setup.swing > 0.0;
    // On a table undercuts lie on the underside, which the map does not show.
    let turned_away = if is_turned { reach.undercut } else { 0.0 };
    let missed = turned_away + reach.hollow + reach.clamped;
    if reach.places.len() < FEWEST_PLACES || missed <= 0.0 {
        return Ok(None);
    }
    let cut = cut_at(&reach.places);
    let grid =
        if is_turned { unrolled(&reach.places, cut) } else { from_above(&reach.places, cut) };
    let labels = if is_turned {
        Labels { x: "X along the spindle [mm]", y: "angle about it [deg]" }
    } else {
        Labels { x: "X [mm]", y: "Y [mm]" }
    };
    let view = if is_turned {
        "The surface unrolled about the spindle; 90° points to Z. "
    } else {
        "The surface seen from above; what lies under another place is not shown. "
    };
    let undercut = if reach.undercut > 0.0 { " Orange: undercut, never reached." } else { "" };
    Ok(Some(Picture {
        title: "How far the tool stays off.".to_owned(),
        caption: format!(
            "{view}Dark: the tool touches. Brightest: it stays off by {cut:.2} mm or more.{undercut}"
        ),
        image: Image::Svg(heat_map(&grid, labels, "mm")?),
    }))
}

/// X by angle about it. Where places lie over each other the worst counts.
fn unrolled(places: &[Place], cut: f64) -> Grid {
    let x = extent(places, |place| place.point.x);
    let angle = |place: &Place| place.point.z.atan2(place.point.y).rem_euclid(TAU).to_degrees();
    let mut map = Map::new(places.len(), x, [0.0, 360.0]);
    for place in places {
        map.add([place.point.x, angle(place)], shown(place.off, cut), f64::max);
    }
    while map.fill(true) {}
    map.grid
}

/// X by Y. An underside is an undercut as well, but what counts is the surface over it: undercuts
/// go only where that leaves room.
fn from_above(places: &[Place], cut: f64) -> Grid {
    let x = extent(places, |place| place.point.x);
    let y = extent(places, |place| place.point.y);
    let mut map = Map::new(places.len(), x, y);
    let (upper, under): (Vec<&Place>, Vec<&Place>) =
        places.iter().partition(|place| place.off.is_finite());
    for place in upper {
        map.add([place.point.x, place.point.y], shown(place.off, cut), f64::max);
    }
    for _ in 0..WIDEST_GAP {
        map.fill(false);
    }
    for place in under {
        map.add([place.point.x, place.point.y], place.off, |upper, _| upper);
    }
    map.grid
}

/// Where the scale ends: under a clamp, or in a fold of a scan, the tool may stay off by
/// centimetres, and next to that no hollow would be seen.
fn cut_at(places: &[Place]) -> f64 {
    let off = places.iter().map(|place| place.off);
    let mut off: Vec<f64> = off.filter(|off| (TOUCHES..f64::INFINITY).contains(off)).collect();
    off.sort_unstable_by(f64::total_cmp);
    off.get((off.len() as f64 * SHARE_WITHIN) as usize).map_or(TOUCHES, |&off| off)
}

fn shown(off: f64, cut: f64) -> f64 {
    if off.is_finite() { off.min(cut) } else { off }
}

fn extent(places: &[Place], coordinate: impl Fn(&Place) -> f64) -> [f64; 2] {
    let all = places.iter().map(coordinate);
    all.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], at| [low.min(at), high.max(at)])
}

/// A grid that places fall into.
struct Map {
    grid: Grid,
    n_rows: usize,
}

impl Map {
    fn new(n_places: usize, x: [f64; 2], y: [f64; 2]) -> Self {
        let across = (n_places as f64 / PLACES_A_CELL * ASPECT).sqrt().clamp(4.0, MOST_COLUMNS);
        let (n_columns, n_rows) = (across as usize, (across / ASPECT) as usize);
        let values = vec![f64::NAN; n_columns * n_rows];
        Self { grid: Grid { n_columns, values, x, y }, n_rows }
    }

    /// Puts `value` where it belongs; `both` decides between it and what is there.
    fn add(&mut self, [x, y]: [f64; 2], value: f64, both: impl Fn(f64, f64) -> f64) {
        let cell = |at: f64, [low, high]: [f64; 2], n: usize| {
            (((at - low) / (high - low) * n as f64) as usize).min(n - 1)
        };
        let row = cell(y, self.grid.y, self.n_rows);
        let i = row * self.grid.n_columns + cell(x, self.grid.x, self.grid.n_columns);
        let here = &mut self.grid.values[i];
        *here = if here.is_nan() { value } else { both(*here, value) };
    }

    /// Gives empty cells beside others the worst value of these; true if there was one. The first
    /// row follows the last one of a map that is `closed`.
    fn fill(&mut self, closed: bool) -> bool {
        let before = self.grid.values.clone();
        let (n_columns, n_rows) = (self.grid.n_columns, self.n_rows);
        let mut filled = false;
        for i in (0..before.len()).filter(|&i| before[i].is_nan()) {
            let (row, column) = (i / n_columns, i % n_columns);
            let below = if row > 0 { Some(row - 1) } else { closed.then_some(n_rows - 1) };
            let above = if row + 1 < n_rows { Some(row + 1) } else { closed.then_some(0) };
            let rows = [below, above].into_iter().flatten().map(|row| row * n_columns + column);
            let left = (column > 0).then(|| i - 1);
            let right = (column + 1 < n_columns).then(|| i + 1);
            let worst = rows.chain(left).chain(right).map(|i| before[i]).fold(f64::NAN, f64::max);
            filled |= !worst.is_nan();
            self.grid.values[i] = worst;
        }
        filled
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Point3;

    /// A tube along X, touched everywhere but near X = 10, where the tool stays 3 mm off.
    fn tube() -> Vec<Place> {
        let place = |i: usize| {
            let (x, angle) = (20.0 * (i / 60) as f64 / 39.0, TAU * (i % 60) as f64 / 60.0);
            let point = Point3::new(x, 30.0 * angle.cos(), 30.0 * angle.sin());
            Place { point, off: if (x - 10.0).abs() < 2.0 { 3.0 } else { 0.0 } }
        };
        (0..2400).map(place).collect()
    }

    #[test]
    fn the_unrolled_map_has_x_to_the_right_and_no_holes() {
        let grid = unrolled(&tube(), 3.0);
        assert_eq!((grid.x, grid.y), ([0.0, 20.0], [0.0, 360.0]));
        for row in grid.values.chunks(grid.n_columns) {
            let middle = grid.n_columns / 2;
            assert_eq!([row[0], row[middle], row[grid.n_columns - 1]], [0.0, 3.0, 0.0]);
        }
    }

    #[test]
    fn an_undercut_is_seen_where_the_surface_is_unrolled() {
        let mut places = tube();
        // At 90 degrees, towards Z, near the end.
        places[39 * 60 + 15].off = f64::INFINITY;
        let grid = unrolled(&places, 3.0);
        let at = grid.values.iter().position(|value| value.is_infinite()).unwrap();
        let n_rows = grid.values.len() / grid.n_columns;
        assert_eq!(at % grid.n_columns, grid.n_columns - 1);
        assert!(((at / grid.n_columns) as f64 / n_rows as f64 - 0.25).abs() < 0.05);
    }

    #[test]
    fn an_underside_is_not_seen_from_above_and_the_table_beside_the_part_is_nothing() {
        // A sheet over the left half of the table, and its underside; a post far to the right.
        let place = |x, y, z, off| Place { point: Point3::new(x, y, z), off };
        let over = |i: i32| (f64::from(i % 50), f64::from(i / 50));
        let mut places = Vec::new();
        for (x, y) in (0..2500).map(over) {
            places.push(place(x, y, 5.0, 0.0));
            places.push(place(x, y, 0.0, f64::INFINITY));
        }
        places.push(place(100.0, 25.0, 5.0, 1.0));
        let grid = from_above(&places, 1.0);
        assert!(!grid.values.iter().any(|value| value.is_infinite()));
        assert!(grid.values[grid.n_columns - 1].is_nan(), "the corner right of the sheet");
        assert_eq!(grid.values[0], 0.0);
    }

    #[test]
    fn the_scale_leaves_out_the_few_places_far_beyond_the_others() {
        let off = |off| Place { point: Point3::origin(), off };
        let mut places: Vec<Place> = (0..100).map(|i| off(f64::from(i) / 100.0)).collect();
        places.extend([off(120.0), off(f64::INFINITY)]);
        assert!((0.8..1.0).contains(&cut_at(&places)), "{}", cut_at(&places));
        assert_eq!(cut_at(&[off(0.0), off(f64::INFINITY)]), TOUCHES);
    }
}
