//! Whether a point lies where its surface ends.

use crate::geom::{Neighbour, Point3, Vector3};
use std::f64::consts::{FRAC_PI_2, TAU};

/// Neighbours this far apart, seen from the point, leave room for a border.
const GAP: f64 = FRAC_PI_2;

/// True if the neighbours of point `i_point` leave a quarter or more of its tangent plane free.
pub fn is_border(
    points: &[Point3],
    i_point: usize,
    normal: &Vector3,
    neighbours: &[Neighbour],
) -> bool {
    let across = if normal.x.abs() < 0.6 { Vector3::x() } else { Vector3::y() };
    let u = normal.cross(&across).normalize();
    let v = normal.cross(&u);
    let mut angles: Vec<f64> = neighbours
        .iter()
        .map(|neighbour| points[neighbour.index as usize] - points[i_point])
        .filter(|out| out.norm_squared() > 0.0)
        .map(|out| out.dot(&v).atan2(out.dot(&u)))
        .collect();
    angles.sort_unstable_by(f64::total_cmp);
    let around = angles.last().zip(angles.first()).map_or(TAU, |(last, first)| first + TAU - last);
    let widest = angles.windows(2).map(|pair| pair[1] - pair[0]).fold(around, f64::max);
    widest >= GAP + 1e-6
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::KdTree;
    use crate::progress::Silent;

    #[test]
    fn the_border_of_a_square_sheet_is_its_outermost_points() {
        let points: Vec<Point3> =
            (0..400).map(|i| Point3::new(f64::from(i % 20), f64::from(i / 20), 0.0)).collect();
        let tree = KdTree::build(&points);
        let border = tree
            .map_neighbourhoods(&points, 20, &Silent, |i, found| {
                is_border(&points, i, &Vector3::z(), found)
            })
            .unwrap();
        for (point, is_border) in points.iter().zip(border) {
            let edge = |x: f64| x == 0.0 || x == 19.0;
            assert_eq!(is_border, edge(point.x) || edge(point.y), "{point}");
        }
    }
}
