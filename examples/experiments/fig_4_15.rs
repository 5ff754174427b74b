//! Figure 4.15: speed-up of different devices in single precision. Morell (2014), experiment III.

use crate::chart::{Chart, row};
use crate::contender::{Contender, Task};
use crate::fig_4_14::{PRECISIONS, TRAJECTORY};
use crate::lathe::Lathe;
use horma::compute::{Gpu, Precision, adapters};
use std::path::Path;

/// Speed-up over the thesis' loop on one thread of this processor: a row for each adapter, and one
/// for the search that none of them needs.
pub(crate) fn run(folder: &Path, share: f64) -> anyhow::Result<()> {
    let lathe = Lathe::new()?;
    let spiral = lathe.spiral(TRAJECTORY * share);
    println!("{lathe}: {} steps, {TRAJECTORY} a mm", spiral.n);
    let gpus = opened();
    let single = |gpu| Contender::Scan(gpu, Precision::Single);
    let mut contenders = vec![Contender::CpuSingle];
    contenders.extend(gpus.iter().map(single));
    contenders.push(Contender::CpuTree);
    let mut rows = Vec::new();
    for precision in PRECISIONS {
        let task = Task::new(&lathe.points(precision * share), spiral);
        let seconds = task.race(&contenders)?;
        rows.push((precision, seconds[1..].iter().map(|s| seconds[0] / s).collect::<Vec<_>>()));
        eprintln!("{precision}: done");
    }
    let mut names: Vec<_> = gpus.iter().map(|gpu| gpu.name().to_owned()).collect();
    names.push("CPU tree".into());

    println!("\nspeed-up over CPU SP on one thread, by surface precision [points/mm2]\n");
    println!("{}", row("device", PRECISIONS.iter().map(f64::to_string)));
    println!("{}", row("---", PRECISIONS.iter().map(|_| "---".into())));
    let published = ["70 to 75", "", "", "", ""];
    println!("{}", row("GTX 480 (thesis, figure 4.13)", published.iter().map(|&cell| cell.into())));
    for (i, name) in names.iter().enumerate() {
        println!("{}", row(name, rows.iter().map(|(_, gains)| format!("{:.2}", gains[i]))));
    }
    println!();
    Chart::of_gains("surface precision [points/mm2]", names, rows).write(folder, "fig-4-15")
}

/// Every adapter that opens, once by each name.
fn opened() -> Vec<Gpu> {
    let mut names: Vec<String> = adapters().into_iter().map(|adapter| adapter.name).collect();
    names.dedup();
    let open = |name: &String| {
        let opened = Gpu::open(Some(name));
        opened.inspect_err(|error| eprintln!("left out: {error}")).ok()
    };
    names.iter().filter_map(open).collect()
}
