//! The page of a cam job: what will be cut, how, and what the user must know before it is.
//!
//! Everything said stands in the [`CamReport`]; a [`Scene`](cam::Scene) adds the pictures.

mod facts;
mod reach_map;
mod summary;
mod views;
mod words;

pub use summary::cam_summary;

use super::{Block, Figure, Image, Labels, Page, Picture, Section, Series, line_chart};
use crate::workflow::cam::{self, CamReport, Work};
use words::{attack_travel, clock, count, reached_percent, strategy};

/// The page of a job; without a `scene` it has no pictures of the part and its path. An error is
/// one of encoding a picture.
pub fn cam_page(report: &CamReport, scene: Option<&cam::Scene>) -> std::io::Result<Page> {
    let mut sections = Vec::new();
    if let Some(scene) = scene {
        sections.push(section("Part and path", views::blocks(scene, report)?));
    }
    sections.push(section("Reach and travel", reach_and_travel(report, scene)?));
    sections.push(section("Run", facts::run(report)));
    sections.push(section("Program", facts::program(&report.program)));
    sections.push(section("Setup", facts::setup(report)));
    sections.push(section("Machine, tool and part", facts::what(report)));
    Ok(Page {
        title: report.part.name.clone(),
        subtitle: subtitle(report),
        warnings: warnings(report),
        figures: figures(report),
        sections,
    })
}

/// What is done with it, in a line.
fn subtitle(report: &CamReport) -> String {
    let work = match (report.work, &report.rough) {
        (Work::Rough, _) => "roughed: ".to_owned(),
        (Work::RoughAndFinish, Some(rough)) => {
            format!("roughed with {}, then finished: ", rough.tool[0])
        }
        _ => String::new(),
    };
    let (strategy, [tool, _]) = (strategy(report.run.strategy), &report.tool);
    format!("{work}{strategy} with {tool} on {}", report.machine[1])
}

fn section(title: &str, blocks: Vec<Block>) -> Section {
    Section { title: title.to_owned(), blocks }
}

/// What the job warns of; first, if so, that the machine would refuse the program.
fn warnings(report: &CamReport) -> Vec<String> {
    let n_violations = report.program.violations.len();
    let refused = (n_violations > 0).then(|| {
        let machine = &report.machine[0];
        format!("the program must not run on {machine}: {n_violations} violations, listed below")
    });
    refused.into_iter().chain(report.warnings.iter().cloned()).collect()
}

/// The few numbers that matter.
fn figures(report: &CamReport) -> Vec<Figure> {
    let figure = |label: &str, value: String, unit: &str| Figure {
        label: label.to_owned(),
        value,
        unit: unit.to_owned(),
    };
    let mut figures = vec![
        figure("Time (h:mm:ss)", clock(report.program.planned.total()), ""),
        figure("Positions", count(n_positions(report)), ""),
    ];
    if let Some(reach) = &report.reach {
        figures.push(figure("Surface", format!("{:.1}", reach.area / 100.0), "cm²"));
        figures.push(figure("Within reach", reached_percent(reach), "%"));
    }
    figures.push(match &report.rough {
        Some(rough) => figure("Deepest cut", format!("≤ {:.1}", rough.max_depth), "mm"),
        None => figure("Stock assumed", format!("≤ {:.1}", report.stock), "mm"),
    });
    if let Some(travel) = attack_travel(&report.program) {
        // Outwards to whole numbers; the program's own stand in its table.
        let range = format!("{}–{}", travel.least.floor(), travel.greatest.ceil());
        figures.push(figure(&format!("{} travel", travel.axis), range, travel.unit));
    }
    figures
}

/// Positions of all the program's cuts.
fn n_positions(report: &CamReport) -> usize {
    let roughing = report.rough.as_ref().map_or(0, |rough| rough.n_positions);
    let finishing = if report.work == Work::Rough { 0 } else { report.run.n_positions };
    roughing + finishing
}

fn reach_and_travel(report: &CamReport, scene: Option<&cam::Scene>) -> std::io::Result<Vec<Block>> {
    let mut pictures = Vec::new();
    if let Some(reach) = &report.reach {
        pictures.extend(reach_map::picture(reach, &report.setup)?);
    }
    pictures.extend(scene.map(heights));
    let mut blocks = Vec::new();
    if !pictures.is_empty() {
        blocks.push(Block::Pictures(pictures));
    }
    blocks.push(match &report.reach {
        Some(reach) => facts::reach(reach),
        None if report.part.mode == "points" => Block::Text(
            "Points alone have no area, so what the tool can reach of them is not known.".into(),
        ),
        None if report.work == Work::Rough => {
            Block::Text("What the tool can reach is mapped with the finishing program.".into())
        }
        None => {
            Block::Text("What the tool cannot reach around a tilted table is not mapped.".into())
        }
    });
    Ok(blocks)
}

/// The words of the attack axis, position by position.
fn heights(scene: &cam::Scene) -> Picture {
    let series = Series { name: String::new(), points: scene.heights.clone() };
    let labels = Labels { x: "position", y: "attack axis [mm]" };
    Picture {
        title: "Travel of the attack axis.".to_owned(),
        caption: "Its word at each position of the run, as the program has it.".to_owned(),
        image: Image::Svg(line_chart(&[series], labels)),
    }
}
