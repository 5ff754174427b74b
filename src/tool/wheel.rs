//! The wheel of a last lathe: a torus about x, filled inside; disc of R (in y-z) plus ball of r.
//!
//! Morell (2014), eq. 4.7; DESIGN section 3.

use super::height::{HeightFunction, Jet, Reach, Tangent};
use crate::geom::Vector3;
use wide::f32x8;

/// Tangent planes touch no farther out than this share of the shadow: the slope stays finite.
const TANGENT_SHARE: f32 = 0.85;

/// A torus wheel by the radii of its height function.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wheel {
    /// From the wheel's axis to the centre of the nose circle [mm].
    pub major: f64,
    /// Of the nose circle [mm].
    pub minor: f64,
}

impl HeightFunction for Wheel {
    fn height(&self, x: f64, z: f64) -> Option<f64> {
        let nose = self.minor * self.minor - x * x;
        if nose < 0.0 {
            return None;
        }
        let radius = self.major + nose.sqrt();
        let reach = radius * radius - z * z;
        (0.0 <= reach).then(|| reach.sqrt())
    }

    // With w^2 = r^2 - x^2, A = R + w and u^2 = A^2 - z^2, each derived twice along the line.
    fn along(&self, x: f64, z: f64, dx: f64, dz: f64) -> Jet {
        let nose = (self.minor * self.minor - x * x).max(0.0).sqrt();
        let radius = self.major + nose;
        let value = (radius * radius - z * z).max(0.0).sqrt();
        let (nose_slope, nose_bend) = if dx == 0.0 {
            (0.0, 0.0)
        } else {
            let slope = -x * dx / nose;
            (slope, -(dx * dx + slope * slope) / nose)
        };
        let slope = (radius * nose_slope - z * dz) / value;
        let bend = (nose_slope * nose_slope + radius * nose_bend - dz * dz - slope * slope) / value;
        Jet { value, slope, bend }
    }

    // The shadow is a capsule: all within r of the segment x = 0, |z| <= R.
    fn clip(&self, x: f64, z: f64, dx: f64, dz: f64) -> Option<[f64; 2]> {
        let mut inside = Span::EMPTY;
        for end in [-self.major, self.major] {
            inside.add(disc_chord(x, z - end, dx, dz, self.minor));
        }
        let across = slab(x, dx, self.minor).and_then(|a| meet(a, slab(z, dz, self.major)?));
        inside.add(across);
        inside.within_unit()
    }

    fn support(&self, normal: &Vector3) -> Vector3 {
        let turned = normal.y.hypot(normal.z);
        let radial = self.minor + self.major / turned;
        -Vector3::new(self.minor * normal.x, radial * normal.y, radial * normal.z)
    }

    fn normal_at(&self, x: f64, z: f64) -> Vector3 {
        let nose = (self.minor * self.minor - x * x).max(0.0).sqrt();
        let radius = self.major + nose;
        let height = (radius * radius - z * z).max(0.0).sqrt();
        let outward = Vector3::new(x * radius, -nose * height, nose * z);
        // A ball (major 0) and the very rim of a wheel of no width degenerate; up is as good as any.
        -outward.try_normalize(0.0).unwrap_or(-Vector3::y())
    }

    fn tangent(&self, x: f32x8, z: f32x8) -> Tangent {
        let (major, minor) = (f32x8::splat(self.major as f32), f32x8::splat(self.minor as f32));
        let x_limit = minor * TANGENT_SHARE;
        let x0 = x.max(-x_limit).min(x_limit);
        let nose = (minor * minor - x0 * x0).sqrt();
        let radius = major + nose;
        let z_limit = radius * TANGENT_SHARE;
        let z0 = z.max(-z_limit).min(z_limit);
        let value = (radius * radius - z0 * z0).sqrt();
        let per_value = f32x8::ONE / value;
        let slope_x = -(radius * x0) / nose * per_value;
        Tangent { x0, z0, value, slope_x, slope_z: -z0 * per_value }
    }

    fn passes_by(&self, x: f32x8, z: f32x8, radius: f32x8) -> f32x8 {
        let x_gap = x.abs() - radius - self.minor as f32;
        let z_gap = z.abs() - radius - (self.major + self.minor) as f32;
        x_gap.max(z_gap).simd_gt(f32x8::ZERO)
    }

    fn steepest_tangent(&self) -> f64 {
        let share = f64::from(TANGENT_SHARE);
        let steep = share / (1.0 - share * share).sqrt();
        steep + steep / (1.0 - share * share).sqrt()
    }

    fn reach(&self) -> Reach {
        let rim = self.major + self.minor;
        Reach { x: self.minor, z: rim, top: rim }
    }
}

/// A growing interval.
struct Span([f64; 2]);

impl Span {
    const EMPTY: Self = Self([f64::INFINITY, f64::NEG_INFINITY]);

    fn add(&mut self, span: Option<[f64; 2]>) {
        if let Some([from, to]) = span {
            self.0 = [self.0[0].min(from), self.0[1].max(to)];
        }
    }

    fn within_unit(&self) -> Option<[f64; 2]> {
        meet(self.0, [0.0, 1.0])
    }
}

fn meet(a: [f64; 2], b: [f64; 2]) -> Option<[f64; 2]> {
    let (from, to) = (a[0].max(b[0]), a[1].min(b[1]));
    (from <= to).then_some([from, to])
}

/// Where `|at + s step| <= limit`.
fn slab(at: f64, step: f64, limit: f64) -> Option<[f64; 2]> {
    if step == 0.0 {
        return (at.abs() <= limit).then_some([f64::NEG_INFINITY, f64::INFINITY]);
    }
    let (a, b) = ((-limit - at) / step, (limit - at) / step);
    Some([a.min(b), a.max(b)])
}

/// Where the line `(x + s dx, z + s dz)` runs inside the disc of `radius` about the origin.
pub(super) fn disc_chord(x: f64, z: f64, dx: f64, dz: f64, radius: f64) -> Option<[f64; 2]> {
    let speed = dx * dx + dz * dz;
    if speed == 0.0 {
        return (x * x + z * z <= radius * radius).then_some([f64::NEG_INFINITY, f64::INFINITY]);
    }
    let nearest = -(x * dx + z * dz) / speed;
    let across = x * dz - z * dx;
    let half = radius * radius - across * across / speed;
    if half < 0.0 {
        return None;
    }
    let half = (half / speed).sqrt();
    Some([nearest - half, nearest + half])
}
