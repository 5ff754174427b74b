//! Weighting: what a pair counts for, by what it is and by how well it fits.

use super::cost::{CHUNK, Cost, Motion};
use super::options::{Kernel, Metric, Weighting};
use super::pair::Pair;
use super::reject::cosine;
use super::view::median;
use rayon::prelude::*;

/// The standard deviation of a normal distribution, in median absolute deviations.
const SIGMAS: f64 = 1.4826;
/// Residuals this small, as a share of a voxel, are rounding: no kernel is narrower.
const EXACT: f64 = 1e-9;

/// Sets the weights of `pairs` by `weighting`; `within` is the greatest distance of a pair.
pub(super) fn weigh(
    pairs: &mut [Pair],
    cost: &Cost,
    motion: &Motion,
    (weighting, within): (Weighting, f64),
) {
    let source = cost.source;
    match weighting {
        Weighting::Even => {}
        Weighting::Distance => {
            for pair in pairs {
                pair.weight = (1.0 - pair.distance / within).max(0.0);
            }
        }
        Weighting::Normals => {
            for pair in pairs {
                pair.weight = cosine([source, cost.target], motion, pair).abs();
            }
        }
        Weighting::SensorNoise => {
            let depth = |pair: &Pair| {
                (source.points[pair.source as usize] + source.center.coords).coords.norm()
            };
            let mut depths: Vec<f64> = pairs.iter().map(depth).collect();
            let typical = median(&mut depths);
            for pair in pairs {
                // The noise grows with the square of the depth; a weight is an inverse variance.
                // Nothing stands nearer than a tenth of the usual depth.
                let depth = depth(pair).max(0.1 * typical);
                pair.weight = if depth > 0.0 { (typical / depth).powi(4) } else { 1.0 };
            }
        }
    }
}

/// Multiplies the weights of `pairs` by what `kernel` leaves of their residuals.
pub(super) fn robust(pairs: &mut [Pair], cost: &Cost, motion: &Motion, kernel: Kernel) {
    if kernel == Kernel::None {
        return;
    }
    let residuals = map(pairs, |pair| cost.square(motion, pair).sqrt());
    let scale = deviation(residuals.clone(), cost);
    for (pair, residual) in pairs.iter_mut().zip(residuals) {
        pair.weight *= kernel.weight(residual / scale);
    }
}

/// What pairs are off by themselves: the standard deviation of those that fit [mm].
pub(super) fn typical(pairs: &[Pair], cost: &Cost, motion: &Motion) -> f64 {
    deviation(map(pairs, |pair| cost.square(motion, pair).sqrt()), cost)
}

/// The standard deviation that the median of `residuals` tells.
fn deviation(mut residuals: Vec<f64>, cost: &Cost) -> f64 {
    (SIGMAS * median(&mut residuals)).max(EXACT * cost.target.voxel)
}

/// How many millimetres a unit of brightness counts for: as noise in both is.
pub(super) fn colour_scale(pairs: &[Pair], cost: &Cost, motion: &Motion) -> f64 {
    if cost.metric != Metric::Coloured {
        return 0.0;
    }
    let squares = map(pairs, |pair| cost.squares(motion, pair));
    let [geometry, colour] =
        [0, 1].map(|k| median(&mut squares.iter().map(|s| s[k].sqrt()).collect::<Vec<_>>()));
    // A cloud of one colour has nothing to say.
    if colour > EXACT { geometry.max(EXACT * cost.target.voxel) / colour } else { 0.0 }
}

fn map<T: Send>(pairs: &[Pair], of: impl Fn(&Pair) -> T + Sync) -> Vec<T> {
    let chunks: Vec<Vec<T>> =
        pairs.par_chunks(CHUNK).map(|chunk| chunk.iter().map(&of).collect()).collect();
    chunks.into_iter().flatten().collect()
}

impl Kernel {
    /// What a residual of so many standard deviations counts for. Constants for 95 percent of the
    /// efficiency of least squares under normal noise: Holland and Welsch (1977).
    pub(super) fn weight(self, residual: f64) -> f64 {
        let square = |c: f64| (residual / c).powi(2);
        match self {
            Self::None => 1.0,
            Self::Huber => (1.345 / residual.abs()).min(1.0),
            Self::Tukey => (1.0 - square(4.685)).max(0.0).powi(2),
            Self::Cauchy => 1.0 / (1.0 + square(2.385)),
            Self::GemanMcclure => 1.0 / (1.0 + square(3.0)).powi(2),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{options, relief};
    use super::super::view::View;
    use super::*;
    use crate::geom::{Pose, Vector3};
    use crate::progress::Silent;
    use crate::register::icp::Role;

    #[test]
    fn kernels_count_what_fits_in_full_and_what_does_not_for_less() {
        for (kernel, at_one_constant, constant) in [
            (Kernel::Huber, 1.0, 1.345),
            (Kernel::Tukey, 0.0, 4.685),
            (Kernel::Cauchy, 0.5, 2.385),
            (Kernel::GemanMcclure, 0.25, 3.0),
            (Kernel::None, 1.0, 7.0),
        ] {
            assert_eq!(kernel.weight(0.0), 1.0, "{kernel:?}");
            assert!((kernel.weight(constant) - at_one_constant).abs() < 1e-12, "{kernel:?}");
            assert_eq!(kernel.weight(constant), kernel.weight(-constant));
        }
        assert!((Kernel::Huber.weight(2.69) - 0.5).abs() < 1e-12);
        assert_eq!(Kernel::Tukey.weight(100.0), 0.0);
    }

    #[test]
    fn weights_follow_distance_normals_and_depth() {
        let mut cloud = relief(3000);
        for point in &mut cloud.points {
            *point += Vector3::new(0.0, 0.0, 200.0);
        }
        let view = View::new(&cloud, Role::Source, options(0.8), &Silent).unwrap();
        let cost =
            Cost { source: &view, target: &view, metric: Metric::PointToPlane, colour_scale: 0.0 };
        let still = Motion::from(&Pose::identity());
        let weights = |weighting| {
            let mut pairs: Vec<Pair> = (0..view.len() as u32)
                .map(|i| Pair {
                    source: i,
                    target: i,
                    distance: 0.5,
                    weight: 1.0,
                    is_turned: false,
                })
                .collect();
            weigh(&mut pairs, &cost, &still, (weighting, 2.0));
            pairs
        };
        assert!(weights(Weighting::Distance).iter().all(|pair| pair.weight == 0.75));
        assert!(weights(Weighting::Normals).iter().all(|pair| (pair.weight - 1.0).abs() < 1e-12));
        let by_depth = weights(Weighting::SensorNoise);
        let depth =
            |pair: &Pair| (view.points[pair.source as usize] + view.center.coords).coords.norm();
        let product = |pair: &Pair| pair.weight * depth(pair).powi(4);
        for pair in &by_depth {
            assert!((product(pair) / product(&by_depth[0]) - 1.0).abs() < 1e-9);
        }
    }

    #[test]
    fn a_pair_far_off_the_median_is_outvoted() {
        let view = View::new(&relief(3000), Role::Source, options(0.8), &Silent).unwrap();
        let cost =
            Cost { source: &view, target: &view, metric: Metric::PointToPlane, colour_scale: 0.0 };
        let n = view.len() as u32;
        let mut pairs: Vec<Pair> = (0..n)
            .map(|i| Pair { source: i, target: i, distance: 0.0, weight: 1.0, is_turned: false })
            .collect();
        // The other end of the cloud.
        pairs[0].target = n - 1;
        let shifted = Motion::from(&Pose::translation(0.1, 0.1, 0.1));
        robust(&mut pairs, &cost, &shifted, Kernel::Tukey);
        assert_eq!(pairs[0].weight, 0.0);
        assert!(pairs[1..].iter().filter(|pair| pair.weight > 0.5).count() > pairs.len() / 2);
    }
}
