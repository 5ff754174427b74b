//! Lines of Heidenhain's plain text as the words they stand for.

use crate::gcode::Problem;
use crate::gcode::line::Line;
use crate::gcode::scan::Turning;

type Misread = (u32, Problem);

/// Takes in the words of `bytes` in place of those before.
pub(super) fn fill(line: &mut Line, bytes: &[u8]) -> Result<(), Misread> {
    line.clear();
    let text = String::from_utf8_lossy(bytes);
    let (text, comment) = match text.split_once(';') {
        Some((text, comment)) => (text, Some(comment)),
        None => (&*text, None),
    };
    if let Some(comment) = comment {
        line.comments.push(comment.trim().into());
    }
    let mut words: Vec<(u32, String)> = Vec::new();
    for (column, word) in columns(text) {
        words.push((column, word.to_ascii_uppercase()));
    }
    // The number of the block.
    if words.first().is_some_and(|(_, word)| word.bytes().all(|byte| byte.is_ascii_digit())) {
        words.remove(0);
    }
    let names: Vec<&str> = words.iter().map(|(_, word)| word.as_str()).collect();
    match names[..] {
        ["BEGIN", "PGM", name, unit @ ("MM" | "INCH")] => begin(line, name, unit, words[2].0),
        ["END", "PGM", ..] => {
            line.percent = true;
            Ok(())
        }
        [] | ["CYCL", "DEF", "9.0", ..] => Ok(()),
        ["CYCL", "DEF", "9.1", "DWELL", time] => {
            line.add_code('G', 4.0, words[0].0)?;
            add(line, 'P', time, None, words[4].0)
        }
        ["TOOL", "CALL", ..] => tool_call(line, &words[2..]),
        ["L", ..] => straight(line, words[0].0, &words[1..]),
        [first, ..] if first.starts_with('M') => {
            words.iter().try_for_each(|(column, word)| auxiliary(line, word, *column))
        }
        [first, ..] => Err((words[0].0, Problem::Klartext { word: first.to_owned() })),
    }
}

/// The words of a line with their columns, counted from 1.
fn columns(text: &str) -> impl Iterator<Item = (u32, &str)> {
    let start = text.as_ptr() as usize;
    text.split_ascii_whitespace()
        .map(move |word| ((word.as_ptr() as usize - start) as u32 + 1, word))
}

/// The name of a program ends in its number, as those we write do; others have none.
fn begin(line: &mut Line, name: &str, unit: &str, column: u32) -> Result<(), Misread> {
    let digits = name.trim_start_matches(|c: char| !c.is_ascii_digit());
    if !digits.is_empty() {
        add(line, 'O', digits, None, column)?;
    }
    if unit == "INCH" { line.add_code('G', 20.0, column) } else { Ok(()) }
}

/// `TOOL CALL 7 Z S6000`: the tool, its axis and its speed, each if it is there.
fn tool_call(line: &mut Line, words: &[(u32, String)]) -> Result<(), Misread> {
    for (column, word) in words {
        match word.as_str() {
            "X" | "Y" | "Z" => {}
            word if word.starts_with('S') => add(line, 'S', &word[1..], None, *column)?,
            number => {
                add(line, 'T', number, None, *column)?;
                line.add_code('M', 6.0, *column)?;
            }
        }
    }
    Ok(())
}

/// `L X+12.5 IA+1.0 R0 F600 M8`; `FMAX` makes it a rapid.
fn straight(line: &mut Line, column: u32, words: &[(u32, String)]) -> Result<(), Misread> {
    let rapid = words.iter().any(|(_, word)| word == "FMAX");
    line.add_code('G', if rapid { 0.0 } else { 1.0 }, column)?;
    for (column, word) in words {
        match word.as_bytes() {
            b"FMAX" | b"R0" => {}
            [b'M', ..] => auxiliary(line, word, *column)?,
            [b'I', letter @ b'A'..=b'Z', ..] => {
                add(line, char::from(*letter), &word[2..], Some(Turning::By), *column)?;
            }
            [letter @ b'A'..=b'Z', ..] => {
                add(line, char::from(*letter), &word[1..], None, *column)?;
            }
            _ => return Err((*column, Problem::Klartext { word: word.clone() })),
        }
    }
    Ok(())
}

fn auxiliary(line: &mut Line, word: &str, column: u32) -> Result<(), Misread> {
    let unread = || (column, Problem::Klartext { word: word.to_owned() });
    let number: u16 = word.strip_prefix('M').and_then(|n| n.parse().ok()).ok_or_else(unread)?;
    line.add_code('M', f64::from(number), column)
}

fn add(
    line: &mut Line,
    letter: char,
    number: &str,
    turning: Option<Turning>,
    column: u32,
) -> Result<(), Misread> {
    let is_decimal = number.bytes().all(|byte| byte.is_ascii_digit() || b"+-.,".contains(&byte));
    // A decimal comma is as good there.
    let value = number.replace(',', ".").parse().ok().filter(|_| is_decimal);
    let value = value.ok_or((column, Problem::NoNumber { letter }))?;
    line.add_word(letter, value, turning, column)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gcode::MillimetreWord;

    fn line(text: &str) -> Result<Line, Misread> {
        let mut line = Line::default();
        fill(&mut line, text.as_bytes())?;
        Ok(line)
    }

    #[test]
    fn a_straight_line_is_g1_or_with_fmax_g0() {
        let read = line("12 L X+12,5 IA-3.25 R0 F600 M8 ; cut").unwrap();
        assert_eq!(read.word(b'X'), Some((12.5, 6)));
        assert_eq!((read.word(b'A'), read.turning(b'A')), (Some((-3.25, 13)), Some(Turning::By)));
        assert_eq!((read.word(b'F').unwrap().0, &*read.comments[0]), (600.0, "cut"));
        let rapid = line("L Y+1 FMAX").unwrap().sorted(MillimetreWord::G21).unwrap();
        assert_eq!(rapid.motion, Some(crate::gcode::Motion::Rapid));
    }

    #[test]
    fn calls_and_cycles_are_read_by_name() {
        let call = line("TOOL CALL 7 Z S6000").unwrap();
        assert_eq!((call.word(b'T').unwrap().0, call.word(b'S').unwrap().0), (7.0, 6000.0));
        assert_eq!(line("3 TOOL CALL S500").unwrap().word(b'T'), None);
        assert_eq!(line("CYCL DEF 9.1 DWELL 0.25").unwrap().word(b'P').unwrap().0, 0.25);
        assert_eq!(line("0 BEGIN PGM HORMA0012 MM").unwrap().word(b'O').unwrap().0, 12.0);
        assert!(line("99 END PGM HORMA0012 MM").unwrap().percent);
    }

    #[test]
    fn any_bytes_are_read_or_refused() {
        for start in ["", "5 ", "L ", "L I", "TOOL CALL ", "TOOL CALL S", "M", "BEGIN PGM "] {
            for byte in 0..=u8::MAX {
                for rest in [&b""[..], b"X", b" MM", "\u{e9}".as_bytes()] {
                    let bytes = [start.as_bytes(), &[byte], rest].concat();
                    // An error is as good as a line; neither may panic.
                    let _ = fill(&mut Line::default(), &bytes);
                }
            }
        }
    }

    #[test]
    fn every_refusal_names_column_and_word() {
        for (text, message) in [
            ("5 CC X+0 Y+0", "3: CC begins no line that is read"),
            ("CYCL DEF 7.0 DATUM", "1: CYCL begins no line"),
            ("L X+1 X+2", "7: the line has X twice"),
            ("L X+Q1", "3: no number after X"),
            ("L IX", "3: no number after X"),
            ("L Xnan", "3: no number after X"),
            ("TOOL CALL \"BALL\"", "11: no number after T"),
            ("M3.5", "1: M3.5 begins no line"),
        ] {
            let (column, problem) = line(text).err().expect("it is no line");
            let told = format!("{column}: {problem}");
            assert!(told.starts_with(message), "{text:?} gave {told:?}");
        }
    }
}
