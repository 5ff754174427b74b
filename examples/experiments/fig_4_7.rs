//! Figure 4.7: the two-minimum reduction alone, over the number of neurons. Morell (2014), section 4.3.3.2.

use crate::chart::Chart;
use horma::compute::{Compute, adapters};
use horma::represent::gng::two_minimum;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

const SIZES: [usize; 5] = [1000, 5000, 20_000, 50_000, 100_000];
/// Signals looked for at a time.
const SIGNALS: usize = 256;

type Place = [f32; 3];

/// One loop on one core, many neurons side by side, every device.
pub(crate) fn run(folder: &Path, share: f64) -> anyhow::Result<()> {
    let mut contenders = vec![("CPU, vectorised".to_owned(), Compute::Cpu)];
    let mut names: Vec<String> = adapters().into_iter().map(|adapter| adapter.name).collect();
    names.dedup();
    for name in names {
        contenders.push((name.clone(), Compute::gpu(Some(&name))?));
    }
    let mut rows = Vec::new();
    for n in SIZES.map(|n| ((n as f64 * share) as usize).max(10)) {
        let neurons = drawn(n, 1);
        let signals = drawn(SIGNALS, 2);
        let mut seconds = vec![best(|| {
            black_box(plain(&neurons, &signals));
            Ok(())
        })?];
        for (_, compute) in &contenders {
            seconds.push(best(|| {
                black_box(two_minimum(&neurons, &signals, compute)?);
                Ok(())
            })?);
        }
        rows.push((n as f64, seconds.iter().map(|s| seconds[0] / s).collect()));
        eprintln!("{n}: done");
    }
    let mut names = vec!["CPU, plain loop".to_owned()];
    names.extend(contenders.into_iter().map(|(name, _)| name));
    let chart = Chart::of_gains("neurons", names, rows);
    println!("{SIGNALS} signals at a time, sending them included; over the plain loop\n");
    println!("{}\n", chart.table());
    println!(
        "thesis: 43 times one core with 100,000 neurons on a GTX 480, 10 to 15 times on a Quadro 2000\n"
    );
    chart.write(folder, "fig-4-7")
}

fn drawn(n: usize, seed: u64) -> Vec<Place> {
    let mut draws = Pcg64Mcg::seed_from_u64(seed);
    (0..n).map(|_| [0, 1, 2].map(|_| draws.random_range(-100.0..100.0))).collect()
}

/// The loop as one writes it down.
fn plain(neurons: &[Place], signals: &[Place]) -> Vec<[usize; 2]> {
    let two = |signal: &Place| {
        let (mut first, mut second) = ((f32::INFINITY, 0), (f32::INFINITY, 0));
        for (i, neuron) in neurons.iter().enumerate() {
            let out = [neuron[0] - signal[0], neuron[1] - signal[1], neuron[2] - signal[2]];
            let square = out[0] * out[0] + out[1] * out[1] + out[2] * out[2];
            if square < first.0 {
                second = first;
                first = (square, i);
            } else if square < second.0 {
                second = (square, i);
            }
        }
        [first.1, second.1]
    };
    signals.iter().map(two).collect()
}

/// The shortest of three runs [s].
fn best(mut run: impl FnMut() -> anyhow::Result<()>) -> anyhow::Result<f64> {
    let mut best = f64::INFINITY;
    for _ in 0..3 {
        let begin = Instant::now();
        run()?;
        best = best.min(begin.elapsed().as_secs_f64());
    }
    Ok(best)
}
