//! Axes that copy another one: who may follow whom.

use super::description::{Flaw, finite, flaw, named, number};
use super::file::{AxisFile, FollowFile};
use super::{Follow, MachineError};

/// What `axis` follows among `axes`: always an axis that is driven on its own.
pub(super) fn follow(axis: &AxisFile, axes: &[AxisFile]) -> Result<Option<Follow>, Flaw> {
    let Some(given) = &axis.follows else { return Ok(None) };
    let leader = named(axes, "follows", &given.axis)?;
    if axes[leader].follows.is_some() {
        return Err(not_driven(axis, given, axes)?);
    }
    let (letter, kind) = (*axis.letter.get_ref(), *axis.kind.get_ref());
    if *axes[leader].kind.get_ref() != kind {
        let leader = *given.axis.get_ref();
        return Err(flaw(&given.axis, MachineError::FollowKind { letter, kind, leader }));
    }
    let ratio = finite("ratio", &given.ratio)?;
    if ratio == 0.0 {
        return Err(number(&given.ratio, "ratio", ratio, "other than 0"));
    }
    Ok(Some(Follow { leader, ratio }))
}

/// The leader of `axis` follows another axis itself: one that leads, or round in a circle.
fn not_driven(axis: &AxisFile, given: &FollowFile, axes: &[AxisFile]) -> Result<Flaw, Flaw> {
    let letter = *axis.letter.get_ref();
    let mut way = vec![letter];
    let mut step = Some(given);
    // Every step meets an axis not met before, or ends.
    while let Some(FollowFile { axis: next, .. }) = step {
        let circle = way.iter().position(|met| met == next.get_ref());
        way.push(*next.get_ref());
        if let Some(start) = circle {
            let letters = way[start..].iter().map(char::to_string).collect();
            return Ok(flaw(&given.axis, MachineError::FollowCircle { letters }));
        }
        step = axes[named(axes, "follows", next)?].follows.as_ref();
    }
    let (leader, driven) = (way[1], way[way.len() - 1]);
    Ok(flaw(&given.axis, MachineError::FollowFollower { letter, leader, driven }))
}
