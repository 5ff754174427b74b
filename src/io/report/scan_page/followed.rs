//! The page of a scan whose camera was followed from frame to frame: a cloud.

use super::super::{Block, Figure, Page};
use super::pictures::PLAIN;
use super::shown::{Curve, Seen, Shown, figure, listed, section};
use crate::geom::{Point3, PointCloud, TriMesh, Vector3};
use crate::register::icp::Verdict;
use crate::register::odometry::FrameRole;
use crate::workflow::scan::{
    FrameReport, LoopReport, LoopResult, LoopsReport, ScanReport, Scanned,
};

/// Points of the cloud that are drawn as tiles, about.
const MOST_TILES: usize = 120_000;
/// What the tiles of a cloud that is thinned cover more, to stay a surface.
const COVER: f64 = 1.3;

/// The page of a scan.
pub fn scan_page(scanned: &Scanned) -> std::io::Result<Page> {
    let report = &scanned.report;
    let counts = report.counts;
    let way = scanned.trajectory.poses().iter();
    let way = way.map(|pose| Point3::from(pose.world_from_camera.translation.vector));
    let tried = report.loops.as_ref().filter(|loops| !loops.tried.is_empty());
    Shown {
        title: report.name.clone(),
        subtitle: format!("{} points of {} frames", report.n_points, counts.ok + counts.doubtful),
        warnings: warnings(report),
        figures: figures(report),
        seen: Seen {
            title: "The cloud",
            caption: "One tile for each point.",
            mesh: tiles(&scanned.cloud, report.voxel),
            points: scanned.cloud.points.clone(),
        },
        ways: vec![way.collect()],
        loops: ends(scanned),
        curves: curves(report),
        counts: vec![
            ("Believed".into(), format!("{}, of them {} key frames", counts.ok, counts.key)),
            ("Doubtful".into(), counts.doubtful.to_string()),
            ("Skipped".into(), counts.skipped.to_string()),
        ],
        odd: odd(report),
        sections: tried.map(|tried| section("Loops", loops(tried))).into_iter().collect(),
        facts: facts(report),
        notes: report.notes.clone(),
    }
    .page()
}

fn warnings(report: &ScanReport) -> Vec<String> {
    let are_believed = report.counts.doubtful + report.counts.skipped == 0;
    let frames = (report.verdict != Verdict::Ok && !are_believed)
        .then(|| format!("The scan is {}: look at the frames below.", report.verdict));
    let walk = report.doubts.iter().map(|doubt| format!("The walk is doubtful: {doubt}."));
    frames.into_iter().chain(walk).collect()
}

fn figures(report: &ScanReport) -> Vec<Figure> {
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
    figures
}

/// What is known of every frame, over the time since the first.
fn curves(report: &ScanReport) -> Vec<Curve> {
    let begin = report.frames.first().map_or(0.0, |frame| frame.stamp);
    let over_time = |of: &dyn Fn(&FrameReport) -> Option<f64>| {
        let point = |frame: &FrameReport| [frame.stamp - begin, of(frame).unwrap_or(f64::NAN)];
        report.frames.iter().map(point).collect()
    };
    vec![
        Curve {
            title: "Error of every frame",
            caption: "The whole way laid over the true one; gaps are frames that were skipped.",
            label: "off the truth [mm]",
            points: over_time(&|frame| frame.off),
        },
        Curve {
            title: "What is left open",
            caption: "How far the camera may be astray, seen from the first frame, by what all motions leave open \
                      that lead there: three standard deviations, before loops are closed.",
            label: "may be astray [mm]",
            points: over_time(&|frame| frame.open),
        },
        Curve {
            title: "Seen again",
            caption: "How much of what its key frame shows a frame shows too; gaps are frames that were \
                      skipped, and the first.",
            label: "of the key frame [%]",
            points: over_time(&|frame| Some(100.0 * frame.overlap?)),
        },
    ]
}

fn odd(report: &ScanReport) -> Vec<Vec<String>> {
    let numbered = report.frames.iter().zip(1..);
    let odd = numbered.filter(|(frame, _)| frame.verdict != Verdict::Ok);
    odd.map(|(frame, number): (&FrameReport, usize)| {
        let became = if frame.role == FrameRole::Skipped { "skipped" } else { "doubtful" };
        let [number, stamp] = [number.to_string(), format!("{:.3}", frame.stamp)];
        vec![number, stamp, became.to_owned(), frame.reasons.join("; ")]
    })
    .collect()
}

fn loops(loops: &LoopsReport) -> Vec<Block> {
    let row = |tried: &LoopReport| {
        let became = match tried.result {
            LoopResult::Closed => "closed",
            LoopResult::Refused => "refused",
            LoopResult::Dropped => "dropped",
        };
        let off = tried.off.map_or_else(String::new, |off| format!("{off:.2}"));
        let [earlier, later] = [tried.earlier, tried.later].map(|stamp| format!("{stamp:.3}"));
        vec![earlier, later, became.to_owned(), off, tried.reasons.join("; ")]
    };
    let columns = ["First seen [s]", "Seen again [s]", "Became", "Off [sigma]", "Because"];
    let mut blocks = vec![Block::Text(format!(
        "They moved the camera by up to {:.1} mm. How far a closed loop is off the way as it was settled \
         is told in standard deviations.",
        loops.moved
    ))];
    blocks.extend(listed(&columns, loops.tried.iter().map(row).collect()));
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

/// Where the camera was at both ends of every loop that closed.
fn ends(scanned: &Scanned) -> Vec<[Point3; 2]> {
    let tried = scanned.report.loops.iter().flat_map(|loops| &loops.tried);
    let place = |stamp: f64| {
        let pose = scanned.trajectory.nearest(stamp)?.world_from_camera;
        Some(Point3::from(pose.translation.vector))
    };
    tried
        .filter(|tried| tried.result == LoopResult::Closed)
        .filter_map(|tried| Some([place(tried.earlier)?, place(tried.later)?]))
        .collect()
}

/// A tile for every point, across its normal.
fn tiles(cloud: &PointCloud, voxel: f64) -> TriMesh {
    let stride = cloud.points.len().div_ceil(MOST_TILES).max(1);
    let half = 0.5 * voxel * COVER * (stride as f64).sqrt();
    let (mut points, mut triangles, mut colors) = (Vec::new(), Vec::new(), Vec::new());
    for (i, point) in cloud.points.iter().enumerate().step_by(stride) {
        let normal = cloud.normals.as_ref().map_or(Vector3::z(), |normals| normals[i]);
        let aside = if normal.x.abs() < 0.7 { Vector3::x() } else { Vector3::y() };
        let Some(across) = normal.cross(&aside).try_normalize(1e-9) else { continue };
        let (across, along) = (across * half, normal.cross(&across) * half);
        let first = points.len() as u32;
        points.extend([
            point - across - along,
            point + across - along,
            point + across + along,
            point - across + along,
        ]);
        triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
        let color = cloud.colors.as_ref().map_or(PLAIN, |colors| colors[i]);
        colors.extend([color; 4]);
    }
    let mut mesh = TriMesh::new(points, triangles);
    mesh.colors = Some(colors);
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_point_has_a_tile_across_its_normal() {
        let normal = Vector3::new(0.6, 0.0, 0.8);
        let cloud = PointCloud {
            points: vec![Point3::new(1.0, 2.0, 3.0); 2],
            normals: Some(vec![normal, Vector3::x()]),
            colors: Some(vec![[9; 3], [7; 3]]),
        };
        let mesh = tiles(&cloud, 2.0);
        assert_eq!((mesh.points.len(), mesh.triangles.len()), (8, 4));
        let area = |i: usize| mesh.area_vector(i);
        assert!(area(0).normalize().cross(&normal).norm() < 1e-12);
        let [a, b] = [0, 1].map(|i| mesh.points[i]);
        assert!(((a - b).norm() - 2.0 * COVER).abs() < 1e-12, "as wide as a voxel, and some");
        assert_eq!(mesh.colors.unwrap()[4], [7; 3]);
    }
}
