//! The moves of a program, one by one.
//!
//! Rounding must neither bend the path nor its time. Words are rounded once, from the exact target,
//! so errors never add up. A timed move too small to change a word hands its time on to the next.
//! Where rounding makes a way longer, or the control cannot be as slow as asked, F says what really
//! happens: the program's time is that of the machine.

use super::fword::FWord;
use super::{PostError, PostWarning};
use crate::cam::{Move, Pace, Toolpath};
use crate::gcode::check::is_outside;
use crate::gcode::number::{floor_to, round_to};
use crate::gcode::write::decimals;
use crate::gcode::{
    BlockKind, Coolant, Dialect, DwellWord, InverseTime, Language, Mode, Motion, MoveWords,
    Program, Rotary, Spindle, SpindleRun,
};
use crate::machine::{AxisKind, AxisValues, MAX_AXES, Machine};
use std::f64::consts::TAU;

/// A speed may be beyond its limit by this part of it: the noise of a scheduler that clips exactly.
const VELOCITY_TOLERANCE: f64 = 1e-9;

/// The part of its time a block may lose to the digits of F before it is told: four of them.
const LOST_IN_DIGITS: f64 = 1e-3;

/// The part of a program between preamble and end, as it grows.
pub(super) struct Body<'a> {
    machine: &'a Machine,
    dialect: &'a Dialect,
    pub(super) program: Program,
    /// Where the axes stand, rounded [mm or deg].
    at: AxisValues,
    /// Where the toolpath wanted them, exactly [mm or rad].
    wanted: AxisValues,
    /// How F is understood; `None` while the program has not said so.
    feed_mode: Option<Mode>,
    /// Time of moves too small to be written [s].
    carried: f64,
    /// How many turns each axis' position has been made less by.
    turns: [i32; MAX_AXES],
    /// Whole turns by which this operation begins farther on: the last one left the axis there, and
    /// turning all the way back would take longer than some operations [rad].
    shift: AxisValues,
    has_begun: bool,
    coolant: Coolant,
    raised: Tally,
    lowered: Tally,
}

/// Blocks that the control runs at another pace than asked.
#[derive(Default)]
struct Tally {
    n_blocks: usize,
    /// Index of the first.
    first: usize,
    seconds: f64,
}

impl<'a> Body<'a> {
    /// A body without moves, for a program whose preamble is that of `dialect`.
    pub(super) fn new(machine: &'a Machine, dialect: &'a Dialect) -> Self {
        let per_minute = dialect.preamble.iter().any(|modes| modes.contains(Mode::PerMinute))
            || dialect.language == Language::Klartext;
        Self {
            machine,
            dialect,
            program: Program::for_machine(machine, dialect),
            at: [0.0; MAX_AXES],
            wanted: [0.0; MAX_AXES],
            feed_mode: per_minute.then_some(Mode::PerMinute),
            carried: 0.0,
            turns: [0; MAX_AXES],
            shift: [0.0; MAX_AXES],
            has_begun: false,
            coolant: Coolant::Off,
            raised: Tally::default(),
            lowered: Tally::default(),
        }
    }

    /// Opens the coolant.
    pub(super) fn cool(&mut self, coolant: Coolant) -> Result<(), PostError> {
        let known = &self.dialect.coolants;
        if coolant != Coolant::Off && !known.contains(&coolant) {
            return Err(PostError::NoCoolant { coolant, dialect: self.dialect.name.clone() });
        }
        self.set_coolant(coolant);
        Ok(())
    }

    fn set_coolant(&mut self, coolant: Coolant) {
        if self.coolant != coolant {
            self.coolant = coolant;
            self.program.push(BlockKind::Coolant(coolant));
        }
    }

    /// Takes the attack axis to where nothing can be touched, before anything else moves.
    pub(super) fn begin(&mut self, path: &Toolpath) -> Result<(), PostError> {
        let first = path.moves.first().ok_or(PostError::Empty)?;
        if first.pace != Pace::Rapid {
            return Err(PostError::NoStart);
        }
        self.program.blocks.reserve(path.moves.len() + 32);
        self.speaks_of_turning()?;
        self.set_shift(&first.to);
        self.wanted = self.target(&first.to);
        self.wanted[self.machine.attack] = path.clear;
        self.at = self.words(0, &self.wanted)?;
        self.push_rapid(1 << self.machine.attack);
        Ok(())
    }

    /// Leaves the turns an axis has made before as they are.
    fn set_shift(&mut self, first: &AxisValues) {
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
    fn target(&self, to: &AxisValues) -> AxisValues {
        let mut target = self.machine.with_followers(to);
        for (value, shift) in target.iter_mut().zip(self.shift) {
            *value += shift;
        }
        target
    }

    /// Takes all axes to the start, the attack axis last. A tool change may have moved the machine
    /// anywhere, so the attack axis is sent off again, and every axis is named.
    pub(super) fn approach(&mut self, path: &Toolpath) -> Result<(), PostError> {
        let attack = 1 << self.machine.attack;
        let all = (1_u8 << self.program.axes.len()) - 1;
        self.push_rapid(attack);
        self.push_rapid(all & !attack);
        path.moves.first().map_or(Err(PostError::Empty), |first| self.take(0, first))
    }

    /// Appends one move of the toolpath.
    pub(super) fn take(&mut self, i_move: usize, step: &Move) -> Result<(), PostError> {
        let target = self.target(&step.to);
        let words = self.words(i_move, &target)?;
        self.turns_less_than_half(i_move, &words)?;
        match step.pace {
            Pace::Rapid => self.rapid(words),
            Pace::Feed(feed) => self.feed(i_move, feed, &target, words)?,
            Pace::Duration(seconds) => self.timed(i_move, seconds, &target, words)?,
        }
        self.wanted = target;
        self.rezero();
        Ok(())
    }

    /// Takes the attack axis back to `clear` and stops spindle and coolant.
    pub(super) fn retreat(&mut self, clear: f64) {
        self.pause();
        self.set_feed_mode(Mode::PerMinute);
        let attack = self.machine.attack;
        let mut words = self.at;
        // Limits and number were checked when the program began.
        words[attack] = self.rounded(attack, clear);
        self.rapid(words);
        let run = Some(SpindleRun::Stop);
        self.program.push(BlockKind::Spindle(Spindle { speed_rpm: None, run }));
        self.set_coolant(Coolant::Off);
    }

    /// What came out differently; `line(i)` is the line of block `i` of the body.
    pub(super) fn warnings(&self, line: impl Fn(usize) -> u32) -> Vec<PostWarning> {
        let mut warnings = Vec::new();
        let Tally { n_blocks, first, seconds } = self.raised;
        if n_blocks > 0 {
            let min_rate = self.dialect.inverse_time.map_or(0.0, |inverse| inverse.min_rate);
            let first_line = line(first);
            warnings.push(PostWarning::FeedRaised { n_blocks, first_line, seconds, min_rate });
        }
        let Tally { n_blocks, first, seconds } = self.lowered;
        if n_blocks > 0 {
            let first_line = line(first);
            warnings.push(PostWarning::FeedLowered { n_blocks, first_line, seconds });
        }
        warnings
    }

    /// Refuses a machine with rotary axes that the control has not.
    fn speaks_of_turning(&self) -> Result<(), PostError> {
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

    /// Where the control turns the shorter way, half a turn could go either way.
    fn turns_less_than_half(&self, i_move: usize, words: &AxisValues) -> Result<(), PostError> {
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
    fn rezero(&mut self) {
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

    /// The words of a target, each a number within the limits of its axis.
    fn words(&self, i_move: usize, target: &AxisValues) -> Result<AxisValues, PostError> {
        let mut words = [0.0; MAX_AXES];
        for (i_axis, axis) in self.machine.axes.iter().enumerate().take(MAX_AXES) {
            let (letter, address) = (axis.letter, self.program.axes[i_axis]);
            if !target[i_axis].is_finite() {
                return Err(PostError::NotFinite { i_move, axis: letter, value: target[i_axis] });
            }
            let word = self.rounded(i_axis, target[i_axis]);
            if let Some(limits) = axis.limits.filter(|&l| is_outside(address.value(word), l)) {
                return Err(PostError::Limit {
                    i_move,
                    axis: letter,
                    word,
                    limits: limits.map(|limit| round_to(address.word(limit), 9)),
                    unit: address.unit(),
                });
            }
            words[i_axis] = word;
        }
        Ok(words)
    }

    fn rounded(&self, i_axis: usize, value: f64) -> f64 {
        let address = self.program.axes[i_axis];
        round_to(address.word(value), decimals(address.kind, self.dialect))
    }

    fn rapid(&mut self, words: AxisValues) {
        self.pause();
        let changed = self.changed(&words);
        self.at = words;
        if changed != 0 {
            self.push_rapid(changed);
        }
    }

    /// A move at a speed of the linear axes [mm/s]: per minute if it is purely linear, else timed.
    fn feed(
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
    fn timed(
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

    fn push_fed(&mut self, words: AxisValues, feed: f64) {
        let changed = self.changed(&words);
        self.at = words;
        self.push_move(MoveWords::new(Motion::Feed).with_feed(feed), changed);
    }

    fn push_rapid(&mut self, axes: u8) {
        self.push_move(MoveWords::new(Motion::Rapid), axes);
    }

    /// Appends `words` with those of the axes flagged in `axes`.
    fn push_move(&mut self, mut words: MoveWords, axes: u8) {
        for (i_axis, &word) in self.at.iter().enumerate() {
            if axes >> i_axis & 1 == 1 {
                words = words.with_axis(i_axis, word);
            }
        }
        if words.names_an_axis() {
            self.program.push(BlockKind::Move(words));
        }
    }

    /// Lets the time of moves too small to be written pass at last.
    fn pause(&mut self) {
        let seconds = std::mem::take(&mut self.carried);
        if seconds > 0.0 {
            let dwell = self.dialect.dwell;
            let places = match dwell.word {
                DwellWord::PMilliseconds => dwell.decimals + 3,
                _ => dwell.decimals,
            };
            let seconds = floor_to(seconds, self.dialect.feed.digits, places);
            // What is shorter than the control can wait is not worth a stop.
            if seconds > 0.0 {
                self.program.push(BlockKind::Dwell(seconds));
            }
        }
    }

    fn set_feed_mode(&mut self, mode: Mode) {
        if self.feed_mode != Some(mode) {
            self.feed_mode = Some(mode);
            self.program.push(BlockKind::Modes([mode].into_iter().collect()));
        }
    }

    /// Flags of the axes whose words differ from where they stand.
    fn changed(&self, words: &AxisValues) -> u8 {
        let pairs = words.iter().zip(&self.at).enumerate();
        pairs.fold(0, |flags, (i, (word, at))| flags | u8::from(word != at) << i)
    }

    fn rotary_that_moves(&self, words: &AxisValues) -> Option<char> {
        let changed = self.changed(words);
        let mut axes = self.program.axes.iter().enumerate();
        let found = axes.find(|(i, axis)| axis.kind == AxisKind::Rotary && changed >> i & 1 == 1);
        found.map(|(_, axis)| axis.letter)
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
}

impl Tally {
    fn count(&mut self, i_block: usize, seconds: f64) {
        if self.n_blocks == 0 {
            self.first = i_block;
        }
        self.n_blocks += 1;
        self.seconds += seconds;
    }
}

fn positive(i_move: usize, what: &'static str, value: f64) -> Result<(), PostError> {
    let is_one = value.is_finite() && value > 0.0;
    if is_one { Ok(()) } else { Err(PostError::Pace { i_move, what, value }) }
}
