//! The keys of a dialect: the closed enums writer and reader match on, and groups of numbers.

use crate::gcode::feeds::{FeedLength, TimeUnit};

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

impl MillimetreWord {
    /// The word.
    pub(in crate::gcode) fn word(self) -> &'static str {
        match self {
            Self::G21 => "G21",
            Self::G71 => "G71",
            Self::G710 => "G710",
        }
    }

    /// The numbers of the G words for inches and for millimetres.
    pub(in crate::gcode) fn codes(self) -> [u32; 2] {
        match self {
            Self::G21 => [20, 21],
            Self::G71 => [70, 71],
            Self::G710 => [700, 710],
        }
    }
}
