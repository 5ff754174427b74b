//! A tool library as its file has it, checked where it stands.

use super::{ToolLibrary, number};
use crate::tool::{Body, Profile, Shape, Tool, ToolError, Turns, printable};
use std::collections::HashSet;
use std::ops::Range;
use toml::Spanned;

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
pub(super) struct Flaw {
    pub(super) span: Range<usize>,
    pub(super) problem: ToolError,
}

fn flaw<T>(value: &Spanned<T>, problem: ToolError) -> Flaw {
    Flaw { span: value.span(), problem }
}

/// Reads `text`, and says between which bytes it is wrong.
pub(super) fn read(text: &str) -> Result<ToolLibrary, Flaw> {
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

#[cfg(test)]
mod tests {
    use super::super::tests::BALL;
    use crate::tool::ToolLibrary;

    /// The error of `BALL` with `old` replaced by `new`, without the excerpt.
    fn error(old: &str, new: &str) -> String {
        assert!(BALL.contains(old), "{old:?} is not in the sample");
        let error = ToolLibrary::parse(&BALL.replacen(old, new, 1), "shop.toml").unwrap_err();
        error.to_string().lines().next().unwrap().to_owned()
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
}
