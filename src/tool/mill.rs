//! End mills: profiles of revolution about the attack axis, programmed at the tip.
//!
//! One shape serves ball, flat, bull, cone and ball-cone mills (the APT tool): seen from the axis
//! outwards a flat, a corner arc, a straight flank, and a rim arc that only an allowance makes.

use super::height::{HeightFunction, Jet, Reach, Tangent};
use super::wheel::disc_chord;
use crate::geom::Vector3;
use wide::f32x8;

/// Tangent planes touch arcs no farther out than this share of their radius: the slope stays finite.
const TANGENT_SHARE: f64 = 0.85;

/// An end mill by the pieces of its height function `u(rho)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mill {
    /// The corner arc: around `rho = flat`, the tool's flat radius.
    corner: Arc,
    /// The straight flank of a cone, if there is one.
    flank: Option<Flank>,
    /// Where the shadow ends [mm].
    radius: f64,
}

/// `u = sqrt(radius^2 - (rho - center)^2) - rise`, level inside `center`.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Arc {
    center: f64,
    radius: f64,
    rise: f64,
}

/// `u = at - slope (rho - from)` from where the corner arc ends to where the rim arc begins.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Flank {
    slope: f64,
    from: f64,
    at: f64,
    to: f64,
    rim: Arc,
}

impl Mill {
    /// A cylinder of `flat + corner` with a flat end and a corner arc, grown by `allowance`.
    pub fn straight(flat: f64, corner: f64, allowance: f64) -> Self {
        let arc = Arc { center: flat, radius: corner + allowance, rise: corner };
        Self { corner: arc, flank: None, radius: flat + arc.radius }
    }

    /// A cone of `half_angle` with a ball of `tip` at its point, up to `radius`, grown by
    /// `allowance`.
    pub fn tapered(tip: f64, half_angle: f64, radius: f64, allowance: f64) -> Self {
        let (sin, cos) = half_angle.sin_cos();
        let corner = Arc { center: 0.0, radius: tip + allowance, rise: tip };
        let slope = cos / sin;
        let from = corner.radius * cos;
        let at = corner.radius * sin - corner.rise;
        // The ungrown flank reaches `radius` this far below the programmed point.
        let depth = tip - tip * sin + slope * (radius - tip * cos);
        let rim = Arc { center: radius, radius: allowance, rise: depth };
        let flank = Flank { slope, from, at, to: radius + allowance * cos, rim };
        Self { corner, flank: Some(flank), radius: radius + allowance }
    }

    /// `u`, `u'` and `u''` at a distance from the axis.
    fn profile(&self, rho: f64) -> Jet {
        match &self.flank {
            Some(flank) if flank.to < rho => flank.rim.jet(rho),
            Some(flank) if flank.from < rho => {
                let value = flank.at - flank.slope * (rho - flank.from);
                Jet { value, slope: -flank.slope, bend: 0.0 }
            }
            _ => self.corner.jet(rho),
        }
    }

    /// How far from the axis tangent planes may touch.
    fn tangent_limit(&self) -> f64 {
        let outer = self.flank.map_or(self.corner, |flank| flank.rim);
        outer.center + TANGENT_SHARE * outer.radius
    }
}

impl Arc {
    fn jet(&self, rho: f64) -> Jet {
        let out = rho - self.center;
        if out <= 0.0 {
            return Jet { value: self.radius - self.rise, slope: 0.0, bend: 0.0 };
        }
        let height = (self.radius * self.radius - out * out).max(0.0).sqrt();
        let slope = -out / height;
        let bend = -(1.0 + slope * slope) / height;
        Jet { value: height - self.rise, slope, bend }
    }
}

impl HeightFunction for Mill {
    fn height(&self, x: f64, z: f64) -> Option<f64> {
        let rho = x.hypot(z);
        (rho <= self.radius).then(|| self.profile(rho).value)
    }

    fn along(&self, x: f64, z: f64, dx: f64, dz: f64) -> Jet {
        let rho = x.hypot(z);
        let speed = dx.hypot(dz);
        let at = self.profile(rho.min(self.radius));
        if at.slope == 0.0 {
            return Jet { value: at.value, slope: 0.0, bend: at.bend * speed * speed };
        }
        // On the axis itself, where only a cone has a slope, any direction leads outwards.
        let outwards = if rho == 0.0 { 0.0 } else { (x * dx + z * dz) / rho };
        let turning = (speed * speed - outwards * outwards).max(0.0) / rho;
        let bend = at.bend * outwards * outwards + at.slope * turning;
        Jet { value: at.value, slope: at.slope * outwards, bend }
    }

    fn clip(&self, x: f64, z: f64, dx: f64, dz: f64) -> Option<[f64; 2]> {
        let [from, to] = disc_chord(x, z, dx, dz, self.radius)?;
        let (from, to) = (from.max(0.0), to.min(1.0));
        (from <= to).then_some([from, to])
    }

    // A level plane is touched at the axis; a plane as steep as the flank at the flank's lower end.
    fn support(&self, normal: &Vector3) -> Vector3 {
        let level = normal.x.hypot(normal.z);
        if level == 0.0 {
            return Vector3::new(0.0, -self.profile(0.0).value, 0.0);
        }
        let arc = match &self.flank {
            Some(flank) if flank.slope * normal.y < level => &flank.rim,
            _ => &self.corner,
        };
        let rho = arc.center + arc.radius * level;
        let height = arc.radius * normal.y - arc.rise;
        Vector3::new(-normal.x / level * rho, -height, -normal.z / level * rho)
    }

    fn normal_at(&self, x: f64, z: f64) -> Vector3 {
        let rho = x.hypot(z);
        let slope = self.profile(rho.min(self.radius)).slope;
        if rho == 0.0 || slope == 0.0 {
            return Vector3::y();
        }
        let (x, z) = (x / rho, z / rho);
        if slope.is_finite() {
            Vector3::new(slope * x, 1.0, slope * z).normalize()
        } else {
            -Vector3::new(x, 0.0, z)
        }
    }

    fn tangent(&self, x: f32x8, z: f32x8) -> Tangent {
        let rho = (x * x + z * z).sqrt();
        let at = rho.min(f32x8::splat(self.tangent_limit() as f32));
        let (mut value, mut slope) = self.corner.tangent(at);
        if let Some(flank) = &self.flank {
            let straight = at.simd_gt(f32x8::splat(flank.from as f32));
            let line = (f32x8::splat(flank.from as f32) - at) * flank.slope as f32;
            value = straight.select(line + flank.at as f32, value);
            slope = straight.select(f32x8::splat(-flank.slope as f32), slope);
            if 0.0 < flank.rim.radius {
                let outer = at.simd_gt(f32x8::splat(flank.to as f32));
                let (rim_value, rim_slope) = flank.rim.tangent(at);
                value = outer.select(rim_value, value);
                slope = outer.select(rim_slope, slope);
            }
        }
        let on_axis = rho.simd_le(f32x8::ZERO);
        let per_rho = on_axis.select(f32x8::ZERO, f32x8::ONE / rho);
        let (along_x, along_z) = (x * per_rho, z * per_rho);
        Tangent {
            x0: along_x * at,
            z0: along_z * at,
            value,
            slope_x: slope * along_x,
            slope_z: slope * along_z,
        }
    }

    fn passes_by(&self, x: f32x8, z: f32x8, radius: f32x8) -> f32x8 {
        let reach = (radius + self.radius as f32).max(f32x8::ZERO);
        let outside = (x * x + z * z).simd_gt(reach * reach);
        outside | f32x8::ZERO.simd_gt(radius)
    }

    fn steepest_tangent(&self) -> f64 {
        let arc = TANGENT_SHARE / (1.0 - TANGENT_SHARE * TANGENT_SHARE).sqrt();
        let flank = self.flank.map_or(0.0, |flank| flank.slope);
        arc.max(flank) * std::f64::consts::SQRT_2
    }

    fn reach(&self) -> Reach {
        Reach { x: self.radius, z: self.radius, top: self.profile(0.0).value }
    }
}

impl Arc {
    /// Value and slope at eight distances from the axis.
    fn tangent(&self, rho: f32x8) -> (f32x8, f32x8) {
        let limit = f32x8::splat((TANGENT_SHARE * self.radius) as f32);
        let out = (rho - self.center as f32).max(f32x8::ZERO).min(limit);
        let height = (f32x8::splat((self.radius * self.radius) as f32) - out * out).sqrt();
        let level = out.simd_le(f32x8::ZERO);
        let slope = level.select(f32x8::ZERO, -out / height);
        (height - self.rise as f32, slope)
    }
}
