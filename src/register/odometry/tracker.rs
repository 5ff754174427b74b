//! A camera followed over many frames, from key frame to key frame.

use super::{Doubt, Look, Method, Motion, OdometryError, OdometryOptions, motion};
use crate::geom::Pose;
use crate::progress::{Cancelled, Progress};
use crate::register::icp::Verdict;
use crate::rgbd::{Camera, RgbdFrame};
use nalgebra::{Matrix6, UnitQuaternion};
use serde::Serialize;
use std::sync::Arc;

/// Follows a camera. Frames are placed against the last key frame. Where that fails, or tells too little
/// by now, they are placed against the last frame that was placed, which becomes the key frame.
#[derive(Debug)]
pub struct Tracker {
    camera: Camera,
    options: OdometryOptions,
    /// Frames it was given so far.
    n_frames: usize,
    /// What later frames are placed against.
    key: Option<Anchor>,
    /// The last frame that was placed.
    last: Option<Anchor>,
    /// How surely the first motion from the key frame was known.
    first_surety: Option<f64>,
    /// The last motion, and how long it took [s]: the next is alike, most likely.
    step: (Pose, f64),
}

/// A frame and where it is.
#[derive(Debug, Clone)]
struct Anchor {
    look: Arc<Look>,
    number: usize,
    world_from_camera: Pose,
}

/// What became of a frame.
#[derive(Debug, Clone)]
pub struct Placed {
    /// When it was taken [s].
    pub stamp: f64,
    /// Where the camera was, in the frame of the first one that could be used; `None` if the frame was
    /// skipped.
    pub world_from_camera: Option<Pose>,
    /// Whether that may be believed.
    pub verdict: Verdict,
    /// What speaks against it.
    pub reasons: Vec<Doubt>,
    /// What it was placed against; `None` of the first frame that was placed, and of those skipped.
    pub link: Option<Link>,
    /// The frame with what was made of it; `None` of one that holds nothing.
    pub look: Option<Arc<Look>>,
}

/// How a frame hangs on a key frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Link {
    /// Which frame the key frame is, counted from 0 over all that the tracker was given.
    pub key: usize,
    /// The motion between them.
    pub key_from_camera: Pose,
    /// What is known of it: information of a small step, turn [rad] before shift [mm], taken from the
    /// left.
    pub information: Matrix6<f64>,
    /// The share of what the key frame shows that this one shows too.
    pub overlap: f64,
}

/// What part a frame has in a walk.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum FrameRole {
    /// Others are placed against it.
    Key,
    /// It was placed.
    Placed,
    /// It was left out.
    Skipped,
}

impl Tracker {
    /// A tracker of frames that `camera` took.
    pub fn new(camera: Camera, options: OdometryOptions) -> Result<Self, OdometryError> {
        options.check()?;
        let (key, last, first_surety) = (None, None, None);
        let step = (Pose::identity(), 1.0);
        Ok(Self { camera, options, n_frames: 0, key, last, first_surety, step })
    }

    /// Places `frame`, or skips it and says why.
    pub fn add(
        &mut self,
        frame: RgbdFrame,
        progress: &dyn Progress,
    ) -> Result<Placed, OdometryError> {
        let stamp = frame.stamp;
        let look = match Look::new(frame, self.camera, self.options.icp_voxel) {
            Ok(look) => Arc::new(look),
            Err(error) => return Ok(self.miss(stamp, Doubt::Unusable(error.to_string()))),
        };
        self.options.icp_voxel.get_or_insert(look.voxel);
        let number = self.n_frames;
        self.n_frames += 1;
        let (Some(key), Some(last)) = (self.key.clone(), self.last.clone()) else {
            return Ok(self.begin(look, number));
        };
        let expected = self.expected(&last, stamp);
        let (anchor, found) = self.best([&key, &last], &look, &expected, progress)?;
        if found.verdict == Verdict::Failed {
            // Where it goes from here is anybody's guess.
            self.step = (Pose::identity(), 1.0);
            return Ok(Placed::skipped(stamp, found.reasons, Some(look)));
        }
        if anchor.number != key.number {
            self.key = Some(anchor.clone());
            self.first_surety = None;
        }
        self.first_surety.get_or_insert(found.surety());
        let world_from_camera = anchor.world_from_camera * found.previous_from_next;
        let took = stamp - last.look.frame.stamp;
        // Stamps that do not rise are told when the trajectory is made.
        if took > 0.0 {
            self.step = (last.world_from_camera.inverse() * world_from_camera, took);
        }
        self.last = Some(Anchor { look: look.clone(), number, world_from_camera });
        Ok(Placed {
            stamp,
            world_from_camera: Some(world_from_camera),
            verdict: found.verdict,
            reasons: found.reasons,
            link: Some(Link {
                key: anchor.number,
                key_from_camera: found.previous_from_next,
                information: found.information,
                overlap: found.overlap,
            }),
            look: Some(look),
        })
    }

    /// Counts a frame that holds nothing to go by.
    pub fn miss(&mut self, stamp: f64, why: Doubt) -> Placed {
        self.n_frames += 1;
        Placed::skipped(stamp, vec![why], None)
    }

    /// The method frames are placed by.
    pub fn method(&self) -> Method {
        self.options.method
    }

    /// The motion from the key frame, or that from the last frame if it is the better one.
    fn best<'a>(
        &self,
        [key, last]: [&'a Anchor; 2],
        look: &Look,
        expected: &Pose,
        progress: &dyn Progress,
    ) -> Result<(&'a Anchor, Motion), Cancelled> {
        let by_key = self.against(key, look, expected, progress)?;
        let is_good = by_key.verdict == Verdict::Ok && !self.is_worn(&by_key);
        if is_good || key.number == last.number {
            return Ok((key, by_key));
        }
        let by_last = self.against(last, look, expected, progress)?;
        let is_key = by_last.verdict > by_key.verdict;
        Ok(if is_key { (key, by_key) } else { (last, by_last) })
    }

    fn against(
        &self,
        anchor: &Anchor,
        look: &Look,
        expected: &Pose,
        progress: &dyn Progress,
    ) -> Result<Motion, Cancelled> {
        let guess = anchor.world_from_camera.inverse() * expected;
        motion(&anchor.look, look, &guess, &self.options, progress)
    }

    /// True if the key frame tells too little of the camera by now: the entropy of its pose has grown, as
    /// Kerl et al. have it, or too little of the key frame is left in the picture.
    ///
    /// They take the ratio of entropies, which depends on the units; this is their difference, which
    /// is the logarithm of the ratio of the standard deviations, over all six.
    fn is_worn(&self, motion: &Motion) -> bool {
        let lost = self.first_surety.map_or(0.0, |first| first - motion.surety());
        lost > 6.0 * self.options.key_factor().ln() || motion.overlap < self.options.key_overlap
    }

    /// Where the camera is if it goes on as it went.
    fn expected(&self, last: &Anchor, stamp: f64) -> Pose {
        let (step, took) = &self.step;
        let share = (stamp - last.look.frame.stamp) / took;
        let turn = UnitQuaternion::from_scaled_axis(step.rotation.scaled_axis() * share);
        let shift = step.translation.vector * share;
        last.world_from_camera * Pose::from_parts(shift.into(), turn)
    }

    fn begin(&mut self, look: Arc<Look>, number: usize) -> Placed {
        let world_from_camera = Pose::identity();
        let here = Anchor { look: look.clone(), number, world_from_camera };
        (self.key, self.last) = (Some(here.clone()), Some(here));
        Placed {
            stamp: look.frame.stamp,
            world_from_camera: Some(world_from_camera),
            verdict: Verdict::Ok,
            reasons: Vec::new(),
            link: None,
            look: Some(look),
        }
    }
}

impl Placed {
    /// A frame that was left out.
    fn skipped(stamp: f64, reasons: Vec<Doubt>, look: Option<Arc<Look>>) -> Self {
        let verdict = Verdict::Failed;
        Self { stamp, world_from_camera: None, verdict, reasons, link: None, look }
    }
}
