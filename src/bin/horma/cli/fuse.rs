//! `horma fuse`: the frames of a depth camera made one surface.

use super::Shell;
use super::table::listed;
use super::turntable::TurntableArgs;
use anyhow::{Context, bail};
use clap::Args;
use horma::geom::{Surface, TriMesh};
use horma::io::rgbd::{
    Sequence, open_sequence, read_camera, read_trajectory, trajectory_text, turntable_text,
};
use horma::io::{OutputSet, Overwrite};
use horma::progress::Progress;
use horma::register::turntable::{Calibration, Turntable};
use horma::workflow::fuse::{FuseJob, FuseOptions, FuseReport, Fused, Placing, fuse};
use horma::workflow::turntable::turntable_report;
use std::path::{Path, PathBuf};

/// Fuse the frames of a depth camera into one surface.
///
/// Each frame is laid over what the frames before it made (Kinect Fusion), or placed where a trajectory
/// says.
#[derive(Debug, Args)]
#[command(
    after_help = "INPUT is a folder in the format of the TUM RGB-D benchmark (depth.txt, rgb.txt), or one with pictures
depth/NAME.png and, where there is colour, color/NAME.png; a camera.toml in it describes the camera.
Without poses the surface is in the frame of the first camera. A frame that cannot be placed is left
out and told; if more than half cannot, nothing is written.

For example:
  horma fuse scan --truth-poses --voxel 2 -o part.stl
  horma fuse desk --camera freiburg1 --voxel 10 -o desk.ply --trajectory desk.txt
  horma fuse scan --turntable calibrate --write-turntable table.toml --voxel 2 -o part.stl
  horma fuse next --turntable table.toml --voxel 2 -o next.stl
  horma fuse desk --poses poses.txt --keep-out 5 -o desk.ply --json"
)]
pub(crate) struct FuseArgs {
    /// The folder with the frames.
    pub(super) input: PathBuf,
    /// Where the surface goes, in millimetres: .stl, .ply, .obj or .glb; all but .stl keep colours.
    #[arg(long, short, value_name = "FILE")]
    pub(super) output: PathBuf,
    /// Write where the frames that made the surface were taken, in the TUM format.
    #[arg(long, value_name = "FILE")]
    pub(super) trajectory: Option<PathBuf>,
    /// Place frames by the folder's own trajectory (groundtruth.txt or poses.txt): turntables have it.
    #[arg(long, conflicts_with = "poses")]
    pub(super) truth_poses: bool,
    /// Place frames by this trajectory, in the TUM format.
    #[arg(long, value_name = "FILE")]
    pub(super) poses: Option<PathBuf>,
    #[command(flatten)]
    pub(super) turntable: TurntableArgs,
    /// The camera: kinect, freiburg1, or a camera.toml [default: that of the folder, else kinect].
    #[arg(long, value_name = "CAMERA")]
    pub(super) camera: Option<PathBuf>,
    /// Replace outputs that are there already.
    #[arg(long)]
    pub(super) force: bool,
    #[command(flatten)]
    pub(super) options: FuseOptions,
}

/// Reads frame by frame, fuses, writes and tells.
pub(crate) fn run(args: &FuseArgs, shell: &Shell) -> anyhow::Result<()> {
    args.try_outputs()?;
    let camera = args.camera.as_deref().map(read_camera).transpose()?;
    let sequence = open_sequence(&args.input, camera)?;
    let bar = shell.progress();
    let context = || format!("while fusing {}", args.input.display());
    let (placing, turntable) = args.placing(&sequence, &bar).with_context(context)?;
    let job = FuseJob {
        frames: sequence.frames(),
        stamps: stamps(&sequence),
        camera: sequence.camera.camera,
        placing,
        truth: sequence.truth.as_ref(),
        notes: sequence.notes.clone(),
        options: &args.options,
    };
    let mut done = fuse(job, &bar).with_context(context)?;
    done.report.turntable = turntable.as_ref().map(turntable_report);
    let files = args.outputs(&done, turntable.as_ref().map(|found| &found.turntable))?;
    bar.stop_if_asked()?;
    files.commit()?;
    drop(bar);
    let written: Vec<String> = args.paths().map(|path| path.display().to_string()).collect();
    let text = format!("{}\n{}", summary(&done.report), listed("wrote", &written));
    shell.report(&done.report, &text)
}

/// When the depth of each frame was taken.
fn stamps(sequence: &Sequence) -> Vec<f64> {
    sequence.files.iter().map(|files| files.depth_stamp).collect()
}

impl FuseArgs {
    /// How frames are placed, and the turntable, if there is one.
    fn placing(
        &self,
        sequence: &Sequence,
        progress: &dyn Progress,
    ) -> anyhow::Result<(Placing, Option<Calibration>)> {
        if self.turntable.is_asked() && (self.truth_poses || self.poses.is_some()) {
            bail!("--turntable says where frames were taken: leave --poses and --truth-poses out");
        }
        if self.turntable.is_asked() && self.options.pose_delay != 0.0 {
            bail!("--pose-delay is for the stamps of --poses and --truth-poses: leave it out");
        }
        if let Some(path) = &self.poses {
            return Ok((Placing::Along(read_trajectory(path)?), None));
        }
        let max_depth = self.options.volume.max_depth;
        if let Some(found) = self.turntable.find(sequence, max_depth, progress)? {
            let along = found.turntable.trajectory(&stamps(sequence))?;
            return Ok((Placing::Along(along), Some(found)));
        }
        if !self.truth_poses {
            return Ok((Placing::Tracked, None));
        }
        let truth = sequence.truth.clone().with_context(|| {
            format!(
                "{} has no groundtruth.txt or poses.txt; give a trajectory with --poses, or leave \
                 --truth-poses out",
                self.input.display()
            )
        })?;
        Ok((Placing::Along(truth), None))
    }

    fn paths(&self) -> impl Iterator<Item = &Path> {
        let others = self.trajectory.iter().chain(&self.turntable.write_turntable);
        std::iter::once(&self.output).chain(others).map(PathBuf::as_path)
    }

    /// Refuses outputs that cannot be written before the work begins.
    fn try_outputs(&self) -> anyhow::Result<()> {
        let mut trial = OutputSet::new(self.overwrite());
        trial.add_surface(&self.output, &Surface::Mesh(TriMesh::default()))?;
        for path in self.paths().skip(1) {
            trial.add(path, |_| Ok(()))?;
        }
        Ok(())
    }

    fn outputs(&self, done: &Fused, turntable: Option<&Turntable>) -> anyhow::Result<OutputSet> {
        let mut files = OutputSet::new(self.overwrite());
        files.add_surface(&self.output, &Surface::Mesh(done.mesh.clone()))?;
        if let Some(path) = &self.trajectory {
            let text = trajectory_text(&done.trajectory);
            files.add(path, |out| out.write_all(text.as_bytes()))?;
        }
        if let (Some(path), Some(turntable)) = (&self.turntable.write_turntable, turntable) {
            let text = turntable_text(turntable);
            files.add(path, |out| out.write_all(text.as_bytes()))?;
        }
        Ok(files)
    }

    fn overwrite(&self) -> Overwrite {
        if self.force { Overwrite::Replace } else { Overwrite::Refuse }
    }
}

/// Skipped frames that are told one by one.
const MOST_TOLD: usize = 5;

/// A fusion in words.
fn summary(report: &FuseReport) -> String {
    let line = |head: &str, text: String| format!("{head:<10}{text}");
    let placed = if report.tracked { "placed by tracking" } else { "placed as given" };
    let mut lines =
        vec![line("frames", format!("{} of {} fused, {placed}", report.n_fused, report.n_frames))];
    if let Some(table) = &report.turntable {
        let [x, y, z] = table.axis;
        let [u, v, w] = table.through;
        lines.push(line(
            "turntable",
            format!(
                "{:.3} deg a step about ({x:.4}, {y:.4}, {z:.4}) through {u:.1} {v:.1} {w:.1} mm",
                table.step_deg
            ),
        ));
        lines.extend(table.reasons.iter().map(|reason| line("doubtful", reason.clone())));
    }
    for skipped in report.skipped.iter().take(MOST_TOLD) {
        lines.push(line("skipped", format!("frame {}: {}", skipped.number, skipped.reason)));
    }
    if report.skipped.len() > MOST_TOLD {
        lines.push(line("", format!("and {} more", report.skipped.len() - MOST_TOLD)));
    }
    lines.push(line(
        "model",
        format!(
            "voxel {} mm, truncation {} mm, {} blocks, {:.0} MB",
            report.voxel, report.truncation, report.n_blocks, report.memory_mb
        ),
    ));
    let why = report.compute.why.as_ref().map_or(String::new(), |why| format!(" ({why})"));
    lines.push(line("", format!("computed on {}{why}", report.compute.on)));
    let mesh = &report.mesh;
    let [x, y, z] = mesh.size;
    lines.push(line(
        "surface",
        format!("{} triangles, {x:.1} x {y:.1} x {z:.1} mm", mesh.n_triangles),
    ));
    lines.push(match (mesh.is_closed, mesh.volume) {
        (true, Some(volume)) => line("", format!("closed, {:.1} cm3", volume / 1000.0)),
        (true, None) => line("", "closed".to_owned()),
        (false, _) => line("", format!("open: {} edges on its borders", mesh.n_open_edges)),
    });
    if mesh.n_pieces > 1 {
        lines.push(line("", format!("in {} pieces", mesh.n_pieces)));
    }
    if report.n_small_pieces > 0 {
        lines.push(line("", format!("{} smaller pieces dropped", report.n_small_pieces)));
    }
    if let Some(off) = &report.kept_out {
        lines.push(line(
            "kept out",
            format!(
                "{} frames: {:.2} mm off in the median, {:.2} mm rms within 50 mm, {:.0} % within a voxel",
                off.n_frames,
                off.median,
                off.rmse_within_50,
                100.0 * off.share_within_voxel
            ),
        ));
    }
    if let Some(truth) = &report.against_truth {
        let n = truth.n_poses - truth.n_unmatched;
        let ate = truth.ate_mm.rmse;
        lines.push(line("truth", format!("{ate:.2} mm off (ATE, root mean square of {n})")));
    }
    lines.extend(report.notes.iter().map(|note| line("note", note.clone())));
    lines.join("\n")
}
