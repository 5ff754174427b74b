//! Which exposures belong together: by the nearest stamp.

/// Pairs of indices into `first` and `second` (both rising) whose stamps lie at most `farthest`
/// apart, in the order of `first`. The nearest go together first, and each stamp is used once: the
/// rule of the TUM benchmark (`associate.py`).
pub fn associate(first: &[f64], second: &[f64], farthest: f64) -> Vec<(usize, usize)> {
    let mut candidates = Vec::new();
    let mut begin = 0;
    for (i, &stamp) in first.iter().enumerate() {
        begin += second[begin..].iter().take_while(|other| **other < stamp - farthest).count();
        let near = second[begin..].iter().take_while(|other| **other - stamp <= farthest);
        candidates.extend(near.zip(begin..).map(|(other, j)| ((stamp - other).abs(), i, j)));
    }
    candidates.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    let (mut first_used, mut second_used) = (vec![false; first.len()], vec![false; second.len()]);
    let mut pairs = Vec::new();
    for (distance, i, j) in candidates {
        if distance <= farthest && !first_used[i] && !second_used[j] {
            (first_used[i], second_used[j]) = (true, true);
            pairs.push((i, j));
        }
    }
    pairs.sort_unstable();
    pairs
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_stamp_goes_with_the_nearest_and_is_used_once() {
        // 0.10 is nearest to both 0.11 and 0.115; the nearer one gets it, the other the next best.
        let pairs = associate(&[0.11, 0.115, 0.5], &[0.10, 0.13, 0.531], 0.02);
        assert_eq!(pairs, [(0, 0), (1, 1)]);
        assert_eq!(associate(&[0.11, 0.5], &[0.10, 0.531], 0.04), [(0, 0), (1, 1)]);
    }

    #[test]
    fn what_is_too_far_away_stays_alone() {
        assert_eq!(associate(&[1.0, 2.0], &[1.5], 0.4), []);
        assert_eq!(associate(&[], &[1.5], 0.4), []);
        assert_eq!(associate(&[1.0], &[1.02], 0.02 + 1e-12), [(0, 0)]);
    }

    #[test]
    fn long_lists_at_different_rates_pair_one_to_one() {
        let first: Vec<f64> = (0..300).map(|i| f64::from(i) / 30.0).collect();
        let second: Vec<f64> = (0..1000).map(|i| f64::from(i) / 100.0 + 0.001).collect();
        let pairs = associate(&first, &second, 0.02);
        assert_eq!(pairs.len(), 300);
        assert!(pairs.windows(2).all(|w| w[0].0 < w[1].0 && w[0].1 < w[1].1));
        assert!(pairs.iter().all(|&(i, j)| (first[i] - second[j]).abs() < 0.0051));
    }
}
