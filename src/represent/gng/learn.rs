//! The loop: signals, and a new neuron after every lambda of them.

use super::error::GngError;
use super::network::{Network, Place};
use super::options::{GngOptions, Rates};
use super::signals::Signals;
use super::winners::{Winners, Won};
use crate::progress::Progress;
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

/// What a network is to learn, and how far it is.
pub(super) struct Lesson<'a> {
    pub(super) signals: Signals<'a>,
    pub(super) rates: Rates,
    pub(super) options: &'a GngOptions,
    pub(super) course: Course<'a>,
}

impl<'a> Lesson<'a> {
    pub(super) fn new(signals: Signals<'a>, options: &'a GngOptions) -> Self {
        Self { signals, rates: options.rates(), options, course: Course::new(options) }
    }
}

/// Lets `network` learn and grow to `n_neurons`, or until the options stop it.
pub(super) fn learn<W: Winners + Sync>(
    network: &mut Network,
    winners: &mut W,
    lesson: &mut Lesson<'_>,
    n_neurons: usize,
    progress: &dyn Progress,
) -> Result<Stopped, GngError> {
    loop {
        let n = lesson.course.next();
        let sum = match lesson.options.batch {
            None => one_by_one(network, winners, lesson, n)?,
            Some(n_batch) => in_batches(network, winners, lesson, n, n_batch)?,
        };
        lesson.course.did(n, sum, progress);
        if let Some(stopped) = lesson.course.end(network.neurons.len(), n_neurons) {
            return Ok(stopped);
        }
        let n_before = network.neurons.len();
        network.insert(&lesson.rates, winners);
        progress.advance((network.neurons.len() - n_before) as u64)?;
    }
}

/// The algorithm as it stands: every signal finds the network as the one before left it. The sum of their
/// distances [mm].
fn one_by_one<W: Winners>(
    network: &mut Network,
    winners: &mut W,
    lesson: &mut Lesson<'_>,
    n: u64,
) -> Result<f64, GngError> {
    let mut drawn = [[0.0; 3]; DRAWN];
    let mut sum = 0.0;
    let mut left = n;
    while 0 < left {
        let drawn = &mut drawn[..left.min(DRAWN as u64) as usize];
        lesson.signals.fill(drawn)?;
        for &signal in &*drawn {
            let won = winners.find(signal, &network.neurons, &network.links);
            sum += f64::from(won.square.sqrt());
            network.adapt(signal, won, &lesson.rates, winners);
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
    lesson: &mut Lesson<'_>,
    n: u64,
    n_batch: usize,
) -> Result<f64, GngError> {
    let mut sum = 0.0;
    let mut left = n;
    let mut drawn: Vec<Place> = Vec::new();
    while 0 < left {
        drawn.resize(left.min(n_batch as u64) as usize, [0.0; 3]);
        lesson.signals.fill(&mut drawn)?;
        let all: Vec<Won> = winners.look_all(&drawn, &network.neurons, &network.links)?;
        for (&signal, &won) in drawn.iter().zip(&all) {
            sum += f64::from(won.square.sqrt());
            winners.remember(signal, won);
            network.adapt(signal, won, &lesson.rates, winners);
        }
        network.bury(winners);
        left -= drawn.len() as u64;
    }
    Ok(sum)
}

/// How far learning is, and whether it is over.
pub(super) struct Course<'a> {
    options: &'a GngOptions,
    begin: Instant,
    pub(super) n_signals: u64,
    /// Sum of the distances of the last signals, and how many they are.
    window: (f64, u64),
    /// Mean distance of a window of them.
    error: Option<f64>,
}

impl<'a> Course<'a> {
    fn new(options: &'a GngOptions) -> Self {
        Self { options, begin: Instant::now(), n_signals: 0, window: (0.0, 0), error: None }
    }

    /// Signals to learn before the next neuron.
    pub(super) fn next(&self) -> u64 {
        let left = self.options.max_signals.map_or(u64::MAX, |most| most - self.n_signals);
        u64::from(self.options.lambda).min(left)
    }

    /// Learned `n` signals whose distances sum up to `sum`.
    pub(super) fn did(&mut self, n: u64, sum: f64, progress: &dyn Progress) {
        self.n_signals += n;
        self.window = (self.window.0 + sum, self.window.1 + n);
        if WINDOW <= self.window.1 {
            let mean = self.window.0 / self.window.1 as f64;
            progress.tell(&format!("signals {mean:.4} mm off"));
            (self.error, self.window) = (Some(mean), (0.0, 0));
        }
    }

    /// Why it is over with `n_neurons` of `most`, if it is.
    pub(super) fn end(&self, n_neurons: usize, most: usize) -> Option<Stopped> {
        let GngOptions { max_signals, max_seconds, target_error, .. } = self.options;
        let is_late = |longest: f64| longest <= self.begin.elapsed().as_secs_f64();
        let is_near = target_error.zip(self.error).is_some_and(|(target, mean)| mean <= target);
        let ends = [
            (most <= n_neurons, Stopped::Count),
            (max_signals.is_some_and(|n| n <= self.n_signals), Stopped::Signals),
            (is_near, Stopped::MeanError),
            (max_seconds.is_some_and(is_late), Stopped::Time),
        ];
        ends.into_iter().find(|(is_met, _)| *is_met).map(|(_, stopped)| stopped)
    }
}
