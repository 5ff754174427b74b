//! The tables of the page.

use super::super::{Block, Table};
use super::words::{
    clear, clock, count, fine, pitch, proof, proved, range, reached, strategy, tool,
};
use crate::cam::{FeedReport, ReachReport, Strategy};
use crate::gcode::CheckReport;
use crate::workflow::cam::CamReport;

/// A broken program can have a violation per line; the page lists this many.
const MOST_VIOLATIONS: usize = 50;

/// How the tool runs.
pub(super) fn run(report: &CamReport) -> Vec<Block> {
    let (run, certificate) = (&report.run, report.certificate.as_ref());
    let mut facts =
        vec![fact("Strategy", strategy(run.strategy)), fact("Positions", count(run.n_positions))];
    facts.push(match run.strategy {
        Strategy::Helix | Strategy::Rings => fact("Positions a turn", run.per_turn),
        Strategy::Lines => fact("Lines around the part", run.per_turn),
        Strategy::Raster | Strategy::Contour => {
            fact("Step along a row", format!("{} mm", fine(run.step)))
        }
    });
    facts.push(match run.strategy {
        Strategy::Lines => fact("Step along a line", format!("{} mm", fine(run.step))),
        _ => fact("Pitch", format!("{} mm", pitch(run.pitch))),
    });
    facts.push(fact("Along X", format!("{} mm", range(run.along))));
    facts.push(fact("Left on purpose", format!("{} mm", fine(run.allowance))));
    facts.push(fact(
        "Greatest ridge left",
        run.scallop.map_or("not known".to_owned(), |height| format!("{height:.3} mm")),
    ));
    facts.push(match run.rpm {
        Some(rpm) => fact("Rotation", format!("{} rpm of the part", fine(rpm))),
        None => fact("Cutting feed", format!("{} mm/min at the contact", run.feed.round())),
    });
    facts.push(fact("Feed held", held(&run.held)));
    facts.push(fact(
        "Between positions",
        certificate.map_or("nothing is proved".to_owned(), proved),
    ));
    for (name, value) in certificate.into_iter().flat_map(proof) {
        facts.push(fact(name, value));
    }
    facts.push(fact(
        "Greatest step of the attack axis",
        format!("{:.3} mm between two positions", run.greatest_rise),
    ));
    facts.push(fact(
        "Positions that meet nothing",
        match run.n_missed {
            0 => "none".to_owned(),
            n_missed => format!("{}; {}", count(n_missed), run.off_part),
        },
    ));
    if let Some(rough) = &report.rough {
        facts.push(fact("Roughed from", rough.block.clone()));
        facts.push(fact("Roughed with", tool(&rough.tool)));
        facts.push(fact("Left by roughing", format!("{} mm", fine(rough.allowance))));
        facts.push(fact("Layers", rough.n_layers));
        facts.push(fact("Deepest cut", format!("{} mm", fine(rough.max_depth))));
        facts.push(fact("Cuts", format!("{}, a link before each", count(rough.n_cuts))));
        facts.push(fact("Positions of all cuts", count(rough.n_positions)));
        facts.push(fact("Rapids", clear(&rough.links)));
    }
    vec![Block::Facts(facts)]
}

/// How much of the feed the machine holds over the whole cut, and what takes most of the rest.
fn held(feed: &FeedReport) -> String {
    let share = if feed.taken > 0.0 { (100.0 * feed.asked / feed.taken).min(100.0) } else { 100.0 };
    let most = feed.slowed.first().map_or_else(String::new, |slowed| format!("; {slowed}"));
    format!("{share:.0} %{most}")
}

/// What the tool can touch, by area.
pub(super) fn reach(reach: &ReachReport) -> Block {
    let row = |what: String, area: f64| {
        let percent = if reach.area > 0.0 { 100.0 * area / reach.area } else { 0.0 };
        vec![what, format!("{area:.1}"), format!("{percent:.2}")]
    };
    let hollow = if reach.hollow > 0.0 {
        format!("in hollows too narrow for the tool, kept off by up to {:.2} mm", reach.deepest)
    } else {
        "in hollows too narrow for the tool".to_owned()
    };
    Block::Table(Table {
        columns: strings(["Surface", "mm²", "%"]),
        rows: vec![
            row("the tool touches".to_owned(), reached(reach)),
            row("under a clamp or beside it".to_owned(), reach.clamped),
            row(hollow, reach.hollow),
            row("undercut, turned away from the tool in every pose".to_owned(), reach.undercut),
            row("the whole part".to_owned(), reach.area),
        ],
    })
}

/// The program as read back: travel, time, and what the machine has against it.
pub(super) fn program(program: &CheckReport) -> Vec<Block> {
    let bounds = program.bounds.iter().map(|bounds| {
        vec![
            bounds.axis.to_string(),
            format!("{:.3}", bounds.least),
            format!("{:.3}", bounds.greatest),
            bounds.unit.to_owned(),
        ]
    });
    let mut facts = vec![
        fact(
            "Time",
            format!(
                "{} with the accelerations of the machine; the feeds alone make {}",
                clock(program.planned.total()),
                clock(program.seconds)
            ),
        ),
        fact("Seconds spent on", program.planned),
    ];
    facts.extend(program.several_operations().iter().map(|operation| {
        let tool = operation.tool.map_or("the tool".to_owned(), |number| format!("T{number}"));
        let (clock, planned) = (clock(operation.planned.total()), operation.planned);
        fact(&format!("With {tool}, from line {}", operation.line), format!("{clock}: {planned}"))
    }));
    facts.extend([
        fact("Blocks", format!("{}, {} moves", count(program.n_blocks), count(program.n_moves))),
        fact(
            "Way of the linear axes",
            format!(
                "{:.0} mm feeding, {:.0} mm rapid",
                program.feed_distance_mm, program.rapid_distance_mm
            ),
        ),
    ]);
    facts.extend(program.block_rate.map(|rate| {
        let most = format!(
            "up to {:.0} a second (line {}); the control reads {:.0}",
            rate.highest, rate.line, rate.limit
        );
        fact("Blocks in a row", most)
    }));
    facts.extend(program.longest_line.map(|longest| {
        fact("Longest line", format!("{} characters (line {})", longest.length, longest.line))
    }));
    let travel =
        Table { columns: strings(["Axis", "Least", "Greatest", ""]), rows: bounds.collect() };
    let mut blocks = vec![Block::Table(travel), Block::Facts(facts)];
    blocks.extend(violations(program));
    blocks
}

/// How the part lies on the machine.
pub(super) fn setup(report: &CamReport) -> Vec<Block> {
    let setup = &report.setup;
    let [x, y, z] = setup.axis;
    let mut facts = vec![
        fact("Direction laid along X", format!("{x:.4} {y:.4} {z:.4} in the file")),
        fact("Turned before the first step", format!("{}°", fine(setup.start_angle_deg))),
        fact("Mirrored", if setup.mirrored { "yes: the other foot" } else { "no" }),
        fact("Part along X", format!("{} mm", range(setup.part_x))),
        fact("Part and clamps along X", format!("{} mm", range(setup.clamped_x))),
    ];
    if setup.swing > 0.0 {
        facts.push(fact("Greatest radius about the spindle", format!("{:.2} mm", setup.swing)));
    }
    let row = |row: &[f64; 4]| row.iter().map(|value| format!("{value:.6}")).collect();
    vec![
        Block::Facts(facts),
        Block::Text(
            "From the file's coordinates (after mirroring) to the machine's, in millimetres:"
                .into(),
        ),
        Block::Table(Table {
            columns: strings(["x", "y", "z", "shift"]),
            rows: setup.machine_from_file.iter().map(row).collect(),
        }),
    ]
}

/// What the job is made of, and what reading it had to say.
pub(super) fn what(report: &CamReport) -> Vec<Block> {
    let part = &report.part;
    let [x, y, z] = part.size;
    let mut facts = vec![
        fact("Machine", format!("{}: {}", report.machine[0], report.machine[1])),
        fact("Tool", tool(&report.tool)),
        fact("Part", &part.name),
        fact("Digitized", format!("{} {}", count(part.n_primitives), part.mode)),
        fact("Size on the machine", format!("{x:.1} × {y:.1} × {z:.1} mm")),
    ];
    facts.extend(part.notes.iter().map(|note| fact("Note", note)));
    vec![Block::Facts(facts)]
}

fn violations(program: &CheckReport) -> Vec<Block> {
    let shown = program.violations.iter().take(MOST_VIOLATIONS);
    let rows: Vec<_> = shown.map(|v| vec![v.line.to_string(), v.kind.to_string()]).collect();
    if rows.is_empty() {
        return vec![Block::Text("The machine has nothing against it.".to_owned())];
    }
    let n_left = program.violations.len() - rows.len();
    let mut blocks = vec![Block::Table(Table { columns: strings(["Line", "Violation"]), rows })];
    if n_left > 0 {
        blocks.push(Block::Text(format!("... and {} more.", count(n_left))));
    }
    blocks
}

fn fact(name: &str, value: impl std::fmt::Display) -> (String, String) {
    (name.to_owned(), value.to_string())
}

fn strings<const N: usize>(texts: [&str; N]) -> Vec<String> {
    texts.map(str::to_owned).into()
}
