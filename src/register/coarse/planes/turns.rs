//! Turns that lay two planes of one cloud parallel to two of the other.

use super::Patch;
use crate::geom::{Matrix3, Vector3};
use nalgebra::{Rotation3, UnitQuaternion};

/// The largest planes of a cloud that make turns.
const MOST_PLANES: usize = 12;
/// Normals of two planes that make a turn enclose this at least: the sine of 20 degrees.
const APART: f64 = 0.342;
/// The angles of both pairs differ by no more than this [rad].
const SAME_ANGLE: f64 = 0.14;
/// Turns nearer than this are one [rad].
const SAME_TURN: f64 = 0.1;
/// Turns kept at most. A room of right angles has 24.
const MOST_TURNS: usize = 48;

/// The sides that the normals of two planes may point to; where they are known, the first.
const SIDES: [[f64; 2]; 4] = [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]];

/// The turns that pairs of planes with equal angles make, by how large the planes are.
pub(super) fn turns(
    source: &[Patch],
    target: &[Patch],
    is_oriented: bool,
) -> Vec<UnitQuaternion<f64>> {
    let [source, target] =
        [source, target].map(|patches| &patches[..patches.len().min(MOST_PLANES)]);
    let sides = if is_oriented { &SIDES[..1] } else { &SIDES };
    let mut found: Vec<(f64, UnitQuaternion<f64>)> = Vec::new();
    for (a, b) in pairs(source.len()).filter(|(a, b)| a < b) {
        let [from, next] = [source[a].normal, source[b].normal];
        if from.cross(&next).norm() < APART {
            continue;
        }
        let before = frame(&from, &next);
        for (c, d) in pairs(target.len()) {
            let large = source[a].area.min(target[c].area) * source[b].area.min(target[d].area);
            for [one, two] in sides {
                let (onto, other) = (target[c].normal * *one, target[d].normal * *two);
                if onto.cross(&other).norm() < APART
                    || (from.angle(&next) - onto.angle(&other)).abs() > SAME_ANGLE
                {
                    continue;
                }
                let turn = frame(&onto, &other) * before.transpose();
                let turn = Rotation3::from_matrix_unchecked(turn);
                found.push((large.sqrt(), UnitQuaternion::from_rotation_matrix(&turn)));
            }
        }
    }
    found.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut groups: Vec<(f64, UnitQuaternion<f64>)> = Vec::new();
    for (large, turn) in found {
        match groups.iter_mut().find(|group| group.1.angle_to(&turn) < SAME_TURN) {
            Some(group) => group.0 += large,
            None => groups.push((large, turn)),
        }
    }
    groups.sort_by(|a, b| b.0.total_cmp(&a.0));
    groups.into_iter().take(MOST_TURNS).map(|(_, turn)| turn).collect()
}

/// All two different numbers below `n`, in both orders.
fn pairs(n: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..n).flat_map(move |a| (0..n).map(move |b| (a, b))).filter(|(a, b)| a != b)
}

/// The right-handed frame of two directions that treats both alike: their sum, their difference.
fn frame(a: &Vector3, b: &Vector3) -> Matrix3 {
    let (x, y) = ((a + b).normalize(), (a - b).normalize());
    Matrix3::from_columns(&[x, y, x.cross(&y)])
}
