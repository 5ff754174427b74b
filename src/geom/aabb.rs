//! The axis-aligned bounding box.

use super::{Point3, Vector3};

/// An axis-aligned box; empty while `min > max` on any axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Aabb {
    /// The corner with the least coordinates [mm].
    pub min: Point3,
    /// The corner with the greatest coordinates [mm].
    pub max: Point3,
}

impl Aabb {
    /// The box around nothing; it grows to whatever is added.
    pub const EMPTY: Self = Self {
        min: Point3::new(f64::INFINITY, f64::INFINITY, f64::INFINITY),
        max: Point3::new(f64::NEG_INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY),
    };

    /// The smallest box around all `points`.
    pub fn around<'a>(points: impl IntoIterator<Item = &'a Point3>) -> Self {
        points.into_iter().fold(Self::EMPTY, Self::with)
    }

    /// The smallest box around this one and `point`.
    #[must_use]
    pub fn with(self, point: &Point3) -> Self {
        Self { min: self.min.inf(point), max: self.max.sup(point) }
    }

    /// True if nothing was ever added.
    pub fn is_empty(&self) -> bool {
        (0..3).any(|k| self.min[k] > self.max[k])
    }

    /// Lengths of the sides [mm]; zero for an empty box.
    pub fn size(&self) -> Vector3 {
        if self.is_empty() { Vector3::zeros() } else { self.max - self.min }
    }

    /// The middle of the box.
    pub fn center(&self) -> Point3 {
        nalgebra::center(&self.min, &self.max)
    }
}
