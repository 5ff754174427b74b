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

/// The map, unless there is no place that stays uncut.
pub(super) fn picture(
    reach: &ReachReport,
    setup: &SetupReport,
) -> std::io::Result<Option<Picture>> {
    let missed = reach.undercut + reach.hollow + reach.clamped;
    if reach.places.is_empty() || missed <= 0.0 {
        return Ok(None);
    }
    let is_turned = setup.swing > 0.0;
    let grid = if is_turned { unrolled(reach) } else { from_above(reach) };
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
    let cut = if reach.deepest > 0.0 && reach.clamped > 0.0 {
        " Under clamps it may be more than the scale shows."
    } else {
        ""
    };
    Ok(Some(Picture {
        title: "How far the tool stays off.".to_owned(),
        caption: format!("{view}Dark: the tool touches.{undercut}{cut}"),
        image: Image::Svg(heat_map(&grid, labels, "mm")?),
    }))
}

/// X by angle about it. Where places lie over each other the worst counts.
fn unrolled(reach: &ReachReport) -> Grid {
    let x = extent(&reach.places, |place| place.point.x);
    let angle = |place: &Place| place.point.z.atan2(place.point.y).rem_euclid(TAU).to_degrees();
    let mut map = Map::new(reach.places.len(), x, [0.0, 360.0]);
    for place in &reach.places {
        map.add([place.point.x, angle(place)], shown(place.off, reach), f64::max);
    }
    while map.fill(true) {}
    map.grid
}

/// X by Y. An underside is an undercut as well, but what counts is the surface over it: undercuts
/// go only where that leaves room.
fn from_above(reach: &ReachReport) -> Grid {
    let x = extent(&reach.places, |place| place.point.x);
    let y = extent(&reach.places, |place| place.point.y);
    let mut map = Map::new(reach.places.len(), x, y);
    let (upper, under): (Vec<&Place>, Vec<&Place>) =
        reach.places.iter().partition(|place| place.off.is_finite());
    for place in upper {
        map.add([place.point.x, place.point.y], shown(place.off, reach), f64::max);
    }
    for _ in 0..WIDEST_GAP {
        map.fill(false);
    }
    for place in under {
        map.add([place.point.x, place.point.y], place.off, |upper, _| upper);
    }
    map.grid
}

/// Under a clamp the tool may stay off by centimetres; next to that no hollow would be seen.
fn shown(off: f64, reach: &ReachReport) -> f64 {
    if off.is_finite() && reach.deepest > 0.0 { off.min(reach.deepest) } else { off }
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
