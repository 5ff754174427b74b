//! Places that two frames both see, and the motion that explains them.
//!
//! A feature with depth is a point. Laid over its twin by the right motion it appears where the other
//! frame saw it, to about a pixel, and as near, to what the sensor's depth is good for: a triangulating
//! sensor errs evenly in 1/z, so in depth it errs by z². Both are asked in both directions.

use super::Look;
use crate::geom::{Point3, Pose, Vector3};
use crate::register::align;
use crate::register::features::{Match, MatchOptions, matches};
use crate::register::icp::Normal;
use crate::register::ransac::Model;
use nalgebra::{Matrix6, Vector6};

/// How exactly a corner is found again [px].
const SIGMA_PX: f64 = 1.0;
/// How exact inverse depth is [1/mm]: three times the noise of a Kinect, whose depth is not of the
/// same moment as its colour.
const SIGMA_INVERSE: f64 = 4.5e-6;
/// What squared residuals of a sighting may add up to, in standard deviations: six, because a rolling
/// shutter and late depth bend a picture by more than noise does.
const LIMIT: f64 = 36.0;
/// A feature that both frames see.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sighting {
    /// Where, in the previous and in the next camera's frame [mm].
    pub(super) points: [Point3; 2],
}

/// All of them.
#[derive(Debug)]
pub(super) struct Sightings {
    pub(super) all: Vec<Sighting>,
    /// How many features matched, with or without depth.
    pub(super) n_matches: usize,
    focal: f64,
}

/// A residual: its derivative by a small step from the left, and its value in standard deviations.
struct Row {
    by_step: Vector6<f64>,
    value: f64,
}

impl Sightings {
    /// The features that `previous` and `next` both see and have depth for; `None` without colours.
    pub(super) fn of(previous: &Look, next: &Look, options: &MatchOptions) -> Option<Self> {
        let (before, after) = (previous.features()?, next.features()?);
        let found = matches(&before.descriptors, &after.descriptors, options);
        let sighting = |found: &Match| {
            let point = previous.place(before.corners[found.first].at)?;
            let twin = next.place(after.corners[found.second].at)?;
            Some(Sighting { points: [point, twin] })
        };
        let all = found.iter().filter_map(sighting).collect();
        let focal = (previous.camera.fx * previous.camera.fy).sqrt();
        Some(Self { all, n_matches: found.len(), focal })
    }

    /// The motion that lays the points of `some` over each other, all counting the same.
    ///
    /// Weighed by what the sensor is good for, trajectories of real sequences came out worse: what is off most is
    /// that depth and colour are not of the same moment, and that grows with speed and not with depth.
    pub(super) fn fitted(&self, some: &[usize]) -> Option<Pose> {
        let of = |k: usize| some.iter().map(|&i| self.all[i].points[k]).collect::<Vec<Point3>>();
        let pose = align(&of(1), &of(0));
        pose.to_homogeneous().iter().all(|x| x.is_finite()).then_some(pose)
    }

    /// What `some` say about a small motion from the left of `pose`, by how well they agree.
    pub(super) fn information(&self, pose: &Pose, some: &[usize]) -> Matrix6<f64> {
        let (h, variance) = self.normal(pose, some);
        // Both directions see the same two corners: that is one observation, not two.
        h / (2.0 * variance.max(0.1))
    }

    /// The mean square of what `some` are off, and its normal equations for a small step from the left
    /// of `pose`.
    pub(super) fn mean_square(&self, pose: &Pose, some: &[usize]) -> Normal {
        let mut sum = Normal { h: Matrix6::zeros(), g: Vector6::zeros(), cost: 0.0 };
        let mut n_rows = 0.0_f64;
        for row in some.iter().filter_map(|&i| self.rows(pose, &self.all[i])).flatten() {
            sum.h += row.by_step * row.by_step.transpose();
            sum.g += row.by_step * row.value;
            sum.cost += row.value * row.value;
            n_rows += 1.0;
        }
        sum * (1.0 / n_rows.max(1.0))
    }

    /// The matrix of the normal equations, and the weighted mean of a residual's square.
    fn normal(&self, pose: &Pose, some: &[usize]) -> (Matrix6<f64>, f64) {
        let mut h = Matrix6::zeros();
        let (mut squares, mut total) = (0.0, 0.0);
        for &i in some {
            let Some(rows) = self.rows(pose, &self.all[i]) else { continue };
            let square = rows.iter().map(|row| row.value * row.value).sum::<f64>() / 2.0;
            let weight = (1.0 - square / (2.0 * LIMIT)).max(0.0).powi(2);
            for row in &rows {
                h += row.by_step * row.by_step.transpose() * weight;
            }
            squares += weight * square;
            total += weight * 3.0;
        }
        (h, squares / total.max(1e-12))
    }

    /// The residuals of a sighting in both pictures; `None` if it comes to lie behind a camera.
    fn rows(&self, pose: &Pose, seen: &Sighting) -> Option<[Row; 6]> {
        let [before, after] = &seen.points;
        let there = pose * after;
        let back = pose.inverse_transform_point(before);
        let forward = self.residuals(&there, before)?;
        let backward = self.residuals(&back, after)?;
        let mut rows =
            forward.into_iter().chain(backward).enumerate().map(|(k, (value, along))| {
                // Going back, the point to be seen is moved against the step, and turned.
                let (at, along) =
                    if k < 3 { (&there, along) } else { (before, -(pose.rotation * along)) };
                let turn = at.coords.cross(&along);
                let by_step = Vector6::new(turn.x, turn.y, turn.z, along.x, along.y, along.z);
                Row { by_step, value }
            });
        let mut next = || rows.next();
        Some([next()?, next()?, next()?, next()?, next()?, next()?])
    }

    /// How far `point` appears from where `seen` does, in the picture and in nearness, with derivatives.
    fn residuals(&self, point: &Point3, seen: &Point3) -> Option<[(f64, Vector3); 3]> {
        let is_before = point.z > 0.0 && seen.z > 0.0;
        if !is_before {
            return None;
        }
        let (near, px) = (1.0 / point.z, self.focal / SIGMA_PX);
        let [x, y] = [point.x * near, point.y * near];
        Some([
            (px * (x - seen.x / seen.z), Vector3::new(near, 0.0, -x * near) * px),
            (px * (y - seen.y / seen.z), Vector3::new(0.0, near, -y * near) * px),
            (
                (near - 1.0 / seen.z) / SIGMA_INVERSE,
                Vector3::new(0.0, 0.0, -near * near / SIGMA_INVERSE),
            ),
        ])
    }
}

impl Model for Sightings {
    type Hypothesis = Pose;
    const SAMPLE: usize = 3;

    fn n_data(&self) -> usize {
        self.all.len()
    }

    fn fit(&self, sample: &[usize]) -> Option<Pose> {
        let of =
            |k: usize| -> Vec<Point3> { sample.iter().map(|&i| self.all[i].points[k]).collect() };
        let (before, after) = (of(0), of(1));
        let [a, b, c] = [after[0], after[1], after[2]];
        // Three points in a line turn about it; three close together say little.
        let (ab, ac) = (b - a, c - a);
        let wide = ab.norm().max(ac.norm());
        if ab.cross(&ac).norm() < 0.1 * wide * wide || wide < 0.05 * a.z {
            return None;
        }
        let pose = align(&after, &before);
        sample.iter().all(|&i| self.square(&pose, i) <= 4.0).then_some(pose)
    }

    fn square(&self, pose: &Pose, i: usize) -> f64 {
        let [before, after] = &self.all[i].points;
        let one = |point: &Point3, seen: &Point3| {
            let residuals = self.residuals(point, seen);
            residuals.map_or(f64::INFINITY, |rows| rows.iter().map(|row| row.0 * row.0).sum())
        };
        let back = pose.inverse_transform_point(before);
        (one(&(pose * after), before) + one(&back, after)) / (2.0 * LIMIT)
    }

    fn refit(&self, _pose: &Pose, inliers: &[usize]) -> Option<Pose> {
        self.fitted(inliers)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::register::ransac::{RansacOptions, ransac};
    use nalgebra::UnitQuaternion;

    /// A pose after a small step from the left: a turn and a shift.
    fn moved(step: &Vector6<f64>, pose: &Pose) -> Pose {
        let turn = UnitQuaternion::from_scaled_axis(Vector3::new(step[0], step[1], step[2]));
        let shift = turn * pose.translation.vector + Vector3::new(step[3], step[4], step[5]);
        Pose::from_parts(shift.into(), turn * pose.rotation)
    }

    /// Points before a camera, and where they come to lie; the last `n_wrong` of them anywhere.
    fn sightings(pose: &Pose, n: usize, n_wrong: usize) -> Sightings {
        let place = |i: usize, by: usize| {
            let even = |k: usize| ((i * by + k * 37) % 101) as f64 / 50.0 - 1.0;
            Point3::new(600.0 * even(1), 450.0 * even(2), 1500.0 + 500.0 * even(3))
        };
        let sighting = |i: usize| {
            let after = place(i, 29);
            let before = if i + n_wrong < n { pose * after } else { place(i, 53) };
            Sighting { points: [before, after] }
        };
        Sightings { all: (0..n).map(sighting).collect(), n_matches: n, focal: 525.0 }
    }

    fn pose() -> Pose {
        Pose::new(Vector3::new(40.0, -15.0, 25.0), Vector3::new(0.03, -0.08, 0.05))
    }

    #[test]
    fn a_motion_is_found_among_as_many_wrong_matches() {
        let all = sightings(&pose(), 100, 50);
        let found = ransac(&all, &RansacOptions::default()).unwrap();
        let off = pose().inverse() * found.hypothesis;
        assert!(off.translation.vector.norm() < 1e-6, "{}", off.translation.vector.norm());
        assert!(off.rotation.angle() < 1e-9);
        assert!((0..50).all(|i| found.inliers.contains(&i)));
        assert!(found.inliers.len() < 55);
    }

    #[test]
    fn derivatives_are_those_of_the_residuals() {
        let all = sightings(&pose(), 5, 0);
        let near =
            pose() * Pose::new(Vector3::new(3.0, 1.0, -2.0), Vector3::new(1e-3, 2e-3, -1e-3));
        let rows = all.rows(&near, &all.all[2]).unwrap();
        let h = 1e-6;
        for k in 0..6 {
            let step = |size: f64| {
                let mut step = Vector6::zeros();
                step[k] = size;
                all.rows(&moved(&step, &near), &all.all[2]).unwrap()
            };
            for (i, (ahead, behind)) in step(h).iter().zip(&step(-h)).enumerate() {
                let slope = (ahead.value - behind.value) / (2.0 * h);
                let known = rows[i].by_step[k];
                assert!(
                    (slope - known).abs() < 1e-4 * (1.0 + known.abs()),
                    "{i} {k}: {slope} {known}"
                );
            }
        }
    }

    #[test]
    fn points_in_a_line_or_behind_the_camera_make_no_motion() {
        let mut all = sightings(&pose(), 6, 0);
        for (i, sighting) in all.all.iter_mut().enumerate() {
            sighting.points = [Point3::new(100.0 * i as f64, 0.0, 1500.0); 2];
        }
        assert_eq!(all.fit(&[0, 1, 2]), None);
        all.all[3].points[0].z = -5.0;
        assert_eq!(all.square(&Pose::identity(), 3), f64::INFINITY);
        assert!(all.rows(&Pose::identity(), &all.all[3]).is_none());
    }
}
