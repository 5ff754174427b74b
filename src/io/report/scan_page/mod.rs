//! What a scan shows: the way of the camera, and what became of its frames.

mod pictures;

use super::{Block, Figure, Page, Section, Table};
use crate::register::icp::Verdict;
use crate::register::odometry::FrameRole;
use crate::workflow::scan::{LoopReport, LoopResult, LoopsReport, ScanReport, Scanned};

/// Frames listed at most.
const MOST_LISTED: usize = 100;

/// The page of a scan.
pub fn scan_page(scanned: &Scanned) -> std::io::Result<Page> {
    let report = &scanned.report;
    let figure = |label: &str, value: String, unit: &str| Figure {
        label: label.to_owned(),
        value,
        unit: unit.to_owned(),
    };
    let placed = report.counts.ok + report.counts.doubtful;
    let mut figures = vec![
        figure("Frames placed", placed.to_string(), &format!("of {}", report.frames.len())),
        figure("Skipped", report.counts.skipped.to_string(), ""),
        figure("Doubtful", report.counts.doubtful.to_string(), ""),
        figure("Way of the camera", format!("{:.0}", report.way), "mm"),
    ];
    if let Some(truth) = &report.against_truth {
        figures.push(figure("Off the truth (ATE)", format!("{:.2}", truth.ate_mm.rmse), "mm"));
    }
    if let Some(loops) = &report.loops {
        figures.push(figure("Loops closed", loops.n_closed.to_string(), ""));
    }
    let mut sections = Vec::new();
    if !scanned.cloud.points.is_empty() {
        sections.push(section("The cloud", vec![Block::Pictures(pictures::cloud(scanned)?)]));
    }
    let mut plans = pictures::plans(scanned);
    plans.extend(pictures::errors(report));
    sections.push(section("Way of the camera", vec![Block::Pictures(plans)]));
    sections.push(section("Frames", frames(report)));
    if let Some(loops) = report.loops.as_ref().filter(|loops| !loops.tried.is_empty()) {
        sections.push(section("Loops", self::loops(loops)));
    }
    sections.push(section("How it was done", vec![Block::Facts(facts(report))]));
    if !report.notes.is_empty() {
        let notes = report.notes.iter().cloned().map(Block::Text).collect();
        sections.push(section("Notes", notes));
    }
    let warnings = match report.verdict {
        Verdict::Ok => Vec::new(),
        verdict => vec![format!("The scan is {verdict}: look at the frames below.")],
    };
    Ok(Page {
        title: report.name.clone(),
        subtitle: format!("{} points of {} frames", report.n_points, placed),
        warnings,
        figures,
        sections,
    })
}

fn frames(report: &ScanReport) -> Vec<Block> {
    let counts = report.counts;
    let mut blocks = vec![Block::Facts(vec![
        ("Believed".into(), format!("{}, of them {} key frames", counts.ok, counts.key)),
        ("Doubtful".into(), counts.doubtful.to_string()),
        ("Skipped".into(), counts.skipped.to_string()),
    ])];
    let odd: Vec<_> = report.frames.iter().filter(|frame| frame.verdict != Verdict::Ok).collect();
    if odd.is_empty() {
        return blocks;
    }
    let row = |frame: &&crate::workflow::scan::FrameReport| {
        let became = if frame.role == FrameRole::Skipped { "skipped" } else { "doubtful" };
        vec![format!("{:.3}", frame.stamp), became.to_owned(), frame.reasons.join("; ")]
    };
    blocks.push(Block::Table(Table {
        columns: ["Stamp [s]", "Became", "Because"].map(str::to_owned).to_vec(),
        rows: odd.iter().take(MOST_LISTED).map(row).collect(),
    }));
    if odd.len() > MOST_LISTED {
        blocks.push(Block::Text(format!("And {} more.", odd.len() - MOST_LISTED)));
    }
    blocks
}

fn loops(loops: &LoopsReport) -> Vec<Block> {
    let row = |tried: &LoopReport| {
        let became = match tried.result {
            LoopResult::Closed => "closed",
            LoopResult::Refused => "refused",
            LoopResult::Dropped => "dropped",
        };
        let off = tried.off.map_or_else(String::new, |off| format!("{off:.2}"));
        let stamps = [tried.earlier, tried.later].map(|stamp| format!("{stamp:.3}"));
        let [earlier, later] = stamps;
        vec![earlier, later, became.to_owned(), off, tried.reasons.join("; ")]
    };
    let columns = ["First seen [s]", "Seen again [s]", "Became", "Off [sigma]", "Because"];
    let mut blocks = vec![
        Block::Text(format!(
            "They moved the camera by up to {:.1} mm. How far a closed loop is off the way as it was settled \
             is told in standard deviations.",
            loops.moved
        )),
        Block::Table(Table {
            columns: columns.map(str::to_owned).to_vec(),
            rows: loops.tried.iter().take(MOST_LISTED).map(row).collect(),
        }),
    ];
    if loops.tried.len() > MOST_LISTED {
        blocks.push(Block::Text(format!("And {} more.", loops.tried.len() - MOST_LISTED)));
    }
    blocks
}

fn facts(report: &ScanReport) -> Vec<(String, String)> {
    let mut facts = vec![
        ("Method".into(), format!("{:?}", report.options.odometry.method)),
        ("Voxels of the cloud".into(), format!("{:.3} mm", report.voxel)),
        ("Outliers left out".into(), report.n_outliers.to_string()),
        ("Turns of the camera, added up".into(), format!("{:.1} deg", report.turned_deg)),
        ("Seed".into(), report.options.odometry.seed.to_string()),
    ];
    if let Some(before) = report.ate_before_loops_mm {
        facts.push(("Off the truth before loops were closed".into(), format!("{before:.2} mm")));
    }
    facts
}

fn section(title: &str, blocks: Vec<Block>) -> Section {
    Section { title: title.to_owned(), blocks }
}
