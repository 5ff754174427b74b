//! `horma mean-error`: how far a cloud is from what stands for it.

use super::Shell;
use super::reduce::notes;
use anyhow::Context;
use clap::Args;
use horma::geom::LengthUnit;
use horma::io;
use horma::represent::{MeanError, mean_error};
use std::path::PathBuf;

/// Tell how far the points of a cloud are from the nearest of those that stand for it.
///
/// The mean of these distances is eq. 3.5 of Morell (2014).
#[derive(Debug, Args)]
#[command(after_help = "For example: horma mean-error thin.ply scan.ply")]
pub(crate) struct MeanErrorArgs {
    /// The points that stand for the cloud, as `horma reduce` wrote them.
    reduced: PathBuf,
    /// The cloud.
    cloud: PathBuf,
    /// The unit of both files [default: what each declares, else by its extent].
    #[arg(long, value_name = "UNIT")]
    units: Option<LengthUnit>,
}

/// Reads both, measures and tells.
pub(crate) fn run(args: &MeanErrorArgs, shell: &Shell) -> anyhow::Result<()> {
    let reduced = io::read_surface(&args.reduced, args.units)?;
    let mut file = io::open_cloud(&args.cloud, args.units)?;
    let bar = shell.progress();
    let points = reduced.surface.into_points().points;
    let error = mean_error(&points, &mut file, &bar)
        .with_context(|| format!("while measuring {}", args.cloud.display()))?;
    drop(bar);
    let report = Report { n_representatives: points.len(), error, notes: notes(&file) };
    let mut lines = vec![error_text(&error)];
    lines.extend(report.notes.iter().map(|note| format!("{:<9}{note}", "note")));
    shell.report(&report, &lines.join("\n"))
}

/// What the JSON holds.
#[derive(serde::Serialize)]
struct Report {
    n_representatives: usize,
    error: MeanError,
    notes: Vec<String>,
}

/// The error in words.
pub(super) fn error_text(error: &MeanError) -> String {
    format!(
        "{:<9}{:.4} mm on average, rms {:.4}, median {:.4}, 90 % {:.4}, 95 % {:.4}, 99 % {:.4}, at most {:.4}",
        "error",
        error.mean,
        error.rms,
        error.median,
        error.percentile_90,
        error.percentile_95,
        error.percentile_99,
        error.max
    )
}
