//! A control, as far as reading depends on it: what a line means in the light of those before.

mod axes;

use crate::gcode::line::{Line, Sorted};
use crate::gcode::number::round_to;
use crate::gcode::{
    Block, BlockKind, Dialect, DwellWord, Language, LongestLine, Mode, Motion, Problem, Program,
    Rotary, Spindle, Tape, ToolChange,
};
use crate::machine::MAX_AXES;

const MM_PER_INCH: f64 = 25.4;

/// As many as a dialect can ask for, in milliseconds.
const DWELL_DECIMALS: u8 = 12;

/// The state of a control as far as reading depends on it.
pub(super) struct Control<'a> {
    pub(super) program: Program,
    dialect: &'a Dialect,
    /// Index of the axis a letter stands for, A first.
    axis_of: [Option<usize>; 26],
    motion: Option<Motion>,
    feed: FeedState,
    /// Millimetres per unit of a linear word.
    unit: f64,
    incremental: bool,
    tool: Option<u32>,
    /// Where the axes stand, angles counted on [mm or deg].
    at: [Option<f64>; MAX_AXES],
    /// How many turns G92 has taken off each.
    turns: [i32; MAX_AXES],
    n_percent: u32,
    pub(super) stage: Stage,
}

/// How far reading is.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Stage {
    Runs,
    /// Behind M2 or M30, on a tape that a `%` has begun.
    AwaitsPercent,
    Done,
}

/// What a feed move can count on.
#[derive(Clone, Copy, PartialEq)]
enum FeedState {
    /// G94, but no F since.
    Missing,
    /// G94 and an F.
    Given,
    /// G93: each block has its own.
    PerBlock,
}

impl<'a> Control<'a> {
    pub(super) fn new(program: Program, dialect: &'a Dialect) -> Self {
        let mut axis_of = [None; 26];
        for (i_axis, axis) in program.axes.iter().enumerate() {
            let letter = dialect.letter(axis.letter);
            if letter.is_ascii_uppercase() {
                axis_of[usize::from(letter as u8 - b'A')] = Some(i_axis);
            }
        }
        Self {
            program,
            dialect,
            axis_of,
            motion: None,
            feed: FeedState::Missing,
            unit: 1.0,
            incremental: false,
            tool: None,
            at: [None; MAX_AXES],
            turns: [0; MAX_AXES],
            n_percent: 0,
            stage: Stage::Runs,
        }
    }

    pub(super) fn measure(&mut self, line: u32, length: usize) {
        if self.program.longest_line.is_none_or(|longest| longest.length < length) {
            self.program.longest_line = Some(LongestLine { line, length });
        }
    }

    /// Behind the end of the program only the end of the tape means anything.
    pub(super) fn await_percent(&mut self, bytes: &[u8], line: u32) {
        let ends = match self.dialect.language {
            Language::Klartext => {
                bytes.windows(7).any(|part| part.eq_ignore_ascii_case(b"END PGM"))
            }
            _ => bytes.trim_ascii() == b"%",
        };
        if ends {
            self.push(line, BlockKind::Percent);
            self.stage = Stage::Done;
        }
    }

    /// Carries out what a line says, in the order of RS274/NGC.
    pub(super) fn execute(&mut self, line: &Line, number: u32) -> Result<(), (u32, Problem)> {
        let sorted = line.sorted(self.dialect.millimetres)?;
        if line.percent {
            self.n_percent += 1;
            self.push(number, BlockKind::Percent);
            // The one mark of Klartext stands at the end.
            if self.n_percent == 2 || self.dialect.tape == Tape::Pgm {
                self.stage = Stage::Done;
            }
        }
        self.set_number(line, number)?;
        for text in &line.comments {
            self.push(number, BlockKind::Comment(text.clone()));
        }
        self.set_modes(&sorted, number);
        let words = self.move_words(line, &sorted)?;
        let feed = self.feed(line, words.is_some(), sorted.dwells.is_some())?;
        let is_fed = words.is_some_and(|words| words.motion == Motion::Feed);
        if let Some(feed) = feed.filter(|_| !is_fed) {
            self.push(number, BlockKind::Feed(feed));
        }
        self.set_tool(line, &sorted, number)?;
        self.set_spindle(line, &sorted, number)?;
        if let Some(coolant) = sorted.coolant {
            self.push(number, BlockKind::Coolant(coolant));
        }
        self.dwell(line, &sorted, number)?;
        self.rezero(line, &sorted, number)?;
        if let Some(words) = words {
            let words = feed.filter(|_| is_fed).map_or(words, |feed| words.with_feed(feed));
            self.push(number, BlockKind::Move(words));
        }
        if sorted.ends {
            self.push(number, BlockKind::End);
            let goes_on = self.n_percent == 1 || self.dialect.tape == Tape::Pgm;
            self.stage = if goes_on { Stage::AwaitsPercent } else { Stage::Done };
        }
        Ok(())
    }

    pub(super) fn push(&mut self, line: u32, kind: BlockKind) {
        self.program.blocks.push(Block { line, kind });
    }

    fn set_modes(&mut self, sorted: &Sorted, number: u32) {
        if let Some(inches) = sorted.inches {
            self.unit = if inches { MM_PER_INCH } else { 1.0 };
        }
        self.incremental = sorted.increments.unwrap_or(self.incremental);
        if sorted.modes.contains(Mode::NoCycle) {
            self.motion = None;
        }
        self.motion = sorted.motion.or(self.motion);
        if sorted.modes.contains(Mode::InverseTime) {
            self.feed = FeedState::PerBlock;
        } else if sorted.modes.contains(Mode::PerMinute) && self.feed == FeedState::PerBlock {
            self.feed = FeedState::Missing;
        }
        if !sorted.modes.is_empty() {
            self.push(number, BlockKind::Modes(sorted.modes));
        }
    }

    fn names_programs(&self) -> bool {
        matches!(self.dialect.tape, Tape::PercentNumber | Tape::Pgm)
    }

    fn set_number(&mut self, line: &Line, number: u32) -> Result<(), (u32, Problem)> {
        if let Some(name) = line.word(b'O').filter(|_| self.names_programs()) {
            let name = whole('O', name)?;
            self.push(number, BlockKind::Number(name));
        }
        Ok(())
    }

    fn needs_feed(&self, line: &Line) -> Result<(), (u32, Problem)> {
        match (self.feed, line.word(b'F')) {
            (FeedState::PerBlock, None) => Err((1, Problem::NoInverseTimeFeed)),
            (FeedState::Missing, None) => Err((1, Problem::NoFeed)),
            _ => Ok(()),
        }
    }

    /// The F word of a line in millimetres; under inverse time it needs a move to belong to.
    fn feed(
        &mut self,
        line: &Line,
        moves: bool,
        pauses: bool,
    ) -> Result<Option<f64>, (u32, Problem)> {
        let Some((feed, column)) = line.word(b'F') else { return Ok(None) };
        if pauses && self.dialect.dwell.word == DwellWord::FSeconds {
            return Ok(None);
        }
        if feed <= 0.0 {
            let bound = "greater than 0";
            return Err((column, Problem::Range { letter: 'F', value: feed, bound }));
        }
        if self.feed == FeedState::PerBlock {
            let belongs = moves && self.motion == Some(Motion::Feed);
            return if belongs { Ok(Some(feed)) } else { Err((column, Problem::StrayFeed)) };
        }
        self.feed = FeedState::Given;
        Ok(Some(feed * self.unit))
    }

    fn set_tool(
        &mut self,
        line: &Line,
        sorted: &Sorted,
        number: u32,
    ) -> Result<(), (u32, Problem)> {
        if let Some(tool) = line.word(b'T') {
            self.tool = Some(whole('T', tool)?);
        }
        if let Some(column) = sorted.stops {
            let by_hand = self.dialect.tool_change == ToolChange::ByHand;
            if !by_hand || line.word(b'T').is_none() {
                return Err((column, Problem::Stop { word: "M0" }));
            }
        }
        if let Some(column) = sorted.changes_tool.or(sorted.stops) {
            let tool = self.tool.ok_or((column, Problem::NoTool))?;
            // It may move the machine anywhere; an angle is then called as the control counts it.
            if matches!(self.dialect.rotary, Rotary::Modulo | Rotary::Increments) {
                self.at = [None; MAX_AXES];
            }
            self.push(number, BlockKind::ToolChange(tool));
        }
        Ok(())
    }

    fn set_spindle(
        &mut self,
        line: &Line,
        sorted: &Sorted,
        number: u32,
    ) -> Result<(), (u32, Problem)> {
        let speed = line.word(b'S');
        if let Some((value, column)) = speed.filter(|(value, _)| *value < 0.0) {
            let bound = "not below 0; M4 turns the other way";
            return Err((column, Problem::Range { letter: 'S', value, bound }));
        }
        if speed.is_some() || sorted.run.is_some() {
            let speed_rpm = speed.map(|(value, _)| value);
            self.push(number, BlockKind::Spindle(Spindle { speed_rpm, run: sorted.run }));
        }
        Ok(())
    }

    fn dwell(&mut self, line: &Line, sorted: &Sorted, number: u32) -> Result<(), (u32, Problem)> {
        let (letter, unit) = match self.dialect.dwell.word {
            DwellWord::PSeconds | DwellWord::Cycle9 => (b'P', 1.0),
            DwellWord::PMilliseconds => (b'P', 1e-3),
            DwellWord::XSeconds => (b'X', 1.0),
            DwellWord::FSeconds => (b'F', 1.0),
        };
        let Some(column) = sorted.dwells else {
            return line.word(b'P').map_or(Ok(()), |(_, column)| Err((column, Problem::StrayTime)));
        };
        let letter_name = char::from(letter);
        let missing = (column, Problem::NoDwellTime { letter: letter_name });
        let (value, column) = line.word(letter).ok_or(missing)?;
        if value < 0.0 {
            let bound = "not below 0";
            return Err((column, Problem::Range { letter: letter_name, value, bound }));
        }
        // Thousandths are decimals too.
        self.push(number, BlockKind::Dwell(round_to(value * unit, DWELL_DECIMALS)));
        Ok(())
    }
}

fn whole(letter: char, (value, column): (f64, u32)) -> Result<u32, (u32, Problem)> {
    if value.fract() != 0.0 || !(0.0..=f64::from(u32::MAX)).contains(&value) {
        let bound = "a whole number, not below 0";
        return Err((column, Problem::Range { letter, value, bound }));
    }
    Ok(value as u32)
}
