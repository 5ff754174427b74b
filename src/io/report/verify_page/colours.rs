//! What was cut, coloured by how far it is from the part.

use crate::geom::TriMesh;
use crate::workflow::verify::Verified;

/// Too deep, right, and material left; told apart by colour-blind eyes too.
const GOUGE: [f64; 3] = [202.0, 0.0, 32.0];
const RIGHT: [f64; 3] = [238.0, 238.0, 232.0];
const LEFT: [f64; 3] = [5.0, 80.0, 175.0];
/// Nothing to compare with: clamps.
const NOTHING: [u8; 3] = [138, 146, 158];

/// The surface that was cut, its vertices coloured: red where it is too deep, blue where material is
/// left, both in full at `full` millimetres; grey where there is no part to compare with.
pub fn deviation_map(verified: &Verified, full: f64) -> TriMesh {
    let mut mesh = verified.surface.clone();
    let n_points = mesh.points.len();
    let rays = verified.deviation.iter().map(|&distance| color(distance, full));
    let colors: Vec<[u8; 3]> = rays.chain(std::iter::repeat(NOTHING)).take(n_points).collect();
    mesh.colors = Some(colors);
    mesh
}

fn color(distance: f64, full: f64) -> [u8; 3] {
    if distance.is_nan() {
        return NOTHING;
    }
    let share = (distance / full).clamp(-1.0, 1.0);
    let end = if share < 0.0 { GOUGE } else { LEFT };
    [0, 1, 2].map(|k| (RIGHT[k] + (end[k] - RIGHT[k]) * share.abs()).round() as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn red_is_too_deep_blue_is_left_and_grey_is_no_part() {
        let [r, _, b] = color(-1.0, 0.1);
        assert!(r > 150 && b < 60);
        let [r, _, b] = color(1.0, 0.1);
        assert!(b > 150 && r < 60);
        assert_eq!(color(f64::NAN, 0.1), NOTHING);
        assert_eq!(color(0.0, 0.1), [238, 238, 232]);
    }
}
