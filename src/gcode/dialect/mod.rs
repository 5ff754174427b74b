//! How a control wants its programs: data, read from `machines/dialects/*.toml`.
//!
//! What differs by a word or a number is a key of that file; what differs by a rule is one of the
//! closed enums here, and the writer and the reader know each of them.

mod description;
mod keys;

use super::feeds::FeedLaw;
use super::{Coolant, Modes};

pub use super::feeds::{FeedLength, TimeUnit};
pub use keys::{
    CommentStyle, Decimals, DwellWord, DwellWords, EndWord, FeedWords, InverseTime, Language,
    MillimetreWord, Numbering, Rotary, Smoothing, Tape, ToolChange,
};

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
