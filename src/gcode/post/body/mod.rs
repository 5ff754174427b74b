//! The moves of a program, one by one.
//!
//! Rounding must neither bend the path nor its time. Words are rounded once, from the exact target,
//! so errors never add up. A timed move too small to change a word hands its time on to the next.
//! Where rounding makes a way longer, or the control cannot be as slow as asked, F says what really
//! happens: the program's time is that of the machine.

mod pace;
mod turning;

use super::{PostError, PostWarning};
use crate::cam::{Move, Pace, Toolpath};
use crate::gcode::check::is_outside;
use crate::gcode::number::{floor_to, round_to};
use crate::gcode::write::decimals;
use crate::gcode::{
    BlockKind, Coolant, Dialect, DwellWord, Language, Mode, Motion, MoveWords, Program, Spindle,
    SpindleRun,
};
use crate::machine::{AxisValues, MAX_AXES, Machine};

/// A speed may be beyond its limit by this part of it: the noise of a scheduler that clips exactly.
const VELOCITY_TOLERANCE: f64 = 1e-9;

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
