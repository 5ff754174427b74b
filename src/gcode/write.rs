//! From a program to text: one line per block.

use super::number::{push_digits, push_fixed};
use super::{
    BlockKind, CommentStyle, Dialect, EndWord, Motion, MoveWords, Program, Spindle, SpindleRun,
};
use crate::machine::AxisKind;
use std::io::Write;

/// Text is handed on in pieces of about this size.
const CHUNK: usize = 1 << 16;

/// Decimals of S words [rpm].
pub(super) const SPEED_DECIMALS: u8 = 1;

/// Writes `program` as `dialect` wants it.
pub fn write(program: &Program, dialect: &Dialect, out: &mut dyn Write) -> std::io::Result<()> {
    let mut text = Vec::with_capacity(CHUNK + 1024);
    let mut number = 0;
    for block in &program.blocks {
        if let Some(numbering) = dialect.block_numbers
            && !matches!(block.kind, BlockKind::Percent)
        {
            number = if number + numbering.step > numbering.last { 0 } else { number };
            number += numbering.step;
            text.extend_from_slice(format!("N{number} ").as_bytes());
        }
        push_block(&mut text, program, &block.kind, dialect);
        text.push(b'\n');
        if text.len() >= CHUNK {
            out.write_all(&text)?;
            text.clear();
        }
    }
    out.write_all(&text)
}

/// The comment `text` as lines that fit the dialect, in characters every control takes.
pub(super) fn comment_lines(text: &str, dialect: &Dialect) -> Vec<Box<str>> {
    let plain: String = text.chars().map(plain_char).collect();
    // Leaves room for the marks around it and for a block number.
    let room = dialect.line_length.saturating_sub(16).max(16);
    let mut lines = Vec::new();
    let mut rest = plain.trim();
    while rest.len() > room {
        let cut = rest[..room].rfind(' ').filter(|&cut| cut > 0).unwrap_or(room);
        lines.push(rest[..cut].trim_end().into());
        rest = rest[cut..].trim_start();
    }
    lines.push(rest.into());
    lines
}

/// An upper bound on the length of a line that holds a move of `program`.
pub(super) fn longest_move(program: &Program, greatest_words: &[f64], dialect: &Dialect) -> usize {
    let digits_before_point = |word: &f64| word.abs().max(1.0).log10() as usize + 1;
    let words = program.axes.iter().zip(greatest_words).map(|(axis, word)| {
        let decimals = usize::from(decimals(axis.kind, dialect));
        // Blank, letter, sign, point.
        4 + digits_before_point(word) + decimals
    });
    let number = dialect.block_numbers.map_or(0, |numbers| numbers.last.to_string().len() + 2);
    // G1 and an F word of any size.
    number + 2 + words.sum::<usize>() + 4 + 20
}

fn plain_char(c: char) -> char {
    match c {
        '(' => '[',
        ')' => ']',
        ' '..='~' => c,
        c if c.is_whitespace() => ' ',
        _ => '?',
    }
}

fn push_block(text: &mut Vec<u8>, program: &Program, kind: &BlockKind, dialect: &Dialect) {
    match kind {
        BlockKind::Comment(comment) => push_comment(text, comment, dialect.comment),
        BlockKind::Modes(modes) => {
            for (i, mode) in modes.iter().enumerate() {
                text.extend_from_slice(if i == 0 { b"" } else { b" " });
                text.extend_from_slice(mode.word().as_bytes());
            }
        }
        BlockKind::ToolChange(tool) => text.extend_from_slice(format!("T{tool} M6").as_bytes()),
        BlockKind::Spindle(spindle) => push_spindle(text, spindle),
        BlockKind::Feed(feed) => push_feed(text, *feed, dialect),
        BlockKind::Dwell(seconds) => {
            text.extend_from_slice(b"G4 P");
            push_digits(text, *seconds, dialect.feed.digits);
        }
        BlockKind::Move(words) => push_move(text, program, words, dialect),
        BlockKind::Percent => text.push(b'%'),
        BlockKind::End => text.extend_from_slice(match dialect.end {
            EndWord::M2 => b"M2",
            EndWord::M30 => b"M30",
        }),
    }
}

fn push_comment(text: &mut Vec<u8>, comment: &str, style: CommentStyle) {
    let plain = comment.chars().map(plain_char).map(|c| c as u8);
    match style {
        CommentStyle::Parentheses => {
            text.push(b'(');
            text.extend(plain);
            text.push(b')');
        }
        CommentStyle::Semicolon => {
            text.extend_from_slice(b"; ");
            text.extend(plain);
        }
    }
}

fn push_spindle(text: &mut Vec<u8>, spindle: &Spindle) {
    if let Some(speed) = spindle.speed_rpm {
        text.push(b'S');
        push_fixed(text, speed, SPEED_DECIMALS);
    }
    if let Some(run) = spindle.run {
        text.extend_from_slice(if spindle.speed_rpm.is_some() { b" " } else { b"" });
        text.extend_from_slice(match run {
            SpindleRun::Clockwise => b"M3",
            SpindleRun::CounterClockwise => b"M4",
            SpindleRun::Stop => b"M5",
        });
    }
}

fn push_move(text: &mut Vec<u8>, program: &Program, words: &MoveWords, dialect: &Dialect) {
    text.extend_from_slice(match words.motion {
        Motion::Rapid => b"G0",
        Motion::Feed => b"G1",
    });
    for (i_axis, axis) in program.axes.iter().enumerate() {
        if let Some(word) = words.axis(i_axis) {
            text.extend_from_slice(&[b' ', axis.letter as u8]);
            push_fixed(text, word, decimals(axis.kind, dialect));
        }
    }
    if let Some(feed) = words.feed() {
        text.push(b' ');
        push_feed(text, feed, dialect);
    }
}

fn push_feed(text: &mut Vec<u8>, feed: f64, dialect: &Dialect) {
    text.push(b'F');
    push_digits(text, feed, dialect.feed.digits);
}

/// Decimals of an axis' words.
pub(super) fn decimals(kind: AxisKind, dialect: &Dialect) -> u8 {
    match kind {
        AxisKind::Linear => dialect.decimals.linear,
        AxisKind::Rotary => dialect.decimals.rotary,
    }
}

#[cfg(test)]
mod tests {
    use super::super::Address;
    use super::super::{Mode, Numbering};
    use super::*;

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
    fn long_comments_are_wrapped_and_every_character_is_plain() {
        let mut dialect = Dialect::named("linuxcnc").unwrap();
        dialect.line_length = 40;
        let lines = comment_lines("pie de señora (izquierdo)\nnúmero treinta y siete", &dialect);
        let expected = ["pie de se?ora", "[izquierdo] n?mero", "treinta y siete"];
        assert_eq!(lines, expected.map(Box::from));
    }
}
