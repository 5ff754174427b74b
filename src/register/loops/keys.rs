//! The key frames of a walk, kept to be seen again.

use crate::geom::Pose;
use crate::register::odometry::{Look, Placed};
use std::sync::Arc;

/// So many are kept; then every second one is let go: some 600 MB for a Kinect's.
const MOST: usize = 256;

/// A key frame that was kept.
#[derive(Debug)]
pub struct KeyFrame {
    /// Which frame it is, counted from 0.
    pub number: usize,
    /// The frame, bare.
    pub look: Look,
    /// Where the camera was, as the walk has it.
    pub world_from_camera: Pose,
}

/// The key frames of a walk so far.
#[derive(Debug, Default)]
pub struct KeyFrames {
    kept: Vec<KeyFrame>,
    /// Of key frames one of so many is kept, this being how many are let go between.
    n_between: usize,
    n_to_skip: usize,
    /// The newest key frame, kept or not.
    newest: Option<usize>,
    /// The last frame that was placed: it may become a key frame.
    last: Option<(usize, Arc<Look>, Pose)>,
}

impl KeyFrames {
    /// Looks at what became of frame `number`: if it hangs on the frame placed before it, that one is a
    /// key frame.
    pub fn note(&mut self, number: usize, placed: &Placed) {
        if let (Some(link), Some((last, look, pose))) = (&placed.link, &self.last)
            && link.key == *last
            && self.newest.is_none_or(|newest| newest < *last)
        {
            self.newest = Some(*last);
            if self.n_to_skip > 0 {
                self.n_to_skip -= 1;
            } else {
                let key = KeyFrame { number: *last, look: look.bare(), world_from_camera: *pose };
                self.keep(key);
            }
        }
        if let (Some(pose), Some(look)) = (placed.world_from_camera, &placed.look) {
            self.last = Some((number, look.clone(), pose));
        }
    }

    /// Those that were kept, in order, and the last frame of the walk, which may close a loop too.
    pub fn into_all(mut self) -> Vec<KeyFrame> {
        if let Some((number, look, world_from_camera)) = self.last.take()
            && self.newest.is_none_or(|newest| newest < number)
        {
            self.kept.push(KeyFrame { number, look: look.bare(), world_from_camera });
        }
        self.kept
    }

    fn keep(&mut self, key: KeyFrame) {
        self.kept.push(key);
        self.n_to_skip = self.n_between;
        if self.kept.len() > MOST {
            let mut is_second = false;
            self.kept.retain(|_| {
                is_second = !is_second;
                is_second
            });
            self.n_between = 2 * self.n_between + 1;
        }
    }
}
