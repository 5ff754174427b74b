//! Which triangle each pixel sees, and how far away.
//!
//! M. Olano and T. Greer, *Triangle scan conversion using 2D homogeneous coordinates* (1997): a ray `d`
//! from the eye passes through the triangle `a b c` if `d . (b x c)`, `d . (c x a)` and `d . (a x b)` have
//! one sign. Nothing is divided, so triangles that reach behind the eye need no clipping; and two
//! triangles with a common edge compute the same number for it but for the sign, so no pixel falls
//! between them.

use crate::geom::{Point3, Pose, TriMesh};
use crate::rgbd::{Camera, Image};
use rayon::prelude::*;

/// What a pixel sees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Seen {
    /// z in the camera [mm]; 0 if it sees nothing.
    pub(super) depth: f32,
    /// The triangle; meaningless if it sees nothing.
    pub(super) triangle: u32,
}

/// Nearer than this nothing is seen [mm].
const NEAREST: f64 = 1.0;
/// Rows that are drawn by one thread.
const BAND: usize = 16;
const NOTHING: Seen = Seen { depth: 0.0, triangle: 0 };

/// What `camera` (without distortion) sees of `mesh`, both sides of it. Of two triangles equally far
/// away the first in the mesh is seen.
pub(super) fn look(mesh: &TriMesh, camera: &Camera, camera_from_world: &Pose) -> Image<Seen> {
    let points: Vec<Point3> = mesh.points.par_iter().map(|p| camera_from_world * p).collect();
    let windows: Vec<Window> = mesh
        .triangles
        .par_iter()
        .map(|triangle| Window::around(triangle.map(|i| points[i as usize]), camera))
        .collect();
    let (width, height) = (camera.width, camera.height);
    let mut pixels = vec![NOTHING; width * height];
    pixels.par_chunks_mut(BAND * width).enumerate().for_each(|(i_band, pixels)| {
        let rows = i_band * BAND..(i_band * BAND + BAND).min(height);
        for (i, window) in windows.iter().enumerate() {
            let (top, bottom) = (window.top as usize, window.bottom as usize);
            if bottom <= rows.start || rows.end <= top {
                continue;
            }
            let triangle = Triangle::new(mesh.triangles[i].map(|i| points[i as usize]), i as u32);
            for y in rows.start.max(top)..rows.end.min(bottom) {
                let row = &mut pixels[(y - rows.start) * width..][..width];
                triangle.fill(row, y, window, camera);
            }
        }
    });
    // Whole rows by construction; an image of nothing is the answer to a bug alone.
    Image::new(width, height, pixels).unwrap_or_else(|_| Image::filled(0, 0, NOTHING))
}

/// The columns and rows in which a triangle may be seen.
struct Window {
    left: u16,
    right: u16,
    top: u16,
    bottom: u16,
}

impl Window {
    fn around(corners: [Point3; 3], camera: &Camera) -> Self {
        let (width, height) = (camera.width as u16, camera.height as u16);
        if corners.iter().all(|p| p.z < NEAREST) {
            return Self { left: 0, right: 0, top: 0, bottom: 0 };
        }
        if corners.iter().any(|p| p.z < NEAREST) {
            // Seen from infinitely far on one side: anywhere.
            return Self { left: 0, right: width, top: 0, bottom: height };
        }
        let columns = corners.map(|p| camera.fx * p.x / p.z + camera.cx);
        let rows = corners.map(|p| camera.fy * p.y / p.z + camera.cy);
        // A pixel more on each side than the exact borders: rounding decides nothing.
        let least = |values: [f64; 3]| values.into_iter().fold(f64::INFINITY, f64::min) - 1.0;
        let most = |values: [f64; 3]| values.into_iter().fold(f64::NEG_INFINITY, f64::max) + 2.0;
        // The cast cuts what lies outside to 0 and 65535.
        Self {
            left: (least(columns) as u16).min(width),
            right: (most(columns) as u16).min(width),
            top: (least(rows) as u16).min(height),
            bottom: (most(rows) as u16).min(height),
        }
    }
}

/// A triangle by what its sides are for a ray.
struct Triangle {
    /// Cross products of the corners two by two.
    sides: [[f64; 3]; 3],
    /// Six times the volume under the eye.
    volume: f64,
    number: u32,
}

impl Triangle {
    fn new([a, b, c]: [Point3; 3], number: u32) -> Self {
        let [a, b, c] = [a.coords, b.coords, c.coords];
        let sides = [b.cross(&c), c.cross(&a), a.cross(&b)];
        let volume = a.dot(&sides[0]);
        Self { sides: sides.map(Into::into), volume, number }
    }

    /// Draws the triangle into row `y` wherever it is nearer than what was drawn before.
    fn fill(&self, row: &mut [Seen], y: usize, window: &Window, camera: &Camera) {
        let ray_y = (y as f64 - camera.cy) / camera.fy;
        let parts = self.sides.map(|[x, y, z]| (x, y * ray_y + z));
        let columns = usize::from(window.left)..usize::from(window.right);
        for (x, seen) in columns.clone().zip(&mut row[columns]) {
            let ray_x = (x as f64 - camera.cx) / camera.fx;
            let [a, b, c] = parts.map(|(x, rest)| x * ray_x + rest);
            let is_inside =
                (a >= 0.0 && b >= 0.0 && c >= 0.0) || (a <= 0.0 && b <= 0.0 && c <= 0.0);
            // All three are 0 if the triangle is seen edge on.
            if !is_inside || a + b + c == 0.0 {
                continue;
            }
            let depth = self.volume / (a + b + c);
            let is_nearer = seen.depth == 0.0 || (depth as f32) < seen.depth;
            if depth >= NEAREST && depth <= f64::from(f32::MAX) && is_nearer {
                *seen = Seen { depth: depth as f32, triangle: self.number };
            }
        }
    }
}
