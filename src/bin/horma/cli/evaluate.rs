//! `horma evaluate`: how far an estimated trajectory is off the true one.

use super::Shell;
use super::table::table;
use anyhow::Context;
use clap::Args;
use horma::io::report::odometry_plot;
use horma::io::rgbd::read_trajectory;
use horma::io::{Overwrite, write_file};
use horma::register::{Delta, OdometryErrorOptions, Statistics};
use horma::workflow::evaluate::{EvaluationReport, evaluate};
use std::path::PathBuf;

/// Compare an estimated camera trajectory with the true one: relative and absolute errors.
#[derive(Debug, Args)]
#[command(
    after_help = "Both files are in the format of the TUM RGB-D benchmark: stamp tx ty tz qx qy qz qw, in metres.
RPE is the relative pose error over a step, ATE the absolute trajectory error after the best rigid
alignment, both as the benchmark's tools define them.

For example:
  horma evaluate estimate.txt groundtruth.txt
  horma evaluate estimate.txt groundtruth.txt --delta 1 --delta 30 --plot errors.svg
  horma evaluate estimate.txt groundtruth.txt --truth-at interpolated --json"
)]
pub(crate) struct EvaluateArgs {
    /// The estimated trajectory.
    estimate: PathBuf,
    /// The true one.
    truth: PathBuf,
    /// Draw both from above, and the errors over time, as SVG.
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
    /// Replace the plot if it is there already.
    #[arg(long)]
    force: bool,
    #[command(flatten)]
    options: OdometryErrorOptions,
}

/// Compares, draws and tells.
pub(crate) fn run(args: &EvaluateArgs, shell: &Shell) -> anyhow::Result<()> {
    let estimate = read_trajectory(&args.estimate)?;
    let truth = read_trajectory(&args.truth)?;
    let found = evaluate(&estimate, &truth, &args.options).with_context(|| {
        format!("comparing {} with {}", args.estimate.display(), args.truth.display())
    })?;
    if let Some(path) = &args.plot {
        let overwrite = if args.force { Overwrite::Replace } else { Overwrite::Refuse };
        write_file(path, overwrite, |out| out.write_all(odometry_plot(&found.error).as_bytes()))?;
    }
    shell.report(&found.report, &text(&found.report))
}

fn text(report: &EvaluationReport) -> String {
    let matched = report.n_poses - report.n_unmatched;
    let mut rows = vec![["", "rmse", "mean", "median", "std", "min", "max"].map(str::to_owned)];
    rows.push(row("ATE [mm]", &report.ate_mm));
    for relative in &report.rpe {
        let step = match relative.delta {
            Delta::Poses(1) => "1 pose".to_owned(),
            Delta::Poses(n) => format!("{n} poses"),
            Delta::Seconds(seconds) => format!("{seconds} s"),
        };
        rows.push(row(&format!("RPE over {step} [mm]"), &relative.translation_mm));
        rows.push(row(&format!("RPE over {step} [deg]"), &relative.rotation_deg));
    }
    format!("{matched} of {} poses have a true one\n{}", report.n_poses, table(&rows))
}

fn row(name: &str, s: &Statistics) -> [String; 7] {
    let number = |value: f64| format!("{value:.3}");
    let [a, b, c, d, e, f] = [s.rmse, s.mean, s.median, s.std, s.min, s.max].map(number);
    [name.to_owned(), a, b, c, d, e, f]
}
