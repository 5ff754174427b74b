//! `horma dialect`: which controls horma can talk to, how, and whether a file describes one.

use super::machine::mistake;
use super::table::{number, table};
use super::{Shell, print};
use anyhow::Context;
use clap::{Args, Subcommand};
use horma::gcode::{Coolant, Dialect, FeedLength, Language, Rotary, TimeUnit, ToolChange};
use horma::io;
use serde_json::{Value, json};
use std::fmt::Write;

/// List the controls horma writes programs for, show one, or check a dialect file.
#[derive(Debug, Args)]
pub(crate) struct DialectArgs {
    #[command(subcommand)]
    action: Action,
}

#[derive(Debug, Subcommand)]
enum Action {
    /// List the dialects that come with horma.
    List,
    /// Show how a control wants its programs.
    Show {
        /// A dialect's name, or the path of a dialect file.
        dialect: String,
        /// Print the dialect file itself, to be copied and changed.
        #[arg(long, conflicts_with = "json")]
        toml: bool,
    },
    /// Check a dialect file; mistakes are shown with line and column.
    Check {
        /// The path of a dialect file, or a dialect's name.
        dialect: String,
    },
}

/// Runs the chosen action.
pub(crate) fn run(args: &DialectArgs, shell: &Shell) -> anyhow::Result<()> {
    match &args.action {
        Action::List => list(shell),
        Action::Show { dialect, toml: true } => print(&io::read_dialect_text(dialect)?),
        Action::Show { dialect, toml: false } => {
            let dialect = io::read_dialect(dialect)?;
            shell.report(&description(&dialect), &summary(&dialect))
        }
        Action::Check { dialect } => check(dialect, shell),
    }
}

fn list(shell: &Shell) -> anyhow::Result<()> {
    let dialects: Vec<Dialect> = Dialect::names().map(Dialect::named).collect::<Result<_, _>>()?;
    let mut rows = vec![["NAME", "FILES", "ROTARY AXES", "TITLE"].map(str::to_owned)];
    rows.extend(dialects.iter().map(|dialect| {
        [
            dialect.name.clone(),
            format!(".{}", dialect.extension),
            rotary(dialect).to_owned(),
            dialect.title.clone(),
        ]
    }));
    let all: Vec<Value> = dialects.iter().map(description).collect();
    shell.report(&all, &table(&rows))
}

fn check(file: &str, shell: &Shell) -> anyhow::Result<()> {
    match io::read_dialect(file) {
        Ok(dialect) => {
            let text = format!("ok: {file} describes {}, {}", dialect.name, dialect.title);
            shell.report(&json!({ "ok": true, "dialect": description(&dialect) }), &text)
        }
        Err(error) => {
            if shell.json {
                shell.report(&mistake(&error), "")?;
            }
            Err(error).context("the dialect file cannot be used")
        }
    }
}

/// What there is to tell about a dialect, a name and a value each.
fn rows(dialect: &Dialect) -> Vec<(&'static str, String)> {
    let decimals = dialect.decimals;
    let coolants: Vec<&str> =
        dialect.coolants.iter().map(|coolant| coolant_name(*coolant)).collect();
    let bytes = |most: Option<usize>| most.map_or("any".to_owned(), |most| most.to_string());
    vec![
        ("language", language(dialect.language).to_owned()),
        ("files", format!(".{}", dialect.extension)),
        ("lines", format!("up to {} bytes", dialect.line_length)),
        ("size", format!("{} bytes", bytes(dialect.max_program_bytes))),
        ("rotary", rotary(dialect).to_owned()),
        ("decimals", format!("{} of mm, {} of degrees", decimals.linear, decimals.rotary)),
        ("feed", feed(dialect)),
        ("timed", timed(dialect)),
        ("corners", corners(dialect)),
        ("tools", tools(dialect.tool_change).to_owned()),
        ("coolants", if coolants.is_empty() { "none".to_owned() } else { coolants.join(", ") }),
    ]
}

fn description(dialect: &Dialect) -> Value {
    let mut all = json!({ "name": dialect.name, "title": dialect.title });
    for (name, value) in rows(dialect) {
        all[name] = json!(value);
    }
    all
}

fn summary(dialect: &Dialect) -> String {
    let mut text = format!("{}: {}\n\n", dialect.name, dialect.title);
    for (name, value) in rows(dialect) {
        // Writing to a String cannot fail.
        let _ = writeln!(text, "  {name:<10} {value}");
    }
    text
}

fn language(language: Language) -> &'static str {
    match language {
        Language::Iso => "letters and numbers",
        Language::Siemens => "letters and numbers, Siemens' calls",
        Language::Klartext => "Klartext",
    }
}

fn rotary(dialect: &Dialect) -> &'static str {
    match dialect.rotary {
        Rotary::None => "none",
        Rotary::Unwound => "counted on",
        Rotary::Modulo => "0 to 360",
        Rotary::Increments => "increments",
        Rotary::Rezero { .. } => "counted on, turns taken off",
    }
}

fn feed(dialect: &Dialect) -> String {
    match dialect.feed.measures {
        FeedLength::LinearFirst => {
            "of the linear axes; of the rotary ones if they move alone".into()
        }
        FeedLength::AllAxes => {
            format!("of all axes together, a degree as {} mm", number(dialect.feed.degree_mm))
        }
    }
}

fn timed(dialect: &Dialect) -> String {
    let inverse = |unit| match unit {
        TimeUnit::PerMinute => "G93, F one over minutes".to_owned(),
        TimeUnit::Seconds => "G93, F in seconds".to_owned(),
    };
    dialect
        .inverse_time
        .map_or_else(|| "by the feed of each block".to_owned(), |keys| inverse(keys.unit))
}

fn corners(dialect: &Dialect) -> String {
    dialect.smoothing.as_ref().map_or_else(
        || "as the control is set".to_owned(),
        |smoothing| {
            format!("{}, {} mm unless told", smoothing.on.join(" / "), number(smoothing.tolerance))
        },
    )
}

fn tools(change: ToolChange) -> &'static str {
    match change {
        ToolChange::Automatic => "changed by the machine",
        ToolChange::ByHand => "changed by hand while the program waits",
    }
}

fn coolant_name(coolant: Coolant) -> &'static str {
    match coolant {
        Coolant::Off => "off",
        Coolant::Mist => "mist",
        Coolant::Flood => "flood",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_summary_tells_what_a_machinist_asks_first() {
        let beckhoff = summary(&Dialect::named("beckhoff").unwrap());
        assert!(beckhoff.contains("timed      G93, F in seconds\n"), "{beckhoff}");
        let grbl = summary(&Dialect::named("grbl").unwrap());
        assert!(grbl.contains("rotary     none\n"), "{grbl}");
        let heidenhain = summary(&Dialect::named("heidenhain").unwrap());
        assert!(heidenhain.contains("timed      by the feed of each block\n"), "{heidenhain}");
    }
}
