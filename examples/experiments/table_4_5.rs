//! Table 4.5 and figure 4.8: speed-up of growing neural gas over the plain loop on one core. Morell (2014),
//! section 4.3.3.3.

use crate::chart::{Chart, row};
use crate::clouds;
use crate::gng_race::{Learner, network};
use horma::compute::adapters;
use std::path::Path;

const SIZES: [usize; 4] = [1000, 5000, 10_000, 20_000];
/// The GTX 480 of the thesis, and what it hoped for.
const PUBLISHED: [(&str, [f64; 4]); 2] = [
    ("GTX 480 (thesis)", [0.68, 2.36, 4.23, 6.11]),
    ("its bound (thesis)", [0.76, 2.44, 4.47, 7.98]),
];

/// Every way to learn a signal, at the sizes of the table; the chart is figure 4.8.
pub(crate) fn run(folder: &Path, share: f64) -> anyhow::Result<()> {
    let clouds = clouds::all();
    let Some((name, cloud)) = clouds.first() else { return Ok(()) };
    let mut learners = vec![Learner::Plain, Learner::Scan, Learner::Batch, Learner::Cells];
    let mut devices: Vec<String> = adapters().into_iter().map(|adapter| adapter.name).collect();
    devices.dedup();
    learners.extend(devices.into_iter().map(Learner::Device));
    println!("{name}: {} points; time of a signal [ns]\n", cloud.points.len());
    let names: Vec<String> = learners.iter().map(Learner::name).collect();
    println!("{}", row("neurons", names.iter().cloned()));
    println!("{}", row("---", names.iter().map(|_| "---".to_owned())));
    let mut rows: Vec<(f64, Vec<f64>)> = Vec::new();
    let mut graph = None;
    for n in SIZES.map(|n| ((n as f64 * share) as usize).max(10)) {
        let grown = network(cloud, graph.as_ref(), n)?;
        let ns = learners.iter().map(|learner| learner.ns(cloud, &grown));
        let ns = ns.collect::<anyhow::Result<Vec<f64>>>()?;
        println!("{}", row(&n.to_string(), ns.iter().map(|ns| format!("{ns:.0}"))));
        rows.push((n as f64, ns.iter().map(|other| ns[0] / other).collect()));
        graph = Some(grown);
    }
    println!("\nspeed-up over the plain loop\n");
    println!("{}", row("neurons", rows.iter().map(|(n, _)| n.to_string())));
    println!("{}", row("---", rows.iter().map(|_| "---".to_owned())));
    for (name, gains) in PUBLISHED {
        println!("{}", row(name, gains.iter().map(f64::to_string)));
    }
    println!(
        "{}",
        row(
            "multi-core CPU (thesis, figure 4.8)",
            ["", "", "", "2.2"].map(str::to_owned).into_iter()
        )
    );
    for (i, name) in names.iter().enumerate() {
        println!("{}", row(name, rows.iter().map(|(_, gains)| format!("{:.2}", gains[i]))));
    }
    println!();
    Chart::of_gains("neurons", names, rows).write(folder, "fig-4-8")
}
