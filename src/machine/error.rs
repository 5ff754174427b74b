//! Why a machine cannot be used.

use super::{AxisKind, Mount};
use crate::tool::{Place, ToolError, hint};

/// Why a machine, or the file that describes it, cannot be used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MachineError {
    /// A problem at a place in a machine file.
    #[error("{place}: {problem}{}", place.excerpt())]
    At {
        /// Where.
        place: Place,
        /// What is wrong there.
        problem: Box<MachineError>,
    },
    /// No machine of that name comes with horma.
    #[error(
        "no machine is called {name:?}{}; there are: {}; or give the path of a machine file",
        hint(nearest.as_deref()), known.join(", ")
    )]
    Unknown {
        /// What was asked for.
        name: String,
        /// The machine that was perhaps meant.
        nearest: Option<String>,
        /// All names.
        known: Vec<String>,
    },
    /// The text is no TOML, or no machine file: an unknown key, a missing one, a wrong type.
    #[error("{0}")]
    Syntax(String),
    /// A name with other characters than a name has.
    #[error("{value:?} cannot be a {key}: use letters, digits, - and _, beginning with a letter")]
    Name {
        /// The key in the file.
        key: &'static str,
        /// What was given.
        value: String,
    },
    /// A title with line breaks or other control characters, which would end up in programs.
    #[error("the title has a control character in it; write one line of plain text")]
    Title,
    /// A number out of range.
    #[error("{key} is {value}: it must be {rule}")]
    Number {
        /// The key in the file.
        key: &'static str,
        /// What was given.
        value: f64,
        /// What is possible.
        rule: &'static str,
    },
    /// An obstacle where there is none.
    #[error(
        "{key} is for a machine that holds the part {beside}, and this one does not: leave it out"
    )]
    Obstacle {
        /// The key in the file.
        key: &'static str,
        /// How the part must be held.
        beside: &'static str,
    },
    /// A letter programs do not use for that kind of axis.
    #[error(
        "{letter:?} cannot be the letter of a {} axis: programs call linear axes X, Y, Z, U, V or W \
         and rotary ones A, B or C", kind_word(*kind)
    )]
    Letter {
        /// What was given.
        letter: char,
        /// Of what kind the axis is.
        kind: AxisKind,
    },
    /// Two axes under one letter.
    #[error("there are two axes {letter}; give each its own letter")]
    LetterTwice {
        /// What both have.
        letter: char,
    },
    /// More axes than a position has room for.
    #[error("a machine can have at most {limit} axes, and {letter} is one more", limit = super::MAX_AXES)]
    TooManyAxes {
        /// The first one too many.
        letter: char,
    },
    /// An axis named elsewhere in the file is not described in it.
    #[error("{key} names the axis {letter}, but there is none; the axes are {}", axes.join(", "))]
    NoAxis {
        /// The key in the file.
        key: &'static str,
        /// The missing axis.
        letter: char,
        /// Those there are.
        axes: Vec<String>,
    },
    /// A vector that points nowhere.
    #[error(
        "axis {letter}: the direction {direction:?} points nowhere; give a vector with a length"
    )]
    Direction {
        /// The axis.
        letter: char,
        /// What was given.
        direction: [f64; 3],
    },
    /// A key an axis of its kind must have is not given.
    #[error("axis {letter} is {} and needs {key}", kind_word(*kind))]
    Missing {
        /// The axis.
        letter: char,
        /// Of what kind it is.
        kind: AxisKind,
        /// The key in the file.
        key: &'static str,
    },
    /// A key that belongs to the other kind of axis.
    #[error("axis {letter} is {}: {given} is for the other kind of axis; {remedy}", kind_word(*kind))]
    OtherKind {
        /// The axis.
        letter: char,
        /// Of what kind it is.
        kind: AxisKind,
        /// The key in the file.
        given: &'static str,
        /// What to do.
        remedy: String,
    },
    /// Limits that leave no travel.
    #[error("axis {letter}: the limits {limits:?} leave no travel; write the least word first")]
    Limits {
        /// The axis.
        letter: char,
        /// What was given [mm or deg].
        limits: [f64; 2],
    },
    /// A rotary axis under the tool.
    #[error(
        "axis {letter} is rotary and carries the tool: horma drives machines whose rotary axes \
         carry the part; a swivelling head must be described at one fixed angle"
    )]
    RotaryTool {
        /// The axis.
        letter: char,
    },
    /// The attack axis must slide.
    #[error("the attack axis must be linear, and {letter} is rotary")]
    AttackNotLinear {
        /// The axis.
        letter: char,
    },
    /// The attack axis must keep its direction.
    #[error(
        "the attack axis {letter} rides on the rotary axis {rotary}, so its direction changes; \
         list it before {rotary}, or name another attack axis"
    )]
    AttackTurns {
        /// The axis.
        letter: char,
        /// The axis that turns it.
        rotary: char,
    },
    /// Not square to the machine's X as it has to be.
    #[error(
        "the attack axis {letter} must be square to X of the machine frame, along which {along} \
         lies; describe the machine in another frame, letters are free"
    )]
    AttackNotSquare {
        /// The axis.
        letter: char,
        /// What lies along X.
        along: &'static str,
    },
    /// The spindle must turn.
    #[error("the spindle must be a rotary axis, and {letter} is linear")]
    SpindleNotRotary {
        /// The axis.
        letter: char,
    },
    /// The spindle must turn about X.
    #[error(
        "the spindle {letter} must turn about X of the machine frame: X runs along the spindle; \
         describe the machine in such a frame, letters are free"
    )]
    SpindleNotAlongX {
        /// The axis.
        letter: char,
    },
    /// An axis that others drive cannot be driven.
    #[error("{key} must be driven on its own, and {letter} follows another axis")]
    NotDriven {
        /// The key in the file.
        key: &'static str,
        /// The axis.
        letter: char,
    },
    /// Axes that follow each other in a circle.
    #[error("no axis leads: {} follow each other in a circle; let one of them go free", letters.join(" -> "))]
    FollowCircle {
        /// The circle, from the first axis back to it.
        letters: Vec<String>,
    },
    /// An axis that follows a follower.
    #[error(
        "axis {letter} follows {leader}, which follows {driven} itself; let it follow {driven}"
    )]
    FollowFollower {
        /// The axis.
        letter: char,
        /// What it names.
        leader: char,
        /// The axis that is driven.
        driven: char,
    },
    /// An axis that follows one of the other kind.
    #[error("axis {letter} is {} and cannot follow {leader}, which is not", kind_word(*kind))]
    FollowKind {
        /// The axis.
        letter: char,
        /// Of what kind it is.
        kind: AxisKind,
        /// What it names.
        leader: char,
    },
    /// The default tool is a shape that cannot be.
    #[error(transparent)]
    Tool(ToolError),
    /// The tool does not go onto the machine.
    #[error("the tool {tool} does not fit: {}", misfit(*mount))]
    Misfit {
        /// The tool's name.
        tool: String,
        /// How tools sit on the machine.
        mount: Mount,
    },
}

fn kind_word(kind: AxisKind) -> &'static str {
    match kind {
        AxisKind::Linear => "linear",
        AxisKind::Rotary => "rotary",
    }
}

fn misfit(mount: Mount) -> &'static str {
    match mount {
        Mount::Across => {
            "the cutter sits across the attack axis, where only a wheel cuts; choose a wheel"
        }
        Mount::Along => {
            "the cutter sits along the attack axis, where a wheel cannot; choose an end mill"
        }
    }
}
