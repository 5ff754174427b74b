//! How far frames lie apart where poses put them.

use super::{Halves, Sketch};
use crate::geom::{Point3, Pose};
use crate::rgbd::CameraTrajectory;
use rayon::prelude::*;

/// Pairs looked at, at most.
const MOST_PAIRS: usize = 400;
/// Frames of a pair show the same if this share of the one's points lies before the other, at least.
const LEAST_OVERLAP: f64 = 0.3;
/// Surfaces farther apart than this share of the depth are not the same, and count as that far apart.
const SAME: f64 = 0.02;
/// Every so many points are asked whether frames show the same.
const SPARSE: usize = 16;

/// Frames that show the same, two by two, and where they were.
pub(super) struct Pairs<'a> {
    sketches: Vec<&'a Sketch>,
    along: &'a CameraTrajectory,
    same: Vec<[usize; 2]>,
}

impl<'a> Pairs<'a> {
    /// Of the frames that have a pose for any delay up to `longest`.
    pub(super) fn new(sketches: &'a [Sketch], along: &'a CameraTrajectory, longest: f64) -> Self {
        let has_poses = |sketch: &&Sketch| {
            [-longest, longest].iter().all(|delay| along.at(sketch.stamp - delay).is_some())
        };
        let sketches: Vec<&Sketch> = sketches.iter().filter(has_poses).collect();
        let mut pairs = Self { sketches, along, same: Vec::new() };
        let n = pairs.sketches.len();
        let all: Vec<[usize; 2]> = (0..n).flat_map(|i| (i + 1..n).map(move |j| [i, j])).collect();
        let shows_same = |pair: &[usize; 2]| {
            pairs.between(*pair, 0.0).is_some_and(|onto_from| pairs.shows_same(*pair, &onto_from))
        };
        let same: Vec<[usize; 2]> = all.into_par_iter().filter(shows_same).collect();
        let stride = same.len().div_ceil(MOST_PAIRS).max(1);
        pairs.same = same.into_iter().step_by(stride).collect();
        pairs
    }

    /// How many frames have poses.
    pub(super) fn n_frames(&self) -> usize {
        self.sketches.len()
    }

    /// How many pairs there are.
    pub(super) fn len(&self) -> usize {
        self.same.len()
    }

    /// How far surfaces lie apart if frames were taken `delay` before their stamps: in either half of the
    /// pairs the sum and the number of distances along normals.
    pub(super) fn apart(&self, delay: f64) -> Halves {
        let of_pair = |&pair: &[usize; 2]| self.distances(pair, delay);
        let sums: Vec<[f64; 2]> = self.same.par_iter().map(of_pair).collect();
        let mut halves = Halves::default();
        for (i, [sum, n]) in sums.into_iter().enumerate() {
            halves[i % 2][0] += sum;
            halves[i % 2][1] += n;
        }
        halves
    }

    /// The motion from the first frame of a pair to the second.
    fn between(&self, [from, onto]: [usize; 2], delay: f64) -> Option<Pose> {
        let at = |i: usize| self.along.at(self.sketches[i].stamp - delay);
        Some(at(onto)?.inverse() * at(from)?)
    }

    fn shows_same(&self, [from, onto]: [usize; 2], onto_from: &Pose) -> bool {
        let seen = self.sketches[from].cloud.points.pixels().iter().step_by(SPARSE);
        let (mut n, mut n_there) = (0, 0);
        for point in seen.filter(|point| !point.x.is_nan()) {
            n += 1;
            n_there += usize::from(self.sketches[onto].off(&(onto_from * point)).is_some());
        }
        n_there as f64 > LEAST_OVERLAP * f64::from(n)
    }

    fn distances(&self, pair: [usize; 2], delay: f64) -> [f64; 2] {
        let Some(onto_from) = self.between(pair, delay) else { return [0.0; 2] };
        let [from, onto] = pair.map(|i| self.sketches[i]);
        let seen = from.cloud.points.pixels().iter().filter(|point| !point.x.is_nan());
        let (mut sum, mut n) = (0.0, 0.0);
        for point in seen {
            let there = onto_from * point;
            if let Some(off) = onto.off(&there) {
                sum += off.min(SAME * there.z);
                n += 1.0;
            }
        }
        [sum, n]
    }
}

impl Sketch {
    /// How far a point lies off the surface that is seen where the point would be [mm].
    fn off(&self, point: &Point3) -> Option<f64> {
        let at = self.camera.project(point).filter(|at| self.camera.sees(*at))?;
        let [x, y] = at.map(|c| c.round().max(0.0) as usize);
        let (seen, normal) = (self.cloud.point(x, y)?, self.cloud.normal(x, y)?);
        Some(normal.dot(&(point - seen)).abs())
    }
}
