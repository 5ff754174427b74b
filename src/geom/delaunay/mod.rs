//! The Delaunay tetrahedra of points: no point lies inside the ball around any four that make one.
//!
//! Points come one after the other. All tetrahedra whose ball holds the new point make way for ones that end
//! in it. Signs of volumes and balls are exact (Shewchuk 1997), so that points on a common sphere, plane or
//! line do no harm. Space beyond the hull is cells too, each over one facet of it.
//!
//! Bowyer (1981), Watson (1981); the order of insertion after Amenta, Choi and Rote (2003).

mod insert;
mod order;

use super::{Point3, weld};
use crate::progress::{Cancelled, Progress};
use insert::Insertion;
use order::insertion_order;

/// The corner that cells beyond the hull have in place of a point.
pub const BEYOND: u32 = u32::MAX;

/// A tetrahedron, or the space beyond a facet of the hull.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Cell {
    /// Its corners, positively wound; [`BEYOND`] is one of them if it lies beyond the hull.
    pub corners: [u32; 4],
    /// The cells across the facets opposite to each corner.
    pub across: [u32; 4],
}

/// Why points have no tetrahedra.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum DelaunayError {
    /// There are too few of them, or all lie in a plane.
    #[error("{n_points} points in one plane span no body; give points that do")]
    Flat {
        /// Points given.
        n_points: usize,
    },
    /// The caller asked to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// The cells over finite `points`. Of points in one place only the first becomes a corner.
pub fn delaunay(points: &[Point3], progress: &dyn Progress) -> Result<Vec<Cell>, DelaunayError> {
    let first = weld(points);
    let order = insertion_order(points, |i| first[i as usize] == i);
    let flat = DelaunayError::Flat { n_points: points.len() };
    let (mut insertion, rest) = Insertion::begin(points, &order).ok_or(flat)?;
    progress.start("tetrahedra", rest.len() as u64);
    for chunk in rest.chunks(1024) {
        for &i_point in chunk {
            insertion.insert(i_point);
        }
        progress.advance(chunk.len() as u64)?;
    }
    Ok(insertion.into_cells())
}

impl Cell {
    /// True if it lies beyond the hull.
    pub fn is_beyond(&self) -> bool {
        self.corners.contains(&BEYOND)
    }

    /// The facet opposite to corner `i`, counter-clockwise seen from outside the cell.
    pub fn facet(&self, i: usize) -> [u32; 3] {
        let [a, b, c, d] = self.corners;
        match i {
            0 => [b, d, c],
            1 => [a, c, d],
            2 => [a, d, b],
            _ => [a, b, c],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::insert::{in_ball, volume_sign};
    use super::*;
    use crate::progress::Silent;

    fn drawn(n: u32) -> Vec<Point3> {
        let at = |i: u32| {
            let t = f64::from(i);
            [(t * 0.618_034).fract(), (t * 0.754_878).fract(), (t * 0.569_84).fract()]
        };
        (0..n).map(|i| Point3::from(at(i)) * 100.0).collect()
    }

    /// Cells fit together, are wound positively, fill the hull, and hold no point in their balls.
    fn assert_delaunay(points: &[Point3], volume: f64) {
        let cells = delaunay(points, &Silent).unwrap();
        let mut filled = 0.0;
        for (i_cell, cell) in cells.iter().enumerate() {
            for (i, &beyond) in cell.across.iter().enumerate() {
                let back = &cells[beyond as usize];
                let j = back.across.iter().position(|&c| c as usize == i_cell).unwrap();
                let sorted = |mut facet: [u32; 3]| {
                    facet.sort_unstable();
                    facet
                };
                assert_eq!(sorted(cell.facet(i)), sorted(back.facet(j)));
            }
            if cell.is_beyond() {
                continue;
            }
            let corners = cell.corners.map(|i| points[i as usize]);
            assert!(volume_sign(&corners) > 0.0);
            let [a, b, c, d] = corners;
            filled += (a - d).cross(&(b - d)).dot(&(c - d)).abs() / 6.0;
            assert!(points.iter().all(|p| in_ball(&corners, p) <= 0.0));
            let facet = cell.facet(3).map(|i| points[i as usize]);
            let out = (facet[1] - facet[0]).cross(&(facet[2] - facet[0]));
            assert!(out.dot(&(d - facet[0])) < 0.0, "a facet is wound as seen from outside");
        }
        assert!((filled - volume).abs() < 1e-6 * volume, "{filled} of {volume}");
    }

    #[test]
    fn no_ball_holds_a_point_and_the_hull_is_filled() {
        let mut points = drawn(300);
        for i in 0..8 {
            points.push(Point3::new(
                f64::from(i & 1) * 100.0,
                f64::from(i & 2) * 50.0,
                f64::from(i & 4) * 25.0,
            ));
        }
        assert_delaunay(&points, 1e6);
    }

    #[test]
    fn a_grid_whose_every_cube_lies_on_a_sphere_is_no_trouble() {
        let axis = || (0..6).map(f64::from);
        let grid = axis().flat_map(|x| axis().flat_map(move |y| axis().map(move |z| [x, y, z])));
        assert_delaunay(&grid.map(Point3::from).collect::<Vec<_>>(), 125.0);
    }

    #[test]
    fn points_in_one_place_are_one_corner() {
        let mut points = drawn(60);
        let once = delaunay(&points, &Silent).unwrap();
        points.extend_from_within(..);
        let corners = |cells: &[Cell]| cells.iter().flat_map(|c| c.corners).collect::<Vec<_>>();
        assert_eq!(corners(&delaunay(&points, &Silent).unwrap()), corners(&once));
    }

    #[test]
    fn points_that_span_no_body_are_refused() {
        let plane: Vec<_> = drawn(50).iter().map(|p| Point3::new(p.x, p.y, 3.0)).collect();
        for points in [&plane[..], &plane[..3], &[]] {
            let error = delaunay(points, &Silent).unwrap_err();
            assert_eq!(error, DelaunayError::Flat { n_points: points.len() });
        }
    }
}
