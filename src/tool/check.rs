//! Whether a profile can exist.

use super::{Profile, Shape, ToolError};

/// No tool of this trade is larger; a bigger number is in other units [mm].
const LARGEST: f64 = 10_000.0;

impl Profile {
    /// Refuses a profile that no real tool has, by the dimension that is wrong.
    ///
    /// A wheel with a major radius of 0 is a ball and allowed.
    pub fn check(&self) -> Result<(), ToolError> {
        let shape = self.shape();
        for (&key, value) in shape.keys().iter().zip(self.dimensions()) {
            let possible = match key {
                "half-angle-deg" => 0.0 < value && value < 90.0,
                "major-radius" => (0.0..=LARGEST).contains(&value),
                _ => 0.0 < value && value <= LARGEST,
            };
            if !possible {
                return Err(ToolError::Dimension { shape, key, value, rule: rule(key) });
            }
        }
        match *self {
            Self::Bull { radius, corner_radius } => {
                within(shape, "corner-radius", corner_radius, radius)
            }
            Self::BallCone { radius, tip_radius, .. } => {
                within(shape, "tip-radius", tip_radius, radius)
            }
            _ => Ok(()),
        }
    }
}

fn rule(key: &str) -> String {
    match key {
        "half-angle-deg" => "between 0 and 90 degrees, both excluded".to_owned(),
        "major-radius" => format!("from 0 (a ball) to {LARGEST} mm"),
        _ => format!("greater than 0 and at most {LARGEST} mm"),
    }
}

fn within(shape: Shape, key: &'static str, value: f64, radius: f64) -> Result<(), ToolError> {
    if value <= radius {
        return Ok(());
    }
    Err(ToolError::Dimension {
        shape,
        key,
        value,
        rule: format!("at most the radius, {radius} mm"),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(shape: Shape, dimensions: &[f64]) -> String {
        shape.profile(dimensions).unwrap().check().unwrap_err().to_string()
    }

    #[test]
    fn a_negative_or_zero_radius_is_refused_by_name_and_value() {
        assert_eq!(
            message(Shape::Ball, &[-3.0]),
            "a ball cannot have a radius of -3: it must be greater than 0 and at most 10000 mm"
        );
        assert_eq!(
            message(Shape::Wheel, &[60.0, 0.0]),
            "a wheel cannot have a minor-radius of 0: it must be greater than 0 and at most 10000 mm"
        );
        assert_eq!(
            message(Shape::Wheel, &[-60.0, 10.0]),
            "a wheel cannot have a major-radius of -60: it must be from 0 (a ball) to 10000 mm"
        );
    }

    #[test]
    fn every_dimension_of_every_shape_must_be_a_finite_number() {
        for shape in Shape::ALL {
            let good: Vec<f64> = shape.keys().iter().map(|_| 5.0).collect();
            assert_eq!(shape.profile(&good).unwrap().check(), Ok(()));
            for (i, key) in shape.keys().iter().enumerate() {
                for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1.0, 1e300] {
                    let mut dimensions = good.clone();
                    dimensions[i] = bad;
                    let error = shape.profile(&dimensions).unwrap().check().unwrap_err();
                    assert!(
                        matches!(error, ToolError::Dimension { key: k, .. } if k == *key),
                        "{shape:?} {key} {bad}: {error}"
                    );
                }
            }
        }
    }

    #[test]
    fn a_corner_or_tip_wider_than_the_tool_is_refused() {
        assert_eq!(
            message(Shape::Bull, &[6.0, 6.5]),
            "a bull cannot have a corner-radius of 6.5: it must be at most the radius, 6 mm"
        );
        assert_eq!(
            message(Shape::BallCone, &[5.0, 7.0, 15.0]),
            "a ball-cone cannot have a tip-radius of 7: it must be at most the radius, 5 mm"
        );
    }

    #[test]
    fn a_cone_is_neither_a_needle_nor_a_plane() {
        for angle in [0.0, 90.0] {
            assert_eq!(
                message(Shape::Cone, &[5.0, angle]),
                format!(
                    "a cone cannot have a half-angle-deg of {angle}: \
                     it must be between 0 and 90 degrees, both excluded"
                )
            );
        }
    }

    #[test]
    fn a_wheel_without_a_major_radius_is_a_ball_and_allowed() {
        assert_eq!(Shape::Wheel.profile(&[0.0, 10.0]).unwrap().check(), Ok(()));
    }
}
