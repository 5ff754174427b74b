//! Sampling: which points of the source look for a partner.

use super::options::{IcpOptions, Sampling};
use super::view::View;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::collections::BTreeMap;

/// A level keeps this many points, if there are as many.
const LEAST: usize = 500;
/// Each level has this many times the points of the one before.
const RATIO: usize = 4;
/// Cells along a side of the cube of directions.
const DIRECTIONS: f64 = 6.0;

/// The points that look for a partner at the last level, in the order of the view.
pub(super) fn sample(view: &View, options: &IcpOptions) -> Vec<u32> {
    let all: Vec<u32> = (0..view.len() as u32).collect();
    let n = options.samples;
    if options.sampling == Sampling::All || all.len() <= n {
        return all;
    }
    let mut random = Pcg64Mcg::seed_from_u64(options.seed);
    let mut chosen = match options.sampling {
        Sampling::All | Sampling::Uniform => {
            // The view is in the order of its tree, which goes through the cloud piece by piece.
            (0..n).map(|i| all[i * all.len() / n]).collect()
        }
        Sampling::Random => drawn(all, n, &mut random),
        Sampling::NormalSpace => of_all_directions(view, all, n, &mut random),
    };
    chosen.sort_unstable();
    chosen
}

/// What is left of `samples` after `n_times` thinnings.
pub(super) fn thinned(samples: &[u32], n_times: u32) -> Vec<u32> {
    let most = (samples.len() / LEAST).max(1);
    let stride = RATIO.saturating_pow(n_times).min(most);
    samples.iter().copied().step_by(stride).collect()
}

fn drawn(mut all: Vec<u32>, n: usize, random: &mut Pcg64Mcg) -> Vec<u32> {
    let n = n.min(all.len());
    for i in 0..n {
        let other = random.random_range(i..all.len());
        all.swap(i, other);
    }
    all.truncate(n);
    all
}

/// Takes turns among the directions, a random point each, until there are `n`.
fn of_all_directions(view: &View, all: Vec<u32>, n: usize, random: &mut Pcg64Mcg) -> Vec<u32> {
    let mut buckets: BTreeMap<[i8; 3], Vec<u32>> = BTreeMap::new();
    for i in all {
        let normal = view.normals[i as usize];
        // Opposite normals are one direction: which side is out is open.
        let normal = if normal.z < 0.0 { -normal } else { normal };
        let cell = (normal / normal.amax() * (DIRECTIONS / 2.0)).map(|x| x.floor() as i8);
        buckets.entry(cell.into()).or_default().push(i);
    }
    let mut buckets: Vec<Vec<u32>> = buckets
        .into_values()
        .map(|bucket| {
            let n_bucket = bucket.len();
            drawn(bucket, n_bucket, random)
        })
        .collect();
    let mut chosen = Vec::with_capacity(n);
    while chosen.len() < n && !buckets.is_empty() {
        for bucket in &mut buckets {
            chosen.extend(bucket.pop());
        }
        buckets.retain(|bucket| !bucket.is_empty());
    }
    chosen.truncate(n);
    chosen
}

#[cfg(test)]
mod tests {
    use super::super::tests::{options as view_options, relief};
    use super::*;
    use crate::progress::Silent;
    use crate::register::icp::Role;

    fn view() -> View {
        View::new(&relief(4000), Role::Source, view_options(0.8), &Silent).unwrap()
    }

    fn chosen(view: &View, sampling: Sampling, seed: u64) -> Vec<u32> {
        sample(view, &IcpOptions { sampling, samples: 300, seed, ..IcpOptions::default() })
    }

    #[test]
    fn every_sampling_takes_as_many_different_points_as_asked_and_the_same_again() {
        let view = view();
        for sampling in [Sampling::Uniform, Sampling::Random, Sampling::NormalSpace] {
            let mut found = chosen(&view, sampling, 1);
            assert_eq!(found, chosen(&view, sampling, 1));
            found.dedup();
            assert_eq!(found.len(), 300, "{sampling:?}");
            let is_drawn = sampling != Sampling::Uniform;
            assert_eq!(found != chosen(&view, sampling, 2), is_drawn, "{sampling:?}");
        }
        assert_eq!(chosen(&view, Sampling::All, 1).len(), view.len());
    }

    #[test]
    fn normal_space_takes_more_of_the_slopes_than_chance_does() {
        let view = view();
        let n_steep = |sampling| {
            let steep = |i: &&u32| view.normals[**i as usize].z.abs() < 0.8;
            chosen(&view, sampling, 1).iter().filter(steep).count()
        };
        assert!(n_steep(Sampling::NormalSpace) > 2 * n_steep(Sampling::Random));
    }

    #[test]
    fn a_level_has_a_fourth_of_the_points_but_not_too_few() {
        let samples: Vec<u32> = (0..10_000).collect();
        assert_eq!([0, 1, 2, 3].map(|n| thinned(&samples, n).len()), [10_000, 2500, 625, 500]);
        assert_eq!(thinned(&samples[..100], 2).len(), 100);
    }
}
