//! How far residuals scatter: Student's t-distribution, which expects some to lie far out.
//!
//! Kerl, Sturm, Cremers, *Robust odometry estimation for RGB-D cameras* (ICRA 2013) for brightness
//! alone, *Dense visual SLAM for RGB-D cameras* (IROS 2013) for brightness and depth together.

use super::warp::Batch;
use rayon::prelude::*;

/// Degrees of freedom, as in both papers.
pub(super) const NU: f32 = 5.0;
/// No residual is known better than this: brightness (a fifth of what eight bits tell apart), and
/// inverse depth [1/mm] (0.02 mm, a metre away).
const LEAST: [f64; 2] = [8e-4, 2e-8];
/// Scale and weights depend on each other; from the start, and from the scale of the last step.
const FIRST_ROUNDS: usize = 12;
const NEXT_ROUNDS: usize = 3;
/// No exposure makes a picture this much brighter or darker than the one before.
const GAINS: std::ops::RangeInclusive<f64> = 0.4..=2.5;

/// How one picture's brightness becomes the other's, and how much both residuals scatter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Noise {
    /// The reference's brightness is `gain * next + offset`.
    pub(super) gain: f64,
    pub(super) offset: f64,
    /// Scale matrix of brightness and inverse depth: both squares, and what they have in common.
    pub(super) scale: [f64; 3],
}

/// What weighs residuals, in single precision: `e1 = a r + b d`, `e2 = c d` are unit residuals, and
/// `e1 = alone r` where there is no depth.
#[derive(Debug, Clone, Copy)]
pub(super) struct Whitening {
    pub(super) gain: f32,
    pub(super) offset: f32,
    pub(super) a: f32,
    pub(super) b: f32,
    pub(super) c: f32,
    pub(super) alone: f32,
}

impl Noise {
    /// Before anything is known: `None` stands for no scale yet.
    pub(super) const START: Self = Self { gain: 1.0, offset: 0.0, scale: [0.01, 1e-10, 0.0] };

    /// The residual of brightness scatters by this (0 to 1), that of inverse depth by this [1/mm].
    pub(super) fn sigmas(&self) -> [f64; 2] {
        [self.scale[0].sqrt(), self.scale[1].sqrt()]
    }

    /// Fitted to what was seen, beginning at `self`; `is_first` if that is a mere guess.
    pub(super) fn fitted(mut self, batches: &[Batch], light: bool, is_first: bool) -> Self {
        let rounds = if is_first { FIRST_ROUNDS } else { NEXT_ROUNDS };
        for _ in 0..rounds {
            let white = self.whitening();
            let sums: Vec<[f64; 10]> =
                batches.par_iter().map(|batch| moments(batch, &white)).collect();
            let mut total = [0.0; 10];
            for sum in sums {
                total.iter_mut().zip(sum).for_each(|(total, sum)| *total += sum);
            }
            let [n, weight, next, own, next2, own2, depth_n, depth2, both, common] = total;
            if n < 1.0 || weight <= 0.0 {
                break;
            }
            let (next, own) = (next / weight, own / weight);
            let (next2, own2) = (next2 / weight - next * next, own2 / weight - own * own);
            let common = common / weight - next * own;
            if light && next2 > 0.0 && own2 > 0.0 {
                self.gain = (own2 / next2).sqrt().clamp(*GAINS.start(), *GAINS.end());
                self.offset = own - self.gain * next;
            }
            let mean = self.gain * next + self.offset - own;
            let spread = self.gain * self.gain * next2 + own2 - 2.0 * self.gain * common;
            let grey = (weight / n) * (spread.max(0.0) + mean * mean);
            let depth = if depth_n > 0.0 { depth2 / depth_n } else { 0.0 };
            let both = if depth_n > 0.0 { both / depth_n } else { 0.0 };
            let squares = [grey.max(LEAST[0].powi(2)), depth.max(LEAST[1].powi(2))];
            // Rounding must not make the matrix singular.
            let most = 0.95 * (squares[0] * squares[1]).sqrt();
            self.scale = [squares[0], squares[1], both.clamp(-most, most)];
        }
        self
    }

    /// What makes residuals unit ones.
    pub(super) fn whitening(&self) -> Whitening {
        let [grey, depth, both] = self.scale;
        // The inverse of the matrix, as a triangle times its transpose.
        let left = grey - both * both / depth;
        let a = (1.0 / left).sqrt();
        Whitening {
            gain: self.gain as f32,
            offset: self.offset as f32,
            a: a as f32,
            b: (-both / depth * a) as f32,
            c: (1.0 / depth).sqrt() as f32,
            alone: (1.0 / grey).sqrt() as f32,
        }
    }
}

impl Whitening {
    /// The unit residuals of a point, and how many there are.
    #[inline(always)]
    pub(super) fn residuals(&self, batch: &Batch, i: usize) -> ([f32; 2], f32) {
        let held = batch.held[i];
        let grey = batch.seen[i] * (self.gain * batch.grey[i] + self.offset) - batch.own[i];
        let a = held * self.a + (1.0 - held) * self.alone;
        ([a * grey + self.b * batch.off[i], self.c * batch.off[i]], 1.0 + held)
    }

    /// What a point counts for, of 1.
    #[inline(always)]
    pub(super) fn weight(&self, batch: &Batch, i: usize) -> f32 {
        let ([e1, e2], n) = self.residuals(batch, i);
        batch.seen[i] * (NU + n) / (NU + e1 * e1 + e2 * e2)
    }
}

/// Points seen, weights, weighted brightness (seen, own, their squares), points with depth, weighted
/// squares of depth, products of depth and brightness, and of both brightnesses.
fn moments(batch: &Batch, white: &Whitening) -> [f64; 10] {
    let mut sums = [[0.0_f32; 8]; 10];
    for start in (0..super::points::BATCH).step_by(8) {
        for lane in 0..8 {
            let i = start + lane;
            let weight = white.weight(batch, i);
            let (next, own, off) = (batch.grey[i], batch.own[i], batch.off[i]);
            let grey = batch.seen[i] * (white.gain * next + white.offset) - own;
            let terms = [
                batch.seen[i],
                weight,
                weight * next,
                weight * own,
                weight * next * next,
                weight * own * own,
                batch.held[i],
                weight * off * off,
                weight * off * grey,
                weight * next * own,
            ];
            for (sum, term) in sums.iter_mut().zip(terms) {
                sum[lane] += term;
            }
        }
    }
    sums.map(|lanes| lanes.iter().map(|lane| f64::from(*lane)).sum())
}

#[cfg(test)]
mod tests {
    use super::super::points::BATCH;
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    /// Brightness and depth off by normal noise with something in common, a tenth of it far off; what is
    /// seen is the points' own brightness by a gain and an offset.
    fn batches(light: [f64; 2]) -> Vec<Batch> {
        let mut draw = Pcg64Mcg::seed_from_u64(11);
        let mut normal = move || (0..12).map(|_| draw.random::<f64>()).sum::<f64>() - 6.0;
        let mut batch = |_| {
            let mut batch = Batch::EMPTY;
            for i in 0..BATCH {
                let (a, b) = (normal(), normal());
                let far = if i % 10 == 0 { 30.0 } else { 1.0 };
                let own = 0.5 + 0.15 * normal();
                let reference = light[0] * own + light[1] + far * 0.02 * a;
                (batch.seen[i], batch.held[i]) = (1.0, 1.0);
                batch.grey[i] = own as f32;
                batch.own[i] = reference as f32;
                batch.off[i] = (far * 1e-5 * (0.8 * b - 0.6 * a)) as f32;
            }
            batch
        };
        (0..40).map(&mut batch).collect()
    }

    #[test]
    fn the_scale_is_that_of_the_many_and_not_of_the_few() {
        let noise = Noise::START.fitted(&batches([1.0, 0.0]), false, true);
        let [grey, depth] = noise.sigmas();
        // A t-distribution's scale lies a little off a normal one's deviation.
        assert!((0.016..0.026).contains(&grey), "{grey}");
        assert!((0.8e-5..1.3e-5).contains(&depth), "{depth}");
        let common = noise.scale[2] / (grey * depth);
        // The residual is what is seen less the point's own.
        assert!((common - 0.6).abs() < 0.1, "{common}");
        assert_eq!((noise.gain, noise.offset), (1.0, 0.0));
    }

    #[test]
    fn light_is_found_with_the_scale() {
        let noise = Noise::START.fitted(&batches([1.3, -0.1]), true, true);
        assert!((noise.gain - 1.3).abs() < 0.04, "{}", noise.gain);
        assert!((noise.offset + 0.1).abs() < 0.02, "{}", noise.offset);
    }

    #[test]
    fn weights_fall_from_seven_fifths_by_the_square_of_what_is_far_off() {
        let noise = Noise { gain: 1.0, offset: 0.0, scale: [0.01, 1e-10, 0.0] };
        let white = noise.whitening();
        let mut batch = Batch::EMPTY;
        (batch.seen[0], batch.held[0]) = (1.0, 1.0);
        assert!((white.weight(&batch, 0) - 7.0 / 5.0).abs() < 1e-6);
        (batch.grey[0], batch.off[0]) = (0.3, 4e-5);
        assert!((white.weight(&batch, 0) - 7.0 / 30.0).abs() < 1e-4, "3 and 4 sigmas are 5");
        batch.held[0] = 0.0;
        batch.off[0] = 0.0;
        assert!((white.weight(&batch, 0) - 6.0 / 14.0).abs() < 1e-4, "brightness alone");
        assert_eq!(white.weight(&batch, 1), 0.0, "not seen");
    }
}
