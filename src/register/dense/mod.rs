//! Dense visual odometry: the motion between two frames of a depth camera, from all they show.
//!
//! Every point of a reference frame, moved, should be as bright and as far away as what the next frame
//! shows where it comes to lie. What differs is weighed by Student's t-distribution and made small by
//! damped Gauss-Newton steps on rigid motions, from coarse pictures to fine ones. If the end is not like
//! the other picture, turns of the camera are tried on tiny pictures and the best is begun at instead.
//!
//! At the end the motion is judged: what is not held, how much of the frames is in each other, how alike
//! they look, whether one sees through what the other saw, and whether the way back is the same.
//!
//! Steinbruecker, Sturm, Cremers (2011); Kerl, Sturm, Cremers, ICRA 2013 and IROS 2013; Morell (2014),
//! section 2.3. Not as there: depth is compared by its inverse, which changes evenly over a plane and in
//! which the noise of a Kinect is even.

mod descend;
mod error;
mod judge;
mod noise;
mod normal;
mod options;
mod points;
mod pyramid;
mod search;
mod verdict;
mod warp;

pub use error::DenseError;
pub use judge::DenseMotion;
pub use options::{DenseOptions, Light, Residuals, Search};
pub use pyramid::Pyramid;
pub use verdict::DenseReason;

use crate::geom::Pose;
use crate::register::icp::Verdict;
use crate::register::small_motion::surety;
use descend::descend;
use judge::judge;

/// Turns that are begun at when the start led nowhere.
const STARTS: usize = 3;

/// The motion of the camera from `reference` to `next`, which is about `guess` (it takes points of the
/// reference's camera into the next one's).
///
/// Both pyramids must have been made by one camera and the same options. The same bits for any number of
/// threads.
pub fn align_frames(
    reference: &Pyramid,
    next: &Pyramid,
    guess: &Pose,
    options: &DenseOptions,
) -> Result<DenseMotion, DenseError> {
    options.check()?;
    let frames = [reference, next];
    let is_as_asked = |frame: &Pyramid| frame.levels.len() == options.levels;
    if reference.camera() != next.camera() || !frames.into_iter().all(is_as_asked) {
        return Err(DenseError::Cameras);
    }
    if !guess.to_homogeneous().iter().all(|x| x.is_finite()) {
        return Err(DenseError::Start);
    }
    let motion = from_start(frames, guess, options);
    let is_lost = motion.reasons.iter().any(DenseReason::is_lost);
    if !is_lost || options.search == Search::Never {
        return Ok(motion);
    }
    let coarsest = options.levels - 1;
    let starts = search::turns(frames, STARTS);
    let rough = starts.iter().map(|start| descend(frames, start, [coarsest; 2], options));
    let best = rough.max_by(|a, b| surety(&a.normal.h).total_cmp(&surety(&b.normal.h)));
    let Some(best) = best else { return Ok(motion) };
    let other = from_start(frames, &best.pose, options);
    let rank = |motion: &DenseMotion| (motion.verdict != Verdict::Failed, motion.surety());
    let is_better = rank(&other).partial_cmp(&rank(&motion)).is_some_and(std::cmp::Ordering::is_gt);
    Ok(if is_better { other } else { motion })
}

/// From one start to the finest pictures, and back again, judged.
fn from_start(frames: [&Pyramid; 2], start: &Pose, options: &DenseOptions) -> DenseMotion {
    let coarsest = options.levels - 1;
    let there = descend(frames, start, [coarsest, 0], options);
    // The way back begins at its end, so it needs neither the coarsest pictures nor the finest.
    let (from, to) = (coarsest.min(2), coarsest.min(1));
    let [reference, next] = frames;
    let back = descend([next, reference], &there.pose.inverse(), [from, to], options);
    judge(frames, &there, &back.pose, options)
}

#[cfg(test)]
mod tests;
