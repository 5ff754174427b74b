//! Why a tool cannot be used.

use super::{BodyError, Place, Shape};

/// Why a tool, or a library of tools, cannot be used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ToolError {
    /// A problem at a place in a tool library.
    #[error("{place}: {problem}{}", place.excerpt())]
    At {
        /// Where.
        place: Place,
        /// What is wrong there.
        problem: Box<ToolError>,
    },
    /// The text is no TOML, or no tool library: an unknown key, a missing one, a wrong type.
    #[error("{0}")]
    Syntax(String),
    /// A dimension no tool can have.
    #[error("a {} cannot have a {key} of {value}: it must be {rule}", shape.word())]
    Dimension {
        /// The kind of profile.
        shape: Shape,
        /// The dimension, by its key in files.
        key: &'static str,
        /// What was given [mm or deg].
        value: f64,
        /// What is possible.
        rule: String,
    },
    /// A dimension the shape needs is not given.
    #[error("a {} needs a {key}; its dimensions are {}", shape.word(), shape.keys().join(", "))]
    MissingDimension {
        /// The kind of profile.
        shape: Shape,
        /// The dimension, by its key in files.
        key: &'static str,
    },
    /// A dimension of another shape is given.
    #[error("a {} has no {key}; its dimensions are {}", shape.word(), shape.keys().join(", "))]
    ForeignDimension {
        /// The kind of profile.
        shape: Shape,
        /// The dimension, by its key in files.
        key: &'static str,
    },
    /// A speed, feed or length out of range.
    #[error("{key} is {value}: it must be {rule}")]
    Number {
        /// The key in the file.
        key: &'static str,
        /// What was given.
        value: f64,
        /// What is possible.
        rule: &'static str,
    },
    /// What does not cut cannot be.
    #[error(transparent)]
    Body(#[from] BodyError),
    /// A name that could not be told from a number, a shape or a path.
    #[error(
        "{name:?} cannot be the name of a tool: use letters, digits, - and _, beginning with a letter"
    )]
    Name {
        /// What was given.
        name: String,
    },
    /// Two tools under one name or number.
    #[error("there are two tools with the {key} {value}; give each its own")]
    Twice {
        /// `name` or `number`.
        key: &'static str,
        /// What both have.
        value: String,
    },
    /// No tool of that name or number.
    #[error(
        "no tool is called {name:?}{}; there are: {}; or give its shape, as in wheel:60,10",
        hint(nearest.as_deref()), known.join(", ")
    )]
    Unknown {
        /// What was asked for.
        name: String,
        /// The tool that was perhaps meant.
        nearest: Option<String>,
        /// All names.
        known: Vec<String>,
    },
    /// A shape on the command line that cannot be read.
    #[error(
        "{text:?} is not a tool: {problem}; write a shape and its dimensions in mm and degrees, \
         as in wheel:60,10 ball:3 flat:5 bull:6,1 cone:5,30 ball-cone:5,1,15"
    )]
    Shorthand {
        /// What was given.
        text: String,
        /// What is wrong with it.
        problem: String,
    },
}

/// The words that suggest `nearest`, or none.
pub(crate) fn hint(nearest: Option<&str>) -> String {
    nearest.map_or_else(String::new, |name| format!(" (did you mean {name:?}?)"))
}

/// The one of `known` that `name` was perhaps meant to be.
pub(crate) fn nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    // Pairs of letters in common: forgives a part of a name as well as a slip of the fingers.
    let likeness = |other: &str| strsim::sorensen_dice(&name.to_lowercase(), other);
    let best = known.into_iter().max_by(|a, b| likeness(a).total_cmp(&likeness(b)))?;
    (0.5 < likeness(best)).then_some(best)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slip_and_a_part_of_a_name_are_recognised_and_nonsense_is_not() {
        let known = ["last-lathe", "last-lathe-pair", "mill-3axis"];
        assert_eq!(nearest("last-lahte", known), Some("last-lathe"));
        assert_eq!(nearest("Lathe", known), Some("last-lathe"));
        assert_eq!(nearest("mill3axis", known), Some("mill-3axis"));
        assert_eq!(nearest("toaster", known), None);
        assert_eq!(nearest("", known), None);
    }
}
