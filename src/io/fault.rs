//! Why a file could not be read: the file, the place in it, the value there, and what to do.

use std::fmt;
use std::path::PathBuf;

/// A file that cannot be read.
#[derive(Debug, thiserror::Error)]
#[error("cannot read {path:?}: {fault}")]
pub struct ReadError {
    /// The file.
    pub path: PathBuf,
    /// What is wrong with it.
    pub fault: Fault,
}

/// What is wrong with a file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Fault {
    /// The system refused.
    #[error("{0}; check that the file is there and may be read")]
    System(#[from] std::io::Error),
    /// Not a byte in it.
    #[error("the file is empty; copy or export it again")]
    Empty,
    /// Neither the content nor the extension says what it is.
    #[error(
        "its content is in no format that horma reads ({}); export the part in one of these",
        super::Format::NAMES
    )]
    Unrecognised,
    /// The file ends too early.
    #[error("the file ends at {place}, in the middle of {what}; copy or export it again")]
    Truncated {
        /// Where it ends.
        place: Place,
        /// What was being read.
        what: String,
    },
    /// A header promises more than the file can hold.
    #[error(
        "the header promises {claimed} {what}, but the {room} bytes after it hold {possible} at \
         most; the file was cut off or its header is wrong: copy or export it again"
    )]
    Lies {
        /// What was promised.
        what: String,
        /// How many of them.
        claimed: u64,
        /// Bytes left for them.
        room: u64,
        /// How many fit.
        possible: u64,
    },
    /// Something does not follow the rules of the format.
    #[error("{place}: {problem}; {remedy}")]
    Malformed {
        /// Where.
        place: Place,
        /// What is there.
        problem: String,
        /// What to do.
        remedy: &'static str,
    },
    /// A coordinate that is no length.
    #[error("coordinate {axis} of {place} is {value}; repair or re-export the part")]
    BadCoordinate {
        /// The vertex, point or triangle, counted from 1.
        place: Place,
        /// Which coordinate.
        axis: char,
        /// Its value.
        value: f64,
    },
    /// A face names a vertex that is not there.
    #[error(
        "{place}: a face names vertex {index}, but there are only {n_points} (counted from \
         {counted_from}); repair or re-export the part"
    )]
    NoSuchPoint {
        /// Where.
        place: Place,
        /// The vertex it names, as the file counts.
        index: i64,
        /// How many there are.
        n_points: usize,
        /// How the file counts.
        counted_from: i64,
    },
    /// Pictures, cameras or poses that cannot be.
    #[error("{0}")]
    Rgbd(#[from] crate::rgbd::RgbdError),
    /// A description that says something that cannot be.
    #[error("{place}: {problem}{excerpt}")]
    Description {
        /// File, line and column.
        place: String,
        /// What is wrong there.
        problem: String,
        /// The line with a mark under the place.
        excerpt: String,
    },
    /// Well-formed, but there is no pose in it.
    #[error("there are no poses in it; each line is: stamp tx ty tz qx qy qz qw")]
    NoPoses,
    /// A folder that is no sequence of frames.
    #[error(
        "it is no scan: there is neither rgb.txt or depth.txt (TUM) nor a folder depth/ with PNG pictures \
         in it"
    )]
    NoSequence,
    /// A sequence in which no depth goes with a colour.
    #[error(
        "there is no frame in it: no picture of depth is listed that has one of colour within 0.02 s; the \
         stamps of rgb.txt and depth.txt must be of one clock"
    )]
    NoFrames,
    /// Well-formed, but there is no surface in it.
    #[error("there are no {0} in it; export the part again, with its surface selected")]
    Nothing(&'static str),
}

/// A place in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// A line, counted from 1.
    Line(u64),
    /// A byte, counted from 0.
    Byte(u64),
    /// A thing of some kind, counted as the format counts, or from 1 where it does not.
    Thing(&'static str, u64),
    /// A whole part of the file.
    Part(&'static str),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line(number) => write!(f, "line {number}"),
            Self::Byte(offset) => write!(f, "byte {offset}"),
            Self::Thing(kind, number) => write!(f, "{kind} {number}"),
            Self::Part(name) => f.write_str(name),
        }
    }
}

impl Fault {
    /// A breach of the format's rules that only a new export can mend.
    pub(super) fn malformed(place: Place, problem: impl Into<String>) -> Self {
        Self::Malformed { place, problem: problem.into(), remedy: "repair or re-export the part" }
    }
}
