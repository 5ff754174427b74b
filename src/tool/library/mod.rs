//! The tool library: a TOML file that lists cutters, and looking one up in it.

mod file;

use super::{Place, Tool, ToolError, nearest};
use file::Flaw;

const BUILTIN: &str = include_str!("../../../machines/tools.toml");

/// The cutters of a workshop.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ToolLibrary {
    /// In the order of the file; names and numbers are unique.
    pub tools: Vec<Tool>,
}

impl ToolLibrary {
    /// The text of the library that comes with horma, to be copied and changed.
    pub const BUILTIN: &str = BUILTIN;

    /// The library that comes with horma.
    ///
    /// # Panics
    /// If the embedded file is wrong, which a test excludes.
    pub fn builtin() -> Self {
        Self::parse(BUILTIN, "machines/tools.toml").expect("a test parses the embedded library")
    }

    /// Reads a library from `text`; errors call it `file`.
    pub fn parse(text: &str, file: &str) -> Result<Self, ToolError> {
        file::read(text).map_err(|Flaw { span, problem }| ToolError::At {
            place: Place::new(text, file, span),
            problem: Box::new(problem),
        })
    }

    /// The tool called `wanted`: a name, a number (`3` or `T3`), or a shape (`wheel:60,10`, see
    /// [`Tool::from_shorthand`]).
    pub fn find(&self, wanted: &str) -> Result<Tool, ToolError> {
        if wanted.contains(':') {
            return Tool::from_shorthand(wanted);
        }
        let found = self.by_name(wanted).or_else(|| self.by_number(number(wanted)?));
        found.cloned().ok_or_else(|| ToolError::Unknown {
            name: wanted.to_owned(),
            nearest: nearest(wanted, self.names()).map(str::to_owned),
            known: self.names().map(str::to_owned).collect(),
        })
    }

    /// The tool of exactly this name.
    pub fn by_name(&self, name: &str) -> Option<&Tool> {
        self.tools.iter().find(|tool| tool.name == name)
    }

    /// The tool with this T word.
    pub fn by_number(&self, number: u32) -> Option<&Tool> {
        self.tools.iter().find(|tool| tool.number == number)
    }

    /// All names, in the order of the file.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.tools.iter().map(|tool| tool.name.as_str())
    }
}

/// `3` or `T3`.
fn number(text: &str) -> Option<u32> {
    text.strip_prefix(['T', 't']).unwrap_or(text).parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tool::{Profile, Shape, Turns};

    /// A library of one tool.
    pub(super) const BALL: &str = r#"[[tool]]
number = 7
name = "ball-6"
shape = "ball"
radius = 3
length = 60
speed-rpm = 12_000
turns = "counter-clockwise"
feed-mm-per-s = 40
plunge-feed-mm-per-s = 10
"#;

    #[test]
    fn a_library_gives_its_tools_by_name_and_by_number() {
        let library = ToolLibrary::parse(BALL, "shop.toml").unwrap();
        let ball = Tool {
            number: 7,
            name: "ball-6".to_owned(),
            profile: Profile::Ball { radius: 3.0 },
            length: 60.0,
            speed_rpm: 12_000.0,
            turns: Turns::CounterClockwise,
            feed: 40.0,
            plunge_feed: 10.0,
            body: None,
        };
        for wanted in ["ball-6", "7", "T7"] {
            assert_eq!(library.find(wanted).unwrap(), ball);
        }
        assert_eq!(library.find("ball:5").unwrap().profile, Profile::Ball { radius: 5.0 });
    }

    #[test]
    fn an_unknown_tool_is_answered_with_the_nearest_and_all_names() {
        let library = ToolLibrary::parse(BALL, "shop.toml").unwrap();
        assert_eq!(
            library.find("bal-6").unwrap_err().to_string(),
            "no tool is called \"bal-6\" (did you mean \"ball-6\"?); there are: ball-6; \
             or give its shape, as in wheel:60,10"
        );
        assert_eq!(
            library.find("8").unwrap_err().to_string(),
            "no tool is called \"8\"; there are: ball-6; or give its shape, as in wheel:60,10"
        );
    }

    #[test]
    fn the_embedded_library_has_the_wheels_and_end_mills_promised() {
        let library = ToolLibrary::builtin();
        assert_eq!(
            library.by_name("wheel-r60-r10").unwrap().profile,
            Profile::Wheel { major_radius: 60.0, minor_radius: 10.0 }
        );
        assert_eq!(
            library.by_name("wheel-r75-r12").unwrap().profile,
            Profile::Wheel { major_radius: 75.0, minor_radius: 12.0 }
        );
        assert_eq!(library.by_name("ball-6").unwrap().profile, Profile::Ball { radius: 3.0 });
        for shape in Shape::ALL {
            assert!(library.tools.iter().any(|tool| tool.profile.shape() == shape), "{shape:?}");
        }
    }
}
