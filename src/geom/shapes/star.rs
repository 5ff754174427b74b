//! Bodies star-shaped about X, given by their radius at each station and angle.

use super::solids::capped;
use crate::geom::{Point3, SectionGrid, TriMesh};
use std::f64::consts::TAU;

/// A body of 120 mm with a helical lobe: turned, slid or flipped end for end it never equals its
/// mirror image, so it tells a rotary axis of the wrong sign from a right one.
///
/// Closed, about `n_triangles` triangles, radius between 10 and 26 mm.
pub fn chiral(n_triangles: usize) -> TriMesh {
    star(120.0, n_triangles, |x, angle| {
        let lobe = (angle - 0.6 * TAU * x).cos();
        (20.0 + 4.0 * lobe + 1.5 * (2.0 * angle + 0.3 * TAU * x).cos()) * (1.0 - 0.25 * x)
    })
}

/// A last-like body of 240 mm, radius 28 to 42 mm, with waves along and around: smooth, closed,
/// about `n_triangles` triangles.
pub fn bumpy_cylinder(n_triangles: usize) -> TriMesh {
    star(240.0, n_triangles, |x, angle| {
        let along = 3.0 * (2.0 * TAU * x).sin();
        let around = 2.5 * (3.0 * angle).cos() * (1.5 * TAU * x).cos() + 1.5 * (2.0 * angle).sin();
        35.0 + along + around
    })
}

/// The body with `radius(x / length, angle)` from `x = 0` to `length`, with flat ends; cells about
/// square at a radius of `length / 8`.
fn star(length: f64, n_triangles: usize, radius: impl Fn(f64, f64) -> f64) -> TriMesh {
    let n_columns = ((n_triangles as f64 * TAU / 16.0).sqrt().round() as usize).max(8);
    let n_rows = (n_triangles / (2 * n_columns)).max(2);
    let mut points = Vec::with_capacity(n_rows * n_columns);
    for row in 0..n_rows {
        let x = row as f64 / (n_rows - 1) as f64;
        for column in 0..n_columns {
            let angle = TAU * column as f64 / n_columns as f64;
            let (sin, cos) = angle.sin_cos();
            let radius = radius(x, angle);
            points.push(Point3::new(length * x, radius * cos, radius * sin));
        }
    }
    let grid = SectionGrid { n_columns, points };
    capped(&grid, Point3::origin(), Point3::new(length, 0.0, 0.0))
}

#[cfg(test)]
mod tests {
    use super::super::solids::tests::{assert_watertight, volume};
    use super::*;

    #[test]
    fn star_bodies_are_closed_and_as_fine_as_asked() {
        for (mesh, n_triangles) in [(chiral(5_000), 5_000.0), (bumpy_cylinder(20_000), 20_000.0)] {
            assert_watertight(&mesh);
            assert!(volume(&mesh) > 0.0);
            let ratio = mesh.triangles.len() as f64 / n_triangles;
            assert!((0.95..1.05).contains(&ratio), "{ratio}");
        }
    }

    #[test]
    fn radii_stay_in_the_ranges_their_docs_name() {
        for (mesh, range) in [(chiral(5_000), 10.0..26.0), (bumpy_cylinder(5_000), 28.0..42.0)] {
            let surface = &mesh.points[..mesh.points.len() - 2];
            assert!(surface.iter().all(|p| range.contains(&p.y.hypot(p.z))));
        }
    }

    #[test]
    fn chiral_body_is_not_its_mirror_image_however_turned() {
        let body = chiral(5_000);
        let n_columns = body.points.iter().take_while(|p| p.x == 0.0).count();
        let radius = |row: usize, column: usize| {
            let p = body.points[row * n_columns + column % n_columns];
            p.y.hypot(p.z)
        };
        let n_rows = (body.points.len() - 2) / n_columns;
        // Mirroring turns column c into column -c; flipping end for end about an axis across X as
        // well turns the mirror image into one with rows reversed and columns kept.
        let worst = |image: &dyn Fn(usize, usize) -> f64| {
            let cells = (0..n_rows).flat_map(|r| (0..n_columns).map(move |c| (r, c)));
            cells.map(|(r, c)| (radius(r, c) - image(r, c)).abs()).fold(0.0, f64::max)
        };
        for turn in 0..n_columns {
            let mirrored = |row, column| radius(row, 2 * n_columns - column + turn);
            let flipped = |row, column| radius(n_rows - 1 - row, column + turn);
            assert!(worst(&mirrored) > 1.0, "mirrored and turned by {turn} it looks the same");
            assert!(worst(&flipped) > 1.0, "flipped and turned by {turn} it looks the same");
        }
    }
}
