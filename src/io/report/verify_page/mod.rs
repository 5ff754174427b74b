//! The page of a verification: what the program makes of its block, against the part.

mod colours;
mod summary;

pub use colours::deviation_map;
pub use summary::verify_summary;

use super::{
    Block, Camera, Figure, Image, Labels, Page, Picture, Scene, Section, Series, Solid, Table,
    encode_png, line_chart, render,
};
use crate::geom::{TriMesh, Vector3};
use crate::measure::{Extreme, Spot};
use crate::workflow::verify::{Verified, VerifyReport};

/// Width and height of each picture: sharp on a screen of twice the density.
const SIZE_PX: [u32; 2] = [960, 600];
/// Deviation shown in full colour, unless the tolerance is larger [mm].
const FULL: f64 = 0.1;
/// The page lists this many collisions.
const MOST_COLLISIONS: usize = 20;

/// The page of a verification. An error is one of encoding a picture.
pub fn verify_page(verified: &Verified) -> std::io::Result<Page> {
    let report = &verified.report;
    let full = FULL.max(report.tolerance);
    let map = deviation_map(verified, full);
    let mut sections = vec![
        section("Deviation", vec![Block::Pictures(views(&map, full)?), deviation_facts(report)]),
        section("How far how much of it is off", spread(report)),
        section("On the way", vec![simulation_facts(report)]),
    ];
    if !report.simulation.collisions.is_empty() {
        sections.push(section("Collisions", vec![collisions(report)]));
    }
    sections.push(section("How exact this is", vec![resolution_facts(report)]));
    sections.push(section("What was verified", vec![what(report)]));
    Ok(Page {
        title: report.program.clone(),
        subtitle: format!("against {} on {}", report.part, report.machine[1]),
        warnings: report.faults.clone(),
        figures: figures(report),
        sections,
    })
}

fn section(title: &str, blocks: Vec<Block>) -> Section {
    Section { title: title.to_owned(), blocks }
}

fn figures(report: &VerifyReport) -> Vec<Figure> {
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

fn views(map: &TriMesh, full: f64) -> std::io::Result<Vec<Picture>> {
    let above = Camera::three_quarter(SIZE_PX);
    let behind = Camera { direction: Vector3::new(-0.45, -0.8, 0.45), ..above };
    let mut pictures = Vec::new();
    for (title, camera) in [("From the front, above.", above), ("From behind, below.", behind)] {
        let solids = vec![Solid { mesh: map, color: [200; 3] }];
        let image = encode_png(&render(&Scene { solids, paths: Vec::new() }, &camera))?;
        pictures.push(Picture {
            title: title.to_owned(),
            caption: format!(
                "Red: cut too deep. Blue: material left. Both in full from {full} mm on. Grey: clamps."
            ),
            image: Image::Png(image),
        });
    }
    Ok(pictures)
}

fn deviation_facts(report: &VerifyReport) -> Block {
    let deviation = &report.deviation;
    let spot = |spot: &Option<Spot>| match spot {
        None => "none".to_owned(),
        Some(Spot { value, at: [x, y, z] }) => {
            format!("{value:.3} mm at X {x:.1} Y {y:.1} Z {z:.1}")
        }
    };
    let percent = |area: f64| 100.0 * area / deviation.area.max(f64::MIN_POSITIVE);
    let by_tool = deviation.left_area_by_tool;
    Block::Facts(vec![
        fact("Deepest gouge", spot(&deviation.gouge)),
        fact(
            "Surface gouged",
            format!(
                "{:.1} mm² deeper than {} mm ({:.2} %)",
                deviation.gouged_area,
                report.tolerance,
                percent(deviation.gouged_area)
            ),
        ),
        fact("Deepest in a clamp", spot(&deviation.clamp_gouge)),
        fact("Most material left", spot(&deviation.left)),
        fact("Most the tool is too large for", spot(&deviation.left_by_tool)),
        fact("Most the path passed by", spot(&deviation.left_by_path)),
        fact(
            "More than 0.05 mm left",
            format!(
                "{:.2} % of the surface; on {:.2} % the tool cannot take it",
                percent(deviation.left_area),
                percent(by_tool)
            ),
        ),
        fact("Root of the mean square", format!("{:.4} mm", deviation.rms)),
    ])
}

fn spread(report: &VerifyReport) -> Vec<Block> {
    let deviation = &report.deviation;
    let points = deviation.histogram.iter().map(|bin| [bin.distance, bin.area / 100.0]).collect();
    let labels = Labels { x: "distance from the part [mm]", y: "surface [cm²]" };
    let chart = line_chart(&[Series { name: String::new(), points }], labels);
    let row = |within: &crate::measure::Within| {
        vec![format!("{} mm", within.distance), format!("{:.2} %", 100.0 * within.share)]
    };
    vec![
        Block::Pictures(vec![Picture {
            title: "Surface by distance.".to_owned(),
            caption: "Left of 0 too much is gone, right of it material is left; the outermost \
                      hundredth at either end is counted at the end."
                .to_owned(),
            image: Image::Svg(chart),
        }]),
        Block::Table(Table {
            columns: ["Within", "Share of the surface"].map(str::to_owned).into(),
            rows: deviation.within.iter().map(row).collect(),
        }),
    ]
}

fn simulation_facts(report: &VerifyReport) -> Block {
    let simulation = &report.simulation;
    let extreme = |extreme: &Option<Extreme>, unit: &str| match extreme {
        None => "nothing was cut".to_owned(),
        Some(Extreme { value, line }) => format!("{value:.2} {unit} (line {line})"),
    };
    Block::Facts(vec![
        fact("Block", &report.block),
        fact("Volume before", format!("{:.1} cm³", simulation.start_volume / 1e3)),
        fact("Volume after", format!("{:.1} cm³", simulation.end_volume / 1e3)),
        fact("Removed", format!("{:.2} cm³", simulation.removed / 1e3)),
        fact("Deepest cut", extreme(&simulation.greatest_depth, "mm")),
        fact("Greatest rate", extreme(&simulation.greatest_rate, "mm³/s")),
        fact(
            "Cutting air",
            format!(
                "{:.0} s of {:.0} s feeding ({:.1} %), leads not counted",
                simulation.air_seconds,
                simulation.feed_seconds,
                100.0 * simulation.air_share
            ),
        ),
        fact("Moves", simulation.n_moves),
        fact("Moves beneath overhanging material", simulation.n_overhanging),
    ])
}

fn collisions(report: &VerifyReport) -> Block {
    let shown = report.simulation.collisions.iter().take(MOST_COLLISIONS);
    Block::Table(Table {
        columns: ["Line", "What happens"].map(str::to_owned).into(),
        rows: shown.map(|hit| vec![hit.line.to_string(), hit.in_words()]).collect(),
    })
}

fn resolution_facts(report: &VerifyReport) -> Block {
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

fn what(report: &VerifyReport) -> Block {
    let mut facts = vec![
        fact("Program", &report.program),
        fact("Part", &report.part),
        fact("Machine", format!("{}: {}", report.machine[0], report.machine[1])),
    ];
    facts.extend(report.tools.iter().map(|tool| fact("Tool", tool.join(", "))));
    facts.extend(report.notes.iter().map(|note| fact("Note", note)));
    Block::Facts(facts)
}

fn fact(name: &str, value: impl std::fmt::Display) -> (String, String) {
    (name.to_owned(), value.to_string())
}
