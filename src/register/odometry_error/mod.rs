//! How far an estimated trajectory is off the true one: the relative pose error (RPE) and the absolute
//! trajectory error (ATE).
//!
//! J. Sturm et al., *A Benchmark for the Evaluation of RGB-D SLAM Systems* (IROS 2012), as its tools
//! `evaluate_rpe.py` and `evaluate_ate.py` compute them. With truth `Q` and estimate `P`,
//!
//! ```text
//! RPE  E_i = (Q_i^-1 Q_i+d)^-1 (P_i^-1 P_i+d)     its shift and its angle, over a step d
//! ATE  F_i = trans(Q_i) - S trans(P_i)            S the rigid motion that makes them least (Horn)
//! ```

mod options;

pub use options::{Delta, OdometryErrorOptions, TruthAt};

use super::{Statistics, align};
use crate::geom::{Point3, Pose};
use crate::rgbd::{CameraTrajectory, associate};

/// Why trajectories cannot be compared.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Unmatched {
    /// Hardly a stamp in common.
    #[error(
        "{n_matched} of {n_estimates} poses have a true one within {max_difference} s, but it takes 2 (the \
         estimate runs from {estimate:?} s, the truth from {truth:?} s): the stamps must be of one clock; \
         else allow for more with --max-difference"
    )]
    TooFew {
        /// Those that have.
        n_matched: usize,
        /// All.
        n_estimates: usize,
        /// What was allowed [s].
        max_difference: f64,
        /// First and last stamp of the estimate [s].
        estimate: [f64; 2],
        /// First and last stamp of the truth [s].
        truth: [f64; 2],
    },
    /// The trajectory is shorter than the step.
    #[error("no two of {n_matched} poses lie {delta} apart; take a smaller --delta")]
    TooShort {
        /// Poses that have a truth.
        n_matched: usize,
        /// The step.
        delta: Delta,
    },
    /// An option out of range.
    #[error("--max-difference is {0}: it must be a number of seconds from 0 on")]
    MaxDifference(f64),
}

/// How far a trajectory is off.
#[derive(Debug, Clone, PartialEq)]
pub struct OdometryError {
    /// The relative errors for each step.
    pub relative: Vec<RelativeErrors>,
    /// The absolute error.
    pub absolute: AbsoluteError,
    /// Poses of the estimate that have no truth.
    pub n_unmatched: usize,
}

/// Relative errors over one step.
#[derive(Debug, Clone, PartialEq)]
pub struct RelativeErrors {
    /// The step.
    pub delta: Delta,
    /// The errors, by the stamp at which the step begins.
    pub errors: Vec<RelativeError>,
    /// Of the shifts [mm].
    pub translation: Statistics,
    /// Of the angles [rad].
    pub rotation: Statistics,
}

/// The error of one step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RelativeError {
    /// When the step begins [s].
    pub stamp: f64,
    /// How far it leads astray [mm].
    pub translation: f64,
    /// How much it turns too far [rad].
    pub rotation: f64,
}

/// The error over the whole trajectory.
#[derive(Debug, Clone, PartialEq)]
pub struct AbsoluteError {
    /// What lays the estimate over the truth best.
    pub truth_from_estimate: Pose,
    /// Stamps of the poses that have a truth [s].
    pub stamps: Vec<f64>,
    /// How far each of them is off then [mm].
    pub errors: Vec<f64>,
    /// The estimate, laid over the truth [mm].
    pub estimate: Vec<Point3>,
    /// The truth [mm].
    pub truth: Vec<Point3>,
    /// Of the errors [mm].
    pub statistics: Statistics,
}

impl AbsoluteError {
    /// How far the pose of `stamp` is off; `None` if there is none of it, or no truth [mm].
    pub fn at(&self, stamp: f64) -> Option<f64> {
        let i = self.stamps.partition_point(|known| *known < stamp);
        (self.stamps.get(i) == Some(&stamp)).then(|| self.errors[i])
    }
}

/// Compares `estimate` with `truth`.
pub fn odometry_error(
    estimate: &CameraTrajectory,
    truth: &CameraTrajectory,
    options: &OdometryErrorOptions,
) -> Result<OdometryError, Unmatched> {
    // A comparison that NaN fails.
    let is_duration = options.max_difference >= 0.0;
    if !is_duration {
        return Err(Unmatched::MaxDifference(options.max_difference));
    }
    let matched = matched(estimate, truth, options);
    let n_estimates = estimate.poses().len();
    if matched.len() < 2 {
        let range = |walk: &CameraTrajectory| {
            [walk.poses().first(), walk.poses().last()].map(|p| p.map_or(f64::NAN, |p| p.stamp))
        };
        return Err(Unmatched::TooFew {
            n_matched: matched.len(),
            n_estimates,
            max_difference: options.max_difference,
            estimate: range(estimate),
            truth: range(truth),
        });
    }
    let relative = options.deltas.iter().map(|delta| relative(&matched, *delta));
    Ok(OdometryError {
        relative: relative.collect::<Result<_, _>>()?,
        absolute: absolute(&matched),
        n_unmatched: n_estimates - matched.len(),
    })
}

/// An estimate and its truth.
struct Matched {
    stamp: f64,
    estimate: Pose,
    truth: Pose,
}

fn matched(
    estimate: &CameraTrajectory,
    truth: &CameraTrajectory,
    options: &OdometryErrorOptions,
) -> Vec<Matched> {
    let pair = |i: usize, truth: Pose| {
        let pose = estimate.poses()[i];
        Matched { stamp: pose.stamp, estimate: pose.world_from_camera, truth }
    };
    match options.truth_at {
        TruthAt::Nearest => {
            let pairs = associate(&estimate.stamps(), &truth.stamps(), options.max_difference);
            let truth = |j: usize| truth.poses()[j].world_from_camera;
            pairs.into_iter().map(|(i, j)| pair(i, truth(j))).collect()
        }
        TruthAt::Interpolated => {
            let is_near = |stamp: f64| {
                let nearest = truth.nearest(stamp);
                nearest.is_some_and(|near| (near.stamp - stamp).abs() <= options.max_difference)
            };
            let stamps = estimate.stamps().into_iter().enumerate();
            let near = stamps.filter(|(_, stamp)| is_near(*stamp));
            near.filter_map(|(i, stamp)| Some(pair(i, truth.at(stamp)?))).collect()
        }
    }
}

fn relative(matched: &[Matched], delta: Delta) -> Result<RelativeErrors, Unmatched> {
    let errors: Vec<RelativeError> = steps(matched, delta)
        .into_iter()
        .map(|(i, j)| {
            let (from, to) = (&matched[i], &matched[j]);
            let step = |from: &Pose, to: &Pose| from.inverse() * to;
            let error = step(&from.truth, &to.truth).inverse() * step(&from.estimate, &to.estimate);
            RelativeError {
                stamp: from.stamp,
                translation: error.translation.vector.norm(),
                rotation: error.rotation.angle(),
            }
        })
        .collect();
    if errors.is_empty() {
        return Err(Unmatched::TooShort { n_matched: matched.len(), delta });
    }
    let all = |value: fn(&RelativeError) -> f64| {
        Statistics::of(&errors.iter().map(value).collect::<Vec<_>>())
    };
    let (translation, rotation) = (all(|e| e.translation), all(|e| e.rotation));
    Ok(RelativeErrors { delta, errors, translation, rotation })
}

/// The ends of every step.
fn steps(matched: &[Matched], delta: Delta) -> Vec<(usize, usize)> {
    match delta {
        Delta::Poses(n) => (n..matched.len()).map(|j| (j - n, j)).collect(),
        Delta::Seconds(seconds) => {
            let end = |i: usize| {
                let stamp = matched[i].stamp + seconds;
                let after = matched.partition_point(|m| m.stamp < stamp);
                let near = [after.saturating_sub(1), after.min(matched.len() - 1)];
                let apart = |j: &usize| (matched[*j].stamp - stamp).abs();
                let j = if apart(&near[1]) < apart(&near[0]) { near[1] } else { near[0] };
                (i, j)
            };
            (0..matched.len()).map(end).filter(|(i, j)| i < j && j + 1 < matched.len()).collect()
        }
    }
}

fn absolute(matched: &[Matched]) -> AbsoluteError {
    let place = |pose: &Pose| Point3::from(pose.translation.vector);
    let truth: Vec<Point3> = matched.iter().map(|m| place(&m.truth)).collect();
    let estimate: Vec<Point3> = matched.iter().map(|m| place(&m.estimate)).collect();
    let truth_from_estimate = align(&estimate, &truth);
    let estimate: Vec<Point3> = estimate.iter().map(|p| truth_from_estimate * p).collect();
    let errors: Vec<f64> = estimate.iter().zip(&truth).map(|(a, b)| (a - b).norm()).collect();
    let statistics = Statistics::of(&errors);
    let stamps = matched.iter().map(|m| m.stamp).collect();
    AbsoluteError { truth_from_estimate, stamps, errors, estimate, truth, statistics }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Vector3;
    use crate::rgbd::StampedPose;

    fn walk(poses: impl IntoIterator<Item = (f64, Pose)>) -> CameraTrajectory {
        let stamped = |(stamp, world_from_camera)| StampedPose { stamp, world_from_camera };
        CameraTrajectory::new(poses.into_iter().map(stamped).collect()).unwrap()
    }

    fn curve(i: usize) -> (f64, Pose) {
        let t = i as f64 / 10.0;
        let place = Vector3::new(100.0 * t, 300.0 * t.sin(), 50.0 * t * t);
        (t, Pose::new(place, Vector3::new(0.1 * t, 0.3 * t.cos(), 0.2)))
    }

    fn options(delta: Delta) -> OdometryErrorOptions {
        OdometryErrorOptions { deltas: vec![delta], ..OdometryErrorOptions::default() }
    }

    #[test]
    fn a_trajectory_in_another_frame_of_the_world_is_not_off() {
        let moved = Pose::new(Vector3::new(5.0, -900.0, 3.0), Vector3::new(1.0, 2.0, -0.5));
        let truth = walk((0..60).map(curve));
        let estimate = walk((0..60).map(curve).map(|(t, pose)| (t, moved * pose)));
        let error = odometry_error(&estimate, &truth, &OdometryErrorOptions::default()).unwrap();
        assert!(error.absolute.statistics.max < 1e-9);
        let off = error.absolute.truth_from_estimate * moved;
        assert!(off.translation.vector.norm() < 1e-9 && off.rotation.angle() < 1e-12);
        for relative in &error.relative {
            assert!(relative.translation.max < 1e-9 && relative.rotation.max < 1e-9);
        }
        assert_eq!((error.relative[0].errors.len(), error.n_unmatched), (59, 0));
    }

    #[test]
    fn a_step_that_is_wrong_is_wrong_by_what_it_is_off() {
        // The estimate turns 0.1 too far about Z and goes 3 mm too far along x at step 4 to 5.
        let wrong = Pose::new(Vector3::new(3.0, 0.0, 0.0), Vector3::z() * 0.1);
        let truth = walk((0..10).map(curve));
        let at_five = curve(5).1;
        let follow = |i: usize| {
            let (t, pose) = curve(i);
            (t, if i < 5 { pose } else { at_five * wrong * at_five.inverse() * pose })
        };
        let estimate = walk((0..10).map(follow));
        let error = odometry_error(&estimate, &truth, &options(Delta::Poses(1))).unwrap();
        for (i, step) in error.relative[0].errors.iter().enumerate() {
            let expected = if i == 4 { (3.0, 0.1) } else { (0.0, 0.0) };
            assert!((step.translation - expected.0).abs() < 1e-9, "{i}: {step:?}");
            assert!((step.rotation - expected.1).abs() < 1e-9, "{i}: {step:?}");
        }
        let over_two = odometry_error(&estimate, &truth, &options(Delta::Poses(2))).unwrap();
        let n_off = over_two.relative[0].errors.iter().filter(|e| e.rotation > 0.05).count();
        assert_eq!(n_off, 2);
    }

    #[test]
    fn a_step_of_seconds_ends_at_the_nearest_pose_but_not_at_the_last() {
        let stamps = [0.0, 0.4, 1.1, 1.5, 2.2];
        let truth = walk(stamps.map(|t| (t, Pose::translation(10.0 * t, 0.0, 0.0))));
        let matched: Vec<Matched> = truth
            .poses()
            .iter()
            .map(|p| Matched {
                stamp: p.stamp,
                estimate: p.world_from_camera,
                truth: Pose::identity(),
            })
            .collect();
        // 0 -> 1.1, 0.4 -> 1.5; 1.1 -> 2.2 is the last.
        assert_eq!(steps(&matched, Delta::Seconds(1.0)), [(0, 2), (1, 3)]);
        assert_eq!(steps(&matched, Delta::Poses(3)), [(0, 3), (1, 4)]);
    }

    #[test]
    fn truth_between_two_poses_beats_the_nearest() {
        let truth = walk((0..100).map(curve));
        let between = |i: usize| {
            let stamp = 0.31 + i as f64 / 10.0;
            (stamp, truth.at(stamp).unwrap())
        };
        let estimate = walk((0..90).map(between));
        let error = |truth_at| {
            let options = OdometryErrorOptions { truth_at, ..OdometryErrorOptions::default() };
            odometry_error(&estimate, &truth, &options).unwrap().absolute.statistics.rmse
        };
        assert!(error(TruthAt::Interpolated) < 1e-9 && error(TruthAt::Nearest) > 0.1);
    }

    #[test]
    fn trajectories_without_common_stamps_are_refused_with_both_ranges() {
        let truth = walk((0..10).map(curve));
        let later = walk((0..10).map(curve).map(|(t, pose)| (t + 1e9, pose)));
        let told = odometry_error(&later, &truth, &OdometryErrorOptions::default()).unwrap_err();
        let told = told.to_string();
        assert!(told.starts_with("0 of 10 poses have a true one within 0.02 s"), "{told}");
        assert!(told.contains("the truth from [0.0, 0.9] s"), "{told}");
        let told = odometry_error(&truth, &truth, &options(Delta::Poses(30))).unwrap_err();
        assert!(told.to_string().starts_with("no two of 10 poses lie 30 apart"), "{told}");
        let nan = OdometryErrorOptions { max_difference: f64::NAN, ..options(Delta::Poses(1)) };
        assert!(matches!(odometry_error(&truth, &truth, &nan), Err(Unmatched::MaxDifference(_))));
    }
}
