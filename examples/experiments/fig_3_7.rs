//! Figure 3.7: mean error over the number of representatives, for octree, voxel grid and growing neural gas.
//! Morell (2014), section 3.2.2.2.

use crate::chart::{Chart, row};
use crate::clouds;
use horma::geom::PointCloud;
use horma::progress::Silent;
use horma::represent::gng::GngOptions;
use horma::represent::voxel::Rule;
use horma::represent::{Middle, PolishOptions};
use horma::workflow::reduce::{Method, ReduceJob, ReduceOptions, reduce};
use std::path::Path;

const COUNTS: [u64; 4] = [1000, 5000, 10_000, 20_000];

/// A way to reduce, as the figure names it.
struct Contender {
    name: &'static str,
    method: Method,
    rule: Option<Rule>,
    sweeps: u32,
}

const CONTENDERS: [Contender; 5] = [
    Contender { name: "octree, centre", method: Method::Octree, rule: None, sweeps: 0 },
    Contender { name: "voxel, centroid", method: Method::Voxel, rule: None, sweeps: 0 },
    Contender {
        name: "octree, centroid",
        method: Method::Octree,
        rule: Some(Rule::Centroid),
        sweeps: 0,
    },
    Contender { name: "GNG", method: Method::Gng, rule: None, sweeps: 0 },
    Contender { name: "GNG, polished", method: Method::Gng, rule: None, sweeps: 10 },
];

/// The error of each method for each number, on each cloud.
pub(crate) fn run(folder: &Path, share: f64) -> anyhow::Result<()> {
    for (name, cloud) in clouds::all() {
        println!("{name}: {} points; GNG with lambda 1000", cloud.points.len());
        let mut rows = Vec::new();
        for count in COUNTS.map(|count| (count as f64 * share) as u64) {
            let errors = CONTENDERS.iter().map(|contender| contender.error(&cloud, count));
            rows.push((count as f64, errors.collect::<anyhow::Result<Vec<f64>>>()?));
            eprintln!("{count}: done");
        }
        let names = CONTENDERS.iter().map(|contender| contender.name.to_owned()).collect();
        let chart = Chart::of_errors("representatives", names, rows.clone());
        println!("\n{}\n", chart.table());
        claims(&rows);
        chart.write(folder, &format!("fig-3-7-{name}"))?;
    }
    Ok(())
}

impl Contender {
    fn error(&self, cloud: &PointCloud, count: u64) -> anyhow::Result<f64> {
        let options = ReduceOptions {
            method: self.method,
            count: Some(count),
            rule: self.rule,
            ..ReduceOptions::default()
        };
        let job = ReduceJob {
            parts: &mut &*cloud,
            options: &options,
            gng: &GngOptions::default(),
            polish: &PolishOptions { sweeps: self.sweeps, middle: Middle::Median },
            begin: None,
        };
        Ok(reduce(job, &Silent)?.1.error.mean)
    }
}

/// The thesis' reading beside ours.
fn claims(rows: &[(f64, Vec<f64>)]) {
    let ratios = |a: usize, b: usize| {
        rows.iter().map(move |(_, errors)| format!("{:.3}", errors[a] / errors[b]))
    };
    println!("{}", row("ratio", rows.iter().map(|(count, _)| count.to_string())));
    println!("{}", row("---", rows.iter().map(|_| "---".to_owned())));
    println!("{}", row("octree centre / voxel (thesis: above 1)", ratios(0, 1)));
    println!("{}", row("octree centroid / voxel (same cells: 1)", ratios(2, 1)));
    println!("{}", row("GNG / voxel (thesis: below 1, towards 1 for many)", ratios(3, 1)));
    println!("{}", row("polished / GNG (not in the thesis)", ratios(4, 3)));
    println!();
}
