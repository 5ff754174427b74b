//! What a picture shows and from where.

use crate::geom::{Point3, TriMesh, Vector3};

/// What stands before the camera.
#[derive(Debug, Clone, Default)]
pub struct Scene<'a> {
    /// Shaded surfaces.
    pub solids: Vec<Solid<'a>>,
    /// Lines drawn on and around them.
    pub paths: Vec<Path<'a>>,
}

/// A surface; vertex colours of the mesh go before `color`.
#[derive(Debug, Clone, Copy)]
pub struct Solid<'a> {
    /// Triangles of any winding: both sides are lit alike.
    pub mesh: &'a TriMesh,
    /// Red, green, blue where the mesh has no colours.
    pub color: [u8; 3],
}

/// A line through points, hidden where a solid stands before it.
#[derive(Debug, Clone, Copy)]
pub struct Path<'a> {
    /// Its corners [mm].
    pub points: &'a [Point3],
    /// Red, green, blue.
    pub color: [u8; 3],
    /// Width in the picture.
    pub width_px: f64,
}

/// Where a parallel view looks and how large the picture is; the scene always fills it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// From the eye into the scene; any length.
    pub direction: Vector3,
    /// What is up in the picture; need not be square to `direction`.
    pub up: Vector3,
    /// Width and height; at most [`Camera::LARGEST_PX`] each.
    pub size_px: [u32; 2],
}

impl Camera {
    /// The largest width or height of a picture; greater ones are cut to it.
    pub const LARGEST_PX: u32 = 4096;

    /// From before, beside and above: X to the right, Z up.
    pub fn three_quarter(size_px: [u32; 2]) -> Self {
        Self { direction: Vector3::new(0.45, 0.8, -0.5), up: Vector3::z(), size_px }
    }

    /// From the side, against +Y: X to the right, Z up.
    pub fn side(size_px: [u32; 2]) -> Self {
        Self { direction: Vector3::y(), up: Vector3::z(), size_px }
    }

    /// From above: X to the right, Y up.
    pub fn top(size_px: [u32; 2]) -> Self {
        Self { direction: -Vector3::z(), up: Vector3::y(), size_px }
    }

    /// Rows right, up and into the scene, unit and square to each other, whatever was given.
    pub(super) fn frame(&self) -> [Vector3; 3] {
        let forward = self.direction.try_normalize(1e-12).unwrap_or(Vector3::y());
        let across = |up: &Vector3| forward.cross(up).try_normalize(1e-9);
        let right = across(&self.up)
            .or_else(|| across(&Vector3::z()))
            .or_else(|| across(&Vector3::y()))
            .unwrap_or(Vector3::x());
        [right, right.cross(&forward), forward]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn top_view_has_x_to_the_right_and_y_up() {
        let [right, up, forward] = Camera::top([10, 10]).frame();
        assert!((right - Vector3::x()).norm() < 1e-12);
        assert!((up - Vector3::y()).norm() < 1e-12);
        assert!((forward + Vector3::z()).norm() < 1e-12);
    }

    #[test]
    fn camera_that_looks_along_its_up_still_has_a_frame() {
        for direction in [Vector3::z(), Vector3::zeros(), Vector3::y()] {
            let camera = Camera { direction, up: direction, size_px: [10, 10] };
            let [right, up, forward] = camera.frame();
            assert!((right.cross(&up) + forward).norm() < 1e-12, "{direction}");
        }
    }
}
