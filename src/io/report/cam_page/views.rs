//! The part with its clamps and the path of the contact over it.

use super::super::{Block, Camera, Image, Path, Picture, Scene, Solid, encode_png, render};
use crate::cam::Strategy;
use crate::geom::{Aabb, Point3, Surface, TriMesh, Vector3};
use crate::workflow::cam::{self, CamReport, RunReport};

const PART: [u8; 3] = [222, 190, 148];
const CLAMPS: [u8; 3] = [138, 146, 158];
const PATH: [u8; 3] = [20, 84, 160];
/// Width and height of each picture: sharp on a screen of twice the density.
const SIZE_PX: [u32; 2] = [960, 600];
const PATH_WIDTH_PX: f64 = 1.3;
/// Lines of the path closer than this share of the part's size would cover it.
const CLOSEST_LINES: f64 = 0.012;
/// Points of the path closer than this share are one to the eye.
const CLOSEST_POINTS: f64 = 0.0008;
/// A contact that jumps farther than this share leaves the surface: nothing is drawn there.
const WIDEST_JUMP: f64 = 0.025;
/// Points of a cloud, or of its clamps, that are drawn, about.
const MOST_DOTS: usize = 40_000;
/// What the dots of a cloud cover between them, front and back: enough to hide the back [px2].
const DOTS_COVER: f64 = 1.2e6;
/// Width of a dot, whatever their number [px].
const DOT_WIDTH_PX: [f64; 2] = [2.0, 16.0];
/// Dots stand back by this share of the cloud's size, so that the path is seen over them.
const DOTS_STAND_BACK: f64 = 0.02;
/// Shades of a cloud, from the nearest to the farthest of its points.
const N_SHADES: usize = 16;

/// Two views that show all of the part between them, and what is drawn.
pub(super) fn blocks(scene: &cam::Scene, report: &CamReport) -> std::io::Result<Vec<Block>> {
    let size = scene.surface.aabb().size().norm();
    let row = Row::of(report);
    let stride = row.stride(size);
    let lines = lines(&scene.path, row.n_points, stride, size);
    let caption = match stride {
        1 => "Blue: where the tool touches.".to_owned(),
        2 => format!("Blue: where the tool touches, every second {} of it.", row.name),
        3 => format!("Blue: where the tool touches, every third {} of it.", row.name),
        n => format!("Blue: where the tool touches, every {n}th {} of it.", row.name),
    };
    let above = Camera::three_quarter(SIZE_PX);
    // What stands on a table has nothing to show from below.
    let is_turned = report.setup.swing > 0.0;
    let tilt = if is_turned { 0.45 } else { -0.5 };
    let behind = Camera { direction: Vector3::new(-0.45, -0.8, tilt), ..above };
    let behind_title = if is_turned { "From the other side, below." } else { "From behind." };
    let mut pictures = Vec::new();
    for (title, camera) in [("From the front, above.", above), (behind_title, behind)] {
        let raster = match &scene.surface {
            Surface::Mesh(mesh) => picture_of_mesh(mesh, scene.n_own, &lines, &camera),
            other => picture_of_points(other.points(), scene.n_own, &lines, &camera),
        };
        pictures.push(Picture {
            title: title.to_owned(),
            caption: caption.clone(),
            image: Image::Png(raster?),
        });
    }
    Ok(vec![Block::Pictures(pictures)])
}

fn picture_of_mesh(
    mesh: &TriMesh,
    n_own: usize,
    lines: &[Vec<Point3>],
    camera: &Camera,
) -> std::io::Result<Vec<u8>> {
    let (own, clamps) = mesh.triangles.split_at(n_own.min(mesh.triangles.len()));
    let piece = |triangles: &[[u32; 3]]| TriMesh {
        points: mesh.points.clone(),
        triangles: triangles.to_vec(),
        normals: None,
        colors: mesh.colors.clone(),
    };
    let (own, clamps) = (piece(own), piece(clamps));
    let solids = vec![Solid { mesh: &own, color: PART }, Solid { mesh: &clamps, color: CLAMPS }];
    encode_png(&render(&Scene { solids, paths: paths(lines).collect() }, camera))
}

/// A cloud as dots: light ones near the eye, dark ones far from it.
fn picture_of_points(
    points: &[Point3],
    n_own: usize,
    lines: &[Vec<Point3>],
    camera: &Camera,
) -> std::io::Result<Vec<u8>> {
    let depth = |p: &Point3| camera.direction.dot(&p.coords);
    let (near, far) = points
        .iter()
        .map(depth)
        .fold((f64::MAX, f64::MIN), |(near, far), d| (near.min(d), far.max(d)));
    let back =
        camera.direction.normalize() * (DOTS_STAND_BACK * Aabb::around(points).size().norm());
    let (own, clamps) = points.split_at(n_own.min(points.len()));
    let mut dots = Vec::new();
    for (points, color) in [(own, PART), (clamps, CLAMPS)] {
        let stride = points.len().div_ceil(MOST_DOTS).max(1);
        let width_px = (DOTS_COVER * stride as f64 / points.len() as f64).sqrt();
        let width_px = width_px.clamp(DOT_WIDTH_PX[0], DOT_WIDTH_PX[1]);
        for point in points.iter().step_by(stride) {
            let share = (depth(point) - near) / (far - near).max(f64::MIN_POSITIVE);
            // A line from a point to itself.
            dots.push(([point + back; 2], shaded(color, share), width_px));
        }
    }
    let mut drawn: Vec<Path> = Vec::with_capacity(dots.len() + lines.len());
    for (points, color, width_px) in &dots {
        drawn.push(Path { points, color: *color, width_px: *width_px });
    }
    drawn.extend(paths(lines));
    encode_png(&render(&Scene { solids: Vec::new(), paths: drawn }, camera))
}

/// Less light with each step away from the eye.
fn shaded(color: [u8; 3], share: f64) -> [u8; 3] {
    let step = (share * N_SHADES as f64).floor() / N_SHADES as f64;
    color.map(|c| (f64::from(c) * (1.0 - 0.55 * step)) as u8)
}

fn paths(lines: &[Vec<Point3>]) -> impl Iterator<Item = Path<'_>> {
    lines.iter().map(|points| Path { points, color: PATH, width_px: PATH_WIDTH_PX })
}

/// What repeats along the run: a turn, or a line.
struct Row {
    name: &'static str,
    n_points: usize,
    /// From one to the next [mm].
    spacing: f64,
}

impl Row {
    fn of(report: &CamReport) -> Self {
        let run = &report.run;
        match run.strategy {
            Strategy::Helix | Strategy::Rings => {
                Self { name: "turn", n_points: run.per_turn as usize, spacing: run.pitch[0] }
            }
            Strategy::Lines => {
                let spacing = std::f64::consts::TAU * report.setup.swing / f64::from(run.per_turn);
                Self { name: "line", n_points: on_a_line(run), spacing }
            }
            // A contour's rings are of any length: it is drawn whole.
            Strategy::Contour => {
                Self { name: "ring", n_points: run.n_positions, spacing: f64::INFINITY }
            }
            Strategy::Raster => {
                Self { name: "row", n_points: on_a_line(run), spacing: run.pitch[0] }
            }
        }
    }

    /// Draw one in this many.
    fn stride(&self, size: f64) -> usize {
        // A cast takes no number for 0.
        ((CLOSEST_LINES * size / self.spacing).ceil() as usize).clamp(1, 1000)
    }
}

fn on_a_line(run: &RunReport) -> usize {
    let [from, to] = run.along;
    ((to - from) / run.step).ceil().max(1.0) as usize + 1
}

/// The path as lines to draw: one row in `stride`, broken where the contact jumps, without points
/// too close to matter. Where positions met nothing the rows are a little off; it is a picture.
fn lines(path: &[Point3], n_per_row: usize, stride: usize, size: f64) -> Vec<Vec<Point3>> {
    let mut lines = Vec::new();
    for row in path.chunks(n_per_row.max(1)).step_by(stride) {
        let mut line: Vec<Point3> = Vec::new();
        for (i, point) in row.iter().enumerate() {
            let away = line.last().map_or(f64::INFINITY, |last| (point - last).norm() / size);
            if away > WIDEST_JUMP {
                lines.push(std::mem::take(&mut line));
            }
            if away > CLOSEST_POINTS || i + 1 == row.len() {
                line.push(*point);
            }
        }
        lines.push(line);
    }
    lines.retain(|line| line.len() > 1);
    lines
}
