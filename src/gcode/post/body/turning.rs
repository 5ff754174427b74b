//! Angles beyond a turn: what a control makes of them, and what is left of one tool for the next.

use super::Body;
use crate::gcode::post::PostError;
use crate::gcode::{BlockKind, Rotary};
use crate::machine::{AxisKind, AxisValues, MAX_AXES};
use std::f64::consts::TAU;

impl Body<'_> {
    /// Refuses a machine with rotary axes that the control has not.
    pub(super) fn speaks_of_turning(&self) -> Result<(), PostError> {
        let mut axes = self.program.axes.iter();
        let turning = axes.find(|axis| axis.kind == AxisKind::Rotary);
        match turning.filter(|_| self.dialect.rotary == Rotary::None) {
            Some(axis) => Err(PostError::NoRotary {
                axis: axis.letter,
                machine: self.machine.name.clone(),
                dialect: self.dialect.name.clone(),
            }),
            None => Ok(()),
        }
    }

    /// Leaves the turns an axis has made before as they are.
    pub(super) fn set_shift(&mut self, first: &AxisValues) {
        let first = self.machine.with_followers(first);
        for (i_axis, axis) in self.machine.axes.iter().enumerate().take(MAX_AXES) {
            let endless = axis.kind == AxisKind::Rotary && axis.limits.is_none();
            if endless && self.has_begun && first[i_axis].is_finite() {
                let turns = (self.wanted[i_axis] - first[i_axis]) / TAU;
                self.shift[i_axis] = TAU * turns.round();
            }
        }
        self.has_begun = true;
    }

    /// Where a move of the toolpath takes all axes.
    pub(super) fn target(&self, to: &AxisValues) -> AxisValues {
        let mut target = self.machine.with_followers(to);
        for (value, shift) in target.iter_mut().zip(self.shift) {
            *value += shift;
        }
        target
    }

    /// Where the control turns the shorter way, half a turn could go either way.
    pub(super) fn turns_less_than_half(
        &self,
        i_move: usize,
        words: &AxisValues,
    ) -> Result<(), PostError> {
        if self.dialect.rotary != Rotary::Modulo {
            return Ok(());
        }
        for (i_axis, axis) in self.program.axes.iter().enumerate() {
            let degrees = words[i_axis] - self.at[i_axis];
            if axis.kind == AxisKind::Rotary && degrees.abs() > 179.0 {
                let (axis, dialect) = (axis.letter, self.dialect.name.clone());
                return Err(PostError::HalfTurn { i_move, axis, degrees, dialect });
            }
        }
        Ok(())
    }

    /// Takes whole turns off an axis that has turned too often.
    pub(super) fn rezero(&mut self) {
        let Rotary::Rezero { turns: most } = self.dialect.rotary else { return };
        for i_axis in 0..self.program.axes.len() {
            let axis = &self.machine.axes[i_axis];
            if axis.kind != AxisKind::Rotary || axis.limits.is_some() {
                continue;
            }
            let turns = ((self.at[i_axis] / 360.0) as i32).saturating_sub(self.turns[i_axis]);
            if turns.unsigned_abs() >= most {
                self.turns[i_axis] = self.turns[i_axis].saturating_add(turns);
                self.program.push(BlockKind::Rezero { i_axis, turns });
            }
        }
    }
}
