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
    /// The rows and columns of a cloud, where the file has them.
    pub(super) grid: Option<RawGrid>,
}

/// The rows and columns in which a scanner saw a cloud.
pub(super) struct RawGrid {
    pub(super) width: usize,
    pub(super) height: usize,
    /// The point in each cell, row by row, if there is one; without a list they come in this order.
    pub(super) cells: Option<Vec<Option<u32>>>,
}

impl Raw {
    pub(super) fn new(surface: Surface) -> Self {
        Self { surface, declared: None, metres_are_customary: false, notes: Vec::new(), grid: None }
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
