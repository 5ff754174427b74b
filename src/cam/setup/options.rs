//! How a part is laid on its machine.

use super::SetupError;
use crate::geom::Vector3;
use std::str::FromStr;

/// How the part is laid on the machine.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct SetupOptions {
    /// The part's direction that is laid along the spindle, heel to toe.
    pub axis: SpindleAxis,
    /// Swap heel and toe.
    pub flip: bool,
    /// Which point is laid on the spindle axis.
    pub centre: Centre,
    /// Turn of the part about the spindle before the first step [rad].
    pub start_angle: f64,
    /// Cut the mirror image: the other foot.
    pub mirror: bool,
}

/// The part's direction that is laid along the spindle.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub enum SpindleAxis {
    /// The principal axis of greatest extent, pointing the way its largest coordinate grows.
    #[default]
    Auto,
    /// A direction in the part's own frame.
    Along(Vector3),
}

/// Which point of the part is laid on the spindle axis (or over the middle of a table).
#[derive(
    Debug,
    Clone,
    Copy,
    Default,
    PartialEq,
    Eq,
    serde::Serialize,
    serde::Deserialize,
    clap::ValueEnum,
)]
#[serde(rename_all = "kebab-case")]
pub enum Centre {
    /// The centroid of the surface.
    #[default]
    Centroid,
    /// The middle of the bounding box.
    Box,
    /// The middles of the part's ends, which tilts the axis onto them: what two dogs hold best.
    Ends,
    /// The origin of the file: it was set up before.
    Origin,
}

impl FromStr for SpindleAxis {
    type Err = SetupError;

    /// `auto`, `x`, `y`, `z`, each with a sign, or three numbers.
    fn from_str(text: &str) -> Result<Self, SetupError> {
        let (sign, name) = match text.strip_prefix('-') {
            Some(rest) if rest.len() == 1 => (-1.0, rest),
            _ => (1.0, text.strip_prefix('+').unwrap_or(text)),
        };
        let axis = match name {
            "auto" => return Ok(Self::Auto),
            "x" | "X" => Vector3::x(),
            "y" | "Y" => Vector3::y(),
            "z" | "Z" => Vector3::z(),
            _ => {
                let parts = text.split([' ', ',']).filter(|part| !part.is_empty());
                let numbers: Result<Vec<f64>, _> = parts.map(str::parse).collect();
                match numbers.as_deref() {
                    Ok(&[x, y, z]) => Vector3::new(x, y, z),
                    _ => Vector3::zeros(),
                }
            }
        };
        let length = axis.norm();
        if length > 0.0 && length.is_finite() {
            Ok(Self::Along(axis * (sign / length)))
        } else {
            Err(SetupError::NoAxis(format!("{text:?}")))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_direction_is_refused_by_its_text() {
        for text in ["0 0 0", "1 0", "1 0 wide 0.2", "nan 0 0", "up"] {
            let error = text.parse::<SpindleAxis>().unwrap_err().to_string();
            assert!(error.contains(&format!("{text:?}")), "{error}");
            assert!(error.contains("three numbers"), "{error}");
        }
    }
}
