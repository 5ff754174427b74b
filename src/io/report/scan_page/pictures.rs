//! The cloud as the first camera saw it and from above, with the way of the camera; plans of both.

use super::super::chart::Labels;
use super::super::svg::{Series, line_chart, plan_chart};
use super::super::{Camera, Image, Path, Picture, Scene, Solid, encode_png, render};
use crate::geom::{Point3, PointCloud, TriMesh, Vector3};
use crate::workflow::scan::{LoopResult, ScanReport, Scanned};

/// Points of the cloud that are drawn in a plan, about.
const MOST_DOTS: usize = 3000;
/// Points of the cloud that are drawn as tiles, about.
const MOST_TILES: usize = 120_000;
/// What the tiles of a cloud that is thinned cover more, to stay a surface.
const COVER: f64 = 1.3;
/// Width and height of a picture.
const SIZE_PX: [u32; 2] = [960, 600];
const PLAIN: [u8; 3] = [176, 184, 194];
const WAY: [u8; 3] = [213, 94, 0];
const LOOP: [u8; 3] = [0, 158, 115];
const WIDTH_PX: f64 = 2.5;

/// The cloud from behind the first camera, and from above with the way of the camera.
pub(super) fn cloud(scanned: &Scanned) -> std::io::Result<Vec<Picture>> {
    let tiles = tiles(&scanned.cloud, scanned.report.voxel);
    let way: Vec<Point3> = poses(scanned).collect();
    let loops = loops(scanned);
    let mut paths = vec![Path { points: &way, color: WAY, width_px: WIDTH_PX }];
    paths.extend(loops.iter().map(|ends| Path { points: ends, color: LOOP, width_px: WIDTH_PX }));
    let solids = vec![Solid { mesh: &tiles, color: PLAIN }];
    let alone = Scene { solids: solids.clone(), paths: Vec::new() };
    let with_way = Scene { solids, paths };
    let camera = |direction, up| Camera { direction, up, size_px: SIZE_PX };
    let behind = camera(Vector3::new(0.25, 0.35, 1.0), -Vector3::y());
    let above = camera(Vector3::y(), Vector3::z());
    let way = if loops.is_empty() {
        "Orange: the way of the camera."
    } else {
        "Orange: the way of the camera. Green: between frames that close a loop."
    };
    let picture =
        |title: &str, caption: &str, scene: &Scene, camera: &Camera| -> std::io::Result<Picture> {
            Ok(Picture {
                title: title.to_owned(),
                caption: caption.to_owned(),
                image: Image::Png(encode_png(&render(scene, camera))?),
            })
        };
    Ok(vec![
        picture("From behind the first camera", "One tile for each point.", &alone, &behind)?,
        picture("From above", way, &with_way, &above)?,
    ])
}

/// From above and from the side, as the first camera stands: x to the right, y down, z ahead.
pub(super) fn plans(scanned: &Scanned) -> Vec<Picture> {
    let cloud = &scanned.cloud.points;
    let stride = cloud.len().div_ceil(MOST_DOTS).max(1);
    let loops = loops(scanned);
    let plan = |title: &str, of: fn(&Vector3) -> [f64; 2], labels: Labels| {
        // A dot is a line of its own: between dots is a gap.
        let dots = cloud.iter().step_by(stride).flat_map(|point| {
            let [x, y] = of(&point.coords);
            [[x, y], [x + 2.0, y], [f64::NAN; 2]]
        });
        let way = poses(scanned).map(|place| of(&place.coords));
        let mut series = vec![
            Series { name: "surface".into(), points: dots.collect() },
            Series { name: "camera".into(), points: way.collect() },
        ];
        if !loops.is_empty() {
            let ends = loops.iter().flat_map(|[earlier, later]| {
                [of(&earlier.coords), of(&later.coords), [f64::NAN; 2]]
            });
            series.push(Series { name: "loops".into(), points: ends.collect() });
        }
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

/// How far every frame is off the truth, where that is known; a gap where it was skipped.
pub(super) fn errors(report: &ScanReport) -> Option<Picture> {
    report.against_truth.as_ref()?;
    let begin = report.frames.first()?.stamp;
    let points =
        report.frames.iter().map(|frame| [frame.stamp - begin, frame.off.unwrap_or(f64::NAN)]);
    let series = [Series { name: String::new(), points: points.collect() }];
    let labels = Labels { x: "time [s]", y: "off the truth [mm]" };
    Some(Picture {
        title: "Error of every frame".into(),
        caption: "The whole way laid over the true one; gaps are frames that were skipped.".into(),
        image: Image::Svg(line_chart(&series, labels)),
    })
}

fn poses(scanned: &Scanned) -> impl Iterator<Item = Point3> + '_ {
    let poses = scanned.trajectory.poses().iter();
    poses.map(|pose| Point3::from(pose.world_from_camera.translation.vector))
}

/// Where the camera was at both ends of every loop that closed.
fn loops(scanned: &Scanned) -> Vec<[Point3; 2]> {
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
