//! The wheel of a last lathe: a torus about x, filled inside; disc of R (in y-z) plus ball of r.
//!
//! Morell (2014), eq. 4.7; ARCHITECTURE section 4.

use super::height::{HeightFunction, Jet, Reach, Sharpness, Swept, Tangent};
use crate::geom::Vector3;
use fearless_simd::{f32x16, mask32x16, prelude::*};

/// A torus wheel by the radii of its height function.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wheel {
    /// From the wheel's axis to the centre of the nose circle [mm].
    pub major: f64,
    /// Of the nose circle [mm].
    pub minor: f64,
}

impl HeightFunction for Wheel {
    #[inline(always)]
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
    #[inline(always)]
    fn along(&self, x: f64, z: f64, dx: f64, dz: f64) -> Jet {
        let nose = (self.minor * self.minor - x * x).max(0.0).sqrt();
        let radius = self.major + nose;
        let value = (radius * radius - z * z).max(0.0).sqrt();
        let (nose_slope, nose_bend) = if dx == 0.0 {
            (0.0, 0.0)
        } else {
            let per_nose = 1.0 / nose;
            let slope = -x * dx * per_nose;
            (slope, -(dx * dx + slope * slope) * per_nose)
        };
        let per_value = 1.0 / value;
        let slope = (radius * nose_slope - z * dz) * per_value;
        let bend = nose_slope * nose_slope + radius * nose_bend - dz * dz - slope * slope;
        let bend = bend * per_value;
        Jet { value, slope, bend }
    }

    // The shadow is a capsule: all within r of the segment x = 0, |z| <= R.
    #[inline(always)]
    fn clip(&self, x: f64, z: f64, dx: f64, dz: f64) -> Option<[f64; 2]> {
        // Most edges lie wholly inside, which takes no root to see.
        if self.shadows(x, z) && self.shadows(x + dx, z + dz) {
            return Some([0.0, 1.0]);
        }
        let mut inside = Span::EMPTY;
        for end in [-self.major, self.major] {
            inside.add(disc_chord(x, z - end, dx, dz, self.minor));
        }
        let across = slab(x, dx, self.minor).and_then(|a| meet(a, slab(z, dz, self.major)?));
        inside.add(across);
        inside.within_unit()
    }

    #[inline(always)]
    fn support(&self, normal: &Vector3) -> Vector3 {
        let turned = (normal.y * normal.y + normal.z * normal.z).sqrt();
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

    #[inline(always)]
    fn tangent_within<S: Simd>(
        &self,
        simd: S,
        x: f32x16<S>,
        z: f32x16<S>,
        share: f32,
    ) -> Tangent<S> {
        let (major, minor) = (self.major as f32, self.minor as f32);
        let x_limit = minor * share;
        let x0 = x.max(-x_limit).min(x_limit);
        let nose = (f32x16::splat(simd, minor * minor) - x0 * x0).sqrt();
        let radius = nose + major;
        let z_limit = radius * share;
        let z0 = z.max(-z_limit).min(z_limit);
        let value = (radius * radius - z0 * z0).sqrt();
        // One division for both slopes.
        let scale = f32x16::splat(simd, 1.0) / (nose * value);
        Tangent { x0, z0, value, slope_x: -radius * x0 * scale, slope_z: -z0 * nose * scale }
    }

    // The support functions of the disc and of the ball it is grown by.
    #[inline(always)]
    fn lowest_plane<S: Simd>(&self, _simd: S, slope_x: f32x16<S>, slope_z: f32x16<S>) -> f32x16<S> {
        let turned = slope_z.mul_add(slope_z, 1.0);
        let whole = slope_x.mul_add(slope_x, turned);
        turned.sqrt().mul_add(self.major as f32, whole.sqrt() * self.minor as f32)
    }

    // Every factor of the second derivatives (see `least_bend`) grows with |x| and with |z|, so that
    // the corner farthest out tells for the whole rectangle.
    #[inline(always)]
    fn sharpness<S: Simd>(&self, simd: S, swept: &Swept<S>, share: f32) -> Sharpness<S> {
        let (major, minor) = (self.major as f32, self.minor as f32);
        let x_limit = minor * share;
        let least_radius = major + ((minor - x_limit) * (minor + x_limit)).sqrt();
        let z_limit = least_radius * share;
        let rim = major + minor;
        let beyond = least_radius.max(((rim - z_limit) * (rim + z_limit)).sqrt());
        let (x, z) = (swept.x.abs() - swept.half_x, swept.z.abs() - swept.half_z);
        let is_outside = x.simd_gt(minor) | z.simd_gt(rim);
        let (x, z) = (swept.x.abs() + swept.half_x, swept.z.abs() + swept.half_z);
        let is_within = x.simd_le(x_limit) & z.simd_le(z_limit);
        let (x, z) = (x.min(x_limit), z.min(z_limit));
        let nose2 = (f32x16::splat(simd, minor) - x) * (x + minor);
        let nose = nose2.sqrt();
        let radius = nose + major;
        let height = ((radius - z) * (radius + z)).sqrt();
        let (nose_slope, open) = (x / nose, radius / height);
        let turned = z / radius * nose_slope * swept.step_x + swept.step_z;
        let across = turned * turned * open * open * open / radius;
        let along = swept.step_x * swept.step_x * open * (minor * minor) / (nose2 * nose);
        Sharpness {
            slope_x: open * nose_slope,
            slope_z: z / height,
            bend: across + along,
            is_outside,
            is_within,
            beyond: beyond * (1.0 + 4.0 * f32::EPSILON),
        }
    }

    #[inline(always)]
    fn passes_by<S: Simd>(
        &self,
        _simd: S,
        x: f32x16<S>,
        z: f32x16<S>,
        radius: f32x16<S>,
    ) -> mask32x16<S> {
        let x_gap = x.abs() - radius - self.minor as f32;
        let z_gap = z.abs() - radius - (self.major + self.minor) as f32;
        x_gap.max(z_gap).simd_gt(0.0)
    }

    // With A, w as in `along` the quadratic form of the second derivatives in (a, b) is
    // -(z A' a - A b)^2 / u^3 - (A / u) (r^2 / w^3) a^2. Adding a^2 / r + b^2 / (R + r) and taking
    // the worst b leaves at most ((r^2 - w^2) / (w^2 A) - (r^3 - w^3) / (w^3 r)) a^2 <= 0, as w <= A.
    fn least_bend(&self) -> [f64; 2] {
        [1.0 / self.minor, 1.0 / (self.major + self.minor)]
    }

    fn reach(&self) -> Reach {
        let rim = self.major + self.minor;
        Reach { x: self.minor, z: rim, top: rim }
    }
}

impl Wheel {
    /// Is `(x, z)` within `minor` of the segment x = 0, |z| <= `major`?
    #[inline(always)]
    fn shadows(&self, x: f64, z: f64) -> bool {
        let beyond = (z.abs() - self.major).max(0.0);
        x * x + beyond * beyond <= self.minor * self.minor
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

#[inline(always)]
fn meet(a: [f64; 2], b: [f64; 2]) -> Option<[f64; 2]> {
    let (from, to) = (a[0].max(b[0]), a[1].min(b[1]));
    (from <= to).then_some([from, to])
}

/// Where `|at + s step| <= limit`.
#[inline(always)]
fn slab(at: f64, step: f64, limit: f64) -> Option<[f64; 2]> {
    if step == 0.0 {
        return (at.abs() <= limit).then_some([f64::NEG_INFINITY, f64::INFINITY]);
    }
    let (a, b) = ((-limit - at) / step, (limit - at) / step);
    Some([a.min(b), a.max(b)])
}

/// Where the line `(x + s dx, z + s dz)` runs inside the disc of `radius` about the origin.
#[inline(always)]
pub(crate) fn disc_chord(x: f64, z: f64, dx: f64, dz: f64, radius: f64) -> Option<[f64; 2]> {
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
