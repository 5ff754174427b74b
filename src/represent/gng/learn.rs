//! The loop: signals, and a new neuron after every lambda of them.

use super::error::GngError;
use super::network::{Network, Place};
use super::options::{GngOptions, Rates};
use super::signals::Signals;
use super::winners::{Winners, Won};
use crate::progress::Progress;
use rayon::prelude::*;
use std::time::Instant;

/// Signals drawn at a time.
const DRAWN: usize = 256;
/// Signals that a mean error is taken over, at least.
const WINDOW: u64 = 10_000;

/// Why a network no longer grows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Stopped {
    /// It has the neurons asked for.
    Count,
    /// It has learned the signals asked for.
    Signals,
    /// The time is over.
    Time,
    /// Its signals are near enough.
    MeanError,
    /// All points of the cloud lie in one place.
    OnePlace,
}

/// How learning went.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Learned {
    pub(super) n_signals: u64,
    pub(super) stopped: Stopped,
}

/// Lets `network` learn and grow, to `n_neurons` or until something else stops it.
pub(super) fn learn<W: Winners + Sync>(
    network: &mut Network,
    mut winners: W,
    signals: &mut Signals<'_>,
    n_neurons: usize,
    options: &GngOptions,
    progress: &dyn Progress,
) -> Result<Learned, GngError> {
    let rates = options.rates();
    let begin = Instant::now();
    let mut error = RunningError::default();
    let mut n_signals = 0;
    loop {
        let left = options.max_signals.map_or(u64::MAX, |most| most - n_signals);
        let n = u64::from(options.lambda).min(left);
        let sum = match options.batch {
            None => one_by_one(network, &mut winners, signals, n, &rates)?,
            Some(n_batch) => in_batches(network, &mut winners, signals, n, n_batch, &rates)?,
        };
        n_signals += n;
        error.add(sum, n);
        let stopped = [
            (network.neurons.len() >= n_neurons, Stopped::Count),
            (options.max_signals.is_some_and(|most| most <= n_signals), Stopped::Signals),
            (options.target_error.zip(error.mean).is_some_and(|(a, b)| b <= a), Stopped::MeanError),
            (
                options.max_seconds.is_some_and(|s| s <= begin.elapsed().as_secs_f64()),
                Stopped::Time,
            ),
        ];
        if let Some((_, stopped)) = stopped.into_iter().find(|(is_met, _)| *is_met) {
            return Ok(Learned { n_signals, stopped });
        }
        let n_before = network.neurons.len();
        network.insert(&rates, &mut winners);
        progress.advance((network.neurons.len() - n_before) as u64)?;
        if let Some(mean) = error.mean.filter(|_| error.n == 0) {
            progress.tell(&format!("signals {mean:.4} mm off"));
        }
    }
}

/// The algorithm as it stands: every signal finds the network as the one before left it. The sum of their
/// distances [mm].
fn one_by_one<W: Winners>(
    network: &mut Network,
    winners: &mut W,
    signals: &mut Signals<'_>,
    n: u64,
    rates: &Rates,
) -> Result<f64, GngError> {
    let mut drawn = [[0.0; 3]; DRAWN];
    let mut sum = 0.0;
    let mut left = n;
    while 0 < left {
        let drawn = &mut drawn[..left.min(DRAWN as u64) as usize];
        signals.fill(drawn)?;
        for &signal in &*drawn {
            let won = winners.find(signal, &network.neurons, &network.links);
            sum += f64::from(won.square.sqrt());
            network.adapt(signal, won, rates, winners);
            network.bury(winners);
        }
        left -= drawn.len() as u64;
    }
    Ok(sum)
}

/// Signals find the network as the batch before left it, all at once, and change it in the order in which they
/// were drawn: the same network for any number of threads.
fn in_batches<W: Winners + Sync>(
    network: &mut Network,
    winners: &mut W,
    signals: &mut Signals<'_>,
    n: u64,
    n_batch: usize,
    rates: &Rates,
) -> Result<f64, GngError> {
    let mut sum = 0.0;
    let mut left = n;
    let mut drawn: Vec<Place> = Vec::new();
    while 0 < left {
        drawn.resize(left.min(n_batch as u64) as usize, [0.0; 3]);
        signals.fill(&mut drawn)?;
        let (neurons, links, unchanged) = (&network.neurons, &network.links, &*winners);
        let find = |signal: &Place| unchanged.look(*signal, neurons, links);
        let all: Vec<Won> = drawn.par_iter().with_min_len(64).map(find).collect();
        for (&signal, &won) in drawn.iter().zip(&all) {
            sum += f64::from(won.square.sqrt());
            network.adapt(signal, won, rates, winners);
        }
        network.bury(winners);
        left -= drawn.len() as u64;
    }
    Ok(sum)
}

/// How far signals are off on average, window by window.
#[derive(Debug, Default)]
struct RunningError {
    sum: f64,
    n: u64,
    mean: Option<f64>,
}

impl RunningError {
    fn add(&mut self, sum: f64, n: u64) {
        self.sum += sum;
        self.n += n;
        if WINDOW <= self.n {
            *self = Self { mean: Some(self.sum / self.n as f64), ..Self::default() };
        }
    }
}
