//! F words as a control takes them: so many digits, so many places, no more than so much.

use crate::gcode::number::{ceil_to, floor_to};
use crate::gcode::{FeedWords, TimeUnit};

/// What an F word can be.
#[derive(Debug, Clone, Copy)]
pub(super) struct FWord {
    /// Digits and places.
    pub(super) words: FeedWords,
    /// The greatest.
    pub(super) max: f64,
}

impl FWord {
    /// The greatest F not above `feed` [mm/min or deg/min]; the least there is if that is none.
    pub(super) fn per_minute(self, feed: f64) -> f64 {
        let FeedWords { digits, decimals, .. } = self.words;
        floor_to(feed.min(self.max), digits, decimals).max(self.least())
    }

    /// The F of a block that takes `seconds`, or the next longer time there is a word for.
    pub(super) fn inverse(self, seconds: f64, unit: TimeUnit) -> f64 {
        let FeedWords { digits, decimals, .. } = self.words;
        match unit {
            TimeUnit::PerMinute => self.per_minute(60.0 / seconds),
            TimeUnit::Seconds => ceil_to(seconds, digits, decimals).clamp(self.least(), self.max),
        }
    }

    fn least(self) -> f64 {
        // The quotient is the number its digits are read as; the power itself may not be.
        1.0 / 10_f64.powi(i32::from(self.words.decimals))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gcode::FeedLength;

    fn fword() -> FWord {
        let measures = FeedLength::LinearFirst;
        let max = f64::INFINITY;
        let words = FeedWords { digits: 6, decimals: 3, max, measures, degree_mm: 1.0 };
        FWord { words, max: 15_400.0 }
    }

    #[test]
    fn a_feed_is_rounded_down_and_kept_between_least_and_greatest() {
        assert_eq!(fword().per_minute(1_234.567_8), 1_234.56);
        assert_eq!(fword().per_minute(21_600.0), 15_400.0);
        assert_eq!(fword().per_minute(0.000_4), 0.001);
    }

    #[test]
    fn a_time_in_seconds_is_rounded_up() {
        assert_eq!(fword().inverse(0.012_34, TimeUnit::Seconds), 0.013);
        assert_eq!(fword().inverse(0.5, TimeUnit::PerMinute), 120.0);
    }
}
