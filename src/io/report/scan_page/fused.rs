//! The page of a fusion: a mesh.

use super::super::{Figure, Page, Section};
use super::shown::{Curve, Seen, Shown, figure, listed, section};
use crate::geom::{Point3, Vector3};
use crate::workflow::fuse::{FuseReport, Fused, FusedFrame};
use crate::workflow::turns::TurnReport;

/// The page of the fusion of the frames called `name`.
pub fn fusion_page(name: &str, fused: &Fused) -> std::io::Result<Page> {
    let report = &fused.report;
    let poses = fused.trajectory.poses();
    let first_from_world =
        poses.first().map(|pose| pose.world_from_camera.inverse()).unwrap_or_default();
    let place = |shift: &Vector3| first_from_world * Point3::from(*shift);
    let way: Vec<Point3> =
        poses.iter().map(|pose| place(&pose.world_from_camera.translation.vector)).collect();
    let mesh = fused.mesh.clone().moved(&first_from_world);
    Shown {
        title: name.to_owned(),
        subtitle: format!("{} triangles of {} frames", report.mesh.n_triangles, report.n_fused),
        warnings: warnings(report),
        figures: figures(report, &way),
        seen: Seen {
            title: "The surface",
            caption: if mesh.colors.is_some() { "In the colours that were seen." } else { "" },
            points: mesh.points.clone(),
            mesh,
        },
        ways: ways(report, &way),
        loops: Vec::new(),
        curves: curves(report),
        counts: counts(report),
        odd: odd(report),
        sections: turns(report).into_iter().collect(),
        facts: facts(report),
        notes: report.notes.clone(),
    }
    .page()
}

fn warnings(report: &FuseReport) -> Vec<String> {
    let n_skipped = report.skipped.len();
    let skipped = (n_skipped > 0).then(|| {
        format!("{n_skipped} of {} frames are left out: look at them below.", report.n_frames)
    });
    let table = report.turntable.iter().flat_map(|table| &table.reasons);
    let table = table.map(|reason| format!("The turntable is doubtful: {reason}."));
    let left_out = report.turns.iter().filter(|turn| !turn.is_in());
    let left_out =
        left_out.map(|turn| format!("{} is left out: {}.", turn.name, turn.reasons.join("; ")));
    left_out.chain(skipped).chain(table).collect()
}

/// The way of the camera, turn by turn.
fn ways(report: &FuseReport, way: &[Point3]) -> Vec<Vec<Point3>> {
    let mut ends = Vec::new();
    for turn in report.turns.iter().filter(|turn| turn.is_in()) {
        ends.push(ends.last().copied().unwrap_or(0) + turn.n_frames);
    }
    let turn_of = |frame: &FusedFrame| ends.partition_point(|end| *end < frame.number);
    let frames: Vec<(&FusedFrame, &Point3)> = report.frames.iter().zip(way).collect();
    let turns = frames.chunk_by(|(a, _), (b, _)| turn_of(a) == turn_of(b));
    turns.map(|turn| turn.iter().map(|(_, place)| **place).collect()).collect()
}

fn turns(report: &FuseReport) -> Option<Section> {
    let row = |turn: &TurnReport| {
        let table = turn.turntable.as_ref();
        let fit = turn.lies_on_others.map(|fit| format!("{:.0}", 100.0 * fit));
        let doubts = table.iter().flat_map(|table| &table.reasons);
        let told: Vec<String> = turn.reasons.iter().chain(doubts).cloned().collect();
        vec![
            turn.name.clone(),
            turn.n_frames.to_string(),
            table.map_or_else(String::new, |table| format!("{:.3}", table.step_deg)),
            fit.unwrap_or_default(),
            if turn.is_in() { "fused" } else { "left out" }.to_owned(),
            told.join("; "),
        ]
    };
    let columns = ["Turn", "Frames", "Step [deg]", "Lies on another turn [%]", "Became", "Because"];
    let rows: Vec<Vec<String>> = report.turns.iter().map(row).collect();
    (!rows.is_empty()).then(|| section("Turns", listed(&columns, rows)))
}

fn figures(report: &FuseReport, way: &[Point3]) -> Vec<Figure> {
    let mesh = &report.mesh;
    let mut figures = vec![
        figure("Frames fused", report.n_fused.to_string(), &format!("of {}", report.n_frames)),
        figure("Left out", report.skipped.len().to_string(), ""),
    ];
    if report.tracked {
        let steps = way.windows(2).map(|pair| (pair[1] - pair[0]).norm());
        figures.push(figure("Way of the camera", format!("{:.0}", steps.sum::<f64>()), "mm"));
    }
    if !report.turns.is_empty() {
        let n_in = report.turns.iter().filter(|turn| turn.is_in()).count();
        let of = format!("of {}", report.turns.len());
        figures.push(figure("Turns fused", n_in.to_string(), &of));
    }
    if let Some(table) = &report.turntable {
        figures.push(figure("Turn from view to view", format!("{:.3}", table.step_deg), "deg"));
    }
    if let Some(truth) = &report.against_truth {
        figures.push(figure("Off the truth (ATE)", format!("{:.2}", truth.ate_mm.rmse), "mm"));
    }
    if let Some(kept_out) = &report.kept_out {
        figures.push(figure("Frames kept out lie off", format!("{:.2}", kept_out.median), "mm"));
    }
    figures.push(match (mesh.is_closed, mesh.volume) {
        (true, Some(volume)) => figure("Closed surface", format!("{:.1}", volume / 1000.0), "cm³"),
        (true, None) => figure("Surface", "closed".into(), ""),
        (false, _) => figure("Open surface", mesh.n_open_edges.to_string(), "edges on its borders"),
    });
    figures
}

/// What is known of every frame, over the time since the first.
fn curves(report: &FuseReport) -> Vec<Curve> {
    let stamps = report.frames.iter().map(|frame| frame.stamp);
    let begin = stamps.chain(report.skipped.iter().map(|skipped| skipped.stamp));
    let begin = begin.fold(f64::INFINITY, f64::min);
    let over_time = |of: &dyn Fn(&FusedFrame) -> Option<f64>| {
        let known = report.frames.iter().map(|frame| (frame.stamp, of(frame)));
        let gaps = report.skipped.iter().map(|skipped| (skipped.stamp, None));
        let mut points: Vec<[f64; 2]> = known
            .chain(gaps)
            .map(|(stamp, value)| [stamp - begin, value.unwrap_or(f64::NAN)])
            .collect();
        points.sort_by(|a, b| a[0].total_cmp(&b[0]));
        points
    };
    vec![
        Curve {
            title: "Error of every frame",
            caption: "The whole way laid over the true one; gaps are frames that were left out.",
            label: "off the truth [mm]",
            points: over_time(&|frame| frame.off),
        },
        Curve {
            title: "Frames and the surface",
            caption: "How far half of the readings of a frame lie from the surface that all made: noise, and \
                      where a frame contradicts the others.",
            label: "readings off the surface [mm]",
            points: over_time(&|frame| Some(frame.apart)),
        },
        Curve {
            title: "Pairs of every frame",
            caption: "How much of a frame lay on what those before it had made; gaps are frames that were left \
                      out, and the first.",
            label: "of the frame [%]",
            points: over_time(&|frame| Some(100.0 * frame.overlap?)),
        },
    ]
}

fn counts(report: &FuseReport) -> Vec<(String, String)> {
    let how = if report.tracked { "placed by tracking" } else { "placed as given" };
    let mut counts = vec![
        ("Fused".into(), format!("{}, {how}", report.n_fused)),
        ("Left out".into(), report.skipped.len().to_string()),
    ];
    if let Some(kept_out) = &report.kept_out {
        counts.push(("Kept out to measure by".into(), kept_out.n_frames.to_string()));
    }
    counts
}

fn odd(report: &FuseReport) -> Vec<Vec<String>> {
    let row = |skipped: &crate::workflow::fuse::Skipped| {
        let [number, stamp] = [skipped.number.to_string(), format!("{:.3}", skipped.stamp)];
        vec![number, stamp, "left out".to_owned(), skipped.reason.clone()]
    };
    report.skipped.iter().map(row).collect()
}

fn facts(report: &FuseReport) -> Vec<(String, String)> {
    let mesh = &report.mesh;
    let [x, y, z] = mesh.size;
    let why = report.compute.why.as_ref().map_or(String::new(), |why| format!(" ({why})"));
    let mut facts: Vec<(String, String)> = vec![
        ("Voxel".into(), format!("{} mm", report.voxel)),
        ("Truncation".into(), format!("{} mm", report.truncation)),
        ("Model".into(), format!("{} blocks, {:.0} MB", report.n_blocks, report.memory_mb)),
        ("Computed on".into(), format!("{}{why}", report.compute.on)),
        ("Surface".into(), format!("{x:.1} x {y:.1} x {z:.1} mm, {:.1} cm²", mesh.area / 100.0)),
        ("Pieces".into(), mesh.n_pieces.to_string()),
        ("Smaller pieces dropped".into(), report.n_small_pieces.to_string()),
    ];
    if let Some(delay) = &report.pose_delay {
        let [at_stamps, at_delay] = delay.apart;
        facts.push((
            "Stamps are late by".into(),
            format!(
                "{:.4} s: frames lie {at_delay:.2} mm apart instead of {at_stamps:.2} mm",
                delay.seconds
            ),
        ));
    }
    if let Some(table) = &report.turntable {
        let [axis, through] = [(table.axis, 4), (table.through, 1)]
            .map(|(numbers, digits)| numbers.map(|number| format!("{number:.digits$}")).join(", "));
        facts.push(("Axis of the turntable".into(), format!("({axis}) through ({through}) mm")));
        if table.n_views > 0 {
            facts.push((
                "Neighbouring views lie apart".into(),
                format!("{:.3} mm, of {} views", table.apart, table.n_views),
            ));
        }
        if let Some(apart) = table.apart_after_a_turn {
            facts.push(("Apart after a turn".into(), format!("{apart:.3} mm")));
        }
    }
    if let Some(kept_out) = &report.kept_out {
        facts.push((
            "Readings of frames kept out".into(),
            format!(
                "{:.2} mm off in the median, {:.2} mm rms within 50 mm, {:.0} % within a voxel",
                kept_out.median,
                kept_out.rmse_within_50,
                100.0 * kept_out.share_within_voxel
            ),
        ));
    }
    facts
}
