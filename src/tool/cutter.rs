//! A profile as digitizing sees it: grown by the allowance, as one of two height functions.

use super::{HeightFunction, Mill, Profile, Reach, Wheel};
use crate::geom::Vector3;

/// A profile as digitizing sees it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Cutter {
    /// Across the attack axis.
    Wheel(Wheel),
    /// Along the attack axis.
    Mill(Mill),
}

impl Cutter {
    /// How far it reaches from its programmed point.
    pub fn reach(&self) -> Reach {
        match self {
            Self::Wheel(wheel) => wheel.reach(),
            Self::Mill(mill) => mill.reach(),
        }
    }

    /// Where it touches a plane, from its programmed point; see [`HeightFunction::support`].
    pub fn support(&self, normal: &Vector3) -> Vector3 {
        match self {
            Self::Wheel(wheel) => wheel.support(normal),
            Self::Mill(mill) => mill.support(normal),
        }
    }
}

impl Profile {
    /// The shape whose height function leaves exactly `allowance` on the part: the profile grown by
    /// a ball of that radius (wheel: r + a; ball: r + a; a flat end becomes a bull). Its programmed
    /// point stays that of the tool itself.
    pub fn cutter(&self, allowance: f64) -> Cutter {
        match *self {
            Self::Wheel { major_radius, minor_radius } => {
                Cutter::Wheel(Wheel { major: major_radius, minor: minor_radius + allowance })
            }
            Self::Ball { radius } => Cutter::Mill(Mill::straight(0.0, radius, allowance)),
            Self::Flat { radius } => Cutter::Mill(Mill::straight(radius, 0.0, allowance)),
            Self::Bull { radius, corner_radius } => {
                Cutter::Mill(Mill::straight(radius - corner_radius, corner_radius, allowance))
            }
            Self::Cone { radius, half_angle } => {
                Cutter::Mill(Mill::tapered(0.0, half_angle, radius, allowance))
            }
            Self::BallCone { radius, tip_radius, half_angle } => {
                Cutter::Mill(Mill::tapered(tip_radius, half_angle, radius, allowance))
            }
        }
    }
}
