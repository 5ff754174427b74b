//! Whether what looks alike speaks for a pose, or agrees with it by chance.

use super::matching::Matched;
use crate::geom::{KdTree, Pose};
use serde::Serialize;

/// Pairs that agree by chance come in bunches: where one does, its neighbours may too. So this many
/// times what chance gives must agree,
const BUNCH: f64 = 3.0;
/// and this many more.
const LEAST: f64 = 6.0;
/// Points counted around a place at most.
const MOST: usize = 200;

/// How many alike places a pose lays on each other, and how many it would by chance.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Support {
    /// Pairs of places that look alike.
    pub n_matches: usize,
    /// Those that the pose lays on each other.
    pub n_agreeing: usize,
    /// How many it would if partners were drawn at random.
    pub by_chance: f64,
}

impl Support {
    /// Of `pose` by `matched`; `targets` is over the `n_targets` places that partners are among.
    pub(super) fn of(pose: &Pose, matched: &Matched, targets: &KdTree) -> Self {
        let mut found = Vec::new();
        let mut near = 0;
        for place in &matched.from {
            targets.k_nearest(&(pose * place), MOST, matched.tolerance, &mut found);
            near += found.len();
        }
        Self {
            n_matches: matched.len(),
            n_agreeing: matched.agreeing(pose).len(),
            by_chance: near as f64 / targets.len().max(1) as f64,
        }
    }

    /// True if chance does not explain it.
    pub fn is_enough(&self) -> bool {
        self.n_agreeing as f64 >= LEAST + BUNCH * self.by_chance
    }
}

#[cfg(test)]
mod tests {
    use super::super::matching::tests::known;
    use super::*;

    #[test]
    fn a_right_pose_is_supported_and_a_wrong_one_is_not() {
        let (matched, pose) = known(400, 0.8, 3);
        let targets = KdTree::build(&matched.onto);
        let right = Support::of(&pose, &matched, &targets);
        assert!(right.is_enough() && right.n_agreeing >= 80, "{right:?}");
        let wrong = Support::of(&(pose * Pose::translation(9.0, 0.0, 0.0)), &matched, &targets);
        assert!(!wrong.is_enough() && wrong.by_chance < 5.0, "{wrong:?}");
    }
}
