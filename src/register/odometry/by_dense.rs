//! The motion between two frames by all that they show: the thesis' dense visual odometry.

use super::{Doubt, Look, Motion, OdometryOptions};
use crate::geom::Pose;
use crate::register::dense::{DenseMotion, align_frames};
use crate::register::small_motion::information_of_inverse;

/// Lays the pictures of `previous` over those of `next`, beginning at `guess`.
pub(super) fn motion(
    previous: &Look,
    next: &Look,
    guess: &Pose,
    options: &OdometryOptions,
) -> Motion {
    let pyramids = [previous, next].map(|look| look.pyramid(&options.dense));
    let found = match pyramids {
        [Ok(previous), Ok(next)] => align_frames(previous, next, &guess.inverse(), &options.dense)
            .map_err(|error| error.to_string()),
        [Err(error), _] | [_, Err(error)] => Err(error.to_string()),
    };
    match found {
        Ok(found) => seen_from_before(&found),
        Err(why) => Motion::failed(guess, Doubt::Unusable(why)),
    }
}

/// The motion takes points of the previous camera into the next one's, and what is known of it is known
/// about the next camera; here both are the other way round.
fn seen_from_before(found: &DenseMotion) -> Motion {
    let next_from_previous = &found.next_from_reference;
    let reasons = found.reasons.iter().cloned().map(Doubt::Dense).collect();
    let information = information_of_inverse(&found.information, next_from_previous);
    Motion::new(next_from_previous.inverse(), reasons, information, found.overlap)
}
