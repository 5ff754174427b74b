//! End mills: profiles of revolution about the attack axis, programmed at the tip.
//!
//! One shape serves ball, flat, bull, cone and ball-cone mills (the APT tool): seen from the axis
//! outwards a flat, a corner arc, a straight flank, and a rim arc that only an allowance makes.

use super::height::{HeightFunction, Jet, Reach, Rim, Sharpness, Swept, Tangent};
use super::wheel::disc_chord;
use crate::geom::Vector3;
use fearless_simd::{f32x16, mask32x16, prelude::*};

/// An end mill by the pieces of its height function `u(rho)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mill {
    /// The corner arc: around `rho = flat`, the tool's flat radius.
    pub(crate) corner: Arc,
    /// The straight flank of a cone, if there is one.
    pub(crate) flank: Option<Flank>,
    /// Where the shadow ends [mm].
    pub(crate) radius: f64,
}

/// `u = sqrt(radius^2 - (rho - center)^2) - rise`, level inside `center`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Arc {
    pub(crate) center: f64,
    pub(crate) radius: f64,
    pub(crate) rise: f64,
}

/// `u = at - slope (rho - from)` from where the corner arc ends to where the rim arc begins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Flank {
    pub(crate) slope: f64,
    pub(crate) from: f64,
    pub(crate) at: f64,
    pub(crate) to: f64,
    pub(crate) rim: Arc,
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

    /// The radius of a mill that is a ball and nothing else.
    pub fn ball_radius(&self) -> Option<f64> {
        let is_ball = self.corner.center == 0.0 && self.flank.is_none();
        is_ball.then_some(self.corner.radius)
    }

    /// The radius of a mill that is a flat end and nothing else.
    pub fn flat_radius(&self) -> Option<f64> {
        let is_flat = self.corner.radius == 0.0 && self.flank.is_none();
        is_flat.then_some(self.corner.center)
    }

    /// The arc that the shadow ends with.
    fn outer(&self) -> Arc {
        self.flank.map_or(self.corner, |flank| flank.rim)
    }

    /// How steep planes over the sharp rim are, if there is one: what an arc would be at `share` of its
    /// radius, and no less than the flank inside.
    #[inline(always)]
    fn beyond_rim(&self, share: f32) -> Option<f64> {
        self.rim().map(|_| {
            let share = f64::from(share);
            let of_arc = share / (1.0 - share * share).sqrt();
            self.flank.map_or(of_arc, |flank| of_arc.max(flank.slope))
        })
    }

    /// `u`, `u'` and `u''` at a distance from the axis.
    #[inline(always)]
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
}

impl Arc {
    #[inline(always)]
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
    #[inline(always)]
    fn height(&self, x: f64, z: f64) -> Option<f64> {
        let rho = (x * x + z * z).sqrt();
        (rho <= self.radius).then(|| self.profile(rho).value)
    }

    #[inline(always)]
    fn along(&self, x: f64, z: f64, dx: f64, dz: f64) -> Jet {
        let rho = (x * x + z * z).sqrt();
        let speed = (dx * dx + dz * dz).sqrt();
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

    #[inline(always)]
    fn clip(&self, x: f64, z: f64, dx: f64, dz: f64) -> Option<[f64; 2]> {
        let [from, to] = disc_chord(x, z, dx, dz, self.radius)?;
        let (from, to) = (from.max(0.0), to.min(1.0));
        (from <= to).then_some([from, to])
    }

    // A level plane is touched at the axis; a plane as steep as the flank at the flank's lower end.
    #[inline(always)]
    fn support(&self, normal: &Vector3) -> Vector3 {
        let level = (normal.x * normal.x + normal.z * normal.z).sqrt();
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
        let rho = (x * x + z * z).sqrt();
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

    #[inline(always)]
    fn tangent_within<S: Simd>(
        &self,
        simd: S,
        x: f32x16<S>,
        z: f32x16<S>,
        share: f32,
    ) -> Tangent<S> {
        let splat = |value: f64| f32x16::splat(simd, value as f32);
        let rho = (x * x + z * z).sqrt();
        let outer = self.outer();
        let at = rho.min((outer.center + f64::from(share) * outer.radius) as f32);
        let (mut value, mut slope) = self.corner.tangent(simd, at, share);
        if let Some(flank) = &self.flank {
            let straight = at.simd_gt(flank.from as f32);
            let line = (splat(flank.from) - at) * flank.slope as f32 + flank.at as f32;
            value = straight.select(line, value);
            slope = straight.select(splat(-flank.slope), slope);
            let outer = at.simd_gt(flank.to as f32);
            let (rim_value, rim_slope) = flank.rim.tangent(simd, at, share);
            value = outer.select(rim_value, value);
            slope = outer.select(rim_slope, slope);
        }
        if let Some(steepest) = self.beyond_rim(share) {
            let is_beyond = rho.simd_gt(self.radius as f32);
            slope = is_beyond.select(splat(-steepest), slope);
        }
        let per_rho = rho.simd_gt(0.0).select(splat(1.0) / rho, splat(0.0));
        let (along_x, along_z) = (x * per_rho, z * per_rho);
        Tangent {
            x0: along_x * at,
            z0: along_z * at,
            value,
            slope_x: slope * along_x,
            slope_z: slope * along_z,
        }
    }

    // A mill is what its arcs wrap: the rings they make around the axis, and nothing else.
    #[inline(always)]
    fn lowest_plane<S: Simd>(&self, _simd: S, slope_x: f32x16<S>, slope_z: f32x16<S>) -> f32x16<S> {
        let slope2 = slope_x.mul_add(slope_x, slope_z * slope_z);
        let (slope, length) = (slope2.sqrt(), (slope2 + 1.0).sqrt());
        let over_corner = self.corner.lowest_plane(slope, length);
        match &self.flank {
            Some(flank) => over_corner.max(flank.rim.lowest_plane(slope, length)),
            None => over_corner,
        }
    }

    // Both principal bends of an arc, `R^2 / h^3` outwards and `slope / rho <= 1 / h` around, grow
    // outwards; that of a flank around the axis, `slope / rho`, grows inwards.
    #[inline(always)]
    fn sharpness<S: Simd>(&self, simd: S, swept: &Swept<S>, share: f32) -> Sharpness<S> {
        // The arc that an allowance puts around the rim is not looked into.
        let arc = &self.corner;
        let arc_limit = arc.center + f64::from(share) * arc.radius;
        let limit = self
            .flank
            .map_or(arc_limit, |flank| flank.from + f64::from(share) * (flank.to - flank.from));
        let x = (swept.x.abs() - swept.half_x).max(0.0);
        let z = (swept.z.abs() - swept.half_z).max(0.0);
        let nearest = (x * x + z * z).sqrt();
        // The root's own rounding must not put outside what is not.
        let is_outside = nearest.simd_gt(self.radius as f32 * (1.0 + 4.0 * f32::EPSILON));
        let (x, z) = (swept.x.abs() + swept.half_x, swept.z.abs() + swept.half_z);
        let rho = (x * x + z * z).sqrt();
        let is_within = rho.simd_le(limit as f32);
        let rho = rho.min(limit as f32);
        let step2 = swept.step_x * swept.step_x + swept.step_z * swept.step_z;
        let (mut slope, mut bend) = arc.sharpness(simd, rho, step2);
        if let Some(flank) = &self.flank {
            let from = flank.from as f32;
            let around = step2 * flank.slope as f32 / nearest.max(from);
            let (_, of_arc) = arc.sharpness(simd, f32x16::splat(simd, from), step2);
            let of_flank = nearest.simd_le(from).select(around.max(of_arc), around);
            let is_on_flank = rho.simd_ge(from);
            slope = is_on_flank.select(f32x16::splat(simd, flank.slope as f32), slope);
            bend = is_on_flank.select(of_flank, bend);
        }
        let beyond = self.profile(limit).value as f32;
        let beyond = beyond + (beyond.abs() + self.radius as f32) * (4.0 * f32::EPSILON);
        Sharpness { slope_x: slope, slope_z: slope, bend, is_outside, is_within, beyond }
    }

    #[inline(always)]
    fn passes_by<S: Simd>(
        &self,
        _simd: S,
        x: f32x16<S>,
        z: f32x16<S>,
        radius: f32x16<S>,
    ) -> mask32x16<S> {
        let reach = (radius + self.radius as f32).max(0.0);
        (x * x + z * z).simd_gt(reach * reach) | radius.simd_lt(0.0)
    }

    // Only a ball bends everywhere.
    fn least_bend(&self) -> [f64; 2] {
        [self.ball_radius().map_or(0.0, |radius| 1.0 / radius); 2]
    }

    fn rim(&self) -> Option<Rim> {
        let outer = self.outer();
        (outer.radius == 0.0).then_some(Rim { radius: self.radius, height: -outer.rise })
    }

    fn reach(&self) -> Reach {
        Reach { x: self.radius, z: self.radius, top: self.profile(0.0).value }
    }
}

impl Arc {
    /// The greatest slope, and bend along a motion of length `step2` squared, up to a distance from
    /// the axis.
    #[inline(always)]
    fn sharpness<S: Simd>(
        &self,
        simd: S,
        rho: f32x16<S>,
        step2: f32x16<S>,
    ) -> (f32x16<S>, f32x16<S>) {
        let never = f32x16::splat(simd, f32::INFINITY);
        let level = f32x16::splat(simd, 0.0);
        let radius = self.radius as f32;
        let out = rho - self.center as f32;
        let height2 = (radius - out) * (out + radius);
        let height = height2.max(0.0).sqrt();
        let is_inside = out.simd_lt(radius);
        let bend = is_inside.select(step2 * (radius * radius) / (height2 * height), never);
        let slope = is_inside.select(out / height, never);
        let is_level = out.simd_le(0.0);
        (is_level.select(level, slope), is_level.select(level, bend))
    }

    /// Of planes of this slope, whose normal of height 1 has this length.
    #[inline(always)]
    fn lowest_plane<S: Simd>(&self, slope: f32x16<S>, length: f32x16<S>) -> f32x16<S> {
        slope.mul_add(self.center as f32, length * self.radius as f32) - self.rise as f32
    }

    /// Value and slope at sixteen distances from the axis.
    #[inline(always)]
    fn tangent<S: Simd>(&self, simd: S, rho: f32x16<S>, share: f32) -> (f32x16<S>, f32x16<S>) {
        let limit = share * self.radius as f32;
        let out = (rho - self.center as f32).max(0.0).min(limit);
        let radius = f32x16::splat(simd, self.radius as f32);
        let height = (radius * radius - out * out).sqrt();
        let slope = out.simd_gt(0.0).select(-out / height, f32x16::splat(simd, 0.0));
        (height - self.rise as f32, slope)
    }
}
