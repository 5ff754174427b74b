//! Space beyond the hull: small holes there are seen as such.
//!
//! Through a hole that lies on the hull both sides of the surface reach out of it, as they do round the rim of
//! a sheet. Where the hole is small, what lies beyond it is put on the other side, and the surface closes.

use crate::geom::{Cell, Point3};

/// On which side most of the space beyond the hull is.
pub(super) fn outside(cells: &[Cell], sides: &[bool]) -> bool {
    let beyond = || cells.iter().zip(sides).filter(|(cell, _)| cell.is_beyond());
    beyond().count() < 2 * beyond().filter(|(_, side)| **side).count()
}

/// Turns those parts of the space beyond that lie on the wrong side over a hole with a rim no longer than
/// `longest`.
pub(super) fn close(points: &[Point3], cells: &[Cell], sides: &mut [bool], longest: f64) {
    let outside = outside(cells, sides);
    let mut is_done = vec![false; cells.len()];
    for first in 0..cells.len() {
        if !cells[first].is_beyond() || sides[first] == outside || is_done[first] {
            continue;
        }
        is_done[first] = true;
        let mut part = vec![first as u32];
        let (mut next, mut rim) = (0, 0.0);
        while let Some(&here) = part.get(next) {
            next += 1;
            let cell = &cells[here as usize];
            for (k, &there) in cell.across.iter().enumerate() {
                if !cells[there as usize].is_beyond() {
                    continue;
                }
                if sides[there as usize] == outside {
                    rim += hull_edge(points, cell, k);
                } else if !std::mem::replace(&mut is_done[there as usize], true) {
                    part.push(there);
                }
            }
        }
        // What mostly carries faces of the surface already is the other side of a sheet.
        let is_bare = |here: &&u32| {
            let inner =
                cells[**here as usize].across.iter().find(|&&c| !cells[c as usize].is_beyond());
            inner.is_some_and(|&inner| sides[inner as usize] == sides[**here as usize])
        };
        let n_bare = part.iter().filter(is_bare).count();
        if rim <= longest && part.len() <= 2 * n_bare {
            for cell in part {
                sides[cell as usize] = outside;
            }
        }
    }
}

/// The length of the edge of the hull across which the cell opposite to corner `k` lies.
fn hull_edge(points: &[Point3], cell: &Cell, k: usize) -> f64 {
    let facet = cell.facet(k).into_iter().filter_map(|i| points.get(i as usize));
    let ends: Vec<&Point3> = facet.collect();
    if let [a, b] = ends[..] { (a - b).norm() } else { 0.0 }
}
