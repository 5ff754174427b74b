//! The kinds of profiles, and the words and numbers files write them in.

use super::{Profile, degrees};

/// Which kind of profile: the `shape` of a tool library.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Shape {
    /// The wheel of a last lathe.
    Wheel,
    /// A ball-nosed end mill.
    Ball,
    /// A square-ended mill.
    Flat,
    /// A flat end with rounded corners.
    Bull,
    /// A pointed cone.
    Cone,
    /// A cone with a ball for a tip.
    BallCone,
}

impl Shape {
    /// Every shape there is.
    pub const ALL: [Self; 6] =
        [Self::Wheel, Self::Ball, Self::Flat, Self::Bull, Self::Cone, Self::BallCone];

    /// Its word in files and on the command line.
    pub fn word(self) -> &'static str {
        match self {
            Self::Wheel => "wheel",
            Self::Ball => "ball",
            Self::Flat => "flat",
            Self::Bull => "bull",
            Self::Cone => "cone",
            Self::BallCone => "ball-cone",
        }
    }

    /// The shape called `word`.
    pub fn from_word(word: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|shape| shape.word() == word)
    }

    /// The keys of its dimensions in files, in the order the command line has them.
    pub fn keys(self) -> &'static [&'static str] {
        match self {
            Self::Wheel => &["major-radius", "minor-radius"],
            Self::Ball | Self::Flat => &["radius"],
            Self::Bull => &["radius", "corner-radius"],
            Self::Cone => &["radius", "half-angle-deg"],
            Self::BallCone => &["radius", "tip-radius", "half-angle-deg"],
        }
    }

    /// The profile with these `dimensions`, in the order of [`Shape::keys`], angles in degrees;
    /// `None` if there are too few or too many. They are not checked: see [`Profile::check`].
    pub fn profile(self, dimensions: &[f64]) -> Option<Profile> {
        Some(match (self, dimensions) {
            (Self::Wheel, &[major_radius, minor_radius]) => {
                Profile::Wheel { major_radius, minor_radius }
            }
            (Self::Ball, &[radius]) => Profile::Ball { radius },
            (Self::Flat, &[radius]) => Profile::Flat { radius },
            (Self::Bull, &[radius, corner_radius]) => Profile::Bull { radius, corner_radius },
            (Self::Cone, &[radius, half_angle_deg]) => {
                Profile::Cone { radius, half_angle: half_angle_deg.to_radians() }
            }
            (Self::BallCone, &[radius, tip_radius, half_angle_deg]) => {
                Profile::BallCone { radius, tip_radius, half_angle: half_angle_deg.to_radians() }
            }
            _ => return None,
        })
    }
}

impl Profile {
    /// Which kind it is.
    pub fn shape(&self) -> Shape {
        match self {
            Self::Wheel { .. } => Shape::Wheel,
            Self::Ball { .. } => Shape::Ball,
            Self::Flat { .. } => Shape::Flat,
            Self::Bull { .. } => Shape::Bull,
            Self::Cone { .. } => Shape::Cone,
            Self::BallCone { .. } => Shape::BallCone,
        }
    }

    /// Its dimensions in the order of [`Shape::keys`], angles in degrees.
    pub fn dimensions(&self) -> Vec<f64> {
        match *self {
            Self::Wheel { major_radius, minor_radius } => vec![major_radius, minor_radius],
            Self::Ball { radius } | Self::Flat { radius } => vec![radius],
            Self::Bull { radius, corner_radius } => vec![radius, corner_radius],
            Self::Cone { radius, half_angle } => vec![radius, degrees::of(half_angle)],
            Self::BallCone { radius, tip_radius, half_angle } => {
                vec![radius, tip_radius, degrees::of(half_angle)]
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_shape_is_rebuilt_from_its_word_and_dimensions() {
        for shape in Shape::ALL {
            let dimensions: Vec<f64> = (1..=shape.keys().len()).map(|i| i as f64 * 7.0).collect();
            let profile = shape.profile(&dimensions).unwrap();
            assert_eq!(profile.shape(), shape);
            assert_eq!(Shape::from_word(shape.word()), Some(shape));
            assert_eq!(profile.dimensions(), dimensions);
        }
    }

    #[test]
    fn a_profile_file_has_the_words_and_keys_of_its_shape_and_angles_in_degrees() {
        for shape in Shape::ALL {
            let dimensions: Vec<f64> = (1..=shape.keys().len()).map(|i| i as f64 * 7.0).collect();
            let profile = shape.profile(&dimensions).unwrap();
            let file = serde_json::to_value(profile).unwrap();
            assert_eq!(file["shape"], shape.word());
            for (key, value) in shape.keys().iter().zip(dimensions) {
                assert_eq!(file[key], value);
            }
            assert_eq!(serde_json::from_value::<Profile>(file).unwrap(), profile);
        }
    }

    #[test]
    fn a_wheel_needs_exactly_two_dimensions() {
        assert_eq!(Shape::Wheel.profile(&[60.0]), None);
        assert_eq!(Shape::Wheel.profile(&[60.0, 10.0, 1.0]), None);
    }
}
