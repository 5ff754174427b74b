//! The cutting shapes, by their dimensions.

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
        #[serde(rename = "half-angle-deg", with = "super::degrees")]
        half_angle: f64,
    },
    /// A cone with a ball for a tip.
    BallCone {
        /// Where the flank ends [mm].
        radius: f64,
        /// Of the ball at the tip [mm].
        tip_radius: f64,
        /// Between the axis and the flank [rad; `half-angle-deg` in files].
        #[serde(rename = "half-angle-deg", with = "super::degrees")]
        half_angle: f64,
    },
}
