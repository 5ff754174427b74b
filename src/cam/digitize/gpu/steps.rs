//! Steps as a device sees them.

use super::DigitizeError;
use super::layout::Layout;
use super::slack::Slack;
use crate::cam::digitize::View;
use rayon::prelude::*;

/// Lengths from here on are refused: their squares must stay far from the end of `f32` [mm].
const TOO_FAR: f64 = 1e9;

/// The steps of `views`: poses about the part's centre, and how far they may be off.
pub(super) fn steps<L: Layout>(
    views: &[View],
    slack: &Slack<L>,
) -> Result<Vec<L::Step>, DigitizeError> {
    let step = |view: &View| {
        let of_step = slack.of(view);
        if of_step.far.is_nan() || TOO_FAR <= of_step.far {
            return Err(DigitizeError::TooFar { far: of_step.far });
        }
        let shift = view.see(&slack.centre);
        let row = |axis: usize| {
            let turn = |k| view.rotation[(axis, k)];
            [turn(0), turn(1), turn(2), shift[axis]]
        };
        Ok(L::step([row(0), row(1), row(2)], &of_step))
    };
    views.par_iter().map(step).collect()
}
