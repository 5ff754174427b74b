//! From text to a program, as tolerant as controls are and no more.
//!
//! Any order and case of words, spaces, N numbers, both kinds of comments, `%`, block delete (read
//! as switched off: the line is carried out). Within a line things happen in the order of RS274/NGC:
//! modes, feed, tool, spindle, dwell, move, end. What is not understood is refused by name and place;
//! nothing is skipped in silence.
//!
//! Lines in the languages of other controls become the same words, and what only a dialect can
//! know (its own lines, what F means, which way an angle is reached) is looked up in it.

mod control;
mod klartext;
mod phrase;

use super::line::Line;

use super::{Dialect, Language, Problem, Program};
use crate::machine::Machine;
use control::{Control, Stage};
use phrase::{Listed, Phrases};
use std::io::{BufRead, Read};

/// The longest line the reader takes; controls take 80 to 512.
const MAX_LINE: usize = 4096;

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
    #[error("the program cannot be read behind line {line}: {problem}")]
    System {
        /// The last line that was read.
        line: u32,
        /// What the system said.
        problem: std::io::Error,
    },
}

/// Reads a program for `machine`, written in `dialect`.
///
/// The state at its start is that of every control here: millimetres, positions, feeds per minute.
/// Inches and increments are turned into millimetres and absolute words, angles are counted on.
/// Nothing behind M2, M30 or the second `%` is read but what ends the tape.
pub fn read(
    text: &mut dyn BufRead,
    machine: &Machine,
    dialect: &Dialect,
) -> Result<Program, ReadError> {
    read_program(text, Program::for_machine(machine, dialect), dialect)
}

fn read_program(
    text: &mut dyn BufRead,
    program: Program,
    dialect: &Dialect,
) -> Result<Program, ReadError> {
    let mut control = Control::new(program, dialect);
    let mut phrases = Phrases::new(dialect);
    let mut bytes = Vec::new();
    let mut words = Line::default();
    for line in 1.. {
        bytes.clear();
        if control.stage == Stage::Done {
            break;
        }
        // Two more, so that a line of just the limit still brings its ending along.
        let limit = MAX_LINE as u64 + 2;
        let n_bytes = Read::take(&mut *text, limit).read_until(b'\n', &mut bytes);
        if n_bytes.map_err(|problem| ReadError::System { line: line - 1, problem })? == 0 {
            break;
        }
        let at_line = |(column, problem)| ReadError::Content { line, column, problem };
        while let [.., b'\n' | b'\r'] = bytes[..] {
            bytes.pop();
        }
        if control.stage == Stage::AwaitsPercent {
            control.await_percent(&bytes, line);
            continue;
        }
        if bytes.len() > MAX_LINE {
            return Err(at_line((1, Problem::LineTooLong { limit: MAX_LINE })));
        }
        control.measure(line, bytes.len());
        match phrases.find(&bytes) {
            Some(Listed::Says(kind)) => {
                control.push(line, kind);
                continue;
            }
            Some(Listed::Part) => continue,
            None => {}
        }
        match dialect.language {
            Language::Klartext => klartext::fill(&mut words, &bytes).map_err(at_line)?,
            language => words.fill(&bytes, language).map_err(at_line)?,
        }
        control.execute(&words, line).map_err(at_line)?;
    }
    Ok(control.program)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gcode::{
        Address, BlockKind, LongestLine, Mode, Motion, MoveWords, Spindle, SpindleRun,
    };
    use crate::machine::AxisKind;

    fn lathe_program(text: &str) -> Result<Program, ReadError> {
        let axis = |letter, kind| Address { letter, kind };
        let axes = vec![
            axis('X', AxisKind::Linear),
            axis('Y', AxisKind::Linear),
            axis('A', AxisKind::Rotary),
        ];
        let dialect = Dialect::named("linuxcnc").unwrap();
        read_program(&mut text.as_bytes(), Program { axes, ..Program::default() }, &dialect)
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
        let program = lathe_program("%\nM30\nthe rest\n%\nof the tape").unwrap();
        let lines: Vec<_> = program.blocks.iter().map(|block| block.line).collect();
        assert_eq!(lines, [1, 2, 4]);
    }

    #[test]
    fn every_refusal_names_line_column_and_word() {
        for (text, message) in [
            ("G0 X1\nG2 X1 I2 J0", "line 2, column 1: G2 arcs are not read yet"),
            ("G0 X1\n X2 G43 H1", "line 2, column 5: G43 is not read yet"),
            ("G91.1", "line 1, column 1: G91.1 is not read yet"),
            ("M10", "line 1, column 1: M10 is not read yet"),
            ("T1 M0", "line 1, column 4: M0 is read behind a T word, where tools are changed by"),
            ("G92 A5", "line 1, column 1: G92 is read where it takes whole turns off"),
            ("G92 A", "line 1, column 5: no number after A"),
            ("O7", "line 1, column 1: O is not read yet"),
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
    fn a_source_that_fails_is_told_with_the_last_line_read() {
        struct Broken;
        impl Read for Broken {
            fn read(&mut self, _: &mut [u8]) -> std::io::Result<usize> {
                Err(std::io::Error::other("the cable is out"))
            }
        }
        let mut text = std::io::BufReader::new("M5\nM5\n".as_bytes().chain(Broken));
        let dialect = Dialect::named("linuxcnc").unwrap();
        let error = read_program(&mut text, Program::default(), &dialect).unwrap_err();
        let error = error.to_string();
        assert_eq!(error, "the program cannot be read behind line 2: the cable is out");
    }

    #[test]
    fn the_longest_line_is_remembered() {
        let program = lathe_program("G0 X1\r\n(longest)\r\nX1\r\n").unwrap();
        assert_eq!(program.longest_line, Some(LongestLine { line: 2, length: 9 }));
    }
}
