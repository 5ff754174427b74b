//! Pairs that can be right together: a rigid motion keeps distances.
//!
//! Two pairs are consistent if their points are as far apart on both sides. A wrong pair is consistent
//! with many others by chance, but with few that are so among themselves; counting those (the second
//! order) tells right from wrong where nine in ten are wrong. Leordeanu and Hebert (2005); Chen et al.
//! (2022), *SC²-PCR*.

use super::matching::Matched;
use rayon::prelude::*;

/// A consistent pair is left in a group if it has this share of the common friends of the best one.
const FRIENDS: f64 = 0.5;

/// Which pairs are consistent with which, a bit each.
#[derive(Debug)]
pub(super) struct Consistency {
    rows: Vec<Vec<u64>>,
}

impl Consistency {
    /// Of all pairs with all.
    pub(super) fn new(matched: &Matched) -> Self {
        let n = matched.len();
        let row = |i: usize| {
            let mut row = vec![0_u64; n.div_ceil(64)];
            for j in (0..n).filter(|&j| j != i) {
                if matched.stretch(i, j).is_some_and(|stretch| stretch < matched.tolerance) {
                    row[j / 64] |= 1 << (j % 64);
                }
            }
            row
        };
        Self { rows: (0..n).into_par_iter().map(row).collect() }
    }

    /// How many common friends a pair has with all its friends, of all pairs.
    pub(super) fn standing(&self) -> Vec<u64> {
        let of = |i: usize| self.friends(i).map(|j| u64::from(self.common(i, j))).sum();
        (0..self.rows.len()).into_par_iter().map(of).collect()
    }

    /// A pair with those of its friends that have the most friends in common with it.
    pub(super) fn group(&self, i: usize) -> Vec<usize> {
        let common: Vec<(usize, u32)> = self.friends(i).map(|j| (j, self.common(i, j))).collect();
        let most = common.iter().map(|(_, n)| *n).max().unwrap_or(0);
        let close = common.iter().filter(|(_, n)| f64::from(*n) >= FRIENDS * f64::from(most));
        std::iter::once(i).chain(close.map(|(j, _)| *j)).collect()
    }

    fn common(&self, i: usize, j: usize) -> u32 {
        self.rows[i].iter().zip(&self.rows[j]).map(|(a, b)| (a & b).count_ones()).sum()
    }

    fn friends(&self, i: usize) -> impl Iterator<Item = usize> {
        self.rows[i].iter().enumerate().flat_map(|(place, &word)| {
            (0..64).filter(move |bit| word >> bit & 1 == 1).map(move |bit| place * 64 + bit)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::matching::tests::known;
    use super::*;

    #[test]
    fn right_pairs_stand_out_among_nine_wrong_in_ten() {
        let (matched, pose) = known(600, 0.9, 2);
        let consistency = Consistency::new(&matched);
        let standing = consistency.standing();
        let best = (0..600).max_by_key(|&i| standing[i]).unwrap();
        let right = matched.agreeing(&pose);
        let group = consistency.group(best);
        let n_right = group.iter().filter(|i| right.contains(i)).count();
        assert!(n_right * 10 > group.len() * 8 && n_right * 2 > right.len(), "{group:?}");
    }

    #[test]
    fn friends_are_mutual_and_nobody_is_his_own() {
        let (matched, _) = known(130, 0.5, 2);
        let consistency = Consistency::new(&matched);
        for i in 0..130 {
            for j in consistency.friends(i) {
                assert!(i != j && consistency.friends(j).any(|k| k == i));
            }
        }
    }
}
