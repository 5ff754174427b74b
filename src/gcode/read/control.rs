//! A control, as far as reading depends on it: what a line means in the light of those before.

use crate::gcode::line::{Line, Sorted};
use crate::gcode::scan::Problem;
use crate::gcode::{Block, BlockKind, LongestLine, Mode, Motion, MoveWords, Program, Spindle};
use crate::machine::{AxisKind, MAX_AXES};

const MM_PER_INCH: f64 = 25.4;

/// The state of a control as far as reading depends on it.
pub(super) struct Control {
    pub(super) program: Program,
    /// Index of the axis a letter stands for, A first.
    axis_of: [Option<usize>; 26],
    motion: Option<Motion>,
    feed: FeedState,
    /// Millimetres per unit of a linear word.
    unit: f64,
    incremental: bool,
    tool: Option<u32>,
    at: [Option<f64>; MAX_AXES],
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

impl Control {
    pub(super) fn new(program: Program) -> Self {
        let mut axis_of = [None; 26];
        for (i_axis, axis) in program.axes.iter().enumerate() {
            if axis.letter.is_ascii_uppercase() {
                axis_of[usize::from(axis.letter as u8 - b'A')] = Some(i_axis);
            }
        }
        Self {
            program,
            axis_of,
            motion: None,
            feed: FeedState::Missing,
            unit: 1.0,
            incremental: false,
            tool: None,
            at: [None; MAX_AXES],
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
        if bytes.trim_ascii() == b"%" {
            self.push(line, BlockKind::Percent);
            self.stage = Stage::Done;
        }
    }

    /// Carries out what a line says, in the order of RS274/NGC.
    pub(super) fn execute(&mut self, line: &Line, number: u32) -> Result<(), (u32, Problem)> {
        let sorted = line.sorted()?;
        if line.percent {
            self.n_percent += 1;
            self.push(number, BlockKind::Percent);
            if self.n_percent == 2 {
                self.stage = Stage::Done;
            }
        }
        for text in &line.comments {
            self.push(number, BlockKind::Comment(text.clone()));
        }
        self.set_modes(&sorted, number);
        let words = self.move_words(line, &sorted)?;
        let feed = self.feed(line, words.is_some())?;
        let is_fed = words.is_some_and(|words| words.motion == Motion::Feed);
        if let Some(feed) = feed.filter(|_| !is_fed) {
            self.push(number, BlockKind::Feed(feed));
        }
        self.set_tool(line, &sorted, number)?;
        self.set_spindle(line, &sorted, number)?;
        self.dwell(line, &sorted, number)?;
        if let Some(words) = words {
            let words = feed.filter(|_| is_fed).map_or(words, |feed| words.with_feed(feed));
            self.push(number, BlockKind::Move(words));
        }
        if sorted.ends {
            self.push(number, BlockKind::End);
            self.stage = if self.n_percent == 1 { Stage::AwaitsPercent } else { Stage::Done };
        }
        Ok(())
    }

    fn push(&mut self, line: u32, kind: BlockKind) {
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

    /// The move of a line: its axis words in millimetres and degrees, absolute.
    fn move_words(
        &mut self,
        line: &Line,
        sorted: &Sorted,
    ) -> Result<Option<MoveWords>, (u32, Problem)> {
        let mut found = None;
        for (letter, word, column) in line.others() {
            let Some(i_axis) = self.axis_of[usize::from(letter - b'A')] else {
                return Err((column, self.unknown(letter)));
            };
            let motion = self.motion.ok_or((column, Problem::NoMotion))?;
            if sorted.dwells.is_some() {
                return Err((column, Problem::DwellMoves));
            }
            let axis = self.program.axes[i_axis];
            let scale = if axis.kind == AxisKind::Linear { self.unit } else { 1.0 };
            let start = if self.incremental {
                let letter = axis.letter;
                self.at[i_axis].ok_or((column, Problem::UnknownStart { letter }))?
            } else {
                0.0
            };
            let to = start + word * scale;
            self.at[i_axis] = Some(to);
            let words = found.unwrap_or_else(|| MoveWords::new(motion));
            found = Some(words.with_axis(i_axis, to));
        }
        if found.is_some_and(|words: MoveWords| words.motion == Motion::Feed) {
            self.needs_feed(line)?;
        }
        Ok(found)
    }

    fn needs_feed(&self, line: &Line) -> Result<(), (u32, Problem)> {
        match (self.feed, line.word(b'F')) {
            (FeedState::PerBlock, None) => Err((1, Problem::NoInverseTimeFeed)),
            (FeedState::Missing, None) => Err((1, Problem::NoFeed)),
            _ => Ok(()),
        }
    }

    /// The F word of a line in millimetres; under inverse time it needs a move to belong to.
    fn feed(&mut self, line: &Line, moves: bool) -> Result<Option<f64>, (u32, Problem)> {
        let Some((feed, column)) = line.word(b'F') else { return Ok(None) };
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
        if let Some((value, column)) = line.word(b'T') {
            if value.fract() != 0.0 || !(0.0..=f64::from(u32::MAX)).contains(&value) {
                let bound = "a whole number, not below 0";
                return Err((column, Problem::Range { letter: 'T', value, bound }));
            }
            self.tool = Some(value as u32);
        }
        if let Some(column) = sorted.changes_tool {
            let tool = self.tool.ok_or((column, Problem::NoTool))?;
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
        match (sorted.dwells, line.word(b'P')) {
            (None, None) => Ok(()),
            (None, Some((_, column))) => Err((column, Problem::StrayTime)),
            (Some(column), None) => Err((column, Problem::NoDwellTime)),
            (Some(_), Some((value, column))) if value < 0.0 => {
                Err((column, Problem::Range { letter: 'P', value, bound: "not below 0" }))
            }
            (Some(_), Some((seconds, _))) => {
                self.push(number, BlockKind::Dwell(seconds));
                Ok(())
            }
        }
    }

    fn unknown(&self, letter: u8) -> Problem {
        let letter = char::from(letter);
        if "XYZABCUVW".contains(letter) {
            let letters: Vec<_> =
                self.program.axes.iter().map(|axis| axis.letter.to_string()).collect();
            Problem::NoSuchAxis { letter, axes: letters.join(" ") }
        } else {
            let known = "F G M N P S T and the axes of the machine";
            Problem::Unknown { word: letter.to_string(), known }
        }
    }
}
