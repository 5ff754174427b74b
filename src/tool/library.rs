//! The tool library: a TOML file that lists cutters, and looking one up in it.

use super::{Body, Place, Profile, Shape, Tool, ToolError, Turns, nearest, printable};
use std::collections::HashSet;
use std::ops::Range;
use toml::Spanned;

const BUILTIN: &str = include_str!("../../machines/tools.toml");

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
        read(text).map_err(|Flaw { span, problem }| ToolError::At {
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

/// The file as it is written; `machines/tools.toml` explains the keys.
#[derive(serde::Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
struct LibraryFile {
    tool: Vec<ToolFile>,
}

#[derive(serde::Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
struct ToolFile {
    number: Spanned<u32>,
    name: Spanned<String>,
    shape: Spanned<Shape>,
    major_radius: Option<Spanned<f64>>,
    minor_radius: Option<Spanned<f64>>,
    radius: Option<Spanned<f64>>,
    corner_radius: Option<Spanned<f64>>,
    tip_radius: Option<Spanned<f64>>,
    half_angle_deg: Option<Spanned<f64>>,
    length: Spanned<f64>,
    speed_rpm: Spanned<f64>,
    turns: Turns,
    feed_mm_per_s: Spanned<f64>,
    plunge_feed_mm_per_s: Spanned<f64>,
    body: Option<Spanned<Body>>,
}

impl ToolFile {
    /// What the file gives for each key of a shape.
    fn dimensions(&self) -> [(&'static str, Option<&Spanned<f64>>); 6] {
        [
            ("major-radius", self.major_radius.as_ref()),
            ("minor-radius", self.minor_radius.as_ref()),
            ("radius", self.radius.as_ref()),
            ("corner-radius", self.corner_radius.as_ref()),
            ("tip-radius", self.tip_radius.as_ref()),
            ("half-angle-deg", self.half_angle_deg.as_ref()),
        ]
    }

    fn dimension(&self, key: &str) -> Option<&Spanned<f64>> {
        self.dimensions().into_iter().find(|(own, _)| *own == key)?.1
    }
}

/// What is wrong, and between which bytes.
struct Flaw {
    span: Range<usize>,
    problem: ToolError,
}

fn flaw<T>(value: &Spanned<T>, problem: ToolError) -> Flaw {
    Flaw { span: value.span(), problem }
}

fn read(text: &str) -> Result<ToolLibrary, Flaw> {
    let file: LibraryFile = toml::from_str(text).map_err(|error| Flaw {
        span: error.span().unwrap_or_default(),
        problem: ToolError::Syntax(printable(error.message())),
    })?;
    let (mut names, mut numbers) = (HashSet::new(), HashSet::new());
    for ToolFile { name, number, .. } in &file.tool {
        if !names.insert(name.get_ref()) {
            let value = format!("{:?}", name.get_ref());
            return Err(flaw(name, ToolError::Twice { key: "name", value }));
        }
        if !numbers.insert(number.get_ref()) {
            let value = number.get_ref().to_string();
            return Err(flaw(number, ToolError::Twice { key: "number", value }));
        }
    }
    Ok(ToolLibrary { tools: file.tool.iter().map(tool).collect::<Result<_, _>>()? })
}

fn tool(file: &ToolFile) -> Result<Tool, Flaw> {
    if !is_name(file.name.get_ref()) {
        let name = file.name.get_ref().clone();
        return Err(flaw(&file.name, ToolError::Name { name }));
    }
    if *file.number.get_ref() == 0 {
        let rule = "at least 1, since T0 stands for no tool";
        return Err(flaw(&file.number, ToolError::Number { key: "number", value: 0.0, rule }));
    }
    if !(0.0..f64::INFINITY).contains(file.length.get_ref()) {
        let (value, rule) = (*file.length.get_ref(), "0 or greater");
        return Err(flaw(&file.length, ToolError::Number { key: "length", value, rule }));
    }
    Ok(Tool {
        number: *file.number.get_ref(),
        name: file.name.get_ref().clone(),
        profile: profile(file)?,
        length: *file.length.get_ref(),
        speed_rpm: positive("speed-rpm", &file.speed_rpm)?,
        turns: file.turns,
        feed: positive("feed-mm-per-s", &file.feed_mm_per_s)?,
        plunge_feed: positive("plunge-feed-mm-per-s", &file.plunge_feed_mm_per_s)?,
        body: body(file)?,
    })
}

fn body(file: &ToolFile) -> Result<Option<Body>, Flaw> {
    let Some(given) = &file.body else { return Ok(None) };
    let checked = given.get_ref().check(*file.shape.get_ref(), *file.length.get_ref());
    checked.map_err(|problem| flaw(given, problem.into()))?;
    Ok(Some(*given.get_ref()))
}

fn profile(file: &ToolFile) -> Result<Profile, Flaw> {
    let shape = *file.shape.get_ref();
    for (key, value) in file.dimensions() {
        if let (Some(value), false) = (value, shape.keys().contains(&key)) {
            return Err(flaw(value, ToolError::ForeignDimension { shape, key }));
        }
    }
    let mut values = Vec::new();
    for &key in shape.keys() {
        let missing = || flaw(&file.shape, ToolError::MissingDimension { shape, key });
        values.push(*file.dimension(key).ok_or_else(missing)?.get_ref());
    }
    let count = || flaw(&file.shape, ToolError::MissingDimension { shape, key: shape.keys()[0] });
    let profile = shape.profile(&values).ok_or_else(count)?;
    profile.check().map_err(|problem| {
        let span = match problem {
            ToolError::Dimension { key, .. } => file.dimension(key).map(Spanned::span),
            _ => None,
        };
        Flaw { span: span.unwrap_or_else(|| file.shape.span()), problem }
    })?;
    Ok(profile)
}

fn positive(key: &'static str, given: &Spanned<f64>) -> Result<f64, Flaw> {
    let value = *given.get_ref();
    if 0.0 < value && value.is_finite() {
        return Ok(value);
    }
    Err(flaw(given, ToolError::Number { key, value, rule: "greater than 0" }))
}

/// Names stay apart from numbers, shapes and paths, and are safe in any program's comments.
fn is_name(name: &str) -> bool {
    name.starts_with(|first: char| first.is_ascii_alphabetic())
        && name.chars().all(|c| c.is_ascii_alphanumeric() || "-_".contains(c))
        && number(name).is_none()
}

/// `3` or `T3`.
fn number(text: &str) -> Option<u32> {
    text.strip_prefix(['T', 't']).unwrap_or(text).parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    const BALL: &str = r#"[[tool]]
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

    /// The error of `BALL` with `old` replaced by `new`, without the excerpt.
    fn error(old: &str, new: &str) -> String {
        assert!(BALL.contains(old), "{old:?} is not in the sample");
        let error = ToolLibrary::parse(&BALL.replacen(old, new, 1), "shop.toml").unwrap_err();
        error.to_string().lines().next().unwrap().to_owned()
    }

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
    fn a_body_is_read_and_refused_where_it_stands() {
        let with = |body: &str| format!("{BALL}body = {{ {body} }}\n");
        let text =
            with("shank-diameter = 6, flute-length = 13, stick-out = 30, holder-diameter = 32");
        let library = ToolLibrary::parse(&text, "shop.toml").unwrap();
        let body = library.tools[0].body.unwrap();
        assert_eq!((body.shank_diameter, body.stick_out), (Some(6.0), Some(30.0)));
        let message = |body: &str| {
            let error = ToolLibrary::parse(&with(body), "shop.toml").unwrap_err().to_string();
            error.lines().next().unwrap().to_owned()
        };
        assert_eq!(
            message("shank-diameter = 6"),
            "shop.toml:11:8: shank-diameter says where something is only together with \
             flute-length; give both or none"
        );
        assert!(message("shanks = 6").starts_with("shop.toml:11:10: unknown field `shanks`"));
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
    fn a_negative_tool_radius_is_refused_with_line_and_column_shown() {
        let text = BALL.replace("radius = 3", "radius = -3");
        assert_eq!(
            ToolLibrary::parse(&text, "shop.toml").unwrap_err().to_string(),
            "shop.toml:5:10: a ball cannot have a radius of -3: it must be greater than 0 and at \
             most 10000 mm\n  |\n5 | radius = -3\n  |          ^^"
        );
    }

    #[test]
    fn an_unknown_key_is_refused_with_line_and_column() {
        let message = error("length =", "lenght =");
        assert!(message.starts_with("shop.toml:6:1: unknown field `lenght`"), "{message}");
    }

    #[test]
    fn a_missing_key_is_refused_at_its_tool() {
        assert_eq!(error("length = 60\n", ""), "shop.toml:1:1: missing field `length`");
    }

    #[test]
    fn a_file_that_is_no_toml_is_refused_where_it_goes_wrong() {
        let message = error("\"ball-6\"", "\"ball-6");
        assert!(message.starts_with("shop.toml:3:15: "), "{message}");
    }

    #[test]
    fn dimensions_must_be_those_of_the_shape() {
        assert_eq!(
            error("radius = 3", "radius = 3\ncorner-radius = 1"),
            "shop.toml:6:17: a ball has no corner-radius; its dimensions are radius"
        );
        assert_eq!(
            error("\"ball\"", "\"bull\""),
            "shop.toml:4:9: a bull needs a corner-radius; its dimensions are radius, corner-radius"
        );
    }

    #[test]
    fn speeds_feeds_and_lengths_are_checked_where_they_stand() {
        assert_eq!(
            error("12_000", "0"),
            "shop.toml:7:13: speed-rpm is 0: it must be greater than 0"
        );
        assert_eq!(
            error("s = 40", "s = nan"),
            "shop.toml:9:17: feed-mm-per-s is NaN: it must be greater than 0"
        );
        assert_eq!(
            error("s = 10", "s = -inf"),
            "shop.toml:10:24: plunge-feed-mm-per-s is -inf: it must be greater than 0"
        );
        assert_eq!(
            error("length = 60", "length = -1"),
            "shop.toml:6:10: length is -1: it must be 0 or greater"
        );
    }

    #[test]
    fn names_and_numbers_are_unique_and_tell_themselves_apart() {
        let twice = format!("{BALL}{BALL}");
        let message = ToolLibrary::parse(&twice, "shop.toml").unwrap_err().to_string();
        assert!(
            message.starts_with(
                "shop.toml:13:8: there are two tools with the name \"ball-6\"; give each its own"
            ),
            "{message}"
        );
        let twice = format!("{BALL}{}", BALL.replace("ball-6", "ball-8"));
        let message = ToolLibrary::parse(&twice, "shop.toml").unwrap_err().to_string();
        assert!(
            message.starts_with(
                "shop.toml:12:10: there are two tools with the number 7; give each its own"
            ),
            "{message}"
        );
        assert_eq!(
            error("number = 7", "number = 0"),
            "shop.toml:2:10: number is 0: it must be at least 1, since T0 stands for no tool"
        );
        for name in ["", "7", "T7", "ball:3", "a/b", "two words", "M30)"] {
            assert_eq!(
                error("ball-6", name),
                format!(
                    "shop.toml:3:8: {name:?} cannot be the name of a tool: use letters, digits, - \
                     and _, beginning with a letter"
                )
            );
        }
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
