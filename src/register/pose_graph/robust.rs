//! What a loop counts for, by how far it is off.

use super::LoopKernel;

/// By this factor the cost is made less convex from round to round.
const SHARPER: f64 = 1.4;

/// The kernel as it stands in a round.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Stage {
    /// All count alike.
    Even,
    /// By the inverse square; with the square of the limit.
    Cauchy(f64),
    /// Truncated least squares: with the square of the limit and how sharply it is cut, from 0 (not at
    /// all) to infinity.
    Truncated(f64, f64),
}

impl Stage {
    /// Where to begin, when the loops are off by `squares` (of standard deviations).
    pub(super) fn first(
        kernel: LoopKernel,
        limit: f64,
        squares: impl Iterator<Item = f64>,
    ) -> Self {
        let limit = limit * limit;
        match kernel {
            LoopKernel::None => Self::Even,
            LoopKernel::Cauchy => Self::Cauchy(limit),
            LoopKernel::Truncated => {
                let worst = squares.fold(0.0, f64::max);
                // As convex as the worst one needs it; all that fit are cut sharply at once.
                let sharpness = limit / (2.0 * worst - limit);
                let is_soft = sharpness > 0.0;
                Self::Truncated(limit, if is_soft { sharpness } else { f64::INFINITY })
            }
        }
    }

    /// What a loop that is off by `square` counts for, from 0 to 1.
    pub(super) fn weight(&self, square: f64) -> f64 {
        match *self {
            Self::Even => 1.0,
            Self::Cauchy(limit) => 1.0 / (1.0 + square / limit),
            Self::Truncated(limit, sharpness) if sharpness.is_infinite() => {
                f64::from(u8::from(square <= limit))
            }
            Self::Truncated(limit, sharpness) => {
                if square <= limit * sharpness / (sharpness + 1.0) {
                    1.0
                } else if square >= limit * (sharpness + 1.0) / sharpness {
                    0.0
                } else {
                    (limit * sharpness * (sharpness + 1.0) / square).sqrt() - sharpness
                }
            }
        }
    }

    /// The next round's.
    pub(super) fn next(self) -> Self {
        match self {
            Self::Truncated(limit, sharpness) => Self::Truncated(limit, sharpness * SHARPER),
            same => same,
        }
    }

    /// True if every weight is one that it ends with.
    pub(super) fn is_last(&self, weights: &[f64]) -> bool {
        match self {
            Self::Even => true,
            Self::Cauchy(_) => false,
            Self::Truncated(..) => weights.iter().all(|w| *w == 0.0 || *w == 1.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cut_begins_soft_and_ends_sharp() {
        let mut stage = Stage::first(LoopKernel::Truncated, 2.0, [1.0, 400.0].into_iter());
        assert!((0.0..1.0).contains(&stage.weight(400.0)) && stage.weight(1e9) == 0.0);
        let begin = stage.weight(30.0);
        assert!(begin > 0.0 && !stage.is_last(&[1.0, begin]));
        for _ in 0..60 {
            stage = stage.next();
        }
        assert_eq!([3.9, 4.1].map(|square| stage.weight(square)), [1.0, 0.0]);
    }

    #[test]
    fn loops_that_all_fit_are_cut_sharply_at_once() {
        let stage = Stage::first(LoopKernel::Truncated, 2.0, [0.5, 1.5].into_iter());
        assert_eq!([1.9_f64, 4.0, 4.01].map(|square| stage.weight(square)), [1.0, 1.0, 0.0]);
        assert!(stage.is_last(&[1.0, 0.0]));
        let none = Stage::first(LoopKernel::Truncated, 2.0, std::iter::empty());
        assert!(none.is_last(&[]));
    }

    #[test]
    fn cauchy_takes_weight_and_never_all_of_it() {
        let stage = Stage::first(LoopKernel::Cauchy, 2.0, std::iter::empty());
        assert_eq!([0.0, 4.0, 12.0].map(|square| stage.weight(square)), [1.0, 0.5, 0.25]);
    }
}
