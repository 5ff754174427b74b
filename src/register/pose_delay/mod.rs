//! How late the stamps of frames are, by the clock of the poses they are placed by.
//!
//! A driver stamps a frame when it has come, and poses of another clock (a motion capture's, a robot's) tell
//! where the camera was by then. Frames of a camera that did not move evenly are then laid beside each
//! other. So they are laid on each other by the poses for one delay after the other ([`apart`]), and
//! where they lie nearest is the delay. Nothing is tracked, and nothing but the delay is fitted.

mod apart;
mod error;
mod sketch;

pub use error::PoseDelayError;
pub use sketch::Sketch;

use crate::progress::{Cancelled, Progress};
use crate::rgbd::CameraTrajectory;
use apart::Pairs;
use serde::Serialize;

/// No longer delay is looked for [s].
pub const LONGEST: f64 = 0.1;
/// From one delay that is tried to the next [s].
const STEP: f64 = 0.01;
/// The delay is found to this [s].
const FINE: f64 = 2.5e-4;
/// Frames that it takes.
const LEAST_FRAMES: usize = 6;
/// Pairs of frames that overlap, which it takes.
const LEAST_PAIRS: usize = 8;
/// How far from the best delay frames are looked at again [s].
const BESIDE: f64 = 0.02;
/// There they must lie farther apart by this share: else the camera did not move, or evenly.
const LEAST_RISE: f64 = 0.02;
/// What the delays that either half of the pairs says may differ by [s].
const UNSTEADY: f64 = 0.01;

/// How late stamps are.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct PoseDelay {
    /// How long before its stamp a frame was taken, by the clock of the poses [s].
    pub seconds: f64,
    /// What the two halves of the pairs say [s].
    pub halves: [f64; 2],
    /// How far surfaces lie apart in the mean: at the stamps, and this long before [mm].
    pub apart: [f64; 2],
    /// Frames looked at.
    pub n_frames: usize,
    /// Pairs of them that show the same.
    pub n_pairs: usize,
}

/// How long before their stamps frames were taken, by the clock of `along`.
pub fn pose_delay(
    sketches: &[Sketch],
    along: &CameraTrajectory,
    progress: &dyn Progress,
) -> Result<PoseDelay, PoseDelayError> {
    let pairs = Pairs::new(sketches, along, LONGEST);
    let (n_frames, n_pairs) = (pairs.n_frames(), pairs.len());
    if n_frames < LEAST_FRAMES {
        return Err(PoseDelayError::TooFewFrames { n_frames, least: LEAST_FRAMES });
    }
    if n_pairs < LEAST_PAIRS {
        return Err(PoseDelayError::TooFewPairs { n_pairs, least: LEAST_PAIRS });
    }
    let tried = tried(&pairs, progress)?;
    let [one, other] = [0, 1].map(|half| least(&tried, half..half + 1, &pairs));
    let found = least(&tried, 0..2, &pairs);
    let is_at_end = found.abs() > LONGEST - STEP;
    if is_at_end && spread(&tried) > LEAST_RISE {
        return Err(PoseDelayError::Beyond { longest: LONGEST - STEP });
    }
    let at = |delay: f64| mean(&pairs.apart(delay), 0..2);
    let at_stamps = at(0.0);
    let seconds = if at_stamps <= at(found) { 0.0 } else { found };
    let best = at(seconds);
    let rise = at(seconds - BESIDE).min(at(seconds + BESIDE)) / best - 1.0;
    // A comparison that NaN fails, of frames that lie on each other exactly.
    let is_told = rise > LEAST_RISE;
    if !is_told {
        return Err(PoseDelayError::Even { rise, least: LEAST_RISE });
    }
    if (one - other).abs() > UNSTEADY {
        return Err(PoseDelayError::Unsteady { halves: [one, other] });
    }
    Ok(PoseDelay { seconds, halves: [one, other], apart: [at_stamps, best], n_frames, n_pairs })
}

/// Sum and number of the distances in either half of the pairs.
type Halves = [[f64; 2]; 2];

/// Delays from end to end, and how far frames lie apart then.
fn tried(pairs: &Pairs, progress: &dyn Progress) -> Result<Vec<(f64, Halves)>, Cancelled> {
    let n = (2.0 * LONGEST / STEP).round() as usize + 1;
    progress.start("look for the delay", n as u64);
    let one = |i: usize| {
        let delay = i as f64 * STEP - LONGEST;
        let apart = pairs.apart(delay);
        progress.advance(1).map(|()| (delay, apart))
    };
    (0..n).map(one).collect()
}

/// By which share frames lie farther apart at the worst delay than at the best.
fn spread(tried: &[(f64, Halves)]) -> f64 {
    let all = || tried.iter().map(|(_, halves)| mean(halves, 0..2));
    all().fold(0.0, f64::max) / all().fold(f64::INFINITY, f64::min) - 1.0
}

/// The mean distance in some halves.
fn mean(halves: &Halves, of: std::ops::Range<usize>) -> f64 {
    let [sum, n] =
        halves[of].iter().fold([0.0; 2], |all, half| [all[0] + half[0], all[1] + half[1]]);
    sum / n
}

/// The delay of the least mean distance, between those that were tried: by golden sections.
fn least(tried: &[(f64, Halves)], of: std::ops::Range<usize>, pairs: &Pairs) -> f64 {
    let at = |delay: f64| mean(&pairs.apart(delay), of.clone());
    let known = tried.iter().map(|(delay, halves)| (*delay, mean(halves, of.clone())));
    let best = known.min_by(|a, b| a.1.total_cmp(&b.1)).map_or(0.0, |(delay, _)| delay);
    let golden = (5.0_f64.sqrt() - 1.0) / 2.0;
    let (mut from, mut to) = (best - STEP, best + STEP);
    let mut inner = [to - golden * (to - from), from + golden * (to - from)];
    let mut values = inner.map(at);
    while to - from > FINE {
        if values[0] <= values[1] {
            (to, inner[1], values[1]) = (inner[1], inner[0], values[0]);
            inner[0] = to - golden * (to - from);
            values[0] = at(inner[0]);
        } else {
            (from, inner[0], values[0]) = (inner[0], inner[1], values[1]);
            inner[1] = from + golden * (to - from);
            values[1] = at(inner[1]);
        }
    }
    f64::midpoint(from, to)
}

#[cfg(test)]
mod tests;
