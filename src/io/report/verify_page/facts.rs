//! The tables of a verification.

use super::super::{Block, Figure, Table};
use super::words::{bodies, exactness, fixtures, left, percent, spot};
use crate::measure::{Extreme, Spot, Within};
use crate::workflow::verify::VerifyReport;

/// The page lists this many collisions.
const MOST_COLLISIONS: usize = 20;

/// The few numbers that matter.
pub(super) fn figures(report: &VerifyReport) -> Vec<Figure> {
    let figure = |label: &str, value: String, unit: &str| Figure {
        label: label.to_owned(),
        value,
        unit: unit.to_owned(),
    };
    let value = |spot: &Option<Spot>| spot.map_or(0.0, |spot| spot.value);
    let deviation = &report.deviation;
    vec![
        figure("Deepest gouge", format!("{:.3}", value(&deviation.gouge)), "mm"),
        figure("Most left", format!("{:.3}", value(&deviation.left)), "mm"),
        figure("Left by the path", format!("{:.3}", value(&deviation.left_by_path)), "mm"),
        figure("RMS", format!("{:.3}", deviation.rms), "mm"),
        figure("Air cut", format!("{:.1}", 100.0 * report.simulation.air_share), "%"),
        figure("Collisions", report.simulation.n_collisions.to_string(), ""),
    ]
}

/// How far what is left is from the part.
pub(super) fn deviation(report: &VerifyReport) -> Block {
    let deviation = &report.deviation;
    let gouged = format!(
        "{:.1} mm² deeper than {} mm ({:.2} %)",
        deviation.gouged_area,
        report.tolerance,
        percent(report, deviation.gouged_area)
    );
    Block::Facts(vec![
        fact("Deepest gouge", spot(deviation.gouge.as_ref())),
        fact("Surface gouged", gouged),
        fact("Deepest in a clamp", spot(deviation.clamp_gouge.as_ref())),
        fact("Most material left", spot(deviation.left.as_ref())),
        fact("Most the tool is too large for", spot(deviation.left_by_tool.as_ref())),
        fact("Most the path passed by, scallops too", spot(deviation.left_by_path.as_ref())),
        fact("More than 0.05 mm left", left(report)),
        fact("Root of the mean square", format!("{:.4} mm", deviation.rms)),
    ])
}

/// How much of the surface lies how near.
pub(super) fn within(report: &VerifyReport) -> Block {
    let row = |within: &Within| {
        vec![format!("{} mm", within.distance), format!("{:.2} %", 100.0 * within.share)]
    };
    Block::Table(Table {
        columns: ["Within", "Share of the surface"].map(str::to_owned).into(),
        rows: report.deviation.within.iter().map(row).collect(),
    })
}

/// What the program did on its way, in a few lines.
pub(super) fn way(report: &VerifyReport) -> Block {
    let simulation = &report.simulation;
    Block::Facts(vec![
        fact("Cut from", &report.block),
        fact("Removed", format!("{:.2} cm³", simulation.removed / 1e3)),
        fact("Deepest cut", spot(simulation.thickest_cut.as_ref())),
        fact("Deepest along a ray", extreme(simulation.greatest_depth.as_ref(), "mm")),
        fact("Cutting air", air(report)),
        fact("Collisions", n_collisions(report)),
        fact("Bodies looked at", bodies(&simulation.bodies)),
        fact("Fixtures looked at", fixtures(&simulation.fixtures)),
        fact("Exact to", exactness(&simulation.resolution)),
    ])
}

/// The same in full.
pub(super) fn simulation(report: &VerifyReport) -> Block {
    let simulation = &report.simulation;
    Block::Facts(vec![
        fact("Block", &report.block),
        fact("Volume before", format!("{:.1} cm³", simulation.start_volume / 1e3)),
        fact("Volume after", format!("{:.1} cm³", simulation.end_volume / 1e3)),
        fact("Removed", format!("{:.2} cm³", simulation.removed / 1e3)),
        fact("Deepest cut", spot(simulation.thickest_cut.as_ref())),
        fact("Deepest along a ray", extreme(simulation.greatest_depth.as_ref(), "mm")),
        fact("Greatest rate", extreme(simulation.greatest_rate.as_ref(), "mm³/s")),
        fact("Cutting air", air(report)),
        fact("Moves", simulation.n_moves),
        fact("Moves beneath overhanging material", simulation.n_overhanging),
        fact("Bodies looked at", bodies(&simulation.bodies)),
        fact("Fixtures looked at", fixtures(&simulation.fixtures)),
    ])
}

/// What collided, if anything did.
pub(super) fn collisions(report: &VerifyReport) -> Option<Block> {
    let shown = report.simulation.collisions.iter().take(MOST_COLLISIONS);
    let rows: Vec<_> = shown.map(|hit| vec![hit.line.to_string(), hit.in_words()]).collect();
    let columns = ["Line", "What happens"].map(str::to_owned).into();
    (!rows.is_empty()).then_some(Block::Table(Table { columns, rows }))
}

/// How exact all this is.
pub(super) fn resolution(report: &VerifyReport) -> Block {
    let resolution = &report.simulation.resolution;
    let hollow = resolution.hollow.map_or(
        "not known: the tool has an edge or a point, whose cut may hide between two rays"
            .to_owned(),
        |error| format!("{error:.4} mm at most"),
    );
    Block::Facts(vec![
        fact(
            "Rays",
            format!("{:.3} mm apart along X, {:.3} mm across", resolution.along, resolution.across),
        ),
        fact("Too much shown as left, at a ray", format!("{:.4} mm at most", resolution.sweep)),
        fact("A hollow deeper than shown, between rays", hollow),
        fact(
            "A ridge higher than shown, between rays",
            format!("{:.4} mm at most, on 99 % of the rays", resolution.ridge),
        ),
    ])
}

/// What was verified, and what reading it had to say.
pub(super) fn what(report: &VerifyReport) -> Block {
    let mut facts = vec![
        fact("Program", &report.program),
        fact("Part", &report.part),
        fact("Machine", format!("{}: {}", report.machine[0], report.machine[1])),
    ];
    facts.extend(report.tools.iter().map(|tool| fact("Tool", tool.join(", "))));
    facts.extend(report.notes.iter().map(|note| fact("Note", note)));
    Block::Facts(facts)
}

fn air(report: &VerifyReport) -> String {
    let simulation = &report.simulation;
    format!(
        "{:.0} s of {:.0} s feeding ({:.1} %), leads not counted",
        simulation.air_seconds,
        simulation.feed_seconds,
        100.0 * simulation.air_share
    )
}

fn n_collisions(report: &VerifyReport) -> String {
    match report.simulation.n_collisions {
        0 => "none".to_owned(),
        n => format!("{n}, listed below"),
    }
}

fn extreme(extreme: Option<&Extreme>, unit: &str) -> String {
    match extreme {
        None => "nothing was cut".to_owned(),
        Some(Extreme { value, line }) => format!("{value:.2} {unit} (line {line})"),
    }
}

fn fact(name: &str, value: impl std::fmt::Display) -> (String, String) {
    (name.to_owned(), value.to_string())
}
