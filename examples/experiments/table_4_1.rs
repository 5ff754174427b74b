//! Table 4.1: the share of each stage of growing neural gas. Morell (2014), section 4.3.2.

use crate::chart::row;
use crate::clouds;
use crate::plain_gng::{PlainGng, Stages};
use horma::geom::Aabb;
use horma::progress::Silent;
use horma::represent::gng::{GngOptions, grow};
use std::path::Path;

/// The thesis' rows: neurons, lambda, share of the stages 2, 3, 4 to 7, 8, 9 of the instructions [%].
const PUBLISHED: [(usize, u32, [f64; 5]); 8] = [
    (1000, 500, [1.8, 73.3, 15.0, 1.2, 0.8]),
    (5000, 500, [0.7, 88.8, 5.8, 0.9, 1.0]),
    (10_000, 500, [0.4, 93.2, 3.3, 0.6, 0.8]),
    (20_000, 500, [0.3, 97.6, 1.9, 0.5, 0.9]),
    (1000, 1000, [1.8, 69.6, 21.3, 0.6, 0.3]),
    (5000, 1000, [0.7, 90.0, 5.6, 0.5, 0.5]),
    (10_000, 1000, [0.4, 94.3, 3.2, 0.3, 0.4]),
    (20_000, 1000, [0.3, 96.5, 1.9, 0.2, 0.4]),
];
/// Neurons inserted while the clock runs.
const INSERTED: usize = 5;

/// The share of the time of each stage of the plain loop, beside the thesis' share of instructions.
pub(crate) fn run(_folder: &Path, share: f64) -> anyhow::Result<()> {
    let clouds = clouds::all();
    let Some((_, cloud)) = clouds.first() else { return Ok(()) };
    let origin = Aabb::around(&cloud.points).center();
    println!(
        "plain loop on the bunny; share of the time [%], in brackets the thesis' of the instructions\n"
    );
    let heads = ["lambda", "2 signal", "3 winners", "4-7 adapt", "8 insert", "9 decay"];
    println!("{}", row("neurons", heads.iter().map(|head| (*head).to_owned())));
    println!("{}", row("---", heads.iter().map(|_| "---".to_owned())));
    for (n, lambda, published) in PUBLISHED {
        let n = ((n as f64 * share) as usize).max(10);
        let options = GngOptions { lambda, ..GngOptions::default() };
        let graph = grow(&mut &*cloud, None, Some(n), &options, &Silent)?.graph;
        let mut network = PlainGng::of_graph(&graph, &origin);
        let mut signals = clouds::signals(cloud, &origin);
        let mut seconds = [0.0; 5];
        for _ in 0..INSERTED {
            let stages: Stages = network.learn(signals.by_ref().take(lambda as usize));
            for (sum, stage) in seconds.iter_mut().zip(stages.all()) {
                *sum += stage.as_secs_f64();
            }
        }
        let all: f64 = seconds.iter().sum();
        let cells =
            seconds.iter().zip(published).map(|(s, p)| format!("{:.1} ({p})", 100.0 * s / all));
        println!("{}", row(&n.to_string(), std::iter::once(lambda.to_string()).chain(cells)));
    }
    println!();
    Ok(())
}
