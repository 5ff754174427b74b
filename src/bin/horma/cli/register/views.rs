//! Many scans laid over each other at once.

use super::super::Shell;
use super::super::table::{listed, table};
use super::{RegisterArgs, notes_of};
use crate::bar::Bar;
use anyhow::{Context, bail};
use horma::geom::{LengthUnit, PointCloud, Pose, Surface};
use horma::io::{self, OutputSet, pose_text};
use horma::register::icp::Verdict;
use horma::register::pose_graph::GraphOptions;
use horma::register::views::ViewsAligned;
use horma::workflow::views::{
    PairReport, PairResult, ViewReport, ViewsJob, ViewsReport, merged_views, register_views,
};
use std::collections::BTreeSet;
use std::path::PathBuf;

/// Reads all, lays them over each other, writes and tells; that no two lie together is an error.
pub(super) fn run(args: &RegisterArgs, shell: &Shell) -> anyhow::Result<()> {
    let paths: Vec<&PathBuf> = [&args.source, &args.target].into_iter().chain(&args.more).collect();
    let mut readings = Vec::with_capacity(paths.len());
    for path in &paths {
        readings.push(io::read_surface(path, args.units)?);
    }
    let named = paths.iter().zip(&readings);
    let mut notes: Vec<String> =
        named.flat_map(|(path, reading)| notes_of("scan", path, reading)).collect();
    let unit = readings.last().map_or(LengthUnit::Millimetre, |reading| reading.unit);
    if readings.iter().any(|reading| reading.unit != unit) {
        notes.push(format!("the files are in different units: the matrices are for all in {unit}"));
    }
    let clouds: Vec<PointCloud> =
        readings.into_iter().map(|reading| reading.surface.into_points()).collect();
    let names = names(&paths).into_iter();
    let bar = shell.progress();
    let job = ViewsJob {
        views: names.zip(&clouds).collect(),
        unit,
        notes,
        coarse: &args.coarse,
        fine: &args.options,
        graph: &GraphOptions::default(),
    };
    let what = || format!("while registering {} scans", clouds.len());
    let (aligned, report) = register_views(job, &bar).with_context(what)?;
    let is_good = report.verdict != Verdict::Failed;
    let written =
        if is_good { args.write_views(&aligned, &report, &clouds, &bar)? } else { Vec::new() };
    drop(bar);
    let mut text = summary(&report);
    if !written.is_empty() {
        text.push('\n');
        text.push_str(&listed("wrote", &written));
    }
    shell.report(&report, &text)?;
    if !is_good {
        let why = report.pairs.first().and_then(|pair| pair.reasons.first());
        let why = why.map_or("", String::as_str);
        bail!("no two of {} scans lie on each other: {why}; nothing was written", clouds.len());
    }
    Ok(())
}

/// What scans are called: their files, without folders where these differ.
fn names(paths: &[&PathBuf]) -> Vec<String> {
    let short = |path: &PathBuf| path.file_name().map(|name| name.to_string_lossy().into_owned());
    let all: Vec<String> = paths.iter().filter_map(|path| short(path)).collect();
    let distinct: BTreeSet<&String> = all.iter().collect();
    if distinct.len() == paths.len() {
        return all;
    }
    paths.iter().map(|path| path.display().to_string()).collect()
}

impl RegisterArgs {
    /// Writes what was asked for, all of it or nothing, and says what that was.
    fn write_views(
        &self,
        aligned: &ViewsAligned,
        report: &ViewsReport,
        clouds: &[PointCloud],
        bar: &Bar,
    ) -> anyhow::Result<Vec<String>> {
        let mut files = OutputSet::new(self.overwrite());
        if let Some(path) = &self.output {
            let placed = report.views.iter().zip(&aligned.stays_from_view);
            let matrix = |(view, pose): (&ViewReport, &Option<Pose>)| match pose {
                Some(pose) => {
                    pose_text(&format!("{}_from_{}", report.stays, view.name), pose, report.unit)
                }
                None => format!("# {} is left out\n", view.name),
            };
            let text: String = placed.map(matrix).collect();
            files.add(path, |out| out.write_all(text.as_bytes()))?;
        }
        if let Some(path) = &self.write_cloud {
            let clouds: Vec<&PointCloud> = clouds.iter().collect();
            let all = merged_views(&clouds, &aligned.stays_from_view);
            files.add_surface(path, &Surface::Points(all))?;
        }
        bar.stop_if_asked()?;
        files.commit()?;
        let paths = self.output.iter().chain(&self.write_cloud);
        Ok(paths.map(|path| path.display().to_string()).collect())
    }
}

fn summary(report: &ViewsReport) -> String {
    let placed = report.views.iter().filter(|view| view.stays_from_view.is_some()).count();
    let n = |result| report.pairs.iter().filter(|pair| pair.result == result).count();
    let mut lines = vec![
        format!("{:<9}{}", "verdict", report.verdict),
        format!(
            "{:<9}{placed} of {} lie together, in the frame of {}",
            "scans",
            report.views.len(),
            report.stays
        ),
    ];
    for view in report.views.iter().filter(|view| view.stays_from_view.is_none()) {
        lines.push(format!("{:<9}{} is left out: {}", "", view.name, view.reasons.join("; ")));
    }
    lines.push(format!(
        "{:<9}{} kept, {} more found by the others, {} dropped, {} refused",
        "pairs",
        n(PairResult::Kept),
        n(PairResult::Joined),
        n(PairResult::Dropped),
        n(PairResult::Refused)
    ));
    let head = ["", "scan", "on", "result", "fit"].map(str::to_owned);
    let row = |pair: &PairReport| {
        let result = format!("{:?}", pair.result).to_lowercase();
        let fit = format!("{:.0} %", 100.0 * pair.fit);
        ["       ".to_owned(), pair.source.clone(), pair.target.clone(), result, fit]
    };
    let rows: Vec<[String; 5]> =
        std::iter::once(head).chain(report.pairs.iter().map(row)).collect();
    lines.push(table(&rows).trim_end().to_owned());
    let residual = report.residual;
    lines.push(format!(
        "{:<9}rms {:.4} mm end to end, {:.4} mm settled, {:.4} mm after {} rounds",
        "fit", residual.chained, residual.settled, residual.refined, report.n_rounds
    ));
    lines.extend(report.notes.iter().map(|note| format!("{:<9}{note}", "note")));
    lines.join("\n")
}
