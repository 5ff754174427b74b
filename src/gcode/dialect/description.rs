//! A dialect file: its keys, and the rules between them.

use super::{
    CommentStyle, Decimals, Dialect, DialectError, DwellWord, DwellWords, EndWord, FeedWords,
    InverseTime, Language, MillimetreWord, Numbering, Rotary, Smoothing, Tape, ToolChange,
};
use crate::gcode::line::Line;
use crate::gcode::{Coolant, Mode, Modes};
use std::collections::BTreeMap;
use std::ops::Range;
use toml::Spanned;

/// The dialect a TOML text describes; errors call the text `file`.
pub(super) fn parse(text: &str, file: &str) -> Result<Dialect, DialectError> {
    let described: Description = toml::from_str(text).map_err(|error| {
        problem_at(text, file, error.span().unwrap_or_default(), error.message().to_owned())
    })?;
    described.checked().map_err(|(span, problem)| problem_at(text, file, span, problem))
}

/// A dialect as its file has it, with the places of what is checked.
#[derive(serde::Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
struct Description {
    name: String,
    title: String,
    extension: Spanned<String>,
    language: Language,
    comment: Spanned<CommentStyle>,
    tape: Spanned<Tape>,
    line_length: Spanned<usize>,
    max_program_bytes: Option<Spanned<usize>>,
    block_numbers: Option<Spanned<Numbering>>,
    #[serde(default)]
    letters: BTreeMap<Spanned<char>, Spanned<char>>,
    rotary: Spanned<RotaryKey>,
    rezero_turns: Option<Spanned<u32>>,
    #[serde(default)]
    millimetres: MillimetreWord,
    preamble: Vec<Spanned<String>>,
    #[serde(default)]
    setup: Vec<Spanned<String>>,
    smoothing: Option<SmoothingKeys>,
    tool_change: ToolChange,
    coolants: Vec<Spanned<Coolant>>,
    dwell: Spanned<DwellWords>,
    end: EndWord,
    decimals: Spanned<Decimals>,
    feed: Spanned<FeedWords>,
    inverse_time: Option<Spanned<InverseTime>>,
}

#[derive(Clone, Copy, PartialEq, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
enum RotaryKey {
    None,
    Unwound,
    Modulo,
    Increments,
    Rezero,
}

#[derive(serde::Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
struct SmoothingKeys {
    on: Vec<Spanned<String>>,
    #[serde(default)]
    off: Vec<Spanned<String>>,
    tolerance: Spanned<f64>,
}

type Misplaced = (Range<usize>, String);

impl Description {
    fn checked(self) -> Result<Dialect, Misplaced> {
        self.check_numbers()?;
        self.check_language()?;
        let letters = self.checked_letters()?;
        let rotary = self.checked_rotary()?;
        let smoothing = self.smoothing.as_ref().map(SmoothingKeys::checked).transpose()?;
        let modes = |line: &Spanned<String>| modes(line, self.millimetres);
        let preamble = self.preamble.iter().map(modes).collect::<Result<Vec<_>, _>>()?;
        self.check_feed_modes(&preamble)?;
        Ok(Dialect {
            preamble,
            letters,
            rotary,
            smoothing,
            setup: lines(&self.setup)?,
            name: self.name,
            title: self.title,
            extension: self.extension.into_inner(),
            language: self.language,
            comment: self.comment.into_inner(),
            tape: self.tape.into_inner(),
            line_length: self.line_length.into_inner(),
            max_program_bytes: self.max_program_bytes.map(Spanned::into_inner),
            block_numbers: self.block_numbers.map(Spanned::into_inner),
            millimetres: self.millimetres,
            tool_change: self.tool_change,
            coolants: self.coolants.into_iter().map(Spanned::into_inner).collect(),
            dwell: self.dwell.into_inner(),
            end: self.end,
            decimals: self.decimals.into_inner(),
            feed: self.feed.into_inner(),
            inverse_time: self.inverse_time.map(Spanned::into_inner),
        })
    }

    fn check_numbers(&self) -> Result<(), Misplaced> {
        let Decimals { linear, rotary, speed } = *self.decimals.get_ref();
        let few = [linear, rotary].iter().all(|n| (2..=6).contains(n)) && speed <= 3;
        bound(&self.decimals, few, "2 to 6 decimals, 0 to 3 of the speed")?;
        let FeedWords { digits, decimals, max, degree_mm, .. } = *self.feed.get_ref();
        // Four digits keep the time of a block within 0.1 %; an f64 has no more than fifteen.
        bound(&self.feed, (4..=15).contains(&digits), "feeds have 4 to 15 significant digits")?;
        bound(&self.feed, (1..=9).contains(&decimals), "feeds have 1 to 9 decimals")?;
        bound(&self.feed, max >= 1.0, "the greatest feed is 1 or more")?;
        let counts = degree_mm.is_finite() && degree_mm > 0.0;
        bound(&self.feed, counts, "a degree counts more than 0 mm")?;
        bound(&self.line_length, *self.line_length.get_ref() >= 40, "lines hold 40 bytes or more")?;
        if let Some(numbers) = &self.block_numbers {
            let Numbering { step, last } = *numbers.get_ref();
            bound(numbers, 0 < step && step <= last, "step is 1 or more, last is step or more")?;
        }
        if let Some(bytes) = &self.max_program_bytes {
            bound(bytes, *bytes.get_ref() >= 1000, "a program may have 1000 bytes or more")?;
        }
        if let Some(inverse) = &self.inverse_time {
            let InverseTime { min_rate: rate, max, .. } = *inverse.get_ref();
            bound(inverse, rate.is_finite() && rate >= 0.0, "min-rate is a number, 0 or more")?;
            bound(inverse, max >= 1.0, "the greatest F is 1 or more")?;
        }
        bound(&self.dwell, self.dwell.get_ref().decimals <= 9, "pauses have 0 to 9 decimals")?;
        let plain = |c: char| c.is_ascii_alphanumeric();
        let extension = self.extension.get_ref();
        let is_one = !extension.is_empty() && extension.chars().all(plain);
        bound(&self.extension, is_one, "an extension is letters and digits, without the dot")
    }

    /// What only goes together with the language.
    fn check_language(&self) -> Result<(), Misplaced> {
        let klartext = self.language == Language::Klartext;
        let tape = (*self.tape.get_ref() == Tape::Pgm) == klartext;
        bound(&self.tape, tape, "pgm is the tape of klartext, and klartext has no other")?;
        let dwell = (self.dwell.get_ref().word == DwellWord::Cycle9) == klartext;
        bound(&self.dwell, dwell, "cycle-9 is the pause of klartext, and klartext has no other")?;
        let iso = self.language == Language::Iso;
        let semicolons = *self.comment.get_ref() == CommentStyle::Semicolon;
        bound(&self.comment, iso || semicolons, "comments begin with a semicolon there")?;
        let has_inverse = self.inverse_time.as_ref().filter(|_| klartext);
        has_inverse.map_or(Ok(()), |keys| bound(keys, false, "klartext has no inverse time"))
    }

    /// The post counts on feeds per minute where nothing else was said.
    fn check_feed_modes(&self, preamble: &[Modes]) -> Result<(), Misplaced> {
        let Some(line) = self.preamble.iter().zip(preamble).find_map(|(line, modes)| {
            let inverse = modes.contains(Mode::InverseTime);
            inverse.then_some(line)
        }) else {
            return Ok(());
        };
        bound(line, false, "a program begins with feeds per minute (G94)")
    }

    fn checked_letters(&self) -> Result<Vec<(char, char)>, Misplaced> {
        let mut letters = Vec::new();
        for (ours, theirs) in &self.letters {
            for letter in [ours, theirs] {
                bound(
                    letter,
                    "XYZABCUVW".contains(*letter.get_ref()),
                    "an axis letter: XYZABCUVW",
                )?;
            }
            letters.push((*ours.get_ref(), *theirs.get_ref()));
        }
        Ok(letters)
    }

    fn checked_rotary(&self) -> Result<Rotary, Misplaced> {
        let key = *self.rotary.get_ref();
        let turns = self.rezero_turns.as_ref().map(|turns| *turns.get_ref());
        let has_turns = turns.is_some_and(|turns| turns > 0) == (key == RotaryKey::Rezero);
        bound(&self.rotary, has_turns, "rezero, and nothing else, has rezero-turns of 1 or more")?;
        let iso = self.language == Language::Iso;
        let is_spoken = match key {
            RotaryKey::Rezero => iso,
            RotaryKey::Increments => !iso,
            RotaryKey::Modulo => self.language != Language::Klartext,
            RotaryKey::None | RotaryKey::Unwound => true,
        };
        bound(&self.rotary, is_spoken, "the language has no words for that")?;
        Ok(match key {
            RotaryKey::None => Rotary::None,
            RotaryKey::Unwound => Rotary::Unwound,
            RotaryKey::Modulo => Rotary::Modulo,
            RotaryKey::Increments => Rotary::Increments,
            RotaryKey::Rezero => Rotary::Rezero { turns: turns.unwrap_or(1) },
        })
    }
}

impl SmoothingKeys {
    fn checked(&self) -> Result<Smoothing, Misplaced> {
        let tolerance = *self.tolerance.get_ref();
        let is_one = tolerance.is_finite() && tolerance > 0.0;
        bound(&self.tolerance, is_one, "a tolerance is more than 0 mm")?;
        bound(&self.tolerance, !self.on.is_empty(), "smoothing is switched on by a line or two")?;
        Ok(Smoothing { on: lines(&self.on)?, off: lines(&self.off)?, tolerance })
    }
}

/// Lines that are handed on as they are.
fn lines(described: &[Spanned<String>]) -> Result<Vec<String>, Misplaced> {
    for line in described {
        let text = line.get_ref();
        let plain = text.chars().all(|c| (' '..='~').contains(&c));
        let one_number = text.matches("{}").count() <= 1;
        let something = !text.trim().is_empty();
        bound(
            line,
            plain && one_number && something,
            "a line of plain characters, {} once at most",
        )?;
    }
    Ok(described.iter().map(|line| line.get_ref().clone()).collect())
}

fn bound<T>(value: &Spanned<T>, holds: bool, rule: &str) -> Result<(), Misplaced> {
    if holds { Ok(()) } else { Err((value.span(), rule.to_owned())) }
}

fn modes(line: &Spanned<String>, millimetres: MillimetreWord) -> Result<Modes, Misplaced> {
    Line::modes_alone(line.get_ref(), millimetres).map_err(|(column, problem)| {
        // The span opens with the quotation mark, which makes up for columns counting from 1.
        let start = line.span().start + column as usize;
        (start..start, problem.to_string())
    })
}

fn problem_at(text: &str, file: &str, span: Range<usize>, problem: String) -> DialectError {
    let before = text.get(..span.start).unwrap_or(text);
    let line = before.matches('\n').count() + 1;
    let column = before.chars().rev().take_while(|&c| c != '\n').count() + 1;
    DialectError::Content { file: file.to_owned(), line, column, problem }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is wrong with an embedded dialect in which `from` is `to`: where, and what.
    fn complaint(name: &str, from: &str, to: &str) -> String {
        let text = Dialect::text_named(name).unwrap();
        assert!(text.contains(from), "{from:?} is in the file");
        parse(&text.replacen(from, to, 1), "my.toml").unwrap_err().to_string()
    }

    /// Where `text` begins in the file of LinuxCNC.
    fn place(text: &str) -> String {
        let file = Dialect::text_named("linuxcnc").unwrap();
        let before = file.split(text).next().unwrap();
        let column = before.len() - before.rfind('\n').map_or(0, |end| end + 1) + 1;
        format!("my.toml:{}:{column}: ", before.matches('\n').count() + 1)
    }

    #[test]
    fn mistakes_are_found_by_line_and_column() {
        let unknown_key = complaint("linuxcnc", "tape = ", "tapes = ");
        assert!(unknown_key.starts_with(&(place("tape = ") + "unknown field `tapes`")));
        let preamble = complaint("linuxcnc", "G54\"]", "G43 H1\"]");
        assert!(preamble.starts_with(&(place("G54\"]") + "G43 is not read")), "{preamble}");
        for other in ["M3", "G20", "G91", "G54 G0", "G54 F100", "G54 (remark)", ""] {
            let refused = complaint("linuxcnc", "G54\"]", &format!("{other}\"]"));
            let expected = place("G54\"]") + "modal words alone belong here";
            assert!(refused.starts_with(&expected), "{refused}");
        }
    }

    #[test]
    fn what_no_control_could_do_is_refused() {
        for (name, from, to, rule) in [
            ("linuxcnc", "linear = 4", "linear = 1", "2 to 6 decimals"),
            ("linuxcnc", "digits = 6", "digits = 3", "feeds have 4 to 15 significant digits"),
            ("linuxcnc", "min-rate = 0.1", "min-rate = -0.1", "min-rate is a number, 0 or more"),
            (
                "linuxcnc",
                "rotary = \"unwound\"",
                "rotary = \"rezero\"",
                "rezero-turns of 1 or more",
            ),
            ("linuxcnc", "rotary = \"unwound\"", "rotary = \"increments\"", "no words for that"),
            ("linuxcnc", "tolerance = 0.01", "tolerance = 0", "a tolerance is more than 0 mm"),
            ("linuxcnc", "G90 G94", "G90 G93", "begins with feeds per minute (G94)"),
            ("linuxcnc", "G64 P{}", "G64 P{} Q{}", "{} once at most"),
            (
                "linuxcnc",
                "word = \"p-seconds\"",
                "word = \"cycle-9\"",
                "cycle-9 is the pause of klartext",
            ),
            ("heidenhain", "tape = \"pgm\"", "tape = \"percent\"", "pgm is the tape of klartext"),
            ("siemens-840d", "\"semicolon\"", "\"parentheses\"", "begin with a semicolon"),
        ] {
            let refused = complaint(name, from, to);
            assert!(refused.contains(rule), "{from:?} as {to:?} gave {refused:?}");
        }
    }

    #[test]
    fn letters_are_those_of_axes() {
        let text = Dialect::text_named("linuxcnc").unwrap();
        let dialect = parse(&format!("{text}\n[letters]\nA = \"C\"\n"), "my.toml").unwrap();
        assert_eq!(dialect.letters, [('A', 'C')]);
        let refused = parse(&format!("{text}\n[letters]\nA = \"Q\"\n"), "my.toml").unwrap_err();
        assert!(refused.to_string().ends_with("an axis letter: XYZABCUVW"), "{refused}");
    }
}
