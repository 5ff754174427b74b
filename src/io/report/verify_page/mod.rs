//! What cutting a program in simulation shows: a page of its own, or a section of the job's.

mod facts;
mod maps;
mod summary;
mod words;

pub use maps::deviation_map;
pub use summary::verify_summary;

use super::{Block, Figure, Page, Section};
use crate::workflow::verify::Verified;

/// The page of a verification. An error is one of encoding a picture.
pub fn verify_page(verified: &Verified) -> std::io::Result<Page> {
    let report = &verified.report;
    let shown = vec![Block::Pictures(maps::pictures(verified)?), facts::deviation(report)];
    let mut sections = vec![
        section("Deviation", shown),
        section("How much of it is how near", vec![facts::within(report)]),
        section("On the way", vec![facts::simulation(report)]),
    ];
    sections.extend(facts::collisions(report).map(|table| section("Collisions", vec![table])));
    sections.push(section("How exact this is", vec![facts::resolution(report)]));
    sections.push(section("What was verified", vec![facts::what(report)]));
    Ok(Page {
        title: report.program.clone(),
        subtitle: format!("against {} on {}", report.part, report.machine[1]),
        warnings: report.faults.clone(),
        figures: facts::figures(report),
        sections,
    })
}

/// The page of a job with what its program leaves: faults first, then two figures, and a section
/// after the first. An error is one of encoding a picture.
pub fn with_cut(mut page: Page, verified: &Verified) -> std::io::Result<Page> {
    let report = &verified.report;
    let mut blocks = vec![
        Block::Text(format!(
            "The program as it was read back, run on its block in simulation ({}), and what it \
             leaves compared with {}.",
            report.block, report.part
        )),
        Block::Pictures(maps::pictures(verified)?),
        facts::deviation(report),
        facts::way(report),
    ];
    blocks.extend(facts::collisions(report));
    page.sections.insert(page.sections.len().min(1), section("Cut in simulation", blocks));
    page.warnings.splice(0..0, report.faults.iter().cloned());
    let labels = ["Deepest gouge", "Collisions"];
    let is_shown = |figure: &Figure| labels.contains(&figure.label.as_str());
    page.figures.extend(facts::figures(report).into_iter().filter(is_shown));
    Ok(page)
}

fn section(title: &str, blocks: Vec<Block>) -> Section {
    Section { title: title.to_owned(), blocks }
}
