//! Every contender over a range of precisions: what figures 4.13 and 4.14 have in common.

use crate::chart::Chart;
use crate::contender::{Contender, Task};
use horma::compute::Gpu;
use std::path::Path;

/// A figure of the thesis over some precision.
pub(crate) struct Sweep<'a> {
    /// Its name, for files.
    pub(crate) figure: &'a str,
    /// What it is over, with the unit.
    pub(crate) over: &'a str,
    /// Where along it is measured.
    pub(crate) precisions: [f64; 5],
}

impl Sweep<'_> {
    /// Times all contenders at the task of each precision; prints the table and the claims, and
    /// writes the CSV and the chart.
    pub(crate) fn run(&self, folder: &Path, task: impl Fn(f64) -> Task) -> anyhow::Result<()> {
        let gpu = Gpu::open(None).inspect_err(|error| eprintln!("without a device: {error}")).ok();
        println!("device: {}", gpu.as_ref().map_or("none", |gpu| gpu.name()));
        let contenders = Contender::all(gpu.as_ref());
        let mut rows = Vec::new();
        let mut off: f64 = 0.0;
        for precision in self.precisions {
            let task = task(precision);
            rows.push((precision, task.race(&contenders)?));
            off = off.max(task.off());
            eprintln!("{precision}: done");
        }
        let names = contenders.iter().map(|contender| contender.name().to_owned()).collect();
        let chart = Chart::of_times(self.over, names, rows);
        println!("\n{}\n", chart.table());
        claims(&chart, off);
        chart.write(folder, self.figure)
    }
}

/// The thesis' claims beside ours.
fn claims(times: &Chart, off: f64) {
    println!("| claim | thesis, GTX 480 against one core | here |");
    println!("| --- | --- | --- |");
    for (name, than, published) in [
        ("GPU SP", "CPU SP", "70 to 75x"),
        ("GPU DP", "CPU DP", "35x"),
        ("CPU SP", "CPU DP", "about the same"),
        ("CPU wide", "CPU SP", "none there"),
        ("CPU tree", "CPU SP", "none there"),
        ("GPU tree", "GPU SP", "none there"),
    ] {
        let gain = times.gain(name, than).unwrap_or_else(|| "no device".into());
        println!("| {name} over {than} | {published} | {gain} |");
    }
    println!("| CPU SP against CPU DP | less than 0.01 mm off | {off:.1e} mm |");
    println!("| GPU SP against CPU DP | | the same bits: kernels bound, the processor decides |\n");
}
