//! From a program to text: a line per block, but where a control wants two.
//!
//! A [`Program`] counts its angles on over as many turns as there are; how they are called in the
//! text, and whether a word is a position or a way, is decided here.

mod comment;
mod iso;
mod klartext;

use super::number::{push_fixed, round_to};
use super::{BlockKind, Dialect, DwellWord, Language, MoveWords, Program, Rotary, Tape};
use crate::machine::{AxisKind, MAX_AXES};
use std::io::Write;

pub(super) use comment::comment_lines;

/// Text is handed on in pieces of about this size.
const CHUNK: usize = 1 << 16;

/// Decimals of a tolerance [mm].
const TOLERANCE_DECIMALS: u8 = 4;

/// Writes `program` as `dialect` wants it.
pub fn write(program: &Program, dialect: &Dialect, out: &mut dyn Write) -> std::io::Result<()> {
    let mut writer = Writer::new(program, dialect);
    let mut text = Vec::with_capacity(CHUNK + 1024);
    for block in &program.blocks {
        writer.push(&mut text, &block.kind);
        if text.len() >= CHUNK {
            out.write_all(&text)?;
            text.clear();
        }
    }
    out.write_all(&text)
}

/// How many lines a block takes.
pub(super) fn n_lines(kind: &BlockKind, dialect: &Dialect) -> u32 {
    match kind {
        BlockKind::Smoothing(tolerance) => smoothing_lines(*tolerance, dialect).len() as u32,
        BlockKind::Dwell(_) if dialect.dwell.word == DwellWord::Cycle9 => 2,
        BlockKind::Spindle(spindle) if dialect.language == Language::Klartext => {
            u32::from(spindle.speed_rpm.is_some()) + u32::from(spindle.run.is_some())
        }
        _ => 1,
    }
}

/// An upper bound on the length of a line that holds a move of `program`.
pub(super) fn longest_move(program: &Program, greatest_words: &[f64], dialect: &Dialect) -> usize {
    let digits_before_point = |word: &f64| word.abs().max(1.0).log10() as usize + 1;
    let words = program.axes.iter().zip(greatest_words).map(|(axis, word)| {
        let decimals = usize::from(decimals(axis.kind, dialect));
        // Blank, letter, sign, point; what stands around an angle.
        let around = if dialect.language == Language::Iso { 4 } else { 9 };
        around + digits_before_point(word) + decimals
    });
    let number = dialect.block_numbers.map_or(0, |numbers| numbers.last.to_string().len() + 2);
    // G1 and an F word of any size.
    number + 2 + words.sum::<usize>() + 4 + 20
}

/// Decimals of an axis' words.
pub(super) fn decimals(kind: AxisKind, dialect: &Dialect) -> u8 {
    match kind {
        AxisKind::Linear => dialect.decimals.linear,
        AxisKind::Rotary => dialect.decimals.rotary,
    }
}

/// A program on its way into text.
pub(super) struct Writer<'a> {
    program: &'a Program,
    dialect: &'a Dialect,
    /// The number of the last line.
    number: Option<u32>,
    /// What the program is called.
    name: u32,
    /// Where the axes stand, as far as the text has said so [mm or deg].
    at: [Option<f64>; MAX_AXES],
    /// How many turns have been taken off what the position of each axis is called.
    turns: [i32; MAX_AXES],
    /// The lines of a block.
    lines: Vec<u8>,
}

/// A word of an axis as it stands in the text.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Word {
    /// A position.
    To(f64),
    /// An angle from 0 to 360, by the shorter way.
    Shorter(f64),
    /// A way to go on by.
    By(f64),
}

impl<'a> Writer<'a> {
    /// A writer at the start of `program`.
    pub(super) fn new(program: &'a Program, dialect: &'a Dialect) -> Self {
        Self {
            program,
            dialect,
            number: None,
            name: 1,
            at: [None; MAX_AXES],
            turns: [0; MAX_AXES],
            lines: Vec::new(),
        }
    }

    /// Appends the lines of one block.
    pub(super) fn push(&mut self, text: &mut Vec<u8>, kind: &BlockKind) {
        let mut lines = std::mem::take(&mut self.lines);
        lines.clear();
        match kind {
            BlockKind::Comment(comment) => {
                comment::push_comment(&mut lines, comment, self.dialect.comment);
            }
            BlockKind::Setup(setup) => lines.extend_from_slice(setup.as_bytes()),
            BlockKind::Smoothing(tolerance) => push_smoothing(&mut lines, *tolerance, self.dialect),
            kind if self.dialect.language == Language::Klartext => {
                self.push_klartext(&mut lines, kind);
            }
            kind => self.push_iso(&mut lines, kind),
        }
        let klartext = self.dialect.language == Language::Klartext;
        let is_tape = matches!(kind, BlockKind::Percent | BlockKind::Number(_)) && !klartext;
        for line in lines.split(|&byte| byte == b'\n').filter(|line| !line.is_empty()) {
            if !is_tape {
                self.push_number(text);
            }
            text.extend_from_slice(line);
            text.push(b'\n');
        }
        self.lines = lines;
        self.follow(kind);
    }

    fn push_number(&mut self, text: &mut Vec<u8>) {
        let Some(numbering) = self.dialect.block_numbers else { return };
        let klartext = self.dialect.language == Language::Klartext;
        let first = if klartext { 0 } else { numbering.step };
        let next = self.number.and_then(|number| number.checked_add(numbering.step));
        let number = next.filter(|&number| number <= numbering.last).unwrap_or(first);
        self.number = Some(number);
        let letter = if klartext { "" } else { "N" };
        text.extend_from_slice(format!("{letter}{number} ").as_bytes());
    }

    /// Keeps track of what the text has said so far.
    fn follow(&mut self, kind: &BlockKind) {
        match kind {
            BlockKind::Move(words) => {
                for (i_axis, at) in self.at.iter_mut().enumerate() {
                    *at = words.axis(i_axis).or(*at);
                }
            }
            BlockKind::Rezero { i_axis, turns } => self.turns[*i_axis] += turns,
            // It may have moved the machine anywhere.
            BlockKind::ToolChange(_) => self.at = [None; MAX_AXES],
            BlockKind::Number(number) => self.name = *number,
            _ => {}
        }
    }

    /// The words of a move: index of the axis, and its word.
    fn words(&self, words: &MoveWords) -> impl Iterator<Item = (usize, Word)> + use<'_> {
        let words = *words;
        let named = (0..self.program.axes.len()).filter_map(move |i| Some((i, words.axis(i)?)));
        named.map(|(i_axis, word)| (i_axis, self.word(i_axis, word)))
    }

    fn word(&self, i_axis: usize, word: f64) -> Word {
        if self.program.axes[i_axis].kind == AxisKind::Linear {
            return Word::To(word);
        }
        match self.dialect.rotary {
            Rotary::None | Rotary::Unwound | Rotary::Rezero { .. } => {
                Word::To(word - 360.0 * f64::from(self.turns[i_axis]))
            }
            Rotary::Modulo => {
                let reduced = round_to(word.rem_euclid(360.0), self.dialect.decimals.rotary);
                Word::Shorter(if reduced >= 360.0 { 0.0 } else { reduced })
            }
            Rotary::Increments => self.at[i_axis].map_or(Word::To(word), |at| Word::By(word - at)),
        }
    }

    /// What the control calls an axis, and the decimals of its words.
    fn address(&self, i_axis: usize) -> (u8, u8) {
        let axis = self.program.axes[i_axis];
        (self.dialect.letter(axis.letter) as u8, decimals(axis.kind, self.dialect))
    }
}

/// The lines that switch smoothing on or off.
fn smoothing_lines(tolerance: Option<f64>, dialect: &Dialect) -> &[String] {
    let smoothing = dialect.smoothing.as_ref();
    smoothing.map_or(&[], |lines| if tolerance.is_some() { &lines.on } else { &lines.off })
}

fn push_smoothing(text: &mut Vec<u8>, tolerance: Option<f64>, dialect: &Dialect) {
    for line in smoothing_lines(tolerance, dialect) {
        let (before, after) = line.split_once("{}").unwrap_or((line, ""));
        text.extend_from_slice(before.as_bytes());
        if let Some(tolerance) = tolerance.filter(|_| line.contains("{}")) {
            push_fixed(text, tolerance, TOLERANCE_DECIMALS);
        }
        text.extend_from_slice(after.as_bytes());
        text.push(b'\n');
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gcode::{
        Address, CommentStyle, EndWord, Mode, Motion, Numbering, Spindle, SpindleRun,
    };

    fn example() -> Program {
        let axes = vec![
            Address { letter: 'X', kind: AxisKind::Linear },
            Address { letter: 'A', kind: AxisKind::Rotary },
        ];
        let mut program = Program { axes, ..Program::default() };
        program.push(BlockKind::Percent);
        program.push(BlockKind::Comment("a (b)".into()));
        program.push(BlockKind::Modes([Mode::Millimetres, Mode::Absolute].into_iter().collect()));
        program.push(BlockKind::ToolChange(3));
        let run = Some(SpindleRun::Clockwise);
        program.push(BlockKind::Spindle(Spindle { speed_rpm: Some(6000.0), run }));
        let words = MoveWords::new(Motion::Feed).with_axis(0, -0.000_01).with_axis(1, 370.25);
        program.push(BlockKind::Move(words.with_feed(1234.5)));
        program.push(BlockKind::Dwell(0.5));
        program.push(BlockKind::Spindle(Spindle { speed_rpm: None, run: Some(SpindleRun::Stop) }));
        program.push(BlockKind::End);
        program
    }

    fn text(program: &Program, dialect: &Dialect) -> String {
        let mut out = Vec::new();
        write(program, dialect, &mut out).unwrap();
        String::from_utf8(out).unwrap()
    }

    #[test]
    fn a_program_is_written_a_line_per_block() {
        let written = text(&example(), &Dialect::named("linuxcnc").unwrap());
        let expected = "%\n(a [b])\nG21 G90\nT3 M6\nS6000.0 M3\nG1 X0.0 A370.25 F1234.5\n\
                        G4 P0.5\nM5\nM30\n";
        assert_eq!(written, expected);
    }

    #[test]
    fn another_dialect_is_only_data() {
        let mut dialect = Dialect::named("linuxcnc").unwrap();
        dialect.comment = CommentStyle::Semicolon;
        dialect.block_numbers = Some(Numbering { step: 10, last: 30 });
        dialect.end = EndWord::M2;
        let expected = "%\nN10 ; a [b]\nN20 G21 G90\nN30 T3 M6\nN10 S6000.0 M3\n\
                        N20 G1 X0.0 A370.25 F1234.5\nN30 G4 P0.5\nN10 M5\nN20 M2\n";
        assert_eq!(text(&example(), &dialect), expected);
    }

    #[test]
    fn angles_are_called_as_the_dialect_calls_them() {
        let axes = vec![Address { letter: 'A', kind: AxisKind::Rotary }];
        let mut program = Program { axes, ..Program::default() };
        for word in [0.0, -120.5, 239.75, 719.999_99] {
            program.push(BlockKind::Move(MoveWords::new(Motion::Rapid).with_axis(0, word)));
        }
        program.push(BlockKind::Rezero { i_axis: 0, turns: 2 });
        program.push(BlockKind::Move(MoveWords::new(Motion::Rapid).with_axis(0, 721.0)));
        assert_eq!(
            words_of(&program, Rotary::Rezero { turns: 2 }, "linuxcnc"),
            "G0 A0.0\nG0 A-120.5\nG0 A239.75\nG0 A720.0\nG92 A0.0\nG0 A1.0\n"
        );
        program.blocks.remove(4);
        let modulo = words_of(&program, Rotary::Modulo, "fanuc");
        assert_eq!(modulo, "G0 A0.0\nG0 A239.5\nG0 A239.75\nG0 A0.0\nG0 A1.0\n");
        let increments = words_of(&program, Rotary::Increments, "heidenhain");
        assert!(increments.contains("L IA+360.25 FMAX\n"), "{increments}");
    }

    fn words_of(program: &Program, rotary: Rotary, name: &str) -> String {
        text(program, &Dialect { rotary, ..Dialect::named(name).unwrap() })
    }
}
