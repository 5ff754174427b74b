//! What a format's reader hands over before units are settled.

use super::fault::{Fault, Place};
use crate::geom::{LengthUnit, Point3, Surface};

/// A surface in the file's own unit.
pub(super) struct Raw {
    pub(super) surface: Surface,
    /// The unit, where the file says it.
    pub(super) declared: Option<LengthUnit>,
    /// The standard of the format, or the habit of its users, is metres.
    pub(super) metres_are_customary: bool,
    /// What the user must know: what was left out and why.
    pub(super) notes: Vec<String>,
}

impl Raw {
    pub(super) fn new(surface: Surface) -> Self {
        Self { surface, declared: None, metres_are_customary: false, notes: Vec::new() }
    }
}

/// Farther out nothing is a part: the number is garbage, and squares of it would overflow.
const FARTHEST: f64 = 1e12;

/// `point` if all its coordinates are lengths.
pub(super) fn checked(point: Point3, place: Place) -> Result<Point3, Fault> {
    for (axis, value) in ['x', 'y', 'z'].into_iter().zip(point.iter().copied()) {
        if value.is_nan() || value.abs() > FARTHEST {
            return Err(Fault::BadCoordinate { place, axis, value });
        }
    }
    Ok(point)
}

/// "1 point", "2 points".
pub(super) fn counted(n: usize, thing: &str) -> String {
    format!("{n} {thing}{}", if n == 1 { "" } else { "s" })
}
