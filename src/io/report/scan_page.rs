//! What a scan shows: the way of the camera, and what became of its frames.

use super::chart::Labels;
use super::svg::{Series, plan_chart};
use super::{Block, Figure, Image, Page, Picture, Section, Table};
use crate::geom::Vector3;
use crate::register::icp::Verdict;
use crate::register::odometry::FrameRole;
use crate::workflow::scan::{ScanReport, Scanned};

/// Points of the cloud that are drawn, about.
const MOST_DOTS: usize = 3000;
/// Frames listed at most.
const MOST_LISTED: usize = 100;

/// The page of a scan.
pub fn scan_page(scanned: &Scanned) -> Page {
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
    let mut sections = vec![
        section("Way of the camera", vec![Block::Pictures(plans(scanned))]),
        section("Frames", frames(report)),
        section("How it was done", vec![Block::Facts(facts(report))]),
    ];
    if !report.notes.is_empty() {
        let notes = report.notes.iter().cloned().map(Block::Text).collect();
        sections.push(section("Notes", notes));
    }
    let warnings = match report.verdict {
        Verdict::Ok => Vec::new(),
        verdict => vec![format!("The scan is {verdict}: look at the frames below.")],
    };
    Page {
        title: report.name.clone(),
        subtitle: format!("{} points of {} frames", report.n_points, placed),
        warnings,
        figures,
        sections,
    }
}

/// From above and from the side, as the first camera stands: x to the right, y down, z ahead.
fn plans(scanned: &Scanned) -> Vec<Picture> {
    let cloud = &scanned.cloud.points;
    let stride = cloud.len().div_ceil(MOST_DOTS).max(1);
    let plan = |title: &str, of: fn(&Vector3) -> [f64; 2], labels: Labels| {
        // A dot is a line of its own: between dots is a gap.
        let dots = cloud.iter().step_by(stride).flat_map(|point| {
            let [x, y] = of(&point.coords);
            [[x, y], [x + 2.0, y], [f64::NAN; 2]]
        });
        let poses = scanned.trajectory.poses().iter();
        let way = poses.map(|pose| of(&pose.world_from_camera.translation.vector));
        let series = [
            Series { name: "surface".into(), points: dots.collect() },
            Series { name: "camera".into(), points: way.collect() },
        ];
        Picture {
            title: title.to_owned(),
            caption: "In the frame of the first camera.".into(),
            image: Image::Svg(plan_chart(&series, labels)),
        }
    };
    vec![
        plan("From above", |v| [v.x, v.z], Labels { x: "to the right [mm]", y: "ahead [mm]" }),
        plan("From the side", |v| [v.z, -v.y], Labels { x: "ahead [mm]", y: "up [mm]" }),
    ]
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

fn facts(report: &ScanReport) -> Vec<(String, String)> {
    vec![
        ("Method".into(), format!("{:?}", report.options.odometry.method)),
        ("Voxels of the cloud".into(), format!("{:.3} mm", report.voxel)),
        ("Turns of the camera, added up".into(), format!("{:.1} deg", report.turned_deg)),
        ("Seed".into(), report.options.odometry.seed.to_string()),
    ]
}

fn section(title: &str, blocks: Vec<Block>) -> Section {
    Section { title: title.to_owned(), blocks }
}
