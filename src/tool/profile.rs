//! The cutting shapes, by their dimensions.

use super::{Mill, Wheel};

/// A convex profile of revolution. The programmed point is the centre of a wheel and the tip of
/// every other tool.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(
    tag = "shape",
    rename_all = "kebab-case",
    rename_all_fields = "kebab-case",
    deny_unknown_fields
)]
pub enum Profile {
    /// The wheel of a last lathe: a torus about X, filled inside; disc of `major_radius` plus ball
    /// of `minor_radius`.
    Wheel {
        /// From the wheel's axis to the centre of its nose circle [mm].
        major_radius: f64,
        /// Of the nose circle [mm].
        minor_radius: f64,
    },
    /// A ball-nosed end mill.
    Ball {
        /// Of the ball [mm].
        radius: f64,
    },
    /// A square-ended mill.
    Flat {
        /// Of the cylinder [mm].
        radius: f64,
    },
    /// A flat end with rounded corners.
    Bull {
        /// Of the cylinder [mm].
        radius: f64,
        /// Of the corner [mm].
        corner_radius: f64,
    },
    /// A pointed cone.
    Cone {
        /// Where the flank ends [mm].
        radius: f64,
        /// Between the axis and the flank [rad; `half-angle-deg` in files].
        half_angle: f64,
    },
    /// A cone with a ball for a tip.
    BallCone {
        /// Where the flank ends [mm].
        radius: f64,
        /// Of the ball at the tip [mm].
        tip_radius: f64,
        /// Between the axis and the flank [rad; `half-angle-deg` in files].
        half_angle: f64,
    },
}

/// A profile as digitizing sees it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape {
    /// Across the attack axis.
    Wheel(Wheel),
    /// Along the attack axis.
    Mill(Mill),
}

impl Profile {
    /// The shape whose height function leaves exactly `allowance` on the part: the profile grown by
    /// a ball of that radius (wheel: r + a; ball: r + a; a flat end becomes a bull). Its programmed
    /// point stays that of the tool itself.
    pub fn shape(&self, allowance: f64) -> Shape {
        match *self {
            Self::Wheel { major_radius, minor_radius } => {
                Shape::Wheel(Wheel { major: major_radius, minor: minor_radius + allowance })
            }
            Self::Ball { radius } => Shape::Mill(Mill::straight(0.0, radius, allowance)),
            Self::Flat { radius } => Shape::Mill(Mill::straight(radius, 0.0, allowance)),
            Self::Bull { radius, corner_radius } => {
                Shape::Mill(Mill::straight(radius - corner_radius, corner_radius, allowance))
            }
            Self::Cone { radius, half_angle } => {
                Shape::Mill(Mill::tapered(0.0, half_angle, radius, allowance))
            }
            Self::BallCone { radius, tip_radius, half_angle } => {
                Shape::Mill(Mill::tapered(tip_radius, half_angle, radius, allowance))
            }
        }
    }
}
