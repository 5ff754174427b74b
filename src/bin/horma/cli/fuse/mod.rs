//! `horma fuse`: the frames of a depth camera made one surface.

mod summary;
mod turns;

use super::Shell;
use super::table::listed;
use super::turntable::TurntableArgs;
use anyhow::{Context, bail};
use clap::Args;
use horma::geom::{Surface, TriMesh};
use horma::io::report::{fusion_page, html};
use horma::io::rgbd::{
    Sequence, open_sequence, read_camera, read_trajectory, trajectory_text, turntable_text,
};
use horma::io::{OutputSet, Overwrite};
use horma::progress::Progress;
use horma::register::pose_delay::PoseDelay;
use horma::register::turntable::{Calibration, Turntable};
use horma::workflow::fuse::{FuseJob, FuseOptions, Fused, Placing, find_pose_delay, fuse};
use horma::workflow::turntable::turntable_report;
use std::path::{Path, PathBuf};
use summary::summary;

/// Fuse the frames of a depth camera into one surface.
///
/// Each frame is laid over what the frames before it made (Kinect Fusion), or placed where a trajectory
/// says.
#[derive(Debug, Args)]
#[command(
    after_help = "INPUT is a folder in the format of the TUM RGB-D benchmark (depth.txt, rgb.txt), or one with
pictures depth/NAME.png and, where there is colour, color/NAME.png; a camera.toml in it
describes the camera. Without poses the surface is in the frame of the first camera. A frame
that cannot be placed is left out and told; if more than half cannot, nothing is written.

A part on a turntable shows its underside only in another turn: turn it standing, lay it down,
turn it again, and give both folders, or one folder that holds both with --turns 2. Each turn is
calibrated by itself and laid on the others; one that cannot be is left out and told. What turns
along with the part counts as part: scan it on a foot that is thin, and cut that off.

For example:
  horma fuse scan --truth-poses --voxel 2 -o part.stl
  horma fuse desk --camera freiburg1 --voxel 10 -o desk.ply --report desk.html
  horma fuse scan --turntable calibrate --write-turntable table.toml --voxel 2 -o part.stl
  horma fuse next --turntable table.toml --voxel 2 -o next.stl
  horma fuse standing lying --turntable calibrate --voxel 2 -o part.stl --report part.html
  horma fuse desk --poses poses.txt --find-pose-delay --keep-out 5 -o desk.ply --json"
)]
pub(crate) struct FuseArgs {
    /// The folder with the frames; with --turntable a folder for each turn of the part.
    #[arg(required = true, value_name = "INPUT")]
    pub(super) inputs: Vec<PathBuf>,
    /// Where the surface goes, in millimetres: .stl, .ply, .obj or .glb; all but .stl keep colours.
    #[arg(long, short, value_name = "FILE")]
    pub(super) output: PathBuf,
    /// Write where the frames that made the surface were taken, in the TUM format.
    #[arg(long, value_name = "FILE")]
    pub(super) trajectory: Option<PathBuf>,
    /// Write a page with the surface, the way of the camera and what was left out.
    #[arg(long, value_name = "FILE")]
    pub(super) report: Option<PathBuf>,
    /// Place frames by the folder's own trajectory (groundtruth.txt or poses.txt): turntables have it.
    #[arg(long, conflicts_with = "poses")]
    pub(super) truth_poses: bool,
    /// Place frames by this trajectory, in the TUM format.
    #[arg(long, value_name = "FILE")]
    pub(super) poses: Option<PathBuf>,
    /// Find how late stamps are, by laying frames on each other by the given poses for one delay after the
    /// other: where the clock of the poses is another one.
    #[arg(long, conflicts_with = "pose_delay")]
    pub(super) find_pose_delay: bool,
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
    let mut turns = Vec::new();
    for input in &args.inputs {
        let sequence = open_sequence(input, camera)?;
        let name = input.display().to_string();
        let within = args.turntable.turns_of(&sequence).with_context(|| name.clone())?;
        let named = |(turn, number): (Sequence, usize)| match args.turntable.turns {
            1 => (name.clone(), turn),
            _ => (format!("{name}, turn {number}"), turn),
        };
        turns.extend(within.into_iter().zip(1..).map(named));
    }
    let bar = shell.progress();
    let (done, turntable) = match &turns[..] {
        [(_, only)] => args.fused(only, &bar),
        several => turns::fused(args, several, &bar).map(|done| (done, None)),
    }
    .with_context(|| format!("while fusing {}", args.name()))?;
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
    /// The surface of one sequence, and the turntable, if there is one.
    fn fused(
        &self,
        sequence: &Sequence,
        progress: &dyn Progress,
    ) -> anyhow::Result<(Fused, Option<Calibration>)> {
        let (placing, turntable) = self.placing(sequence, progress)?;
        let delay = self.pose_delay(sequence, &placing, progress)?;
        let mut options = self.options.clone();
        if let Some(found) = &delay {
            options.pose_delay = found.seconds;
        }
        let job = FuseJob {
            frames: sequence.frames(),
            stamps: stamps(sequence),
            camera: sequence.camera.camera,
            placing,
            truth: sequence.truth.as_ref(),
            notes: sequence.notes.clone(),
            options: &options,
        };
        let mut done = fuse(job, progress)?;
        done.report.pose_delay = delay;
        done.report.turntable = turntable.as_ref().map(turntable_report);
        Ok((done, turntable))
    }

    /// How late stamps are, if that is to be looked for.
    fn pose_delay(
        &self,
        sequence: &Sequence,
        placing: &Placing,
        progress: &dyn Progress,
    ) -> anyhow::Result<Option<PoseDelay>> {
        let along = match placing {
            _ if !self.find_pose_delay => return Ok(None),
            Placing::Along(along) => along,
            Placing::Tracked => bail!(
                "--find-pose-delay is for the stamps of --poses and --truth-poses: give one, or leave it out"
            ),
        };
        let read = |i: usize| sequence.frame(i);
        let seen = (&stamps(sequence)[..], &sequence.camera.camera);
        Ok(Some(find_pose_delay(read, seen, along, &self.options, progress)?))
    }

    /// What is fused, in words.
    fn name(&self) -> String {
        let names: Vec<String> =
            self.inputs.iter().map(|input| input.display().to_string()).collect();
        names.join(" and ")
    }

    /// How frames are placed, and the turntable, if there is one.
    fn placing(
        &self,
        sequence: &Sequence,
        progress: &dyn Progress,
    ) -> anyhow::Result<(Placing, Option<Calibration>)> {
        self.refuse_two_places()?;
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
                self.name()
            )
        })?;
        Ok((Placing::Along(truth), None))
    }

    /// A turntable says where frames were taken, and so do poses.
    fn refuse_two_places(&self) -> anyhow::Result<()> {
        if self.turntable.is_asked() && (self.truth_poses || self.poses.is_some()) {
            bail!("--turntable says where frames were taken: leave --poses and --truth-poses out");
        }
        if self.turntable.is_asked() && (self.options.pose_delay != 0.0 || self.find_pose_delay) {
            bail!(
                "--pose-delay and --find-pose-delay are for the stamps of --poses and --truth-poses: leave \
                 them out"
            );
        }
        Ok(())
    }

    fn paths(&self) -> impl Iterator<Item = &Path> {
        let others = self.trajectory.iter().chain(&self.turntable.write_turntable);
        let others = others.chain(&self.report);
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
        if let Some(path) = &self.report {
            let page = html(&fusion_page(&self.name(), done)?);
            files.add(path, |out| out.write_all(page.as_bytes()))?;
        }
        Ok(files)
    }

    fn overwrite(&self) -> Overwrite {
        if self.force { Overwrite::Replace } else { Overwrite::Refuse }
    }
}
