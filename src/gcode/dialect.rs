//! How a control wants its programs: data, read from `machines/dialects/*.toml`.

use super::Modes;
use super::line::Line;
use std::ops::Range;
use toml::Spanned;

/// The dialects embedded in the package, by name.
const EMBEDDED: [(&str, &str); 1] =
    [("linuxcnc", include_str!("../../machines/dialects/linuxcnc.toml"))];

/// A control's language.
#[derive(Debug, Clone, PartialEq)]
pub struct Dialect {
    /// The name machine files call it by.
    pub name: String,
    /// One line about it, for people.
    pub title: String,
    /// How comments are written.
    pub comment: CommentStyle,
    /// The most bytes a line may have.
    pub line_length: usize,
    /// N words, if lines get any.
    pub block_numbers: Option<Numbering>,
    /// How angles beyond a turn are written.
    pub rotary: Rotary,
    /// True if the first and the last line are `%`.
    pub percent: bool,
    /// The modal words a program begins with, a line each.
    pub preamble: Vec<Modes>,
    /// The last word.
    pub end: EndWord,
    /// Decimals of axis words.
    pub decimals: Decimals,
    /// How F words are written.
    pub feed: FeedWords,
    /// What the control does with inverse time; `None` if it has none.
    pub inverse_time: Option<InverseTime>,
}

/// How comments are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum CommentStyle {
    /// `(like this)`.
    Parentheses,
    /// `; like this`.
    Semicolon,
}

/// N words.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct Numbering {
    /// The first number, and the distance to the next.
    pub step: u32,
    /// After this number the count begins again.
    pub last: u32,
}

/// How angles beyond a turn are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Rotary {
    /// Degrees count on over as many turns as there are.
    Unwound,
}

/// The last word of a program.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Deserialize)]
pub enum EndWord {
    /// End.
    M2,
    /// End and rewind.
    M30,
}

/// Decimals of axis words.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct Decimals {
    /// Of millimetres.
    pub linear: u8,
    /// Of degrees.
    pub rotary: u8,
}

/// How F words are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct FeedWords {
    /// Significant digits.
    pub digits: u8,
}

/// What a control does with F under inverse time.
#[derive(Debug, Clone, Copy, PartialEq, serde::Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct InverseTime {
    /// The slowest it moves: `rate = max(min_rate, length * F)` [mm/min; deg/min without linear part].
    pub min_rate: f64,
}

/// Why a dialect cannot be used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum DialectError {
    /// No dialect has that name.
    #[error("there is no dialect {name:?}; there is {known}")]
    Unknown {
        /// The name asked for.
        name: String,
        /// The names there are.
        known: String,
    },
    /// Its description is wrong.
    #[error("dialect line {line}, column {column}: {problem}")]
    Content {
        /// The line, counted from 1.
        line: usize,
        /// The column, counted from 1.
        column: usize,
        /// What is wrong there.
        problem: String,
    },
}

impl Dialect {
    /// The embedded dialect called `name`.
    pub fn named(name: &str) -> Result<Self, DialectError> {
        let found = EMBEDDED.iter().find(|(known, _)| *known == name);
        let (_, text) = found.ok_or_else(|| DialectError::Unknown {
            name: name.to_owned(),
            known: EMBEDDED.map(|(known, _)| known).join(", "),
        })?;
        Self::parse(text)
    }

    /// The dialect a TOML text describes.
    pub fn parse(text: &str) -> Result<Self, DialectError> {
        let described: Description = toml::from_str(text).map_err(|error| {
            problem_at(text, error.span().unwrap_or_default(), error.message().to_owned())
        })?;
        described.checked().map_err(|(span, problem)| problem_at(text, span, problem))
    }
}

/// A dialect as its file has it, with the places of what is checked.
#[derive(serde::Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
struct Description {
    name: String,
    title: String,
    comment: CommentStyle,
    line_length: Spanned<usize>,
    block_numbers: Option<Spanned<Numbering>>,
    rotary: Rotary,
    percent: bool,
    preamble: Vec<Spanned<String>>,
    end: EndWord,
    decimals: Spanned<Decimals>,
    feed: Spanned<FeedWords>,
    inverse_time: Option<Spanned<InverseTime>>,
}

type Misplaced = (Range<usize>, String);

impl Description {
    fn checked(self) -> Result<Dialect, Misplaced> {
        let decimals = [self.decimals.get_ref().linear, self.decimals.get_ref().rotary];
        bound(&self.decimals, decimals.iter().all(|n| (2..=6).contains(n)), "2 to 6 decimals")?;
        let digits = self.feed.get_ref().digits;
        // Four digits keep the time of a block within 0.1 %; an f64 has no more than fifteen.
        bound(&self.feed, (4..=15).contains(&digits), "feeds have 4 to 15 significant digits")?;
        bound(&self.line_length, *self.line_length.get_ref() >= 40, "lines hold 40 bytes or more")?;
        if let Some(numbers) = &self.block_numbers {
            let Numbering { step, last } = *numbers.get_ref();
            bound(numbers, 0 < step && step <= last, "step is 1 or more, last is step or more")?;
        }
        if let Some(inverse) = &self.inverse_time {
            let rate = inverse.get_ref().min_rate;
            bound(inverse, rate.is_finite() && rate >= 0.0, "min-rate is a number, 0 or more")?;
        }
        Ok(Dialect {
            preamble: self.preamble.iter().map(modes).collect::<Result<_, _>>()?,
            name: self.name,
            title: self.title,
            comment: self.comment,
            line_length: self.line_length.into_inner(),
            block_numbers: self.block_numbers.map(Spanned::into_inner),
            rotary: self.rotary,
            percent: self.percent,
            end: self.end,
            decimals: self.decimals.into_inner(),
            feed: self.feed.into_inner(),
            inverse_time: self.inverse_time.map(Spanned::into_inner),
        })
    }
}

fn bound<T>(value: &Spanned<T>, holds: bool, rule: &str) -> Result<(), Misplaced> {
    if holds { Ok(()) } else { Err((value.span(), rule.to_owned())) }
}

fn modes(line: &Spanned<String>) -> Result<Modes, Misplaced> {
    Line::modes_alone(line.get_ref()).map_err(|(column, problem)| {
        // The span opens with the quotation mark, which makes up for columns counting from 1.
        let start = line.span().start + column as usize;
        (start..start, problem.to_string())
    })
}

fn problem_at(text: &str, span: Range<usize>, problem: String) -> DialectError {
    let before = text.get(..span.start).unwrap_or(text);
    let line = before.matches('\n').count() + 1;
    let column = before.chars().rev().take_while(|&c| c != '\n').count() + 1;
    DialectError::Content { line, column, problem }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn complaint(from: &str, to: &str) -> String {
        let (_, text) = EMBEDDED[0];
        assert!(text.contains(from), "{from:?} is in the file");
        Dialect::parse(&text.replace(from, to)).unwrap_err().to_string()
    }

    #[test]
    fn every_embedded_dialect_is_found_under_its_own_name() {
        for (name, _) in EMBEDDED {
            assert_eq!(Dialect::named(name).unwrap().name, name);
        }
    }

    #[test]
    fn an_unknown_dialect_is_refused_with_those_there_are() {
        let error = Dialect::named("fanuk").unwrap_err().to_string();
        assert_eq!(error, "there is no dialect \"fanuk\"; there is linuxcnc");
    }

    #[test]
    fn mistakes_are_found_by_line_and_column() {
        let unknown_key = complaint("percent = false", "percents = false");
        assert!(unknown_key.starts_with("dialect line 13, column 1: unknown field `percents`"));
        let preamble = complaint("G54\"]", "G43 H1\"]");
        assert!(preamble.starts_with("dialect line 15, column 45: G43 is not read"), "{preamble}");
        for other in ["M3", "G20", "G91", "G54 G0", "G54 F100", "G54 (remark)", ""] {
            let refused = complaint("G54\"]", &format!("{other}\"]"));
            assert!(refused.contains("column 45: modal words alone belong here"), "{refused}");
        }
        let decimals = complaint("linear = 4", "linear = 1");
        assert!(decimals.ends_with("2 to 6 decimals"), "{decimals}");
        let digits = complaint("digits = 6", "digits = 3");
        assert!(digits.ends_with("feeds have 4 to 15 significant digits"), "{digits}");
        let rate = complaint("min-rate = 0.1", "min-rate = -0.1");
        assert!(rate.ends_with("min-rate is a number, 0 or more"), "{rate}");
    }
}
