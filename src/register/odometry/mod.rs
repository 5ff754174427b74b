//! Odometry: where a depth camera went, from one frame to the next.
//!
//! A [`Look`] is a frame with what the methods make of it, each made when first asked for. [`motion`]
//! finds the motion between two looks by one [`Method`] and judges it; the [`Tracker`] strings motions
//! together, from key frames to the frames that follow, and skips what it does not believe.
//!
//! Morell (2014), section 2.3: every method fails somewhere, and its failures "can be detected and
//! corrected or discarded".

mod agreement;
mod by_dense;
mod by_icp;
mod drift;
mod joint;
mod look;
mod motion;
mod options;
mod sightings;
mod tracker;
mod visual;

pub use agreement::{Agreement, agreement};
pub use drift::{Hanging, drift};
pub use look::Look;
pub use motion::{Doubt, Motion};
pub use options::{Method, OdometryError, OdometryOptions};
pub use tracker::{FrameRole, Link, Placed, Tracker};

use crate::geom::Pose;
use crate::progress::{Cancelled, Progress};

/// The motion of the camera from `previous` to `next`, which is about `guess`
/// (`previous_from_next`), by the method of the options.
///
/// What speaks against the motion is in its [`Doubt`]s; an error is nothing but the wish to stop.
pub fn motion(
    previous: &Look,
    next: &Look,
    guess: &Pose,
    options: &OdometryOptions,
    progress: &dyn Progress,
) -> Result<Motion, Cancelled> {
    let found = match options.method {
        Method::Dvo => by_dense::motion(previous, next, guess, options),
        Method::Visual => visual::motion(previous, next, guess, options),
        Method::VisualIcp => visual::motion_then_icp(previous, next, guess, options, progress)?,
        Method::RgbdIcp => joint::motion(previous, next, guess, options, progress)?,
        Method::Icp => by_icp::motion(previous, next, guess, options, progress)?,
        // `OdometryOptions::check` refuses it.
        Method::Kinfu => {
            return Ok(Motion::failed(guess, Doubt::Unusable(OdometryError::Model.to_string())));
        }
    };
    Ok(found.within_bounds(guess, options).seen_in(previous, next))
}

#[cfg(test)]
mod tests;
