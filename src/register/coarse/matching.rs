//! Pairs of points whose surroundings look alike, and how well a pose explains them.

use super::fpfh::{Feature, likeness};
use crate::geom::{Point3, Pose};
use crate::register::align::align;
use rayon::prelude::*;

/// Pairs kept at most; the consistency of all pairs with all is looked at.
const MOST: usize = 3000;
/// Times a pose is fitted again to what agrees with it.
const REFITS: usize = 2;

/// Points that may belong to each other; most pairs may be wrong.
#[derive(Debug, Clone, Default)]
pub(super) struct Matched {
    pub(super) from: Vec<Point3>,
    pub(super) onto: Vec<Point3>,
    /// Pairs nearer than this agree with a pose [mm].
    pub(super) tolerance: f64,
    /// Nearer points share their surroundings: together they prove nothing [mm].
    pub(super) apart: f64,
}

/// A pose, and how much speaks for it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Hypothesis {
    pub(super) pose: Pose,
    pub(super) score: f64,
}

/// The places of features that are each other's most alike.
///
/// Where fewer than `least` are, those that are the most alike for one of both sides.
pub(super) fn matches(source: &[Feature], target: &[Feature], least: usize) -> Vec<[u32; 2]> {
    let onto = most_alike(source, target);
    let back = most_alike(target, source);
    let there: Vec<[u32; 2]> =
        onto.iter().enumerate().filter_map(|(i, found)| Some([i as u32, (*found)?])).collect();
    let mutual: Vec<[u32; 2]> =
        there.iter().copied().filter(|[i, j]| back[*j as usize] == Some(*i)).collect();
    let mut all = mutual;
    if all.len() < least {
        let others = back.iter().enumerate().filter_map(|(j, found)| Some([(*found)?, j as u32]));
        all = there.into_iter().chain(others).collect();
        all.sort_unstable();
        all.dedup();
    }
    let stride = all.len().div_ceil(MOST).max(1);
    all.into_iter().step_by(stride).collect()
}

/// Of every feature the most alike of `others`, of equals the first; nothing for empty ones.
fn most_alike(features: &[Feature], others: &[Feature]) -> Vec<Option<u32>> {
    let of = |feature: &Feature| {
        let mut best = (0.0, None);
        for (i, other) in others.iter().enumerate() {
            let like = likeness(feature, other);
            if like > best.0 {
                best = (like, Some(i as u32));
            }
        }
        best.1
    };
    features.par_iter().map(of).collect()
}

impl Matched {
    pub(super) fn len(&self) -> usize {
        self.from.len()
    }

    /// 1 for every pair that a pose lays on each other, less the farther they are off: truncated
    /// least squares, turned round.
    pub(super) fn score(&self, pose: &Pose) -> f64 {
        let least = self.tolerance.powi(2);
        let of =
            |(p, q): (&Point3, &Point3)| (1.0 - (pose * p - q).norm_squared() / least).max(0.0);
        self.from.iter().zip(&self.onto).map(of).sum()
    }

    /// The pairs that agree with a pose.
    pub(super) fn agreeing(&self, pose: &Pose) -> Vec<usize> {
        let is_near = |i: &usize| (pose * self.from[*i] - self.onto[*i]).norm() < self.tolerance;
        (0..self.len()).filter(is_near).collect()
    }

    /// `pose` fitted to the pairs that agree with it, as long as that makes it better.
    pub(super) fn refitted(&self, pose: &Pose) -> Hypothesis {
        let mut best = Hypothesis { pose: *pose, score: self.score(pose) };
        for _ in 0..REFITS {
            let agreeing = self.agreeing(&best.pose);
            if agreeing.len() < 3 {
                break;
            }
            let pose = self.fitted(&agreeing);
            let score = self.score(&pose);
            if score <= best.score {
                break;
            }
            best = Hypothesis { pose, score };
        }
        best
    }

    /// The pose that fits these pairs best.
    pub(super) fn fitted(&self, pairs: &[usize]) -> Pose {
        let take = |points: &[Point3]| pairs.iter().map(|&i| points[i]).collect::<Vec<_>>();
        align(&take(&self.from), &take(&self.onto))
    }

    /// By how much the distance between two pairs' points differs on both sides; `None` if they are
    /// too near to prove anything.
    pub(super) fn stretch(&self, i: usize, j: usize) -> Option<f64> {
        let here = (self.from[i] - self.from[j]).norm();
        let there = (self.onto[i] - self.onto[j]).norm();
        (here.min(there) > self.apart).then(|| (here - there).abs())
    }
}

/// How far two poses lay points apart that lie `radius` about the origin, root mean square.
pub(super) fn between(a: &Pose, b: &Pose, radius: f64) -> f64 {
    let turn = a.rotation.to_rotation_matrix().matrix() - b.rotation.to_rotation_matrix().matrix();
    let shift = a.translation.vector - b.translation.vector;
    (turn.norm_squared() * radius * radius / 3.0 + shift.norm_squared()).sqrt()
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::geom::Vector3;
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    /// Pairs under a known pose, of which a share is wrong, the right ones with a little noise.
    pub(in crate::register::coarse) fn known(n: usize, wrong: f64, seed: u64) -> (Matched, Pose) {
        let mut random = Pcg64Mcg::seed_from_u64(seed);
        let pose = Pose::new(Vector3::new(40.0, -25.0, 60.0), Vector3::new(1.2, -2.0, 0.5));
        let place = |random: &mut Pcg64Mcg, size: f64| {
            Point3::from(Vector3::from_fn(|_, _| random.random_range(-size..size)))
        };
        let from: Vec<Point3> = (0..n).map(|_| place(&mut random, 50.0)).collect();
        let n_wrong = (wrong * n as f64) as usize;
        let onto = from.iter().enumerate().map(|(i, p)| {
            let right = pose * p + place(&mut random, 0.3).coords;
            let other = pose * place(&mut random, 50.0);
            if i < n_wrong { other } else { right }
        });
        (Matched { onto: onto.collect(), from, tolerance: 1.5, apart: 10.0 }, pose)
    }

    #[test]
    fn mutual_matches_are_the_same_places() {
        let feature = |i: usize| {
            let mut feature = [0.0; super::super::fpfh::WIDTH];
            feature[i % 33] = 0.8;
            feature[(i * 7 + 3) % 33] += 0.6;
            feature
        };
        let source: Vec<Feature> = (0..30).map(feature).collect();
        let target: Vec<Feature> = (0..30).rev().map(feature).collect();
        let found = matches(&source, &target, 0);
        let right = found.iter().filter(|[i, j]| i + j == 29).count();
        assert!(right > 25 && right == found.len(), "{found:?}");
        // An empty feature is like nothing.
        assert!(matches(&[[0.0; super::super::fpfh::WIDTH]], &target, 5).is_empty());
    }

    #[test]
    fn poses_are_as_far_apart_as_the_points_they_move() {
        let a = Pose::new(Vector3::new(1.0, 2.0, 3.0), Vector3::new(0.3, 0.1, -0.4));
        let b = Pose::new(Vector3::new(-2.0, 1.0, 3.5), Vector3::new(-0.2, 0.6, 0.9));
        let r = 20.0 / 3_f64.sqrt();
        // Six points with the spread 20 along all directions.
        let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
        let points = axes.iter().flat_map(|v| [v * 20.0, v * -20.0]).map(Point3::from);
        let mean = points.map(|p| (a * p - b * p).norm_squared()).sum::<f64>() / 6.0;
        assert!((between(&a, &b, r * 3_f64.sqrt()) - mean.sqrt()).abs() < 1e-9);
    }
}
