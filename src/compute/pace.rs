//! How much work one dispatch takes.

use std::time::Duration;

/// A dispatch shall take about this long: short enough to be stopped between two, and for a driver's
/// watchdog; long enough not to notice what starting one costs.
const AIM: Duration = Duration::from_millis(100);
/// What the first takes.
const FIRST: u64 = 1 << 20;

/// How many units of work one dispatch takes, from how long those before took.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Pace {
    n_units: u64,
}

impl Pace {
    pub(crate) fn new() -> Self {
        Self { n_units: FIRST }
    }

    /// What the next may take.
    pub(crate) fn n_units(self) -> u64 {
        self.n_units
    }

    /// One that did `n_done` took `time`.
    pub(crate) fn took(&mut self, n_done: u64, time: Duration) {
        let share = AIM.as_secs_f64() / time.as_secs_f64().max(1e-6);
        let asked = n_done as f64 * share.min(4.0);
        self.n_units = (asked as u64).clamp(FIRST / 16, 1 << 40);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grows_while_dispatches_are_short_and_shrinks_when_they_are_long() {
        let mut pace = Pace::new();
        pace.took(FIRST, Duration::from_millis(1));
        assert_eq!(pace.n_units(), 4 * FIRST);
        pace.took(4 * FIRST, Duration::from_millis(400));
        assert_eq!(pace.n_units(), FIRST);
        pace.took(1, Duration::from_secs(100));
        assert_eq!(pace.n_units(), FIRST / 16);
    }
}
