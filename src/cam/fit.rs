//! Does the part fit the machine, and can the tool pass its clamps?

use super::setup::Setup;
use super::tilt::TurnLine;
use crate::geom::Pose;
use crate::machine::{Axis, AxisValues, Machine};
use crate::tool::Reach;

/// Room less than this below nothing is rounding [mm].
const ROUNDING: f64 = 1e-9;

/// Why a part cannot be cut on a machine.
#[derive(Debug, thiserror::Error)]
pub enum FitError {
    /// An axis would have to leave its travel.
    #[error(
        "the part does not fit {machine}: {axis} would have to go to {needed:.1} mm, its travel is \
         {least:.1} to {greatest:.1} mm; {remedy}"
    )]
    Travel {
        /// The machine.
        machine: String,
        /// The axis.
        axis: char,
        /// The word it would need [mm].
        needed: f64,
        /// Its least word [mm].
        least: f64,
        /// Its greatest word [mm].
        greatest: f64,
        /// What to change.
        remedy: &'static str,
    },
    /// The tool would run into what holds the clamp.
    #[error(
        "the tool cannot pass the clamp at the {end}: it is {width:.1} mm wide and would come within \
         {room:.1} mm of the clamp's far end; clamp longer, take a narrower tool or a smaller --overrun"
    )]
    Clamp {
        /// `heel` or `toe`.
        end: &'static str,
        /// Of the tool [mm].
        width: f64,
        /// Left between tool and clamp's far end; negative is a collision [mm].
        room: f64,
    },
}

/// The attack word at which nothing can be touched: above the part with all its clamps, whichever
/// way it is turned, about `line` if that is what turns it, by the machine's clearance.
pub fn clear_word(
    setup: &Setup,
    machine: &Machine,
    rest: &AxisValues,
    line: Option<&TurnLine>,
    reach: Reach,
) -> Result<f64, FitError> {
    let attack_from_part = machine.attack_from_part(rest);
    let highest = match (line, machine.spindle) {
        (Some(line), _) => line.highest(machine, setup.surface.points().iter()),
        (None, Some(index)) => {
            let line = machine.axes[index].point;
            let points = setup.surface.points().iter();
            let swing = points.map(|p| (p.y - line.y).hypot(p.z - line.z)).fold(0.0, f64::max);
            (attack_from_part * line).y + swing
        }
        (None, None) => highest(setup, &attack_from_part),
    };
    let axis = &machine.axes[machine.attack];
    let word = axis.word(highest + reach.top + machine.clearance);
    within(machine, axis, word, "take a smaller tool, another spindle axis or a larger machine")?;
    Ok(word)
}

fn highest(setup: &Setup, attack_from_part: &Pose) -> f64 {
    let heights = setup.surface.points().iter().map(|point| (attack_from_part * point).y);
    heights.fold(f64::NEG_INFINITY, f64::max)
}

/// How far beyond the part's ends the tool can run before it meets what holds the clamps [mm].
pub fn room_beside(setup: &Setup, reach: Reach) -> f64 {
    match setup.clamp_length() {
        length if length > 0.0 => (length - reach.x).max(0.0),
        _ => f64::INFINITY,
    }
}

/// The stretch of X the tool runs over: `overrun` beyond the part, but never into what holds the
/// clamps. `reach` is the tool's own, without allowance.
pub fn run_along(
    setup: &Setup,
    machine: &Machine,
    reach: Reach,
    overrun: f64,
) -> Result<[f64; 2], FitError> {
    let along = [setup.part.min.x - overrun, setup.part.max.x + overrun];
    let is_held = machine.spindle.is_some() && setup.clamp_length() > 0.0;
    let rooms = [along[0] - reach.x - setup.stretch[0], setup.stretch[1] - along[1] - reach.x];
    for (end, room) in ["heel", "toe"].into_iter().zip(rooms) {
        if is_held && room < -ROUNDING {
            return Err(FitError::Clamp { end, width: 2.0 * reach.x, room });
        }
    }
    Ok(along)
}

/// Refuses words outside an axis' travel before any position is computed.
pub fn within(
    machine: &Machine,
    axis: &Axis,
    word: f64,
    remedy: &'static str,
) -> Result<(), FitError> {
    match axis.limits {
        Some([least, greatest]) if !(least..=greatest).contains(&word) => Err(FitError::Travel {
            machine: machine.name.clone(),
            axis: axis.letter,
            needed: word,
            least,
            greatest,
            remedy,
        }),
        _ => Ok(()),
    }
}
