//! A pose from pairs of which many are wrong, without a draw: graduated non-convexity.
//!
//! Truncated least squares counts a pair fully up to the tolerance and not at all beyond. That has
//! many bottoms; so it begins with a cost that has one, and is bent towards it step by step, each
//! with the weights that its own residuals ask for. Yang, Antonante, Tzoumas and Carlone (2020); like
//! there, it stands up to about eight wrong pairs in ten, so [`Consistency`] goes before.

use super::consistency::Consistency;
use super::matching::{Hypothesis, Matched};
use crate::geom::{Point3, Pose};
use crate::register::align::align_weighted;
use std::cmp::Reverse;

/// How much nearer to truncated squares each step is.
const BEND: f64 = 1.4;
/// Steps at most: from residuals of a thousand tolerances it takes some 45.
const STEPS: u32 = 100;

/// The poses that groups of consistent pairs agree on, best first, `n_kept` at most.
///
/// The group of the pair in best standing comes first. What a pose explains begins no other group, so
/// that the next one says something else.
pub(super) fn gnc(matched: &Matched, n_kept: usize) -> Vec<Hypothesis> {
    let consistency = Consistency::new(matched);
    let standing = consistency.standing();
    let mut waiting: Vec<usize> = (0..matched.len()).filter(|&i| standing[i] > 0).collect();
    waiting.sort_by_key(|&i| (Reverse(standing[i]), i));
    let mut is_explained = vec![false; matched.len()];
    let mut found: Vec<Hypothesis> = Vec::new();
    for seed in waiting {
        if found.len() == n_kept {
            break;
        }
        if std::mem::replace(&mut is_explained[seed], true) {
            continue;
        }
        let group = consistency.group(seed);
        let Some(pose) = truncated(matched, &group) else { continue };
        let hypothesis = matched.refitted(&pose);
        for i in matched.agreeing(&hypothesis.pose) {
            is_explained[i] = true;
        }
        found.push(hypothesis);
    }
    found.sort_by(|a, b| b.score.total_cmp(&a.score));
    found
}

/// The pose that is best for `group` by truncated least squares; `None` if fewer than three pairs
/// are left.
fn truncated(matched: &Matched, group: &[usize]) -> Option<Pose> {
    let take = |points: &[Point3]| group.iter().map(|&i| points[i]).collect::<Vec<_>>();
    let (from, onto) = (take(&matched.from), take(&matched.onto));
    let limit = matched.tolerance.powi(2);
    let mut weights = vec![1.0; from.len()];
    let mut pose = align_weighted(&from, &onto, &weights);
    let squares = |pose: &Pose| -> Vec<f64> {
        from.iter().zip(&onto).map(|(p, q)| (pose * p - q).norm_squared()).collect()
    };
    let mut all = squares(&pose);
    let most = all.iter().copied().fold(0.0, f64::max);
    // Were all within the tolerance, it would be plain least squares.
    let mut mu = limit / (2.0 * most - limit);
    for _ in 0..STEPS {
        if mu <= 0.0
            || weights.iter().all(|w| *w == 0.0 || *w == 1.0) && all.iter().all(|s| *s <= limit)
        {
            break;
        }
        for (weight, square) in weights.iter_mut().zip(&all) {
            *weight = weight_of(*square / limit, mu);
        }
        if weights.iter().filter(|w| **w > 0.0).count() < 3 {
            return None;
        }
        pose = align_weighted(&from, &onto, &weights);
        all = squares(&pose);
        if weights.iter().all(|w| *w == 0.0 || *w == 1.0) {
            break;
        }
        mu *= BEND;
    }
    Some(pose)
}

/// What a pair counts for whose squared residual is `square` squared tolerances. Yang et al. (2020),
/// eq. 14.
fn weight_of(square: f64, mu: f64) -> f64 {
    if square >= (mu + 1.0) / mu {
        0.0
    } else if square <= mu / (mu + 1.0) {
        1.0
    } else {
        (mu * (mu + 1.0) / square).sqrt() - mu
    }
}

#[cfg(test)]
mod tests {
    use super::super::matching::between;
    use super::super::matching::tests::known;
    use super::*;

    #[test]
    fn the_pose_is_found_among_nine_wrong_pairs_in_ten() {
        for seed in 0..5 {
            let (matched, pose) = known(600, 0.9, seed);
            let found = gnc(&matched, 5);
            let off = between(&found[0].pose, &pose, 50.0);
            assert!(off < 0.3, "seed {seed}: {off} mm");
        }
    }

    #[test]
    fn truncation_alone_stands_half_of_the_pairs_being_wrong() {
        let (matched, pose) = known(200, 0.5, 9);
        let all: Vec<usize> = (0..200).collect();
        let found = truncated(&matched, &all).unwrap();
        assert!(between(&found, &pose, 50.0) < 0.3);
    }

    #[test]
    fn weights_fall_from_one_to_nothing_and_steeper_as_it_bends() {
        for mu in [1e-3, 0.1, 1.0, 100.0] {
            let weights: Vec<f64> = (1..300).map(|i| weight_of(0.01 * f64::from(i), mu)).collect();
            assert!(weights.is_sorted_by(|a, b| a >= b) && weights[0] <= 1.0);
        }
        assert_eq!([weight_of(0.9, 1e4), weight_of(1.1, 1e4)], [1.0, 0.0]);
    }

    #[test]
    fn nothing_comes_of_pairs_that_do_not_go_together() {
        let (mut matched, _) = known(100, 0.0, 1);
        matched.onto.iter_mut().for_each(|point| *point *= 3.0);
        assert!(gnc(&matched, 5).is_empty());
        assert!(gnc(&Matched::default(), 5).is_empty());
    }
}
