//! The F of each block: what the control measures, what it can say, and what rounding made of it.

use super::{Body, VELOCITY_TOLERANCE};
use crate::gcode::post::PostError;
use crate::gcode::post::fword::FWord;
use crate::gcode::{InverseTime, Mode, Program};
use crate::machine::{AxisKind, AxisValues, MAX_AXES};

/// The part of its time a block may lose to the digits of F before it is told: four of them.
const LOST_IN_DIGITS: f64 = 1e-3;

impl Body<'_> {
    /// A move at a speed of the linear axes [mm/s]: per minute if it is purely linear, else timed.
    pub(super) fn feed(
        &mut self,
        i_move: usize,
        feed: f64,
        target: &AxisValues,
        words: AxisValues,
    ) -> Result<(), PostError> {
        positive(i_move, "feed", feed)?;
        let length = self.linear_way(target);
        if self.rotary_that_moves(&words).is_some() {
            let refusal = PostError::RotaryFeed { i_move };
            let seconds = Some(length / feed).filter(|&seconds| seconds > 0.0).ok_or(refusal)?;
            return self.timed(i_move, seconds, target, words);
        }
        self.within_velocities(i_move, length / feed, target)?;
        // A way below the decimals goes with the next move, which is longer by it.
        if self.changed(&words) != 0 {
            self.pause();
            // Of the rounded way: the feed stays the one asked for.
            self.push_per_minute(self.fed_length(&words) / feed, words);
        }
        Ok(())
    }

    /// A move that takes `seconds`, all axes together.
    pub(super) fn timed(
        &mut self,
        i_move: usize,
        seconds: f64,
        target: &AxisValues,
        words: AxisValues,
    ) -> Result<(), PostError> {
        positive(i_move, "duration", seconds)?;
        self.within_velocities(i_move, seconds, target)?;
        if self.changed(&words) == 0 {
            self.carried += seconds;
            if *target == self.wanted {
                self.pause();
            }
            return Ok(());
        }
        let seconds = seconds + std::mem::take(&mut self.carried);
        match self.dialect.inverse_time {
            Some(inverse) => self.push_inverse_time(seconds, inverse, words),
            None => self.push_per_minute(seconds, words),
        }
        Ok(())
    }

    fn push_inverse_time(&mut self, seconds: f64, inverse: InverseTime, words: AxisValues) {
        let shortest = self.shortest_time(&words);
        let seconds = seconds.max(shortest);
        let fword = FWord { words: self.dialect.feed, max: inverse.max };
        let mut feed = fword.inverse(seconds, inverse.unit);
        let length = self.fed_length(&words);
        if length * feed < inverse.min_rate {
            let real = (inverse.min_rate / length).min(60.0 / shortest);
            feed = feed.max(fword.inverse(60.0 / real, inverse.unit));
        }
        let real = self.program.feeds.inverse_seconds(feed);
        self.set_feed_mode(Mode::InverseTime);
        self.push_fed(words, feed);
        self.compare(seconds, real);
    }

    /// A move of linear axes alone, or of any on a control that measures them all; `seconds` give way
    /// where rounding made the way of an axis too long for its speed.
    fn push_per_minute(&mut self, seconds: f64, words: AxisValues) {
        let seconds = seconds.max(self.shortest_time(&words));
        let length = self.fed_length(&words);
        let fword = FWord { words: self.dialect.feed, max: self.dialect.feed.max };
        let feed = fword.per_minute(60.0 * length / seconds);
        self.set_feed_mode(Mode::PerMinute);
        self.push_fed(words, feed);
        self.compare(seconds, 60.0 * length / feed);
    }

    /// Counts the block just written if it takes another time than asked.
    fn compare(&mut self, asked: f64, real: f64) {
        let i_block = self.program.blocks.len() - 1;
        if real < asked * (1.0 - 1e-9) {
            self.raised.count(i_block, asked - real);
        } else if real > asked * (1.0 + LOST_IN_DIGITS) {
            self.lowered.count(i_block, real - asked);
        }
    }

    fn fed_length(&self, words: &AxisValues) -> f64 {
        let Program { feeds, axes, .. } = &self.program;
        feeds.length(axes, |i_axis| words[i_axis] - self.at[i_axis])
    }

    /// How far the linear axes go to an exact target [mm].
    fn linear_way(&self, target: &AxisValues) -> f64 {
        let axes = self.program.axes.iter().enumerate();
        let linear = axes.filter(|(_, axis)| axis.kind == AxisKind::Linear);
        linear.map(|(i, _)| (target[i] - self.wanted[i]).powi(2)).sum::<f64>().sqrt()
    }

    /// How long the axes need for the rounded way at their greatest speeds [s].
    fn shortest_time(&self, words: &AxisValues) -> f64 {
        let axes = self.program.axes.iter().zip(&self.machine.axes).enumerate();
        let times = axes.map(|(i_axis, (address, axis))| {
            address.value(words[i_axis] - self.at[i_axis]).abs() / axis.velocity
        });
        times.fold(0.0, f64::max)
    }

    fn within_velocities(
        &self,
        i_move: usize,
        seconds: f64,
        target: &AxisValues,
    ) -> Result<(), PostError> {
        for (i_axis, axis) in self.machine.axes.iter().enumerate().take(MAX_AXES) {
            let way = (target[i_axis] - self.wanted[i_axis]).abs();
            if way > axis.velocity * seconds * (1.0 + VELOCITY_TOLERANCE) {
                let address = self.program.axes[i_axis];
                return Err(PostError::Velocity {
                    i_move,
                    axis: axis.letter,
                    velocity: address.word(way / seconds),
                    limit: address.word(axis.velocity),
                    unit: address.unit(),
                });
            }
        }
        Ok(())
    }

    fn rotary_that_moves(&self, words: &AxisValues) -> Option<char> {
        let changed = self.changed(words);
        let mut axes = self.program.axes.iter().enumerate();
        let found = axes.find(|(i, axis)| axis.kind == AxisKind::Rotary && changed >> i & 1 == 1);
        found.map(|(_, axis)| axis.letter)
    }
}

fn positive(i_move: usize, what: &'static str, value: f64) -> Result<(), PostError> {
    let is_one = value.is_finite() && value > 0.0;
    if is_one { Ok(()) } else { Err(PostError::Pace { i_move, what, value }) }
}
