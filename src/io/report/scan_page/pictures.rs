//! What was seen from several sides, with the way of the camera; plans of both; numbers over time.

use super::super::chart::Labels;
use super::super::svg::{Series, line_chart, plan_chart};
use super::super::{Camera, Image, Path, Picture, Scene, Solid, encode_png, render};
use super::shown::{Curve, Shown};
use crate::geom::{Point3, Vector3};

/// Points that are drawn in a plan, about.
const MOST_DOTS: usize = 3000;
/// Width and height of a picture.
const SIZE_PX: [u32; 2] = [960, 600];
/// Of what has no colour.
pub(super) const PLAIN: [u8; 3] = [176, 184, 194];
const WAY: [u8; 3] = [213, 94, 0];
const LOOP: [u8; 3] = [0, 158, 115];
const WIDTH_PX: f64 = 2.5;

/// From behind the first camera, from its right, from the far side, and from above with the way of the
/// camera.
pub(super) fn seen(shown: &Shown) -> std::io::Result<Vec<Picture>> {
    let solids = vec![Solid { mesh: &shown.seen.mesh, color: PLAIN }];
    let ways = shown.ways.iter().map(|way| Path { points: way, color: WAY, width_px: WIDTH_PX });
    let loops =
        shown.loops.iter().map(|ends| Path { points: ends, color: LOOP, width_px: WIDTH_PX });
    let alone = Scene { solids: solids.clone(), paths: Vec::new() };
    let with_way = Scene { solids, paths: ways.chain(loops).collect() };
    let way = if shown.loops.is_empty() {
        "Orange: the way of the camera."
    } else {
        "Orange: the way of the camera. Green: between frames that close a loop."
    };
    let up = -Vector3::y();
    [
        ("From behind the first camera", Vector3::new(0.25, 0.35, 1.0), up, &alone),
        ("From its right", Vector3::new(-1.0, 0.35, 0.25), up, &alone),
        ("From the far side", Vector3::new(-0.25, 0.35, -1.0), up, &alone),
        ("From above", Vector3::y(), Vector3::z(), &with_way),
    ]
    .into_iter()
    .map(|(title, direction, up, scene)| {
        let camera = Camera { direction, up, size_px: SIZE_PX };
        let caption =
            if std::ptr::eq(scene, &raw const with_way) { way } else { shown.seen.caption };
        Ok(Picture {
            title: title.to_owned(),
            caption: caption.to_owned(),
            image: Image::Png(encode_png(&render(scene, &camera))?),
        })
    })
    .collect()
}

/// From above and from the side, as the first camera stands.
pub(super) fn plans(shown: &Shown) -> Vec<Picture> {
    let stride = shown.seen.points.len().div_ceil(MOST_DOTS).max(1);
    let plan = |title: &str, of: fn(&Point3) -> [f64; 2], labels: Labels| {
        // A dot is a line of its own: between dots is a gap.
        let dots = shown.seen.points.iter().step_by(stride).flat_map(|point| {
            let [x, y] = of(point);
            [[x, y], [x + 2.0, y], [f64::NAN; 2]]
        });
        let gap = std::iter::once([f64::NAN; 2]);
        let way = |way: &Vec<Point3>| way.iter().map(of).chain(gap.clone()).collect::<Vec<_>>();
        let mut series = vec![
            Series { name: "surface".into(), points: dots.collect() },
            Series { name: "camera".into(), points: shown.ways.iter().flat_map(way).collect() },
        ];
        if !shown.loops.is_empty() {
            let ends = shown.loops.iter().flat_map(|ends| {
                let [earlier, later] = ends.each_ref().map(of);
                [earlier, later, [f64::NAN; 2]]
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
        plan("From above", |p| [p.x, p.z], Labels { x: "to the right [mm]", y: "ahead [mm]" }),
        plan("From the side", |p| [p.z, -p.y], Labels { x: "ahead [mm]", y: "up [mm]" }),
    ]
}

/// A number of every frame; nothing if it is known of none.
pub(super) fn curve(curve: &Curve) -> Option<Picture> {
    curve.points.iter().any(|[_, value]| value.is_finite()).then(|| {
        let series = [Series { name: String::new(), points: curve.points.clone() }];
        let labels = Labels { x: "time [s]", y: curve.label };
        Picture {
            title: curve.title.into(),
            caption: curve.caption.into(),
            image: Image::Svg(line_chart(&series, labels)),
        }
    })
}
