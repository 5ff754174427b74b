//! Programs: a toolpath in a control's language, and back.
//!
//! [`post()`] turns a [`Toolpath`](crate::cam::Toolpath) into a [`Program`] for a [`Dialect`],
//! [`write()`] makes it text, [`read()`] makes text a program again, [`Program::steps`] replays it,
//! [`check()`] says what a machine would have against it, and [`restart()`] cuts its beginning off.
//!
//! A program is the twin of its file: words are millimetres and *degrees*, feeds are per minute,
//! each rounded once to the decimals of the dialect. [`Step`]s are back in radians and seconds.

mod check;
mod dialect;
mod feeds;
mod line;
mod modes;
mod number;
mod post;
mod problem;
mod program;
mod read;
mod replay;
mod restart;
mod scan;
mod split;
mod write;

pub use check::{
    AxisBounds, BlockRate, CheckReport, OperationTime, PlannedTime, Violation, ViolationKind, check,
};
pub use dialect::{
    CommentStyle, Decimals, Dialect, DialectError, DwellWord, DwellWords, EndWord, FeedLength,
    FeedWords, InverseTime, Language, MillimetreWord, Numbering, Rotary, Smoothing, Tape, TimeUnit,
    ToolChange,
};
pub use feeds::FeedLaw;
pub use modes::{Mode, Modes};
pub use post::{Header, Operation, PostError, PostWarning, Posted, post, post_operations};
pub use problem::Problem;
pub use program::{
    Address, Block, BlockKind, Coolant, LongestLine, Motion, MoveWords, Program, Spindle,
    SpindleRun,
};
pub use read::{ReadError, read};
pub use replay::{Position, Step, StepKind, Steps};
pub use restart::{RestartError, restart};
pub use split::{SplitError, split};
pub use write::write;
