//! The part as it lies under the tool at one position.

use crate::geom::{Matrix3, Point3, Pose, Vector3};

/// The attack frame from the part frame, ready for many points.
#[derive(Debug, Clone, Copy)]
pub(in crate::cam) struct View {
    /// Turns part directions into attack directions.
    pub(super) rotation: Matrix3,
    /// The part's origin, seen from the tool's programmed point [mm].
    pub(super) shift: Vector3,
}

impl View {
    pub(in crate::cam) fn new(attack_from_part: &Pose) -> Self {
        Self {
            rotation: attack_from_part.rotation.to_rotation_matrix().into_inner(),
            shift: attack_from_part.translation.vector,
        }
    }

    /// One coordinate of a part point; [`see`](Self::see) gives the same bits.
    #[inline(always)]
    pub(super) fn coordinate(&self, axis: usize, point: &Point3) -> f64 {
        self.turned(axis, &point.coords) + self.shift[axis]
    }

    #[inline(always)]
    fn turned(&self, axis: usize, direction: &Vector3) -> f64 {
        let row = |k| self.rotation[(axis, k)];
        row(0) * direction.x + row(1) * direction.y + row(2) * direction.z
    }

    /// A part point in the attack frame.
    #[inline(always)]
    pub(super) fn see(&self, point: &Point3) -> Vector3 {
        Vector3::from_fn(|axis, _| self.coordinate(axis, point))
    }

    /// A unit normal of the part in the attack frame, turned so that it faces the tool: soups have
    /// any winding.
    #[inline(always)]
    pub(super) fn facing(&self, normal: &Vector3) -> Vector3 {
        let turned = Vector3::from_fn(|axis, _| self.turned(axis, normal));
        if turned.y < 0.0 { -turned } else { turned }
    }

    /// A point of the attack frame back in the part.
    pub(super) fn part_point(&self, seen: &Vector3) -> Point3 {
        self.rotation.tr_mul(&(seen - self.shift)).into()
    }

    /// A direction of the attack frame back in the part.
    pub(super) fn part_direction(&self, seen: &Vector3) -> Vector3 {
        self.rotation.tr_mul(seen)
    }
}
