//! Lines of equal distance: marching squares.

use super::Across;
use super::field::Field;
use std::collections::BTreeMap;

/// A side of a square of four cells that a line crosses: the cell it begins at, and whether it
/// leads on along z.
type Side = (usize, usize, bool);

/// The closed lines where the field is `height`, what is lower on their left in x and z.
///
/// The field's border must be higher.
pub(super) fn rings(field: &Field, height: f64) -> Vec<Vec<Across>> {
    let mut next: BTreeMap<Side, Side> = BTreeMap::new();
    for j in 0..field.size[1] - 1 {
        for i in 0..field.size[0] - 1 {
            for [from, to] in crossings(field, height, i, j).into_iter().flatten() {
                next.insert(from, to);
            }
        }
    }
    let mut rings = Vec::new();
    while let Some((first, mut at)) = next.pop_first() {
        let mut ring = vec![place(field, height, first)];
        while at != first {
            ring.push(place(field, height, at));
            let Some(onwards) = next.remove(&at) else { break };
            at = onwards;
        }
        rings.push(ring);
    }
    rings
}

/// How the line crosses the square of cells from `(i, j)`, from side to side: not at all, once or
/// twice.
fn crossings(field: &Field, height: f64, i: usize, j: usize) -> [Option<[Side; 2]>; 2] {
    let corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)];
    let values = corners.map(|(i, j)| field.at(i, j));
    let low = values.map(|value| value < height);
    let [front, right, back, left] =
        [(i, j, false), (i + 1, j, true), (i, j + 1, false), (i, j, true)];
    let middle_is_low = values.iter().sum::<f64>() / 4.0 < height;
    // Corners in the order front left, front right, back right, back left; what is low stays left.
    match low {
        [false, false, false, false] | [true, true, true, true] => [None, None],
        [true, false, false, false] => [Some([front, left]), None],
        [false, true, false, false] => [Some([right, front]), None],
        [false, false, true, false] => [Some([back, right]), None],
        [false, false, false, true] => [Some([left, back]), None],
        [true, true, false, false] => [Some([right, left]), None],
        [false, true, true, false] => [Some([back, front]), None],
        [false, false, true, true] => [Some([left, right]), None],
        [true, false, false, true] => [Some([front, back]), None],
        [false, true, true, true] => [Some([left, front]), None],
        [true, false, true, true] => [Some([front, right]), None],
        [true, true, false, true] => [Some([right, back]), None],
        [true, true, true, false] => [Some([back, left]), None],
        [true, false, true, false] if middle_is_low => [Some([front, right]), Some([back, left])],
        [true, false, true, false] => [Some([front, left]), Some([back, right])],
        [false, true, false, true] if middle_is_low => [Some([left, front]), Some([right, back])],
        [false, true, false, true] => [Some([right, front]), Some([left, back])],
    }
}

/// Where the line crosses a side.
fn place(field: &Field, height: f64, (i, j, is_along_z): Side) -> Across {
    let (next_i, next_j) = if is_along_z { (i, j + 1) } else { (i + 1, j) };
    let (from, to) = (field.at(i, j), field.at(next_i, next_j));
    let share = (height - from) / (to - from);
    let (x, z) = (i as f64, j as f64);
    if is_along_z { field.place(x, z + share) } else { field.place(x + share, z) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ring_around_a_point_is_a_circle_with_what_is_low_on_its_left() {
        let point = [[[0.0, 0.0]; 3]];
        let field = Field::around(&point, 20.0, 0.25, 1e6).unwrap();
        let rings = rings(&field, 15.0);
        assert_eq!(rings.len(), 1);
        let ring = &rings[0];
        for [x, z] in ring {
            assert!((x.hypot(*z) - 15.0).abs() < 0.3, "{x} {z}");
        }
        let pairs = ring.iter().zip(ring.iter().cycle().skip(1));
        let area: f64 = pairs.map(|(p, q)| (p[0] * q[1] - q[0] * p[1]) / 2.0).sum();
        assert!((area / (std::f64::consts::PI * 225.0) - 1.0).abs() < 0.03, "{area}");
    }

    #[test]
    fn two_points_have_two_rings_near_by_and_one_far_off() {
        let points = [[[0.0, 0.0]; 3], [[10.0, 0.0]; 3]];
        let field = Field::around(&points, 20.0, 0.25, 1e6).unwrap();
        assert_eq!(rings(&field, 3.0).len(), 2);
        assert_eq!(rings(&field, 8.0).len(), 1);
    }
}
