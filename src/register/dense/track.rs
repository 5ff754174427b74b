//! A sequence of frames, one after the other, against key frames.

use super::{DenseError, DenseMotion, DenseOptions, Pyramid, align_frames};
use crate::geom::Pose;
use crate::progress::Progress;
use crate::register::icp::Verdict;
use crate::rgbd::{Camera, CameraTrajectory, RgbdError, RgbdFrame, SequenceError, StampedPose};
use std::sync::Arc;

/// Less of the key frame in the picture than this, and it is time for another.
const LEAST_OVERLAP: f64 = 0.6;

/// Where a camera went, and how sure that is.
#[derive(Debug, Clone, PartialEq)]
pub struct DenseTrack {
    /// The poses of all frames but those that were skipped; the first stands at the origin.
    pub trajectory: CameraTrajectory,
    /// All frames.
    pub frames: Vec<TrackedFrame>,
}

/// What became of a frame.
#[derive(Debug, Clone, PartialEq)]
pub struct TrackedFrame {
    /// When it was taken [s].
    pub stamp: f64,
    /// What became of it.
    pub role: FrameRole,
    /// Its motion since the key frame it was held against; `None` of the first one and of those that
    /// could not even be tried.
    pub motion: Option<DenseMotion>,
}

/// What became of a frame.
#[derive(Debug, Clone, PartialEq)]
pub enum FrameRole {
    /// Its pose is the start of the trajectory.
    First,
    /// Its pose is known by the key frame.
    Followed,
    /// Its pose is known by the frame before, which has become the key frame.
    FollowedByNewKeyFrame,
    /// It has no pose: the motion failed.
    Skipped,
    /// It has no pose: it is no frame.
    Unusable(RgbdError),
}

/// Follows the camera through `frames`.
pub fn track_frames(
    frames: impl IntoIterator<Item = Result<RgbdFrame, SequenceError>>,
    camera: &Camera,
    options: &DenseOptions,
    progress: &dyn Progress,
) -> Result<DenseTrack, DenseError> {
    let mut tracker: Option<Tracker> = None;
    let (mut poses, mut tracked) = (Vec::new(), Vec::new());
    for frame in frames {
        progress.advance(0)?;
        let frame = frame?;
        let stamp = frame.stamp;
        let next = match Pyramid::new(&frame, camera, options) {
            Ok(next) => Arc::new(next),
            // One bad frame is no bad sequence; a bad camera is one.
            Err(DenseError::Rgbd(error @ (RgbdError::NoReadings | RgbdError::Scale { .. }))) => {
                let role = FrameRole::Unusable(error);
                tracked.push(TrackedFrame { stamp, role, motion: None });
                progress.advance(1)?;
                continue;
            }
            Err(error) => return Err(error),
        };
        let (role, motion) = if let Some(tracker) = &mut tracker {
            tracker.follow(next, options)?
        } else {
            tracker = Some(Tracker::at(next));
            (FrameRole::First, None)
        };
        if role != FrameRole::Skipped
            && let Some(tracker) = &tracker
        {
            poses.push(StampedPose { stamp, world_from_camera: tracker.last.world_from_camera });
        }
        tracked.push(TrackedFrame { stamp, role, motion });
        progress.advance(1)?;
    }
    Ok(DenseTrack { trajectory: CameraTrajectory::new(poses)?, frames: tracked })
}

/// A frame and its pose.
#[derive(Debug, Clone)]
struct Placed {
    frame: Arc<Pyramid>,
    world_from_camera: Pose,
}

/// What is known between two frames.
struct Tracker {
    key: Placed,
    last: Placed,
    /// How sure the first motion from the key frame was.
    first_surety: Option<f64>,
    /// The last motion, and how long it took [s].
    step: (Pose, f64),
}

impl Tracker {
    fn at(frame: Arc<Pyramid>) -> Self {
        let first = Placed { frame, world_from_camera: Pose::identity() };
        Self { key: first.clone(), last: first, first_surety: None, step: (Pose::identity(), 1.0) }
    }

    /// Finds the pose of `next`, by the key frame, or by the last frame if that is the better one.
    fn follow(
        &mut self,
        next: Arc<Pyramid>,
        options: &DenseOptions,
    ) -> Result<(FrameRole, Option<DenseMotion>), DenseError> {
        let expected = self.expected(next.stamp);
        let motion = motion(&self.key, &next, &expected, options)?;
        let is_known = motion.verdict == Verdict::Ok && !self.is_worn(&motion, options);
        if is_known || Arc::ptr_eq(&self.key.frame, &self.last.frame) {
            if motion.verdict == Verdict::Failed {
                return Ok((FrameRole::Skipped, Some(motion)));
            }
            self.take(next, &motion);
            return Ok((FrameRole::Followed, Some(motion)));
        }
        let newer = self::motion(&self.last, &next, &expected, options)?;
        if newer.verdict == Verdict::Failed && motion.verdict == Verdict::Failed {
            return Ok((FrameRole::Skipped, Some(newer)));
        }
        if newer.verdict > motion.verdict {
            self.take(next, &motion);
            return Ok((FrameRole::Followed, Some(motion)));
        }
        self.key = self.last.clone();
        self.first_surety = None;
        self.take(next, &newer);
        Ok((FrameRole::FollowedByNewKeyFrame, Some(newer)))
    }

    /// Where the camera is if it goes on as it went.
    fn expected(&self, stamp: f64) -> Pose {
        let (step, took) = &self.step;
        let share = (stamp - self.last.frame.stamp) / took;
        let turn = nalgebra::UnitQuaternion::from_scaled_axis(step.rotation.scaled_axis() * share);
        let shift = step.translation.vector * share;
        self.last.world_from_camera * Pose::from_parts(shift.into(), turn)
    }

    /// True if the key frame tells too little of the camera by now: the entropy of its pose has grown, as
    /// Kerl et al. have it, or too little of the key frame is left in the picture.
    ///
    /// They take the ratio of entropies, which depends on the units; this is their difference, which
    /// is the logarithm of the ratio of the standard deviations, over all six.
    fn is_worn(&self, motion: &DenseMotion, options: &DenseOptions) -> bool {
        let lost = self.first_surety.map_or(0.0, |first| first - motion.surety());
        lost > 6.0 * options.key_frame.ln() || motion.overlap < LEAST_OVERLAP
    }

    fn take(&mut self, next: Arc<Pyramid>, motion: &DenseMotion) {
        self.first_surety.get_or_insert(motion.surety());
        let world_from_camera = self.key.world_from_camera * motion.next_from_reference.inverse();
        let took = next.stamp - self.last.frame.stamp;
        let step = self.last.world_from_camera.inverse() * world_from_camera;
        // Stamps that do not rise are told when the trajectory is made.
        if took > 0.0 {
            self.step = (step, took);
        }
        self.last = Placed { frame: next, world_from_camera };
    }
}

fn motion(
    from: &Placed,
    next: &Pyramid,
    expected: &Pose,
    options: &DenseOptions,
) -> Result<DenseMotion, DenseError> {
    let guess = expected.inverse() * from.world_from_camera;
    align_frames(&from.frame, next, &guess, options)
}
