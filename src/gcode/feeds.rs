//! What F means: controls agree on linear axes alone, and on little else.

use super::Address;
use crate::machine::AxisKind;

/// What a control makes of F words.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FeedLaw {
    /// The length a feed per minute is of.
    pub measures: FeedLength,
    /// How many millimetres a degree counts in that length, where linear and rotary axes are taken
    /// together.
    pub degree_mm: f64,
    /// What F is of under inverse time.
    pub inverse: TimeUnit,
}

/// The length a feed per minute is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FeedLength {
    /// X, Y and Z if they move, else U, V and W, else the rotary axes in degrees (RS274/NGC,
    /// `find_straight_length`).
    #[default]
    LinearFirst,
    /// All axes together, a degree as so many millimetres.
    AllAxes,
}

/// What F is of under inverse time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TimeUnit {
    /// One over the minutes a block takes.
    #[default]
    PerMinute,
    /// The seconds a block takes.
    Seconds,
}

impl Default for FeedLaw {
    fn default() -> Self {
        Self { measures: FeedLength::LinearFirst, degree_mm: 1.0, inverse: TimeUnit::PerMinute }
    }
}

impl FeedLaw {
    /// The length a feed per minute is of, where the words change by `ways` [mm or deg].
    pub(super) fn length(&self, axes: &[Address], ways: impl Fn(usize) -> f64) -> f64 {
        match self.measures {
            FeedLength::LinearFirst => linear_first(axes, ways),
            FeedLength::AllAxes => {
                let counted = axes.iter().enumerate().map(|(i_axis, axis)| match axis.kind {
                    AxisKind::Linear => ways(i_axis),
                    AxisKind::Rotary => self.degree_mm * ways(i_axis),
                });
                counted.map(|way| way * way).sum::<f64>().sqrt()
            }
        }
    }

    /// How long a block with `feed` takes under inverse time [s].
    pub(super) fn inverse_seconds(&self, feed: f64) -> f64 {
        match self.inverse {
            TimeUnit::PerMinute => 60.0 / feed,
            TimeUnit::Seconds => feed,
        }
    }
}

fn linear_first(axes: &[Address], ways: impl Fn(usize) -> f64) -> f64 {
    let length = |letters: &str| {
        let named = axes.iter().enumerate().filter(|(_, axis)| letters.contains(axis.letter));
        named.map(|(i_axis, _)| ways(i_axis).powi(2)).sum::<f64>().sqrt()
    };
    // Differences of decimals are not exactly zero; the interpreter draws the line here too.
    let moves = |length: &f64| *length > 1e-7;
    let groups = ["XYZ", "UVW", "ABC"];
    groups.iter().map(|letters| length(letters)).find(moves).unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axes() -> [Address; 3] {
        let axis = |letter, kind| Address { letter, kind };
        [axis('X', AxisKind::Linear), axis('Y', AxisKind::Linear), axis('A', AxisKind::Rotary)]
    }

    #[test]
    fn feed_applies_to_the_linear_part_and_to_degrees_only_without_one() {
        let law = FeedLaw::default();
        assert_eq!(law.length(&axes(), |i| [3.0, 4.0, 90.0][i]), 5.0);
        assert_eq!(law.length(&axes(), |i| [0.0, 0.0, 90.0][i]), 90.0);
        assert_eq!(law.length(&axes(), |_| 0.0), 0.0);
    }

    #[test]
    fn a_degree_counts_what_the_control_says() {
        let law = FeedLaw { measures: FeedLength::AllAxes, ..FeedLaw::default() };
        assert_eq!(law.length(&axes(), |i| [3.0, 0.0, 4.0][i]), 5.0);
        let law = FeedLaw { degree_mm: 0.5, ..law };
        assert_eq!(law.length(&axes(), |i| [3.0, 0.0, 8.0][i]), 5.0);
    }

    #[test]
    fn inverse_time_is_one_over_minutes_or_seconds() {
        let seconds = FeedLaw { inverse: TimeUnit::Seconds, ..FeedLaw::default() };
        assert_eq!(
            (FeedLaw::default().inverse_seconds(120.0), seconds.inverse_seconds(0.5)),
            (0.5, 0.5)
        );
    }
}
