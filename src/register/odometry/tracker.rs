//! A camera followed over many frames, from key frame to key frame.

use super::{Doubt, Look, Method, Motion, OdometryError, OdometryOptions, motion};
use crate::geom::Pose;
use crate::progress::{Cancelled, Progress};
use crate::register::icp::Verdict;
use crate::rgbd::{Camera, RgbdFrame};
use serde::Serialize;
use std::sync::Arc;

/// Follows a camera. Frames are placed against the last key frame; where that fails, against the last
/// frame that was placed.
#[derive(Debug)]
pub struct Tracker {
    camera: Camera,
    options: OdometryOptions,
    /// What later frames are placed against.
    key: Option<Anchor>,
    /// The last frame that was placed.
    last: Option<Anchor>,
    /// How it came from the one placed before it: the next does so again, most likely.
    step: Pose,
}

#[derive(Debug, Clone)]
struct Anchor {
    look: Arc<Look>,
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
    /// What part it has in the walk.
    pub role: FrameRole,
    /// The frame with what was made of it; `None` of one that holds nothing.
    pub look: Option<Arc<Look>>,
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
        Ok(Self { camera, options, key: None, last: None, step: Pose::identity() })
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
            Err(error) => {
                let reasons = vec![Doubt::Unusable(error.to_string())];
                return Ok(Placed::skipped(stamp, reasons, None));
            }
        };
        self.options.icp_voxel.get_or_insert(look.voxel);
        let (Some(key), Some(last)) = (self.key.clone(), self.last.clone()) else {
            return Ok(self.begin(look));
        };
        let expected = last.world_from_camera * self.step;
        let mut found = self.against(&key, &look, &expected, progress)?;
        let mut anchor = &key;
        if found.verdict != Verdict::Ok && !Arc::ptr_eq(&key.look, &last.look) {
            let again = self.against(&last, &look, &expected, progress)?;
            if again.verdict < found.verdict {
                (found, anchor) = (again, &last);
            }
        }
        if found.verdict == Verdict::Failed {
            // Where it goes from here is anybody's guess.
            self.step = Pose::identity();
            return Ok(Placed::skipped(stamp, found.reasons, Some(look)));
        }
        let world_from_camera = anchor.world_from_camera * found.previous_from_next;
        let here = Anchor { look: look.clone(), world_from_camera };
        self.step = last.world_from_camera.inverse() * world_from_camera;
        self.last = Some(here.clone());
        let is_left_behind = found.overlap < self.options.key_overlap || anchor.is_not(&key);
        let role = if found.verdict == Verdict::Ok && is_left_behind {
            self.key = Some(here);
            FrameRole::Key
        } else {
            FrameRole::Placed
        };
        Ok(Placed {
            stamp,
            world_from_camera: Some(world_from_camera),
            verdict: found.verdict,
            reasons: found.reasons,
            role,
            look: Some(look),
        })
    }

    /// The method frames are placed by.
    pub fn method(&self) -> Method {
        self.options.method
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

    fn begin(&mut self, look: Arc<Look>) -> Placed {
        let world_from_camera = Pose::identity();
        let here = Anchor { look: look.clone(), world_from_camera };
        (self.key, self.last) = (Some(here.clone()), Some(here));
        Placed {
            stamp: look.frame.stamp,
            world_from_camera: Some(world_from_camera),
            verdict: Verdict::Ok,
            reasons: Vec::new(),
            role: FrameRole::Key,
            look: Some(look),
        }
    }
}

impl Anchor {
    fn is_not(&self, other: &Self) -> bool {
        !Arc::ptr_eq(&self.look, &other.look)
    }
}

impl Placed {
    /// A frame that was left out.
    pub fn skipped(stamp: f64, reasons: Vec<Doubt>, look: Option<Arc<Look>>) -> Self {
        let (verdict, role) = (Verdict::Failed, FrameRole::Skipped);
        Self { stamp, world_from_camera: None, verdict, reasons, role, look }
    }
}
