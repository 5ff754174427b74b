//! Rejection: pairs that had better not count, by rules on the pairs themselves.

use super::cost::Motion;
use super::options::IcpOptions;
use super::pair::Pair;
use super::view::View;

/// Drops what the options reject, in the order: normals, borders, one partner each, standard
/// deviations, worst share.
pub(super) fn reject(
    pairs: &mut Vec<Pair>,
    [source, target]: [&View; 2],
    motion: &Motion,
    options: &IcpOptions,
) {
    if let Some(angle) = options.reject_angle {
        let least = angle.to_radians().cos();
        let is_oriented = source.is_oriented && target.is_oriented;
        pairs.retain(|pair| {
            let cosine = cosine([source, target], motion, pair);
            // Without a side, normals never enclose more than a right angle.
            let cosine = if is_oriented { cosine } else { cosine.abs() };
            cosine >= least
        });
    }
    if let (true, Some(is_border)) = (options.reject_borders, &target.is_border) {
        pairs.retain(|pair| !is_border[pair.target as usize]);
    }
    if options.bi_unique {
        bi_unique(pairs, target.len());
    }
    if let Some(k) = options.reject_sigma {
        within_sigma(pairs, k);
    }
    if let Some(percent) = options.reject_worst {
        without_worst(pairs, percent / 100.0);
    }
}

/// The cosine between the normals of a pair.
pub(super) fn cosine([source, target]: [&View; 2], motion: &Motion, pair: &Pair) -> f64 {
    let turned = motion.rotation * source.normals[pair.source as usize];
    turned.dot(&target.normals[pair.target as usize])
}

/// Of the pairs of a target point the shortest stays. Zhang (1994).
fn bi_unique(pairs: &mut Vec<Pair>, n_targets: usize) {
    let mut best: Vec<Option<Pair>> = vec![None; n_targets];
    for pair in &*pairs {
        let kept = &mut best[pair.target as usize];
        if kept.is_none_or(|kept| pair.distance < kept.distance) {
            *kept = Some(*pair);
        }
    }
    pairs.retain(|pair| best[pair.target as usize].is_some_and(|kept| kept.source == pair.source));
}

/// Pairs no longer than the mean and `k` standard deviations. Masuda et al. (1996).
fn within_sigma(pairs: &mut Vec<Pair>, k: f64) {
    let n = pairs.len().max(1) as f64;
    let mean = pairs.iter().map(|pair| pair.distance).sum::<f64>() / n;
    let variance = pairs.iter().map(|pair| (pair.distance - mean).powi(2)).sum::<f64>() / n;
    // Rounding must not drop pairs that are all equally long.
    let limit = mean * (1.0 + 1e-12) + k * variance.sqrt();
    pairs.retain(|pair| pair.distance <= limit);
}

/// All but the longest `share` of the pairs. Pulli (1999).
fn without_worst(pairs: &mut Vec<Pair>, share: f64) {
    let n_kept = ((1.0 - share) * pairs.len() as f64).ceil() as usize;
    if n_kept == 0 || n_kept >= pairs.len() {
        return;
    }
    let mut keys: Vec<(f64, u32)> = pairs.iter().map(|pair| (pair.distance, pair.source)).collect();
    let by_key = |a: &(f64, u32), b: &(f64, u32)| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1));
    let last = *keys.select_nth_unstable_by(n_kept - 1, by_key).1;
    pairs.retain(|pair| by_key(&(pair.distance, pair.source), &last).is_le());
}

#[cfg(test)]
mod tests {
    use super::super::tests::{options as view_options, relief};
    use super::super::view::ViewOptions;
    use super::*;
    use crate::geom::{Pose, Vector3};
    use crate::progress::Silent;
    use crate::register::icp::Role;

    fn pairs(distances: &[f64]) -> Vec<Pair> {
        let pair = |(i, &distance): (usize, &f64)| Pair {
            source: i as u32,
            target: i as u32 / 2,
            distance,
            weight: 1.0,
            is_turned: false,
        };
        distances.iter().enumerate().map(pair).collect()
    }

    fn sources(pairs: &[Pair]) -> Vec<u32> {
        pairs.iter().map(|pair| pair.source).collect()
    }

    #[test]
    fn one_partner_each_is_the_nearest_and_of_equals_the_first() {
        let mut pairs = pairs(&[3.0, 2.0, 5.0, 5.0, 1.0]);
        bi_unique(&mut pairs, 3);
        assert_eq!(sources(&pairs), [1, 2, 4]);
    }

    #[test]
    fn pairs_beyond_k_standard_deviations_go() {
        let mut pairs = pairs(&[1.0, 1.0, 1.0, 1.0, 6.0]);
        // Mean 2, standard deviation 2.
        within_sigma(&mut pairs, 2.1);
        assert_eq!(pairs.len(), 5);
        within_sigma(&mut pairs, 1.9);
        assert_eq!(sources(&pairs), [0, 1, 2, 3]);
        within_sigma(&mut pairs, 0.1);
        assert_eq!(pairs.len(), 4);
    }

    #[test]
    fn the_worst_fifth_goes_and_ties_are_kept_in_order() {
        let mut pairs = pairs(&[4.0, 9.0, 2.0, 9.0, 1.0]);
        without_worst(&mut pairs, 0.2);
        assert_eq!(sources(&pairs), [0, 1, 2, 4]);
        without_worst(&mut pairs, 0.0);
        assert_eq!(pairs.len(), 4);
    }

    #[test]
    fn normals_that_do_not_go_together_and_borders_are_dropped() {
        let with_borders = ViewOptions { with_borders: true, ..view_options(0.8) };
        let view = View::new(&relief(3000), Role::Source, with_borders, &Silent).unwrap();
        let all: Vec<Pair> = (0..view.len() as u32)
            .map(|i| Pair { source: i, target: i, distance: 0.0, weight: 1.0, is_turned: false })
            .collect();
        // A quarter of a turn about Y: only what looks along Y keeps its direction.
        let turned = Motion::from(&Pose::rotation(Vector3::y() * std::f64::consts::FRAC_PI_2));
        let options = IcpOptions { reject_angle: Some(45.0), ..IcpOptions::default() };
        let mut kept = all.clone();
        reject(&mut kept, [&view; 2], &turned, &options);
        assert!(kept.len() < all.len() / 4);
        let still = Motion::from(&Pose::identity());
        let options = IcpOptions { reject_borders: true, reject_angle: Some(1.0), ..options };
        let mut kept = all.clone();
        reject(&mut kept, [&view; 2], &still, &options);
        let n_border = view.is_border.as_ref().unwrap().iter().filter(|is| **is).count();
        assert_eq!(kept.len() + n_border, all.len());
        assert!(n_border > 0 && n_border < all.len() / 3);
    }
}
