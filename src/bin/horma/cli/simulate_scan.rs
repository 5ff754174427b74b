//! `horma simulate-scan`: what a depth camera would see of a mesh.

use super::Shell;
use super::cam::notes;
use super::table::listed;
use anyhow::Context;
use clap::Args;
use horma::geom::{LengthUnit, TriMesh};
use horma::io::rgbd::{DepthCamera, ScanFolder, read_camera, read_trajectory};
use horma::io::{self, Overwrite};
use horma::progress::Progress;
use horma::rgbd::simulated::{BuiltinScene, NoiseKind, SimulationOptions};
use horma::workflow::simulate_scan::{SimulateScanJob, Subject, simulate_scan};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Simulate the scan of a mesh: colour and depth pictures with exact camera poses.
#[derive(Debug, Args)]
#[command(
    after_help = "Writes a folder in the format of the TUM RGB-D benchmark: rgb/ and depth/ with rgb.txt and
depth.txt, groundtruth.txt (metres; the world is the mesh's own frame), camera.toml, and contact.png
to look at. The same input, options and seed give the same bytes.

For example:
  horma simulate-scan last.stl -o scan
  horma simulate-scan last.stl --noise kinect --sigma 1 --views 72 --elevations 35,-35 -o scan
  horma simulate-scan --scene textured-structured --views 90 -o walk
  horma simulate-scan desk.ply --along groundtruth.txt --camera freiburg1 -o again"
)]
pub(crate) struct SimulateScanArgs {
    /// The mesh that is scanned.
    #[arg(required_unless_present = "scene", conflicts_with = "scene")]
    mesh: Option<PathBuf>,
    /// Scan one of horma's own scenes instead: with or without texture, flat or structured.
    #[arg(long, value_name = "SCENE")]
    scene: Option<BuiltinScene>,
    /// The folder to write; it must not be there.
    #[arg(long, short, value_name = "DIR")]
    output: PathBuf,
    /// The camera goes along this trajectory (TUM format) instead of a path of horma's.
    #[arg(long, value_name = "FILE", conflicts_with = "path")]
    along: Option<PathBuf>,
    /// The camera: kinect, freiburg1, or a camera.toml.
    #[arg(long, value_name = "CAMERA", default_value = "kinect")]
    camera: PathBuf,
    /// The unit of the mesh's file [default: what it declares, else by its extent].
    #[arg(long, value_name = "UNIT")]
    units: Option<LengthUnit>,
    /// Replace an earlier scan of that name.
    #[arg(long)]
    force: bool,
    #[command(flatten)]
    options: SimulationOptions,
}

/// What the JSON holds.
#[derive(Serialize)]
#[serde(rename_all = "kebab-case")]
struct Report<'a> {
    folder: &'a Path,
    n_frames: usize,
    n_triangles: usize,
    size_px: [usize; 2],
    /// Pixels with a depth, on the mean over all frames.
    mean_readings: usize,
    noise: NoiseKind,
    seed: u64,
    notes: &'a [String],
}

/// Renders frame by frame into a folder that gets its name when all of them are there.
pub(crate) fn run(args: &SimulateScanArgs, shell: &Shell) -> anyhow::Result<()> {
    let camera = read_camera(&args.camera)?;
    let along = args.along.as_deref().map(read_trajectory).transpose()?;
    let (subject, notes) = args.subject()?;
    let job = SimulateScanJob { subject, camera: camera.camera, along, options: &args.options };
    let scan = simulate_scan(job)?;
    let n_frames = scan.truth.poses().len();
    let overwrite = if args.force { Overwrite::Replace } else { Overwrite::Refuse };
    let mut folder = ScanFolder::begin(&args.output, &camera, n_frames, overwrite)?;
    let bar = shell.progress();
    bar.start("render", n_frames as u64);
    let mut n_readings = 0;
    for frame in scan.frames() {
        n_readings += frame.n_readings();
        folder.add(frame)?;
        bar.advance(1)?;
    }
    bar.stop_if_asked()?;
    folder.finish(&scan.truth)?;
    drop(bar);
    let report = Report {
        folder: &args.output,
        n_frames,
        n_triangles: scan.scene.mesh.triangles.len(),
        size_px: [camera.camera.width, camera.camera.height],
        mean_readings: n_readings / n_frames.max(1),
        noise: args.options.noise,
        seed: args.options.seed,
        notes: &notes,
    };
    shell.report(&report, &report.text(&camera))
}

impl SimulateScanArgs {
    fn subject(&self) -> anyhow::Result<(Subject, Vec<String>)> {
        if let Some(scene) = self.scene {
            return Ok((Subject::Scene(scene), Vec::new()));
        }
        let path = self.mesh.as_deref().unwrap_or(Path::new(""));
        let reading = io::read_surface(path, self.units)?;
        let notes = notes(&reading);
        let kind = reading.surface.kind();
        let mesh: Option<TriMesh> = reading.surface.into_mesh();
        let mesh = mesh.with_context(|| {
            format!("{} is a {kind}: a camera sees nothing of it; give triangles", path.display())
        })?;
        Ok((Subject::Mesh(mesh), notes))
    }
}

impl Report<'_> {
    fn text(&self, camera: &DepthCamera) -> String {
        let [width, height] = self.size_px;
        let seen = 100.0 * self.mean_readings as f64 / (width * height) as f64;
        let mut lines = vec![
            format!("{} frames of {width} x {height}, fx {}", self.n_frames, camera.camera.fx),
            format!("{seen:.1} % of the pixels have a depth"),
        ];
        lines.extend(self.notes.iter().map(|note| format!("note: {note}")));
        let written = ["groundtruth.txt", "contact.png  (look at it)"];
        let written = written.map(|name| self.folder.join(name).display().to_string());
        format!("{}\n{}", lines.join("\n"), listed("wrote", &written))
    }
}
