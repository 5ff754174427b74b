//! Which views are laid over each other.

use std::f64::consts::TAU;

/// Views farther apart than this see too little alike [rad].
const WIDEST: f64 = 0.45;
/// Over this angle a pair of views tells where the axis is; neighbours hardly do [rad].
const WIDE: f64 = 0.35;

/// A view that turns into another.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct ViewPair {
    pub(super) source: usize,
    pub(super) target: usize,
    /// From the end of a turn to its beginning.
    pub(super) is_closing: bool,
}

impl ViewPair {
    /// Steps from the source to the target.
    pub(super) fn n_steps(self) -> f64 {
        self.target as f64 - self.source as f64
    }
}

/// The pairs of `n_views` that turn by `step`: neighbours, wider ones, and those a whole turn or more
/// apart.
pub(super) fn view_pairs(n_views: usize, step: f64) -> Vec<ViewPair> {
    let wide = ((WIDE / step.abs()) as usize).max(1);
    let mut pairs = Vec::new();
    for source in 0..n_views {
        for target in source + 1..n_views {
            let apart = target - source;
            let angle = apart as f64 * step.abs();
            let n_turns = (angle / TAU).round();
            let is_closing = n_turns >= 1.0 && (angle - n_turns * TAU).abs() < WIDEST;
            if apart == 1 || apart == wide || is_closing {
                pairs.push(ViewPair { source, target, is_closing });
            }
        }
    }
    pairs
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ends_of_a_turn_meet_its_beginning() {
        let pairs = view_pairs(36, TAU / 36.0);
        let closing: Vec<_> = pairs.iter().filter(|pair| pair.is_closing).collect();
        // Steps of 10 degrees: 34 or 35 of them, two or one from a whole turn.
        assert_eq!(closing.len(), 2 + 1);
        assert!(closing.iter().all(|pair| pair.target - pair.source >= 34));
        let neighbours = pairs.iter().filter(|pair| pair.n_steps() == 1.0).count();
        let wide = pairs.iter().filter(|pair| pair.n_steps() == 2.0).count();
        assert_eq!((neighbours, wide, pairs.len()), (35, 34, 72));
    }

    #[test]
    fn half_a_turn_closes_nothing() {
        assert!(view_pairs(18, TAU / 36.0).iter().all(|pair| !pair.is_closing));
        assert_eq!(view_pairs(4, 1.0).len(), 3, "a step too wide for anything but neighbours");
    }
}
