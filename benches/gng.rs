//! What a signal costs: growing neural gas as one writes it down, with a vectorised scan, and by cells, in one
//! process, in turns. `HORMA_DATA=... cargo bench --bench gng [-- quick]`
//!
//! The three learn from the same networks of 1,000 to 20,000 neurons. A whole run of lambda signals for each neuron
//! takes the integral over the sizes in between, by the trapezium rule; that by cells is also run as a whole.

#[path = "../examples/experiments/clouds.rs"]
mod clouds;
#[expect(dead_code, reason = "table 4.5 has more learners")]
#[path = "../examples/experiments/gng_race.rs"]
mod gng_race;
#[expect(dead_code, reason = "table 4.1 takes the stages apart")]
#[path = "../examples/experiments/plain_gng.rs"]
mod plain_gng;

use gng_race::{Learner, network};
use horma::geom::PointCloud;
use horma::progress::Silent;
use horma::represent::gng::{GngOptions, grow};
use std::time::Instant;

const SIZES: [usize; 5] = [500, 1000, 5000, 10_000, 20_000];
const LAMBDA: u32 = 1000;

fn main() {
    let is_quick = std::env::args().any(|argument| argument == "quick");
    for (name, cloud) in clouds::all() {
        println!("{name}: {} points, lambda {LAMBDA}, one thread", cloud.points.len());
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a pool");
        pool.install(|| race(&cloud, is_quick));
    }
}

fn race(cloud: &PointCloud, is_quick: bool) {
    let n_most = if is_quick { 5000 } else { 20_000 };
    let mut rows: Vec<(usize, [f64; 3])> = Vec::new();
    let mut graph = None;
    println!("| neurons | plain [ns] | scan [ns] | cells [ns] | plain / cells | scan / cells |");
    for n in SIZES.into_iter().filter(|n| *n <= n_most) {
        let grown = network(cloud, graph.as_ref(), n).expect("a network");
        let ns = |learner: Learner| learner.ns(cloud, &grown).expect("a time");
        let [plain, scan, cells] = [Learner::Plain, Learner::Scan, Learner::Cells].map(ns);
        println!(
            "| {n} | {plain:.0} | {scan:.0} | {cells:.0} | {:.1} | {:.1} |",
            plain / cells,
            scan / cells
        );
        rows.push((n, [plain, scan, cells]));
        graph = Some(grown);
    }
    let whole = [0, 1, 2].map(|i| integral(&rows, i) * f64::from(LAMBDA) * 1e-9);
    let begin = Instant::now();
    let options = GngOptions { lambda: LAMBDA, ..GngOptions::default() };
    let grown = grow(&mut &*cloud, None, Some(n_most), &options, &Silent).expect("a network");
    let seconds = begin.elapsed().as_secs_f64();
    println!(
        "{n_most} neurons, whole: plain {:.1} s, scan {:.1} s, cells {:.1} s by integration; cells {seconds:.2} s as run \
         ({:.0} ns a signal): plain / cells {:.1}, scan / cells {:.1}\n",
        whole[0],
        whole[1],
        whole[2],
        seconds * 1e9 / grown.n_signals as f64,
        whole[0] / seconds,
        whole[1] / seconds
    );
}

/// The integral of the time of a signal over the number of neurons [ns].
fn integral(rows: &[(usize, [f64; 3])], i: usize) -> f64 {
    let first = rows[0].0 as f64 * rows[0].1[i];
    let strip = |pair: &[(usize, [f64; 3])]| {
        (pair[1].0 - pair[0].0) as f64 * f64::midpoint(pair[0].1[i], pair[1].1[i])
    };
    first + rows.windows(2).map(strip).sum::<f64>()
}
