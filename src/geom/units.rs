//! Units of length: files come in any of them, inside there are only millimetres.
//!
//! Most formats do not say what a 1 is. What the caller states wins, then what the file itself
//! declares (a comment or header such as `units mm`), and only then the extent is asked, see
//! [`LengthUnit::detect`]. Which of them it was is kept as a [`UnitSource`] and shown in every report.

use std::fmt;

/// A unit of length.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize, clap::ValueEnum,
)]
pub enum LengthUnit {
    /// Millimetres, as scanners and last makers use.
    #[serde(rename = "mm")]
    #[value(name = "mm")]
    Millimetre,
    /// Centimetres.
    #[serde(rename = "cm")]
    #[value(name = "cm")]
    Centimetre,
    /// Inches.
    #[serde(rename = "in")]
    #[value(name = "in")]
    Inch,
    /// Metres, as depth cameras and glTF use.
    #[serde(rename = "m")]
    #[value(name = "m")]
    Metre,
}

/// How the unit of a file came to be known.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum UnitSource {
    /// The caller said so.
    Stated,
    /// The file says so itself.
    Declared,
    /// Guessed from the extent.
    Detected,
}

impl LengthUnit {
    /// An extent below 1 of something horma can machine is metres: 0.05 to 1 m.
    const METRES: std::ops::Range<f64> = 0.05..1.0;
    /// Where metres are the custom of the format, everything below 50 m is believed.
    const CUSTOMARY_METRES: f64 = 50.0;

    /// How many millimetres it is long.
    pub const fn in_mm(self) -> f64 {
        match self {
            Self::Millimetre => 1.0,
            Self::Centimetre => 10.0,
            Self::Inch => 25.4,
            Self::Metre => 1000.0,
        }
    }

    /// The unit of a part whose longest side is `extent` long.
    ///
    /// From 0.05 up to 1 it is metres, else millimetres: lasts, feet and what fits a lathe or mill
    /// are 50 mm to 1 m long, and nobody machines a part shorter than 1 mm. Centimetres and inches
    /// are never guessed, because a part of 10 in and one of 10 mm look the same: state them.
    /// With `metres_are_customary` (glTF by its standard, PCD by its users) everything below 50 is
    /// metres.
    pub fn detect(extent: f64, metres_are_customary: bool) -> Self {
        let metres = if metres_are_customary {
            extent < Self::CUSTOMARY_METRES
        } else {
            Self::METRES.contains(&extent)
        };
        if metres { Self::Metre } else { Self::Millimetre }
    }

    /// The unit that a line of comment declares: `units mm`, `unit: inch`, `UNITS=m`.
    pub fn declared_in(comment: &str) -> Option<Self> {
        let lower = comment.to_ascii_lowercase();
        let mut words = lower.split(|c: char| !c.is_ascii_alphabetic()).filter(|w| !w.is_empty());
        words.find(|word| matches!(*word, "unit" | "units"))?;
        let first = words.find(|word| !matches!(*word, "is" | "are"))?;
        // "units in mm" is no inch.
        let second = words.next().filter(|_| first == "in").and_then(Self::called);
        second.or_else(|| Self::called(first))
    }

    fn called(word: &str) -> Option<Self> {
        Some(match word {
            "mm" | "millimetre" | "millimetres" | "millimeter" | "millimeters" => Self::Millimetre,
            "cm" | "centimetre" | "centimetres" | "centimeter" | "centimeters" => Self::Centimetre,
            "in" | "inch" | "inches" => Self::Inch,
            "m" | "metre" | "metres" | "meter" | "meters" => Self::Metre,
            _ => return None,
        })
    }
}

impl fmt::Display for LengthUnit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Millimetre => "mm",
            Self::Centimetre => "cm",
            Self::Inch => "in",
            Self::Metre => "m",
        })
    }
}

impl fmt::Display for UnitSource {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Stated => "as stated",
            Self::Declared => "as the file declares",
            Self::Detected => "detected by extent",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_foot_in_metres_and_one_in_millimetres_are_told_apart() {
        assert_eq!(LengthUnit::detect(0.27, false), LengthUnit::Metre);
        assert_eq!(LengthUnit::detect(270.0, false), LengthUnit::Millimetre);
    }

    #[test]
    fn the_limits_of_the_rule_are_half_open() {
        for (extent, unit) in [
            (0.0499, LengthUnit::Millimetre),
            (0.05, LengthUnit::Metre),
            (0.9999, LengthUnit::Metre),
            (1.0, LengthUnit::Millimetre),
        ] {
            assert_eq!(LengthUnit::detect(extent, false), unit, "{extent}");
        }
        assert_eq!(LengthUnit::detect(0.001, true), LengthUnit::Metre);
        assert_eq!(LengthUnit::detect(50.0, true), LengthUnit::Millimetre);
    }

    #[test]
    fn a_comment_declares_a_unit_only_after_the_word_units() {
        assert_eq!(LengthUnit::declared_in("# units mm"), Some(LengthUnit::Millimetre));
        assert_eq!(LengthUnit::declared_in("comment UNITS=Inches"), Some(LengthUnit::Inch));
        assert_eq!(LengthUnit::declared_in("File unit: m"), Some(LengthUnit::Metre));
        assert_eq!(LengthUnit::declared_in("units in mm"), Some(LengthUnit::Millimetre));
        assert_eq!(LengthUnit::declared_in("units are in inches"), Some(LengthUnit::Inch));
        assert_eq!(LengthUnit::declared_in("units: in"), Some(LengthUnit::Inch));
        assert_eq!(LengthUnit::declared_in("made in Elda"), None);
        assert_eq!(LengthUnit::declared_in("units unknown"), None);
    }
}
