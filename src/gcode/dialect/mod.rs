//! How a control wants its programs: data, read from `machines/dialects/*.toml`.
//!
//! What differs by a word or a number is a key of that file; what differs by a rule is one of the
//! closed enums here, and the writer and the reader know each of them.

mod description;

use super::feeds::FeedLaw;
use super::{Coolant, Modes};

pub use super::feeds::{FeedLength, TimeUnit};

/// The dialects embedded in the package, by name.
const EMBEDDED: [(&str, &str); 8] = [
    ("linuxcnc", include_str!("../../../machines/dialects/linuxcnc.toml")),
    ("grbl", include_str!("../../../machines/dialects/grbl.toml")),
    ("grblhal", include_str!("../../../machines/dialects/grblhal.toml")),
    ("fanuc", include_str!("../../../machines/dialects/fanuc.toml")),
    ("haas", include_str!("../../../machines/dialects/haas.toml")),
    ("siemens-840d", include_str!("../../../machines/dialects/siemens-840d.toml")),
    ("heidenhain", include_str!("../../../machines/dialects/heidenhain.toml")),
    ("beckhoff", include_str!("../../../machines/dialects/beckhoff.toml")),
];

/// A control's language.
#[derive(Debug, Clone, PartialEq)]
pub struct Dialect {
    /// The name machine files call it by.
    pub name: String,
    /// One line about it, for people.
    pub title: String,
    /// What its program files end in.
    pub extension: String,
    /// How a line is built.
    pub language: Language,
    /// How comments are written.
    pub comment: CommentStyle,
    /// What stands around a program.
    pub tape: Tape,
    /// The most bytes a line may have.
    pub line_length: usize,
    /// The most bytes a program may have; a larger one is split.
    pub max_program_bytes: Option<usize>,
    /// Line numbers, if lines get any.
    pub block_numbers: Option<Numbering>,
    /// Axes that the control calls otherwise than the machine file: its letter, the control's.
    pub letters: Vec<(char, char)>,
    /// How angles beyond a turn are written.
    pub rotary: Rotary,
    /// The word for millimetres.
    pub millimetres: MillimetreWord,
    /// The modal words a program begins with, a line each.
    pub preamble: Vec<Modes>,
    /// Lines behind them that only this control knows: handed on as they are.
    pub setup: Vec<String>,
    /// How the control is told by how much it may round corners off; `None` if it cannot be.
    pub smoothing: Option<Smoothing>,
    /// How tools are changed.
    pub tool_change: ToolChange,
    /// The coolants it has words for.
    pub coolants: Vec<Coolant>,
    /// How pauses are written.
    pub dwell: DwellWords,
    /// The last word.
    pub end: EndWord,
    /// Decimals of words.
    pub decimals: Decimals,
    /// How F words are written, and what they are of.
    pub feed: FeedWords,
    /// What the control does with inverse time; `None` if it has none.
    pub inverse_time: Option<InverseTime>,
}

/// How a line is built.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Language {
    /// Letters and numbers, `G1 X12.5 A370.0 F600.0`.
    Iso,
    /// The same, with `A=DC(10.0)` and calls like `CYCLE832(0.01)`.
    Siemens,
    /// Heidenhain's plain text, `L X+12.5 A+370.0 F600.0`.
    Klartext,
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

/// What stands around a program.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Tape {
    /// Nothing.
    None,
    /// First and last line are `%`.
    Percent,
    /// The same, and an O word behind the first `%`.
    PercentNumber,
    /// `BEGIN PGM name MM` and `END PGM name MM`.
    Pgm,
}

/// Line numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct Numbering {
    /// The first number, and the distance to the next.
    pub step: u32,
    /// After this number the count begins again.
    pub last: u32,
}

/// How angles beyond a turn are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rotary {
    /// Not at all: the control has no rotary axis.
    None,
    /// Degrees count on over as many turns as there are.
    Unwound,
    /// Degrees from 0 to 360; the control turns the shorter way.
    Modulo,
    /// Degrees to go on by.
    Increments,
    /// Degrees count on, and now and then whole turns are taken off where the axis stands (G92).
    Rezero {
        /// After how many turns.
        turns: u32,
    },
}

/// The word for millimetres.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Deserialize)]
pub enum MillimetreWord {
    /// RS274, Fanuc and those after them; G20 is inches.
    #[default]
    G21,
    /// DIN 66025; G70 is inches.
    G71,
    /// Siemens, for lengths and feeds alike; G700 is inches.
    G710,
}

/// How the control is told by how much it may round corners off.
#[derive(Debug, Clone, PartialEq)]
pub struct Smoothing {
    /// The lines that switch it on, `{}` standing for the tolerance [mm].
    pub on: Vec<String>,
    /// The lines that switch it off, if that is needed.
    pub off: Vec<String>,
    /// The tolerance unless told otherwise [mm].
    pub tolerance: f64,
}

/// How tools are changed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ToolChange {
    /// By the machine: `T7 M6`.
    Automatic,
    /// By a person, while the program waits: `T7 M0`.
    ByHand,
}

/// How pauses are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct DwellWords {
    /// The word that holds the time.
    pub word: DwellWord,
    /// Its decimals.
    pub decimals: u8,
}

/// The word that holds the time of a pause.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum DwellWord {
    /// `G4 P` in seconds.
    PSeconds,
    /// `G4 P` in milliseconds.
    PMilliseconds,
    /// `G4 X` in seconds.
    XSeconds,
    /// `G4 F` in seconds.
    FSeconds,
    /// Cycle 9 of Klartext, in seconds.
    #[serde(rename = "cycle-9")]
    Cycle9,
}

/// The last word of a program.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Deserialize)]
pub enum EndWord {
    /// End.
    M2,
    /// End and rewind.
    M30,
}

/// Decimals of words.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct Decimals {
    /// Of millimetres.
    pub linear: u8,
    /// Of degrees.
    pub rotary: u8,
    /// Of S words; some controls take whole numbers alone.
    pub speed: u8,
}

/// How F words are written, and what they are of.
#[derive(Debug, Clone, Copy, PartialEq, serde::Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct FeedWords {
    /// Significant digits.
    pub digits: u8,
    /// The most decimals.
    pub decimals: u8,
    /// The greatest F per minute the control takes.
    #[serde(default = "unbounded")]
    pub max: f64,
    /// The length a feed per minute is of.
    pub measures: FeedLength,
    /// How many millimetres a degree counts in that length.
    #[serde(default = "one")]
    pub degree_mm: f64,
}

/// What a control does with F under inverse time.
#[derive(Debug, Clone, Copy, PartialEq, serde::Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct InverseTime {
    /// What F is of.
    #[serde(default)]
    pub unit: TimeUnit,
    /// The slowest it moves: `rate = max(min_rate, length * F)` [mm/min; deg/min without linear part].
    #[serde(default)]
    pub min_rate: f64,
    /// The greatest F it takes.
    #[serde(default = "unbounded")]
    pub max: f64,
}

fn unbounded() -> f64 {
    f64::INFINITY
}

fn one() -> f64 {
    1.0
}

/// Why a dialect cannot be used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum DialectError {
    /// No dialect has that name.
    #[error("there is no dialect {name:?}; there are: {known}; or give the path of a dialect file")]
    Unknown {
        /// The name asked for.
        name: String,
        /// The names there are.
        known: String,
    },
    /// Its description is wrong.
    #[error("{file}:{line}:{column}: {problem}")]
    Content {
        /// The file, or the name of the embedded one.
        file: String,
        /// The line, counted from 1.
        line: usize,
        /// The column, counted from 1.
        column: usize,
        /// What is wrong there.
        problem: String,
    },
}

impl Dialect {
    /// The names of the embedded dialects.
    pub fn names() -> impl Iterator<Item = &'static str> {
        EMBEDDED.iter().map(|(name, _)| *name)
    }

    /// The embedded dialect called `name`.
    pub fn named(name: &str) -> Result<Self, DialectError> {
        Self::parse(Self::text_named(name)?, name)
    }

    /// The file of the embedded dialect called `name`.
    pub fn text_named(name: &str) -> Result<&'static str, DialectError> {
        let found = EMBEDDED.iter().find(|(known, _)| *known == name);
        found.map(|(_, text)| *text).ok_or_else(|| DialectError::Unknown {
            name: name.to_owned(),
            known: Self::names().collect::<Vec<_>>().join(", "),
        })
    }

    /// The dialect a TOML text describes; errors call the text `file`.
    pub fn parse(text: &str, file: &str) -> Result<Self, DialectError> {
        description::parse(text, file)
    }

    /// What the control calls the axis that the machine calls `letter`.
    pub fn letter(&self, letter: char) -> char {
        let renamed = self.letters.iter().find(|(ours, _)| *ours == letter);
        renamed.map_or(letter, |(_, theirs)| *theirs)
    }

    /// What its F words mean.
    pub fn feed_law(&self) -> FeedLaw {
        FeedLaw {
            measures: self.feed.measures,
            degree_mm: self.feed.degree_mm,
            inverse: self.inverse_time.map_or(TimeUnit::default(), |inverse| inverse.unit),
        }
    }
}

impl MillimetreWord {
    /// The word.
    pub(super) fn word(self) -> &'static str {
        match self {
            Self::G21 => "G21",
            Self::G71 => "G71",
            Self::G710 => "G710",
        }
    }

    /// The numbers of the G words for inches and for millimetres.
    pub(super) fn codes(self) -> [u32; 2] {
        match self {
            Self::G21 => [20, 21],
            Self::G71 => [70, 71],
            Self::G710 => [700, 710],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_embedded_dialect_is_found_under_its_own_name() {
        for name in Dialect::names() {
            assert_eq!(Dialect::named(name).unwrap().name, name);
        }
    }

    #[test]
    fn an_unknown_dialect_is_refused_with_those_there_are() {
        let error = Dialect::named("fanuk").unwrap_err().to_string();
        assert_eq!(
            error,
            "there is no dialect \"fanuk\"; there are: linuxcnc, grbl, grblhal, fanuc, haas, \
             siemens-840d, heidenhain, beckhoff; or give the path of a dialect file"
        );
    }

    #[test]
    fn an_axis_is_called_as_the_control_calls_it() {
        let dialect = Dialect { letters: vec![('A', 'C')], ..Dialect::named("linuxcnc").unwrap() };
        assert_eq!((dialect.letter('A'), dialect.letter('X')), ('C', 'X'));
    }
}
