//! `horma machine`: which machines there are, what one is, whether a file describes one.

use super::table::{number, table};
use super::{Shell, print};
use anyhow::Context;
use clap::{Args, Subcommand};
use horma::gcode::DialectError;
use horma::io::{self, DescriptionError};
use horma::machine::{
    Axis, AxisKind, Carries, Clamping, Dogs, Machine, MachineError, Mount, Obstacles, ToolChanges,
};
use horma::tool::ToolError;
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::PathBuf;

/// List machines, show one, or check a machine file.
#[derive(Debug, Args)]
pub(crate) struct MachineArgs {
    #[command(subcommand)]
    action: Action,
}

#[derive(Debug, Subcommand)]
enum Action {
    /// List the machines that come with horma.
    List,
    /// Show what a machine is: its axes with signs, zero points, limits and speeds.
    Show {
        /// A machine's name, or the path of a machine file.
        machine: String,
        /// Print the machine file itself, to be copied and changed.
        #[arg(long, conflicts_with = "json")]
        toml: bool,
    },
    /// Check a machine file, its default tool and its dialect; mistakes are shown with line and column.
    Check {
        /// The path of a machine file, or a machine's name.
        machine: String,
        /// The tool library to look the default tool up in [default: the one of horma].
        #[arg(long, value_name = "FILE")]
        tools: Option<PathBuf>,
    },
}

/// Runs the chosen action.
pub(crate) fn run(args: &MachineArgs, shell: &Shell) -> anyhow::Result<()> {
    match &args.action {
        Action::List => list(shell),
        Action::Show { machine, toml: true } => print(&io::read_machine_text(machine)?),
        Action::Show { machine, toml: false } => {
            let machine = io::read_machine(machine)?;
            shell.report(&description(&machine), &summary(&machine))
        }
        Action::Check { machine, tools } => {
            let checked = check(machine, tools.as_ref());
            report_check(shell, machine, checked)
        }
    }
}

fn list(shell: &Shell) -> anyhow::Result<()> {
    let machines: Vec<Machine> =
        Machine::builtin_names().map(Machine::builtin).collect::<Result<_, _>>()?;
    let mut rows = vec![["NAME", "AXES", "ATTACK", "DIALECT", "TITLE"].map(str::to_owned)];
    rows.extend(machines.iter().map(|machine| {
        let letters: Vec<String> =
            machine.axes.iter().map(|axis| axis.letter.to_string()).collect();
        [
            machine.name.clone(),
            letters.join(" "),
            machine.axes[machine.attack].letter.to_string(),
            machine.dialect.clone(),
            machine.title.clone(),
        ]
    }));
    let all: Vec<Value> = machines.iter().map(description).collect();
    shell.report(&all, &table(&rows))
}

fn check(machine: &str, tools: Option<&PathBuf>) -> Result<Machine, DescriptionError> {
    let machine = io::read_machine(machine)?;
    let tool = io::read_tools(tools.map(PathBuf::as_path))?.find(&machine.default_tool)?;
    machine.check_tool(&tool)?;
    io::read_dialect(&machine.dialect)?;
    Ok(machine)
}

/// Says "ok", or what is wrong and where; a mistake is an error of the command too.
fn report_check(
    shell: &Shell,
    file: &str,
    checked: Result<Machine, DescriptionError>,
) -> anyhow::Result<()> {
    match checked {
        Ok(machine) => {
            let text = format!("ok: {file} describes {}, {}", machine.name, machine.title);
            shell.report(&json!({ "ok": true, "machine": description(&machine) }), &text)
        }
        Err(error) => {
            if shell.json {
                shell.report(&mistake(&error), "")?;
            }
            Err(error).context("the machine file cannot be used")
        }
    }
}

/// A mistake in a description, for programs.
pub(super) fn mistake(error: &DescriptionError) -> Value {
    if let DescriptionError::Dialect(DialectError::Content { file, line, column, problem }) = error
    {
        return json!({
            "ok": false, "file": file, "line": line, "column": column, "problem": problem,
        });
    }
    let (place, problem) = match error {
        DescriptionError::Machine(MachineError::At { place, problem }) => {
            (Some(place), problem.to_string())
        }
        DescriptionError::Tool(ToolError::At { place, problem }) => {
            (Some(place), problem.to_string())
        }
        other => (None, other.to_string()),
    };
    json!({
        "ok": false,
        "file": place.map(|place| &place.file),
        "line": place.map(|place| place.line),
        "column": place.map(|place| place.column),
        "problem": problem,
    })
}

/// A machine as its file has it: degrees, and units in the keys.
fn description(machine: &Machine) -> Value {
    let axes: Vec<Value> =
        machine.axes.iter().map(|axis| axis_description(machine, axis)).collect();
    let clamping = match machine.clamping {
        Clamping::Table => json!("table"),
        Clamping::Nibs { radius, length } => {
            json!({ "nibs": { "radius": radius, "length": length } })
        }
        Clamping::Cone { radius, length, gap } => {
            json!({ "cone": { "radius": radius, "length": length, "gap": gap } })
        }
    };
    let mut all = json!({
        "name": machine.name,
        "title": machine.title,
        "attack": machine.axes[machine.attack].letter,
        "mount": machine.mount,
        "clamping": clamping,
        "dialect": machine.dialect,
        "default-tool": machine.default_tool,
        "tool-changes": machine.tool_changes,
        "clearance": machine.clearance,
        "blocks-per-second": machine.blocks_per_second,
        "axis": axes,
    });
    if let Some(blocks) = machine.look_ahead_blocks {
        all["look-ahead-blocks"] = json!(blocks);
    }
    if let Some(Dogs { radius, length }) = machine.obstacles.dogs {
        all["obstacles"]["dogs"] = json!({ "radius": radius, "length": length });
    }
    if let Some(radius) = machine.obstacles.table_radius {
        all["obstacles"]["table-radius"] = json!(radius);
    }
    if let Some(spindle) = machine.spindle {
        all["spindle"] = json!(machine.axes[spindle].letter);
    }
    all
}

fn axis_description(machine: &Machine, axis: &Axis) -> Value {
    let unit = unit(axis.kind);
    let mut all = json!({
        "letter": axis.letter,
        "kind": axis.kind,
        "carries": axis.carries,
        "direction": axis.direction.as_slice(),
        "sign": if axis.sign < 0.0 { -1 } else { 1 },
    });
    if axis.kind == AxisKind::Rotary {
        all["point"] = json!(axis.point.coords.as_slice());
    }
    all[format!("zero-{unit}")] = json!(outside(axis.kind, axis.zero));
    if let Some(limits) = axis.limits {
        all[format!("limits-{unit}")] = json!(limits.map(|limit| outside(axis.kind, limit)));
    }
    all[format!("velocity-{unit}-per-s")] = json!(outside(axis.kind, axis.velocity));
    all[format!("acceleration-{unit}-per-s2")] = json!(outside(axis.kind, axis.acceleration));
    if let Some(follow) = axis.follows {
        let leader = machine.axes[follow.leader].letter;
        all["follows"] = json!({ "axis": leader, "ratio": follow.ratio });
    }
    all
}

/// A machine for people.
fn summary(machine: &Machine) -> String {
    let spindle = machine.spindle.map_or_else(
        || "none: nothing turns the part all the way round".to_owned(),
        |index| format!("{} turns the part", machine.axes[index].letter),
    );
    let mount = match machine.mount {
        Mount::Across => "across the attack axis, turning about X: wheels",
        Mount::Along => "along the attack axis: end mills",
    };
    let mut text = format!("{}: {}\n\n", machine.name, machine.title);
    for (what, value) in [
        ("attack", format!("{} brings the tool to the part", machine.axes[machine.attack].letter)),
        ("spindle", spindle),
        ("tools", format!("{mount}; {} unless told otherwise", machine.default_tool)),
        ("changed", tool_changes(machine.tool_changes).to_owned()),
        ("clamping", clamping(machine.clamping)),
        ("clearance", format!("{} mm", number(machine.clearance))),
        ("control", control(machine)),
    ] {
        // Writing to a String cannot fail.
        let _ = writeln!(text, "  {what:<10} {value}");
    }
    for obstacle in obstacles(machine) {
        let _ = writeln!(text, "  {:<10} {obstacle}", "obstacle");
    }
    let head = ["AXIS", "KIND", "CARRIES", "ALONG", "WORD", "LIMITS", "SPEED", "ACCELERATION", ""];
    let mut rows = vec![head.map(str::to_owned)];
    rows.extend(machine.axes.iter().map(|axis| axis_row(machine, axis)));
    text + "\n" + &table(&rows)
}

fn tool_changes(changes: ToolChanges) -> &'static str {
    match changes {
        ToolChanges::WithinPrograms => "within programs: one program can use several tools",
        ToolChanges::BetweenPrograms => "between programs: each program has one tool",
    }
}

/// What stands around the part, as far as its sizes are known.
fn obstacles(machine: &Machine) -> impl Iterator<Item = String> {
    let Obstacles { dogs, table_radius } = machine.obstacles;
    let dogs = dogs.map(|Dogs { radius, length }| {
        format!("dogs of radius {} mm, {} mm long", number(radius), number(length))
    });
    let table = table_radius.map(|radius| format!("a table of radius {} mm", number(radius)));
    dogs.into_iter().chain(table)
}

fn control(machine: &Machine) -> String {
    let ahead = machine.look_ahead_blocks;
    let ahead = ahead.map_or_else(String::new, |blocks| format!(", looks {blocks} blocks ahead"));
    format!("{}, {} blocks/s{ahead}", machine.dialect, number(machine.blocks_per_second))
}

fn axis_row(machine: &Machine, axis: &Axis) -> [String; 9] {
    let unit = unit(axis.kind);
    let value = |inside: f64| number(outside(axis.kind, inside));
    let (kind, motion) = match axis.kind {
        AxisKind::Linear => ("linear", "travel"),
        AxisKind::Rotary => ("rotary", "turn"),
    };
    let carries = match axis.carries {
        Carries::Tool => "tool",
        Carries::Part => "part",
    };
    let sign = if axis.sign < 0.0 { "-" } else { "+" };
    [
        axis.letter.to_string(),
        kind.to_owned(),
        carries.to_owned(),
        direction(axis),
        format!("{} {sign} {motion}", value(axis.zero)),
        axis.limits.map_or_else(
            || "endless".to_owned(),
            |[least, greatest]| format!("{} .. {} {unit}", value(least), value(greatest)),
        ),
        format!("{} {unit}/s", value(axis.velocity)),
        format!("{} {unit}/s2", value(axis.acceleration)),
        axis.follows.map_or_else(String::new, |follow| {
            let leader = machine.axes[follow.leader].letter;
            format!("follows {leader} times {}", number(follow.ratio))
        }),
    ]
}

/// `+X`, or the components of a skew direction.
fn direction(axis: &Axis) -> String {
    let [x, y, z] = [axis.direction.x, axis.direction.y, axis.direction.z];
    for (name, along) in [("X", x), ("Y", y), ("Z", z)] {
        if along.abs() == 1.0 {
            return format!("{}{name}", if along < 0.0 { "-" } else { "+" });
        }
    }
    format!("({}, {}, {})", number(x), number(y), number(z))
}

fn clamping(clamping: Clamping) -> String {
    match clamping {
        Clamping::Table => "on a table, from below".to_owned(),
        Clamping::Nibs { radius, length } => format!(
            "between dogs, on stubs of radius {} mm, {} mm long",
            number(radius),
            number(length)
        ),
        Clamping::Cone { radius, length, gap } => format!(
            "by a post on the cone top, radius {} mm, {} mm long; {} mm free at the heel",
            number(radius),
            number(length),
            number(gap)
        ),
    }
}

fn unit(kind: AxisKind) -> &'static str {
    match kind {
        AxisKind::Linear => "mm",
        AxisKind::Rotary => "deg",
    }
}

/// A value in the unit of files; 900 stays 900 on its way through radians.
fn outside(kind: AxisKind, inside: f64) -> f64 {
    match kind {
        AxisKind::Linear => inside,
        AxisKind::Rotary => (inside.to_degrees() * 1e9).round() / 1e9,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_json_of_a_machine_is_a_machine_file_of_the_same_machine() {
        for name in Machine::builtin_names() {
            let machine = Machine::builtin(name).unwrap();
            let text = toml::to_string(&description(&machine)).unwrap();
            assert_eq!(Machine::parse(&text, "my.toml").unwrap(), machine);
        }
    }

    #[test]
    fn a_summary_tells_sign_zero_limits_and_speed_of_every_axis() {
        let mill = summary(&Machine::builtin("mill-5axis").unwrap());
        let cradle = mill.lines().find(|line| line.starts_with("A ")).unwrap();
        let words: Vec<&str> = cradle.split_whitespace().collect();
        assert_eq!(
            words.join(" "),
            "A rotary part +X 0 - turn -30 .. 120 deg 180 deg/s 900 deg/s2"
        );
        let pair = summary(&Machine::builtin("last-lathe-pair").unwrap());
        assert!(pair.contains("follows A times -1"), "{pair}");
    }
}
