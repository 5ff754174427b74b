//! `horma scan`: from the frames of a depth camera to one cloud.

use super::table::listed;
use super::turntable::TurntableArgs;
use super::{Shell, scan_model};
use anyhow::{Context, bail};
use clap::Args;
use horma::geom::{PointCloud, Surface};
use horma::io::report::{html, scan_page};
use horma::io::rgbd::{open_sequence, read_camera, trajectory_text};
use horma::io::{OutputSet, Overwrite};
use horma::register::icp::Verdict;
use horma::register::odometry::Method;
use horma::workflow::scan::{LoopsReport, ScanJob, ScanOptions, ScanReport, Scanned, scan};
use std::path::{Path, PathBuf};

/// Follow a depth camera frame by frame, and make one cloud of what it saw.
///
/// Where the camera comes back to what it has seen, all its way is put right by that (--no-loops does
/// without). To lay scans over each other that are no frames, in no order, use horma register.
#[derive(Debug, Args)]
#[command(
    after_help = "The input is a folder as the TUM RGB-D benchmark has them (rgb.txt, depth.txt), or with pictures in
depth/ and color/. The cloud is in the frame of the first camera, in millimetres. Frames that cannot be
read or placed are skipped, and the report says why; if that are most, nothing is written and the exit
code is 65. With --method kinfu the frames become a mesh (`horma fuse` has more to set). Where the
folder has a groundtruth.txt, the report says how far the scan is off it, and was before loops were
closed.

For example:
  horma scan walk -o part.ply
  horma scan walk -o part.ply --trajectory went.txt --report scan.html
  horma scan walk --method kinfu --voxel 5 -o part.stl --report scan.html
  horma scan views --method kinfu --turntable calibrate --voxel 2 -o part.stl
  horma scan standing lying --method kinfu --turntable calibrate --voxel 2 -o part.stl
  horma scan rgbd_dataset_freiburg1_rpy --camera freiburg1 --method visual-icp --voxel 8 -o desk.ply"
)]
pub(crate) struct ScanArgs {
    /// The folder with the frames; with --turntable a folder for each turn of the part.
    #[arg(required = true, value_name = "INPUT")]
    pub(super) inputs: Vec<PathBuf>,
    /// Where the cloud goes: .ply, .obj, .glb, .xyz or .csv; with --method kinfu the mesh: .stl, .ply,
    /// .obj or .glb.
    #[arg(long, short, value_name = "FILE")]
    pub(super) output: PathBuf,
    /// Write where the camera went, in the format of the TUM benchmark.
    #[arg(long, value_name = "FILE")]
    pub(super) trajectory: Option<PathBuf>,
    /// Write a page with what was seen, the way of the camera and what was skipped.
    #[arg(long, value_name = "FILE")]
    pub(super) report: Option<PathBuf>,
    /// The camera: kinect, freiburg1, or a camera.toml [default: the folder's camera.toml].
    #[arg(long, value_name = "CAMERA")]
    pub(super) camera: Option<PathBuf>,
    /// Replace outputs that are there already.
    #[arg(long)]
    pub(super) force: bool,
    #[command(flatten)]
    pub(super) turntable: TurntableArgs,
    #[command(flatten)]
    pub(super) options: ScanOptions,
}

/// Opens the folder, places frame by frame, writes and tells; a failed scan is an error.
pub(crate) fn run(args: &ScanArgs, shell: &Shell) -> anyhow::Result<()> {
    if args.options.odometry.method == Method::Kinfu {
        return scan_model::run(args, shell);
    }
    if args.turntable.is_asked() {
        bail!("on a turntable frames are fused into a model: give --method kinfu too");
    }
    let [input] = &args.inputs[..] else {
        bail!(
            "{} folders are given; a camera is followed through one. Scans in no order are laid on each other by \
             horma register, turns of a part fused with --method kinfu --turntable",
            args.inputs.len()
        );
    };
    args.options.check()?;
    args.try_outputs()?;
    let camera = args.camera.as_deref().map(read_camera).transpose()?;
    let sequence = open_sequence(input, camera)?;
    let job = ScanJob {
        name: input.display().to_string(),
        camera: sequence.camera.camera,
        stamps: sequence.files.iter().map(|files| files.stamp).collect(),
        truth: sequence.truth.as_ref(),
        notes: sequence.notes.clone(),
        options: &args.options,
    };
    let bar = shell.progress();
    let scanned = scan(|| sequence.frames(), &job, &bar)
        .with_context(|| format!("while scanning {}", input.display()))?;
    let is_good = scanned.report.verdict != Verdict::Failed;
    let written = if is_good {
        let files = args.outputs(&scanned)?;
        bar.stop_if_asked()?;
        files.commit()?;
        args.paths().map(|path| path.display().to_string()).collect()
    } else {
        Vec::new()
    };
    drop(bar);
    let mut text = summary(&scanned.report);
    if is_good {
        text.push('\n');
        text.push_str(&listed("wrote", &written));
    }
    shell.report(&scanned.report, &text)?;
    if !is_good {
        let counts = scanned.report.counts;
        let of = scanned.report.frames.len();
        let reasons = scanned.report.reasons();
        let why = reasons.first().map_or("", |(reason, _)| reason);
        bail!(
            "{}: {} of {of} frames could not be placed, most often because {why}; nothing was written",
            input.display(),
            counts.skipped
        );
    }
    Ok(())
}

impl ScanArgs {
    fn paths(&self) -> impl Iterator<Item = &Path> {
        let others = self.trajectory.iter().chain(&self.report);
        std::iter::once(&self.output).chain(others).map(PathBuf::as_path)
    }

    /// Refuses outputs that cannot be written before the work begins.
    fn try_outputs(&self) -> anyhow::Result<()> {
        let mut trial = OutputSet::new(self.overwrite());
        trial.add_surface(&self.output, &Surface::Points(PointCloud::default()))?;
        for path in self.paths().skip(1) {
            trial.add(path, |_| Ok(()))?;
        }
        Ok(())
    }

    fn outputs(&self, scanned: &Scanned) -> anyhow::Result<OutputSet> {
        let mut files = OutputSet::new(self.overwrite());
        files.add_surface(&self.output, &Surface::Points(scanned.cloud.clone()))?;
        if let Some(path) = &self.trajectory {
            let text = trajectory_text(&scanned.trajectory);
            files.add(path, |out| out.write_all(text.as_bytes()))?;
        }
        if let Some(path) = &self.report {
            let page = html(&scan_page(scanned)?);
            files.add(path, |out| out.write_all(page.as_bytes()))?;
        }
        Ok(files)
    }

    fn overwrite(&self) -> Overwrite {
        if self.force { Overwrite::Replace } else { Overwrite::Refuse }
    }
}

fn summary(report: &ScanReport) -> String {
    let counts = report.counts;
    let mut lines = vec![
        format!("{:<9}{}", "verdict", report.verdict),
        format!(
            "{:<9}{} ok ({} key), {} doubtful, {} skipped, of {}",
            "frames",
            counts.ok,
            counts.key,
            counts.doubtful,
            counts.skipped,
            report.frames.len()
        ),
    ];
    let reasons = report.reasons();
    lines.extend(reasons.iter().map(|(reason, n)| format!("{:<9}{n} x like: {reason}", "")));
    lines.push(format!(
        "{:<9}went {:.0} mm and turned {:.0} deg; its motions leave {:.1} mm open",
        "camera", report.way, report.turned_deg, report.drift
    ));
    lines.extend(report.loops.as_ref().filter(|loops| !loops.tried.is_empty()).map(loops));
    lines.extend(report.doubts.iter().map(|doubt| format!("{:<9}{doubt}", "doubt")));
    lines.push(format!(
        "{:<9}{} points, one for each {:.2} mm; {} outliers left out",
        "cloud", report.n_points, report.voxel, report.n_outliers
    ));
    if let Some(truth) = &report.against_truth {
        lines.push(format!(
            "{:<9}{:.2} mm off the truth (ATE, root mean square of {})",
            "truth",
            truth.ate_mm.rmse,
            truth.n_poses - truth.n_unmatched
        ));
    }
    if let Some(before) = report.ate_before_loops_mm {
        lines.push(format!("{:<9}{before:.2} mm before loops were closed", ""));
    }
    lines.extend(report.notes.iter().map(|note| format!("{:<9}{note}", "note")));
    lines.join("\n")
}

fn loops(loops: &LoopsReport) -> String {
    let mut lines = vec![format!(
        "{:<9}{} closed, {} dropped, {} refused; they moved the camera by up to {:.1} mm",
        "loops", loops.n_closed, loops.n_dropped, loops.n_refused, loops.moved
    )];
    let why = loops.tried.iter().find_map(|tried| tried.reasons.first());
    lines.extend(why.map(|why| format!("{:<9}one of them because {why}", "")));
    lines.join("\n")
}
