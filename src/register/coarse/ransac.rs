//! Three pairs drawn at random fix a pose; of many such poses those stay that most pairs agree with.
//!
//! Draws whose triangles differ are dropped before anything is computed: with nine wrong pairs in ten,
//! that is nearly all of them. Fischler and Bolles (1981); the test of edges is that of Buch et al.
//! (2013), the score that of MSAC (Torr and Zisserman 2000).

use super::matching::{Hypothesis, Matched};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;

/// Draws from one seed: the same whatever thread makes them.
const CHUNK: u64 = 512;
/// Chunks between two looks at whether it is enough.
const ROUND: u64 = 32;
/// How sure it is to be that the best pose was drawn.
const SURE: f64 = 0.9999;
/// Poses kept of a chunk.
const OF_A_CHUNK: usize = 4;

/// The poses that most pairs agree with, best first, `n_kept` at most; some may be nearly the same.
pub(super) fn ransac(matched: &Matched, draws: u64, seed: u64, n_kept: usize) -> Vec<Hypothesis> {
    let mut best: Vec<Hypothesis> = Vec::new();
    if matched.len() < 3 {
        return best;
    }
    let n_chunks = draws.div_ceil(CHUNK);
    for first in (0..n_chunks).step_by(ROUND as usize) {
        let chunks = first..(first + ROUND).min(n_chunks);
        let done = chunks.end * CHUNK;
        let found: Vec<Vec<Hypothesis>> =
            chunks.into_par_iter().map(|i| chunk(matched, seed, i)).collect();
        best.extend(found.into_iter().flatten());
        best.sort_by(|a, b| b.score.total_cmp(&a.score));
        best.truncate(n_kept);
        if best.first().is_some_and(|best| is_enough(matched, best, done)) {
            break;
        }
    }
    best
}

/// The best poses of a chunk of draws, each fitted to all that agrees with it.
fn chunk(matched: &Matched, seed: u64, i_chunk: u64) -> Vec<Hypothesis> {
    let mut random =
        Pcg64Mcg::seed_from_u64(seed ^ (i_chunk + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15));
    let n = matched.len();
    let mut best: Vec<Hypothesis> = Vec::new();
    for _ in 0..CHUNK {
        let three = [0; 3].map(|_| random.random_range(0..n));
        if !is_congruent(matched, three) {
            continue;
        }
        let pose = matched.fitted(&three);
        let score = matched.score(&pose);
        if best.len() < OF_A_CHUNK || best.last().is_some_and(|last| last.score < score) {
            best.push(Hypothesis { pose, score });
            best.sort_by(|a, b| b.score.total_cmp(&a.score));
            best.truncate(OF_A_CHUNK);
        }
    }
    best.iter().map(|hypothesis| matched.refitted(&hypothesis.pose)).collect()
}

/// True if both triangles have the same sides, and these are long enough to fix a pose.
fn is_congruent(matched: &Matched, [a, b, c]: [usize; 3]) -> bool {
    [(a, b), (b, c), (c, a)].iter().all(|&(i, j)| {
        i != j && matched.stretch(i, j).is_some_and(|stretch| stretch < matched.tolerance)
    })
}

/// True if, were there a better pose, three of its pairs would have been drawn by now.
fn is_enough(matched: &Matched, best: &Hypothesis, n_draws: u64) -> bool {
    let share = best.score / matched.len() as f64;
    let missed = (1.0 - share.powi(3)).powf(n_draws as f64);
    missed < 1.0 - SURE
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
            let found = ransac(&matched, 100_000, seed, 10);
            let off = between(&found[0].pose, &pose, 50.0);
            assert!(off < 0.5, "seed {seed}: {off} mm");
            assert!(found.len() <= 10 && found.is_sorted_by(|a, b| a.score >= b.score));
        }
    }

    #[test]
    fn two_pairs_or_no_congruent_triangles_give_nothing() {
        let (mut matched, _) = known(2, 0.0, 1);
        assert!(ransac(&matched, 10_000, 1, 10).is_empty());
        matched = known(100, 0.0, 1).0;
        matched.onto.iter_mut().for_each(|point| *point *= 3.0);
        assert!(ransac(&matched, 10_000, 1, 10).is_empty());
    }

    #[test]
    fn draws_are_the_same_for_any_number_of_threads() {
        let (matched, _) = known(400, 0.9, 3);
        let on = |n: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap();
            pool.install(|| ransac(&matched, 50_000, 7, 20))
        };
        assert_eq!(on(1), on(2));
    }
}
