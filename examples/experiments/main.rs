//! Tables and figures of Morell (2014), measured again: the published reading beside ours.
//!
//! ```sh
//! HORMA_DATA=... cargo run --release --example experiments -- fig-4-13
//! ```

mod chart;
mod clouds;
mod contender;
mod fig_2_10;
mod fig_3_7;
mod fig_4_13;
mod fig_4_14;
mod fig_4_15;
mod fig_4_7;
mod gng_race;
mod lathe;
mod plain_gng;
mod scan;
mod sweep;
mod table_2_2;
mod table_4_1;
mod table_4_5;
mod walks;

use clap::{Parser, Subcommand};
use std::path::PathBuf;

/// Tables and figures of Morell (2014), measured again.
#[derive(Debug, Parser)]
struct Arguments {
    #[command(subcommand)]
    experiment: Experiment,
    /// Where the CSV and the chart go.
    #[arg(short, long, global = true, value_name = "DIR", default_value = "experiments")]
    output: PathBuf,
    /// A tenth of the points and of the steps: to see that it works.
    #[arg(long, global = true)]
    quick: bool,
}

#[derive(Debug, Clone, Copy, Subcommand)]
enum Experiment {
    /// Errors of five ways to follow a camera, on every recorded sequence.
    #[command(name = "fig-2-10")]
    Fig2_10,
    /// The same where texture or structure is missing, on simulated walks.
    #[command(name = "table-2-2")]
    Table2_2,
    /// Mean error of octree, voxel grid and growing neural gas over the number of representatives.
    #[command(name = "fig-3-7")]
    Fig3_7,
    /// Share of each stage of growing neural gas.
    #[command(name = "table-4-1")]
    Table4_1,
    /// Speed-up of growing neural gas over the plain loop; its chart is figure 4.8.
    #[command(name = "table-4-5", alias = "fig-4-8")]
    Table4_5,
    /// The two-minimum reduction alone.
    #[command(name = "fig-4-7")]
    Fig4_7,
    /// Time over the precision of the trajectory.
    #[command(name = "fig-4-13")]
    Fig4_13,
    /// Time over the precision of the surface.
    #[command(name = "fig-4-14")]
    Fig4_14,
    /// Speed-up of every adapter that is there.
    #[command(name = "fig-4-15")]
    Fig4_15,
}

fn main() -> anyhow::Result<()> {
    let arguments = Arguments::parse();
    println!("{}", machine());
    let share = if arguments.quick { 0.1 } else { 1.0 };
    match arguments.experiment {
        Experiment::Fig2_10 => fig_2_10::run(&arguments.output, share),
        Experiment::Table2_2 => table_2_2::run(&arguments.output, share),
        Experiment::Fig3_7 => fig_3_7::run(&arguments.output, share),
        Experiment::Table4_1 => table_4_1::run(&arguments.output, share),
        Experiment::Table4_5 => table_4_5::run(&arguments.output, share),
        Experiment::Fig4_7 => fig_4_7::run(&arguments.output, share),
        Experiment::Fig4_13 => fig_4_13::run(&arguments.output, share),
        Experiment::Fig4_14 => fig_4_14::run(&arguments.output, share),
        Experiment::Fig4_15 => fig_4_15::run(&arguments.output, share),
    }
}

/// What this is measured on.
fn machine() -> String {
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = info.lines().find(|line| line.starts_with("model name"));
    let model = model.and_then(|line| line.split(": ").nth(1)).unwrap_or("a processor");
    let n_threads = std::thread::available_parallelism().map_or(1, usize::from);
    let profile = if cfg!(debug_assertions) { ", NOT a release build" } else { "" };
    format!("machine: {model}, {n_threads} threads, horma {}{profile}", env!("CARGO_PKG_VERSION"))
}
