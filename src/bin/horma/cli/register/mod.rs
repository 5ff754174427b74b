//! `horma register`: one scan laid over another, or many over each other.

mod views;

use super::Shell;
use super::table::listed;
use crate::bar::Bar;
use anyhow::{Context, bail};
use clap::Args;
use horma::geom::{LengthUnit, PointCloud, Surface};
use horma::io::rgbd::read_scan;
use horma::io::{OutputSet, Overwrite, Reading, pose_text, read_pose};
use horma::register::coarse::{Coarse, CoarseOptions};
use horma::register::icp::{IcpOptions, Verdict};
use horma::rgbd::Exposure;
use horma::workflow::register::{RegisterJob, RegisterReport, Registered, merged, register};
use std::path::{Path, PathBuf};

/// Find the motion that lays one scan over another, and say whether it may be believed.
///
/// With --init it refines the pose given there. Else it looks for one by itself: from where the files
/// have it, by surroundings that look alike, by planes laid on planes, and by the principal axes; what
/// lies best on each other wins. --coarse chooses one way.
///
/// Where both are views of depth cameras that keep their rows and columns (PCD, PLY with a range grid), in
/// the camera's own frame, the verdict also heeds what either camera has looked through.
///
/// More than two scans, in any order, are laid over each other all at once: every two are tried, those
/// that fit the others are kept, and what they are off is shared by all. The last one stays where it is.
#[derive(Debug, Args)]
#[command(
    after_help = "The verdict is ok, doubtful or failed, with the reasons. A failed pose is not written, and the exit
code is 65. What a file is in, metres or millimetres, is told by itself, by its extent or by --units.

For example:
  horma register back.ply front.ply -o front_from_back.txt
  horma register scan.pcd model.stl --init rough.txt --voxel 0.5 --max-distance 10 --write-cloud both.ply
  horma register scan.ply last.stl --coarse axes -o last_from_scan.txt
  horma register table2.pcd table1.pcd --coarse planes -o table1_from_table2.txt
  horma register a.ply b.ply --fine point-to-plane --kernel tukey --bi-unique --json
  horma register views/*.ply -o poses.txt --write-cloud part.ply"
)]
pub(crate) struct RegisterArgs {
    /// The scan that is moved: PLY, PCD, OBJ, STL, glTF/GLB or a list of points.
    source: PathBuf,
    /// The scan that stays.
    target: PathBuf,
    /// More scans: then the last of all stays, and all others are laid over each other and over it.
    more: Vec<PathBuf>,
    /// Where the motion goes: four rows of four numbers that take a point of the source to the target,
    /// in the unit of the target's file. Of more than two scans one such matrix each, in their order,
    /// with its name in a comment.
    #[arg(long, short, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Where the source starts: a motion as --output writes it [default: it is looked for].
    #[arg(long, value_name = "FILE", conflicts_with = "more")]
    init: Option<PathBuf>,
    /// Write all as one cloud, in millimetres; .ply, .obj, .glb, .xyz or .csv.
    #[arg(long, value_name = "FILE")]
    write_cloud: Option<PathBuf>,
    /// The unit of both files [default: what each declares, else by its extent].
    #[arg(long, value_name = "UNIT")]
    units: Option<LengthUnit>,
    /// Replace outputs that are there already.
    #[arg(long)]
    force: bool,
    #[command(flatten)]
    coarse: CoarseOptions,
    #[command(flatten)]
    options: IcpOptions,
}

/// Reads both, registers, writes and tells; a failed pose is an error.
pub(crate) fn run(args: &RegisterArgs, shell: &Shell) -> anyhow::Result<()> {
    args.options.check()?;
    args.coarse.check()?;
    args.try_outputs()?;
    if !args.more.is_empty() {
        return views::run(args, shell);
    }
    let (source, source_view) = read_scan(&args.source, args.units)?;
    let (target, target_view) = read_scan(&args.target, args.units)?;
    let unit = target.unit;
    let notes = notes(args, &source, &target);
    let exposures = [source_view, target_view].map(|view| Exposure::of(&view?));
    let seen = match &exposures {
        [Some(source), Some(target)] => Some([source, target]),
        _ => None,
    };
    let start = match &args.init {
        Some(path) => Some(read_pose(path, unit)?),
        None => None,
    };
    let (source, target) = (source.surface.into_points(), target.surface.into_points());
    let bar = shell.progress();
    let job = RegisterJob {
        source: &source,
        target: &target,
        seen,
        target_from_source: start,
        unit,
        notes,
        coarse: &args.coarse,
        options: &args.options,
    };
    let is_searched = args.coarse.method(args.init.is_some()) != Coarse::None;
    let (from, to) = (args.source.display(), args.target.display());
    let done = register(job, &bar).with_context(|| format!("while registering {from} on {to}"))?;
    let is_good = done.report.verdict != Verdict::Failed;
    let written = if is_good { args.write(&done, [&source, &target], &bar)? } else { Vec::new() };
    drop(bar);
    let mut text = vec![summary(&done.report, is_searched)];
    if !written.is_empty() {
        text.push(listed("wrote", &written));
    }
    let text = text.join("\n");
    shell.report(&done.report, &text)?;
    if !is_good {
        bail!("{from} on {to}: {}; nothing was written", done.report.reasons.join("; "));
    }
    Ok(())
}

impl RegisterArgs {
    /// Refuses outputs that cannot be written before the work begins.
    fn try_outputs(&self) -> anyhow::Result<()> {
        let mut trial = OutputSet::new(self.overwrite());
        if let Some(path) = &self.output {
            trial.add(path, |_| Ok(()))?;
        }
        if let Some(path) = &self.write_cloud {
            trial.add_surface(path, &Surface::Points(PointCloud::default()))?;
        }
        Ok(())
    }

    /// Writes what was asked for, all of it or nothing, and says what that was.
    fn write(
        &self,
        done: &Registered,
        [source, target]: [&PointCloud; 2],
        bar: &Bar,
    ) -> anyhow::Result<Vec<String>> {
        let pose = &done.alignment.target_from_source;
        let mut files = OutputSet::new(self.overwrite());
        if let Some(path) = &self.output {
            let text = pose_text("target_from_source", pose, done.report.unit);
            files.add(path, |out| out.write_all(text.as_bytes()))?;
        }
        if let Some(path) = &self.write_cloud {
            files.add_surface(path, &Surface::Points(merged(source, target, pose)))?;
        }
        bar.stop_if_asked()?;
        files.commit()?;
        let paths = self.output.iter().chain(&self.write_cloud);
        Ok(paths.map(|path| path.display().to_string()).collect())
    }

    fn overwrite(&self) -> Overwrite {
        if self.force { Overwrite::Replace } else { Overwrite::Refuse }
    }
}

fn notes(args: &RegisterArgs, source: &Reading, target: &Reading) -> Vec<String> {
    let mut notes = Vec::new();
    for (role, path, reading) in
        [("source", &args.source, source), ("target", &args.target, target)]
    {
        notes.extend(notes_of(role, path, reading));
    }
    if source.unit != target.unit {
        notes.push(format!(
            "the files are in different units: the matrix is for both in {}",
            target.unit
        ));
    }
    notes
}

/// What the user must know about a file.
fn notes_of(role: &str, path: &Path, reading: &Reading) -> Vec<String> {
    let (format, unit, from) = (&reading.format, reading.unit, &reading.unit_from);
    let mut notes = vec![format!("{role} {}: {format}, units {unit}, {from}", path.display())];
    notes.extend(reading.notes.iter().map(|note| format!("{role}: {note}")));
    notes
}

/// Where it began, and what speaks for that.
fn start(report: &RegisterReport) -> String {
    let alike = report.support.map_or_else(String::new, |support| {
        let (n, all, chance) = (support.n_agreeing, support.n_matches, support.by_chance);
        format!("; {n} of {all} places that look alike agree ({chance:.0} by chance)")
    });
    let flat = report.planes.map_or_else(String::new, |planes| {
        let ([source, target], n) = (planes.n_planes, planes.n_agreeing);
        format!("; {n} of {source} and {target} planes agree ({:.1} by chance)", planes.by_chance)
    });
    format!("{:<9}{}, of {} tried{alike}{flat}", "start", report.started_from, report.n_starts)
}

fn summary(report: &RegisterReport, is_searched: bool) -> String {
    let settled = &report.settled;
    let mut lines = vec![format!("{:<9}{}", "verdict", report.verdict)];
    lines.extend(report.reasons.iter().map(|reason| format!("{:<9}{reason}", "")));
    lines.push(format!(
        "{:<9}turned {:.3} deg; the fine stage moved it {:.3} mm in {} steps",
        "motion", report.turned_deg, report.moved, report.n_iterations
    ));
    if is_searched {
        lines.push(start(report));
    }
    let cell = |x: &f64| format!("{x:>14.8}");
    for (row, i) in report.target_from_source.iter().zip(0..) {
        let head = if i == 0 { "matrix" } else { "" };
        let cells: Vec<String> = row.iter().map(cell).collect();
        lines.push(format!("{head:<9}{}", cells.join("")));
    }
    lines.push(format!("{:<9}target_from_source, row by row, in {}", "", report.unit));
    let [source, target] = report.overlap.map(|share| 100.0 * share);
    lines.push(format!(
        "{:<9}{source:.0} % of the source, {target:.0} % of the target, within {:.3} mm",
        "overlap", settled.final_distance
    ));
    lines.extend(report.free_space.as_ref().map(|space| {
        let percent = 100.0 * space.share();
        format!(
            "{:<9}{percent:.1} % of what one camera sees hangs where the other looked through",
            "seen"
        )
    }));
    lines.push(format!(
        "{:<9}rms {:.4} mm in the metric, {:.4} mm from point to point; {} inliers",
        "fit", report.rms, report.point_rms, report.n_inliers
    ));
    lines.push(format!(
        "{:<9}planes {:.4} mm apart in the median, roughness {:.4} mm",
        "", report.plane_distance, report.roughness
    ));
    lines.push(format!(
        "{:<9}{:?}, voxel {:.4} mm ({} and {} points), pairs from {:.3} down to {:.3} mm",
        "method",
        settled.metric,
        settled.voxel,
        report.n_points[0],
        report.n_points[1],
        settled.max_distance,
        settled.final_distance
    ));
    lines.extend(report.notes.iter().map(|note| format!("{:<9}{note}", "note")));
    lines.join("\n")
}
