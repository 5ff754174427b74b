//! `horma tool`: which tools there are, what one is, whether a file is a tool library.

use super::machine::mistake;
use super::table::{number, table};
use super::{Shell, print};
use anyhow::Context;
use clap::{Args, Subcommand};
use horma::io;
use horma::tool::{Cylinder, Tool, ToolLibrary, Turns};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// List tools, show one, or check a tool library.
#[derive(Debug, Args)]
pub(crate) struct ToolArgs {
    #[command(subcommand)]
    action: Action,
}

#[derive(Debug, Subcommand)]
enum Action {
    /// List the tools of a library.
    List {
        /// The tool library [default: the one of horma].
        #[arg(long, value_name = "FILE")]
        tools: Option<PathBuf>,
        /// Print the library file of horma itself, to be copied and changed.
        #[arg(long, conflicts_with_all = ["json", "tools"])]
        toml: bool,
    },
    /// Show one tool.
    Show {
        /// Its name, its number, or a shape such as wheel:60,10.
        tool: String,
        /// The tool library [default: the one of horma].
        #[arg(long, value_name = "FILE")]
        tools: Option<PathBuf>,
    },
    /// Check a tool library; mistakes are shown with line and column.
    Check {
        /// The tool library.
        file: PathBuf,
    },
}

/// Runs the chosen action.
pub(crate) fn run(args: &ToolArgs, shell: &Shell) -> anyhow::Result<()> {
    match &args.action {
        Action::List { toml: true, .. } => print(ToolLibrary::BUILTIN),
        Action::List { tools, toml: false } => list(&io::read_tools(tools.as_deref())?, shell),
        Action::Show { tool, tools } => {
            let tool = io::read_tools(tools.as_deref())?.find(tool)?;
            shell.report(&description(&tool), &summary(&tool))
        }
        Action::Check { file } => check(file, shell),
    }
}

fn list(library: &ToolLibrary, shell: &Shell) -> anyhow::Result<()> {
    let head = ["T", "NAME", "SHAPE", "LENGTH", "SPEED", "FEED", "PLUNGE"];
    let mut rows = vec![head.map(str::to_owned)];
    rows.extend(library.tools.iter().map(|tool| {
        [
            tool.number.to_string(),
            tool.name.clone(),
            tool.profile.to_string(),
            format!("{} mm", number(tool.length)),
            format!("{} rpm", number(tool.speed_rpm)),
            format!("{} mm/s", number(tool.feed)),
            format!("{} mm/s", number(tool.plunge_feed)),
        ]
    }));
    let all: Vec<Value> = library.tools.iter().map(description).collect();
    shell.report(&all, &table(&rows))
}

fn check(file: &Path, shell: &Shell) -> anyhow::Result<()> {
    match io::read_tools(Some(file)) {
        Ok(library) => {
            let n_tools = library.tools.len();
            let text = format!("ok: {} lists {n_tools} tool(s)", file.display());
            shell.report(&json!({ "ok": true, "n-tools": n_tools }), &text)
        }
        Err(error) => {
            if shell.json {
                shell.report(&mistake(&error), "")?;
            }
            Err(error).context("the tool library cannot be used")
        }
    }
}

/// A tool as its library has it: degrees, and units in the keys.
fn description(tool: &Tool) -> Value {
    let mut all = json!({
        "number": tool.number,
        "name": tool.name,
        "shape": tool.profile.shape(),
        "length": tool.length,
        "speed-rpm": tool.speed_rpm,
        "turns": tool.turns,
        "feed-mm-per-s": tool.feed,
        "plunge-feed-mm-per-s": tool.plunge_feed,
    });
    for (&key, value) in tool.profile.shape().keys().iter().zip(tool.profile.dimensions()) {
        all[key] = json!(value);
    }
    if let Some(body) = &tool.body {
        all["body"] = json!(body);
    }
    all
}

/// A tool for people.
fn summary(tool: &Tool) -> String {
    let turns = match tool.turns {
        Turns::Clockwise => "clockwise",
        Turns::CounterClockwise => "counter-clockwise",
    };
    let profile = &tool.profile;
    let dimensions: Vec<String> = profile
        .shape()
        .keys()
        .iter()
        .zip(profile.dimensions())
        .map(|(key, value)| match key.strip_suffix("-deg") {
            Some(angle) => format!("{} {} deg", angle.replace('-', " "), number(value)),
            None => format!("{} {} mm", key.replace('-', " "), number(value)),
        })
        .collect();
    format!(
        "{}: T{}, {} with {}\n  length  {} mm\n  speed   {} rpm, {turns}\n  feed    {} mm/s, \
         plunging {} mm/s{}",
        tool.name,
        tool.number,
        profile.shape().word(),
        dimensions.join(", "),
        number(tool.length),
        number(tool.speed_rpm),
        number(tool.feed),
        number(tool.plunge_feed),
        body(tool)
    )
}

/// What of a tool does not cut, a line each.
fn body(tool: &Tool) -> String {
    let line = |cylinder: &Cylinder| {
        let [from, to] = cylinder.stretch;
        let stretch = match (from.is_finite(), to.is_finite()) {
            (true, true) => format!("from {} to {} mm", number(from), number(to)),
            (true, false) => format!("from {} mm on", number(from)),
            _ => format!("up to {} mm", number(to)),
        };
        format!(
            "\n  {:<8}{} mm wide {stretch}",
            cylinder.part.word(),
            number(2.0 * cylinder.radius)
        )
    };
    tool.cylinders().iter().map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use horma::tool::{Body, Side};

    #[test]
    fn the_json_of_the_tools_is_a_library_of_the_same_tools() {
        let library = ToolLibrary::builtin();
        let all: Vec<Value> = library.tools.iter().map(description).collect();
        let text = toml::to_string(&json!({ "tool": all })).unwrap();
        assert_eq!(ToolLibrary::parse(&text, "shop.toml").unwrap(), library);
    }

    #[test]
    fn a_body_is_told_to_people_and_kept_in_json() {
        let body = Body {
            spindle_side: Some(Side::Heel),
            spindle_diameter: Some(90.0),
            arbor_diameter: Some(40.0),
            nut_length: Some(30.0),
            ..Body::default()
        };
        let tool = Tool { body: Some(body), ..Tool::from_shorthand("wheel:60,10").unwrap() };
        let text = summary(&tool);
        assert!(text.contains("\n  arbor   40 mm wide from -50 to 30 mm"), "{text}");
        assert!(text.contains("\n  spindle 90 mm wide up to -50 mm"), "{text}");
        assert_eq!(description(&tool)["body"]["spindle-side"], "heel");
    }

    #[test]
    fn a_summary_names_every_dimension_with_its_unit() {
        let tool = Tool::from_shorthand("ball-cone:5,1,15").unwrap();
        assert_eq!(
            summary(&tool).lines().next().unwrap(),
            "ball-cone:5,1,15: T99, ball-cone with radius 5 mm, tip radius 1 mm, half angle 15 deg"
        );
    }
}
