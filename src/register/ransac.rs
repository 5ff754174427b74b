//! The hypothesis that most of the data agree with: random sample consensus.
//!
//! M. Fischler and R. Bolles (1981), scored by truncated residuals (Torr and Zisserman 2000), with the
//! best ones refined as they appear (Chum et al. 2003). Draws belong to the number of a try, and tries
//! are judged in batches, so the result does not depend on threads.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;

/// Tries that are judged side by side before it is asked whether they suffice.
const BATCH: usize = 64;
/// Refinements of a hypothesis at most.
const REFINEMENTS: usize = 4;

/// Data, and what hypotheses about them are made and judged by.
pub trait Model: Sync {
    /// What is looked for.
    type Hypothesis: Clone + Send + Sync;
    /// Data that make a hypothesis.
    const SAMPLE: usize;

    /// How many data there are.
    fn n_data(&self) -> usize;

    /// The hypothesis that `sample` makes; `None` if they make none.
    fn fit(&self, sample: &[usize]) -> Option<Self::Hypothesis>;

    /// How far a datum is from agreeing, squared; up to 1 it does.
    fn square(&self, hypothesis: &Self::Hypothesis, datum: usize) -> f64;

    /// A better hypothesis for `inliers`, near this one.
    fn refit(&self, hypothesis: &Self::Hypothesis, inliers: &[usize]) -> Option<Self::Hypothesis>;
}

/// How long is looked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RansacOptions {
    /// Tries at most.
    pub most_tries: usize,
    /// Stop when a better hypothesis has been missed with no more than this probability.
    pub miss: f64,
    /// Seed of the draws.
    pub seed: u64,
}

/// What most of the data agree with.
#[derive(Debug, Clone, PartialEq)]
pub struct Consensus<H> {
    /// The hypothesis.
    pub hypothesis: H,
    /// The data that agree with it, rising.
    pub inliers: Vec<usize>,
    /// Sum of the squares, each at most 1.
    pub score: f64,
    /// Tries it took.
    pub n_tries: usize,
}

impl Default for RansacOptions {
    fn default() -> Self {
        Self { most_tries: 4096, miss: 1e-4, seed: 1 }
    }
}

/// The hypothesis that most data agree with; `None` if no sample makes one, or there are too few data.
pub fn ransac<M: Model>(model: &M, options: &RansacOptions) -> Option<Consensus<M::Hypothesis>> {
    let n = model.n_data();
    if n < M::SAMPLE || M::SAMPLE == 0 {
        return None;
    }
    let mut best: Option<Consensus<M::Hypothesis>> = None;
    let mut n_tries = 0;
    let mut n_needed = options.most_tries;
    while n_tries < n_needed {
        let batch = n_tries..(n_tries + BATCH).min(options.most_tries);
        n_tries = batch.end;
        let tried: Vec<Option<(f64, M::Hypothesis)>> = batch
            .into_par_iter()
            .map(|i| {
                let hypothesis = model.fit(&drawn(n, M::SAMPLE, options.seed, i))?;
                Some((score(model, &hypothesis), hypothesis))
            })
            .collect();
        // Of equal scores the first try's.
        let better = tried.into_iter().flatten().min_by(|a, b| a.0.total_cmp(&b.0));
        let Some((score, hypothesis)) = better else { continue };
        if best.as_ref().is_none_or(|best| score < best.score) {
            let refined = refined(model, hypothesis, score);
            if best.as_ref().is_none_or(|best| refined.score < best.score) {
                n_needed = n_needed.min(needed(refined.inliers.len(), n, M::SAMPLE, options.miss));
                best = Some(refined);
            }
        }
    }
    best.map(|best| Consensus { n_tries, ..best })
}

/// Refined as long as that makes it better.
fn refined<M: Model>(model: &M, hypothesis: M::Hypothesis, first: f64) -> Consensus<M::Hypothesis> {
    let inliers = agreeing(model, &hypothesis);
    let mut best = Consensus { hypothesis, inliers, score: first, n_tries: 0 };
    for _ in 0..REFINEMENTS {
        let Some(hypothesis) = model.refit(&best.hypothesis, &best.inliers) else { break };
        let score = score(model, &hypothesis);
        if score >= best.score {
            break;
        }
        let inliers = agreeing(model, &hypothesis);
        best = Consensus { hypothesis, inliers, score, n_tries: 0 };
    }
    best
}

fn score<M: Model>(model: &M, hypothesis: &M::Hypothesis) -> f64 {
    // `min` takes NaN for 1: what cannot be judged does not agree.
    (0..model.n_data()).map(|datum| model.square(hypothesis, datum).min(1.0)).sum()
}

fn agreeing<M: Model>(model: &M, hypothesis: &M::Hypothesis) -> Vec<usize> {
    (0..model.n_data()).filter(|&datum| model.square(hypothesis, datum) <= 1.0).collect()
}

/// Tries after which a sample of inliers alone has been missed with the probability `miss`.
fn needed(n_inliers: usize, n: usize, sample: usize, miss: f64) -> usize {
    let share = n_inliers as f64 / n as f64;
    let all_good = share.powf(sample as f64);
    if all_good >= 1.0 {
        return 1;
    }
    let tries = miss.ln() / (-all_good).ln_1p();
    // A float too large becomes the largest number; 0 inliers need infinitely many.
    if tries.is_nan() { usize::MAX } else { tries.ceil() as usize }
}

/// The data of the `i_try`th sample, all different.
fn drawn(n: usize, sample: usize, seed: u64, i_try: usize) -> Vec<usize> {
    let own = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ i_try as u64;
    let mut random = Pcg64Mcg::seed_from_u64(own);
    let mut drawn = Vec::with_capacity(sample);
    while drawn.len() < sample {
        let datum = random.random_range(0..n);
        if !drawn.contains(&datum) {
            drawn.push(datum);
        }
    }
    drawn
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A line through points, by its height at 0 and its slope.
    struct Line(Vec<[f64; 2]>);

    impl Model for Line {
        type Hypothesis = [f64; 2];
        const SAMPLE: usize = 2;

        fn n_data(&self) -> usize {
            self.0.len()
        }

        fn fit(&self, sample: &[usize]) -> Option<[f64; 2]> {
            let [[x0, y0], [x1, y1]] = [self.0[sample[0]], self.0[sample[1]]];
            let slope = (y1 - y0) / (x1 - x0);
            slope.is_finite().then_some([y0 - slope * x0, slope])
        }

        fn square(&self, [height, slope]: &[f64; 2], datum: usize) -> f64 {
            let [x, y] = self.0[datum];
            ((height + slope * x - y) / 0.1).powi(2)
        }

        fn refit(&self, _: &[f64; 2], inliers: &[usize]) -> Option<[f64; 2]> {
            let n = inliers.len() as f64;
            let mean = |k: usize| inliers.iter().map(|&i| self.0[i][k]).sum::<f64>() / n;
            let (mx, my) = (mean(0), mean(1));
            let sum = |k: usize| -> f64 {
                inliers.iter().map(|&i| (self.0[i][0] - mx) * (self.0[i][k] - [mx, my][k])).sum()
            };
            let slope = sum(1) / sum(0);
            slope.is_finite().then_some([my - slope * mx, slope])
        }
    }

    /// 40 points of the line 2 + 3 x, off by less than 0.05, and 60 anywhere.
    fn points() -> Line {
        let mut random = Pcg64Mcg::seed_from_u64(5);
        let mut even = |from: f64, to: f64| random.random_range(from..to);
        let on_line = (0..40).map(|i| {
            let x = f64::from(i) / 10.0;
            [x, 2.0 + 3.0 * x + 0.1 * (f64::from(i * 7 % 10) / 10.0 - 0.45)]
        });
        let anywhere = (0..60).map(|_| [even(0.0, 4.0), even(0.0, 14.0)]);
        Line(on_line.chain(anywhere).collect())
    }

    #[test]
    fn a_line_is_found_among_more_outliers() {
        let found = ransac(&points(), &RansacOptions::default()).unwrap();
        let [height, slope] = found.hypothesis;
        assert!((height - 2.0).abs() < 0.05 && (slope - 3.0).abs() < 0.02, "{height} {slope}");
        assert!((0..40).all(|i| found.inliers.contains(&i)));
        assert!(found.inliers.len() < 50, "{:?}", found.inliers);
        assert!(found.n_tries < 4096, "two in five are good: a hundred tries do");
    }

    #[test]
    fn any_number_of_threads_finds_the_same() {
        let line = points();
        let find = |n_threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads).build().unwrap();
            pool.install(|| ransac(&line, &RansacOptions::default()).unwrap())
        };
        assert_eq!(find(1), find(4));
    }

    #[test]
    fn too_few_data_or_none_that_fit_are_no_consensus() {
        let options = RansacOptions { most_tries: 100, ..RansacOptions::default() };
        assert_eq!(ransac(&Line(vec![[1.0, 1.0]]), &options), None);
        assert_eq!(ransac(&Line(vec![[1.0, 1.0]; 9]), &options), None);
    }

    #[test]
    fn as_many_tries_as_the_share_of_inliers_asks_for() {
        assert_eq!(needed(10, 10, 3, 1e-4), 1);
        // 1 - 0.125 to the 69th is just below 1e-4.
        assert_eq!(needed(50, 100, 3, 1e-4), 69);
        assert_eq!(needed(0, 100, 3, 1e-4), usize::MAX);
    }
}
