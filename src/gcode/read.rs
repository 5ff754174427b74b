//! From text to a program, as tolerant as controls are and no more.
//!
//! Any order and case of words, spaces, N numbers, both kinds of comments, `%`, block delete (read
//! as switched off: the line is carried out). Within a line things happen in the order of RS274/NGC:
//! modes, feed, tool, spindle, dwell, move, end. What is not understood is refused by name and place;
//! nothing is skipped in silence.

use super::line::{Line, Sorted};
use super::scan::Problem;
use super::{Block, BlockKind, LongestLine, Mode, Modes, Motion, MoveWords, Program, Spindle};
use crate::machine::{AxisKind, MAX_AXES, Machine};
use std::io::{BufRead, Read};

/// The longest line the reader takes; controls take 80 to 512.
const MAX_LINE: usize = 4096;
const MM_PER_INCH: f64 = 25.4;

/// Why a text is no program.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// Something in it is wrong, or not understood.
    #[error("line {line}, column {column}: {problem}")]
    Content {
        /// The line, counted from 1.
        line: u32,
        /// The column, counted from 1 in bytes.
        column: u32,
        /// What is wrong there.
        problem: Problem,
    },
    /// The text could not be read.
    #[error("the program cannot be read: {0}")]
    System(#[from] std::io::Error),
}

/// Reads a program for `machine`.
///
/// The state at its start is that of every control here: G21, G90, G94. Inches and increments are
/// turned into millimetres and absolute words. Reading stops at M2, M30 or the second `%`.
pub fn read(text: &mut dyn BufRead, machine: &Machine) -> Result<Program, ReadError> {
    read_program(text, Program::for_machine(machine))
}

/// Reads a line of modal words alone, as a dialect lists them.
pub(super) fn read_modes(text: &str) -> Result<Modes, (u32, Problem)> {
    let mut reader = Reader::new(Program::default());
    let mut line = Line::default();
    line.fill(text.as_bytes())?;
    reader.execute(&line, 1)?;
    match reader.program.blocks.as_slice() {
        [Block { kind: BlockKind::Modes(modes), .. }] => Ok(*modes),
        _ => Err((1, Problem::NotModal)),
    }
}

fn read_program(text: &mut dyn BufRead, program: Program) -> Result<Program, ReadError> {
    let mut reader = Reader::new(program);
    let mut bytes = Vec::new();
    let mut words = Line::default();
    for line in 1.. {
        bytes.clear();
        // Two more, so that a line of just the limit still brings its ending along.
        let limit = MAX_LINE as u64 + 2;
        if reader.ended || Read::take(&mut *text, limit).read_until(b'\n', &mut bytes)? == 0 {
            break;
        }
        let at_line = |(column, problem)| ReadError::Content { line, column, problem };
        while let [.., b'\n' | b'\r'] = bytes[..] {
            bytes.pop();
        }
        if bytes.len() > MAX_LINE {
            return Err(at_line((1, Problem::LineTooLong { limit: MAX_LINE })));
        }
        reader.measure(line, bytes.len());
        words.fill(&bytes).map_err(at_line)?;
        reader.execute(&words, line).map_err(at_line)?;
    }
    Ok(reader.program)
}

/// The state of a control as far as reading depends on it.
struct Reader {
    program: Program,
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
    ended: bool,
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

impl Reader {
    fn new(program: Program) -> Self {
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
            ended: false,
        }
    }

    fn measure(&mut self, line: u32, length: usize) {
        if self.program.longest_line.is_none_or(|longest| longest.length < length) {
            self.program.longest_line = Some(LongestLine { line, length });
        }
    }

    /// Carries out what a line says, in the order of RS274/NGC.
    fn execute(&mut self, line: &Line, number: u32) -> Result<(), (u32, Problem)> {
        let sorted = line.sorted()?;
        if line.percent {
            self.n_percent += 1;
            self.ended = self.n_percent == 2;
            self.push(number, BlockKind::Percent);
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
            self.ended = true;
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

#[cfg(test)]
mod tests {
    use super::super::{Address, SpindleRun};
    use super::*;

    fn lathe_program(text: &str) -> Result<Program, ReadError> {
        let axis = |letter, kind| Address { letter, kind };
        let axes = vec![
            axis('X', AxisKind::Linear),
            axis('Y', AxisKind::Linear),
            axis('A', AxisKind::Rotary),
        ];
        read_program(&mut text.as_bytes(), Program { axes, ..Program::default() })
    }

    fn complaint(text: &str) -> String {
        lathe_program(text).unwrap_err().to_string()
    }

    fn moves(text: &str) -> Vec<[Option<f64>; 4]> {
        let program = lathe_program(text).unwrap();
        let moves = program.blocks.iter().filter_map(|block| match &block.kind {
            BlockKind::Move(words) => {
                Some([words.axis(0), words.axis(1), words.axis(2), words.feed()])
            }
            _ => None,
        });
        moves.collect()
    }

    #[test]
    fn motion_is_modal_and_words_come_in_any_order() {
        let expected = [
            [Some(1.0), None, None, None],
            [None, Some(2.0), None, None],
            [Some(3.0), None, Some(90.0), Some(5.0)],
            [None, Some(-0.5), None, None],
        ];
        assert_eq!(moves("N1 x1 g0\n(up)y2\nF5A90X3G1 ; cut\n\n/Y-.5"), expected);
    }

    #[test]
    fn inches_and_increments_become_millimetres_and_positions() {
        let text = "G20 G0 X1 Y0 A10\nG91 G1 X0.5 A10 F2\nG90 X0\n";
        let expected = [
            [Some(25.4), Some(0.0), Some(10.0), None],
            [Some(25.4 + 12.7), None, Some(20.0), Some(50.8)],
            [Some(0.0), None, None, None],
        ];
        assert_eq!(moves(text), expected);
        let program = lathe_program(text).unwrap();
        let BlockKind::Modes(modes) = program.blocks[0].kind else { panic!("G20 comes first") };
        assert!(modes.contains(Mode::Millimetres));
    }

    #[test]
    fn a_line_happens_in_the_order_of_the_interpreter() {
        let program =
            lathe_program("M3 G1 X1 F10 T2 S500 M6 G21 (go)\nM30\nG2 is never read").unwrap();
        let kinds: Vec<_> = program.blocks.into_iter().map(|block| block.kind).collect();
        let spindle = Spindle { speed_rpm: Some(500.0), run: Some(SpindleRun::Clockwise) };
        let expected = [
            BlockKind::Comment("go".into()),
            BlockKind::Modes([Mode::Millimetres].into_iter().collect()),
            BlockKind::ToolChange(2),
            BlockKind::Spindle(spindle),
            BlockKind::Move(MoveWords::new(Motion::Feed).with_axis(0, 1.0).with_feed(10.0)),
            BlockKind::End,
        ];
        assert_eq!(kinds, expected);
    }

    #[test]
    fn reading_stops_at_the_second_percent_sign() {
        let program = lathe_program("%\nG0 X1\n%\nthe rest of the tape").unwrap();
        assert_eq!(program.blocks.len(), 3);
    }

    #[test]
    fn every_refusal_names_line_column_and_word() {
        for (text, message) in [
            ("G0 X1\nG2 X1 I2 J0", "line 2, column 1: G2 arcs are not read yet"),
            ("G0 X1\n X2 G43 H1", "line 2, column 5: G43 is not read yet"),
            ("G91.1", "line 1, column 1: G91.1 is not read yet"),
            ("M7", "line 1, column 1: M7 is not read yet"),
            ("G55", "line 1, column 1: G55 is not read yet"),
            ("G0 X1 X2", "line 1, column 7: the line has X twice"),
            ("G0 G1 X2 F1", "line 1, column 4: G1 contradicts G0"),
            ("G93 G94", "line 1, column 5: G94 contradicts G93"),
            ("M3 M5", "line 1, column 4: M5 contradicts M3"),
            ("G0 Z1", "line 1, column 4: the machine has no axis Z; it has X Y A"),
            ("G0 X1 Q1", "line 1, column 7: Q is not read yet"),
            ("X1", "line 1, column 1: axis words, but neither G0 nor G1"),
            ("G0 X1\nG80\nX2", "line 3, column 1: axis words, but neither G0 nor G1"),
            ("G93\nG1 X1 F1\nX2", "line 3, column 1: F word missing with inverse time G1"),
            ("G1 X1", "line 1, column 1: G1 with zero feed rate"),
            ("G1 X1 F1\nG93\nG94\nX2", "line 4, column 1: G1 with zero feed rate"),
            ("G1 X1 F0", "line 1, column 7: F0 is out of range: it must be greater than 0"),
            ("G93 F3", "line 1, column 5: F under G93"),
            ("G4", "line 1, column 1: G4 without P"),
            ("P3", "line 1, column 1: P"),
            ("G4 P-1", "line 1, column 4: P-1 is out of range"),
            ("G1 F5\nG4 P1 X3", "line 2, column 7: G4 and axis words"),
            ("M6", "line 1, column 1: M6 without a tool"),
            ("T1.5", "line 1, column 1: T1.5 is out of range"),
            ("S-5 M3", "line 1, column 1: S-5 is out of range"),
            ("G91 G0 X1", "line 1, column 8: an increment (G91) of X"),
            ("G0 X#1", "line 1, column 4: parameters and expressions"),
            ("G0 (x", "line 1, column 4: this comment is not closed"),
        ] {
            let complaint = complaint(text);
            assert!(complaint.starts_with(message), "{text:?} gave {complaint:?}");
        }
    }

    #[test]
    fn a_line_without_end_is_refused_before_it_fills_memory() {
        let text = "(".to_owned() + &"x".repeat(1_000_000);
        assert!(complaint(&text).starts_with("line 1, column 1: the line is longer than 4096"));
    }

    #[test]
    fn the_longest_line_is_remembered() {
        let program = lathe_program("G0 X1\r\n(longest)\r\nX1\r\n").unwrap();
        assert_eq!(program.longest_line, Some(LongestLine { line: 2, length: 9 }));
    }
}
