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
        if self.kept.len() > MOST {
            let mut is_second = false;
            self.kept.retain(|_| {
                is_second = !is_second;
                is_second
            });
            self.n_between = 2 * self.n_between + 1;
        }
        self.n_to_skip = self.n_between;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::register::icp::Verdict;
    use crate::register::odometry::Link;
    use crate::rgbd::{Camera, Image, RgbdFrame};
    use nalgebra::Matrix6;

    /// A frame that hangs on the one before it.
    fn placed(number: usize) -> Placed {
        let depth = Image::filled(16, 12, 800.0);
        let frame = RgbdFrame { stamp: number as f64, color: None, depth, confidence: None };
        let camera = Camera::pinhole([16, 12], [16.0, 16.0], [7.5, 5.5]);
        let link = number.checked_sub(1).map(|key| Link {
            key,
            key_from_camera: Pose::identity(),
            information: Matrix6::identity(),
            overlap: 1.0,
        });
        Placed {
            stamp: number as f64,
            world_from_camera: Some(Pose::identity()),
            verdict: Verdict::Ok,
            reasons: Vec::new(),
            link,
            look: Some(Arc::new(Look::new(frame, camera, None).unwrap())),
        }
    }

    fn kept(n_frames: usize) -> Vec<usize> {
        let mut keys = KeyFrames::default();
        (0..n_frames).for_each(|number| keys.note(number, &placed(number)));
        keys.into_all().iter().map(|key| key.number).collect()
    }

    #[test]
    fn frames_that_others_hang_on_are_kept_and_the_last_one() {
        assert_eq!(kept(4), [0, 1, 2, 3]);
        let mut keys = KeyFrames::default();
        keys.note(0, &placed(0));
        keys.note(1, &placed(1));
        // It hangs on the first one still: the second is no key frame.
        let mut third = placed(2);
        third.link = placed(1).link;
        keys.note(2, &third);
        let numbers: Vec<usize> = keys.into_all().iter().map(|key| key.number).collect();
        assert_eq!(numbers, [0, 2]);
    }

    #[test]
    fn of_many_every_second_is_let_go() {
        let numbers = kept(2 * MOST);
        assert!(numbers.len() <= MOST + 1, "{}", numbers.len());
        let (last, others) = numbers.split_last().unwrap();
        assert_eq!(*last, 2 * MOST - 1);
        assert!(others.windows(2).all(|pair| pair[1] - pair[0] == 2), "{others:?}");
    }
}
