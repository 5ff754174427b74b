//! Motions that two surfaces do not hold: how a plane slides and a ball turns.

use crate::geom::{Matrix3, Point3, Vector3};
use nalgebra::{DMatrix, SymmetricEigen, Vector6};
use std::fmt;

/// A free motion that turns less than this share (squared) slides.
const TURNS: f64 = 0.05;
/// Rising by more than this share of the lever per radian is screwing.
const RISE: f64 = 0.2;
/// The cosine within which a direction is called by an axis' name.
const AXIS: f64 = 0.99;

/// A motion that leaves the fit as it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FreeMotion {
    /// What it does.
    pub kind: MotionKind,
    /// The direction or axis, a unit vector in the target's frame.
    pub along: Vector3,
    /// A point of the axis, in the target's frame [mm].
    pub through: Point3,
}

/// What a free motion does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MotionKind {
    /// Shifts along its direction.
    Sliding,
    /// Turns about its axis.
    Turning,
    /// Does both at once.
    Screwing,
}

impl fmt::Display for FreeMotion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let verb = match self.kind {
            MotionKind::Sliding => "sliding along",
            MotionKind::Turning => "turning about",
            MotionKind::Screwing => "screwing along",
        };
        let mut named = ["x", "y", "z"].into_iter().zip(self.along.iter());
        if let Some((name, _)) = named.find(|(_, share)| share.abs() > AXIS) {
            return write!(f, "{verb} {name}");
        }
        let [x, y, z] = self.along.into();
        write!(f, "{verb} ({x:.2}, {y:.2}, {z:.2})")
    }
}

/// The motions spanned by `directions`, taken apart: pure shifts, then turns about their axes.
///
/// Each direction is a unit step, turn times `lever` before shift, about `pivot`.
pub(in crate::register) fn free_motions(
    directions: &[Vector6<f64>],
    lever: f64,
    pivot: &Point3,
) -> Vec<FreeMotion> {
    if directions.is_empty() {
        return Vec::new();
    }
    // Turns of the combinations, by size: those that hardly turn are shifts.
    let turns = |d: &Vector6<f64>| Vector3::new(d[0], d[1], d[2]);
    let shifts = |d: &Vector6<f64>| Vector3::new(d[3], d[4], d[5]);
    let n = directions.len();
    let gram = DMatrix::from_fn(n, n, |a, b| turns(&directions[a]).dot(&turns(&directions[b])));
    let eigen = SymmetricEigen::new(gram);
    let combined = |k: usize| -> Vector6<f64> {
        directions
            .iter()
            .zip(eigen.eigenvectors.column(k).iter())
            .map(|(d, share)| d * *share)
            .sum()
    };
    let (turning, sliding): (Vec<usize>, Vec<usize>) =
        (0..n).partition(|&k| eigen.eigenvalues[k] > TURNS);
    let slides = plain_axes(sliding.iter().map(|&k| shifts(&combined(k))));
    let turning: Vec<Vector6<f64>> = turning.into_iter().map(combined).collect();
    let axes = plain_axes(turning.iter().map(turns));
    let slide =
        |along: &Vector3| FreeMotion { kind: MotionKind::Sliding, along: *along, through: *pivot };
    let turn = |axis: &Vector3| {
        // The combination that turns about this axis alone; the others' turns are square to it.
        let share = |d: &Vector6<f64>| turns(d).dot(axis) / turns(d).norm_squared();
        let shift: Vector3 = turning.iter().map(|d| shifts(d) * share(d)).sum();
        let shift = slides.iter().fold(shift, |left, along| left - along * along.dot(&left));
        let is_screw = axis.dot(&shift).abs() > RISE;
        FreeMotion {
            kind: if is_screw { MotionKind::Screwing } else { MotionKind::Turning },
            along: *axis,
            through: pivot + axis.cross(&shift) * lever,
        }
    };
    slides.iter().map(slide).chain(axes.iter().map(turn)).collect()
}

/// Unit vectors square to each other that span what `vectors` do, along the axes of the frame where
/// they can be.
fn plain_axes(vectors: impl Iterator<Item = Vector3>) -> Vec<Vector3> {
    let mut span = Matrix3::zeros();
    let mut n_vectors = 0;
    for vector in vectors {
        let left = vector - span * vector;
        if let Some(unit) = left.try_normalize(1e-6) {
            span += unit * unit.transpose();
            n_vectors += 1;
        }
    }
    let mut found = Vec::new();
    for _ in 0..n_vectors {
        let shadows = [Vector3::x(), Vector3::y(), Vector3::z()].map(|axis| span * axis);
        let [mut best, second, third] = shadows;
        for other in [second, third] {
            if other.norm_squared() > best.norm_squared() + 1e-9 {
                best = other;
            }
        }
        let unit = best.normalize();
        span -= unit * unit.transpose();
        // Of both signs the one with the greater component positive.
        found.push(if unit[unit.iamax()] < 0.0 { -unit } else { unit });
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(directions: &[[f64; 6]]) -> Vec<String> {
        let directions: Vec<Vector6<f64>> =
            directions.iter().map(|d| Vector6::from_column_slice(d).normalize()).collect();
        let motions = free_motions(&directions, 10.0, &Point3::origin());
        motions.iter().map(ToString::to_string).collect()
    }

    #[test]
    fn a_mixture_of_a_planes_freedoms_is_taken_apart() {
        let mixed = [
            [0.0, 0.0, 1.0, 1.0, 1.0, 0.0],
            [0.0, 0.0, 1.0, -1.0, 0.0, 0.0],
            [0.0, 0.0, 1.0, 1.0, -2.0, 0.0],
        ];
        assert_eq!(words(&mixed), ["sliding along x", "sliding along y", "turning about z"]);
    }

    #[test]
    fn oblique_directions_are_told_in_numbers_and_screws_as_such() {
        assert_eq!(
            words(&[[0.0, 0.0, 0.0, -3.0, 0.0, -4.0]]),
            ["sliding along (0.60, 0.00, 0.80)"]
        );
        assert_eq!(words(&[[0.0, 1.0, 0.0, 0.0, 1.0, 0.0]]), ["screwing along y"]);
        assert!(words(&[]).is_empty());
    }

    #[test]
    fn a_turn_has_its_axis_where_it_is() {
        // About z through (30, 0, 0): the pivot, ten millimetres of lever, moves along -y by 30.
        let direction = Vector6::new(0.0, 0.0, 10.0, 0.0, -30.0, 0.0).normalize();
        let [motion] = free_motions(&[direction], 10.0, &Point3::origin())[..] else { panic!() };
        assert_eq!(motion.kind, MotionKind::Turning);
        assert!((motion.through - Point3::new(30.0, 0.0, 0.0)).norm() < 1e-9);
    }
}
