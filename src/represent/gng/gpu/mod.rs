//! Growing neural gas on a device.
//!
//! [`learn_on_device`] is the shape of Morell (2014), section 4.3: one signal after the other, each step by all
//! threads of one workgroup, nothing sent back and forth for many signals. [`OnDevice`] finds the winners of a
//! batch, a workgroup for each signal, and the processor learns them.
//!
//! A neuron without edges is taken out after some insertions and not at once: until then it may win and be
//! joined again. Errors are sums of `f32`.

mod batch;
mod kernels;
mod layout;
#[cfg(test)]
mod tests;

pub(super) use batch::OnDevice;

use super::error::GngError;
use super::learn::{Lesson, Stopped};
use super::links::{Links, Slot};
use super::network::{Network, Neuron, Place};
use super::options::{Decay, Rates};
use super::winners::Nobody;
use crate::compute::{Buffer, Gpu};
use crate::progress::Progress;
use kernels::WORKGROUP;
use layout::{Insertion, Outcome, vec4};
use std::time::Instant;

/// Neurons inserted before the network comes back from the device.
const INSERTED: usize = 32;
/// Turns that the loops of one run take together: some drivers end them after 65,535.
const TURNS: usize = 50_000;
/// What a signal costs beside the search, in turns.
const TURNS_BESIDE: usize = 64;

/// Lets `network` learn and grow on the device to `n_neurons`, or until the options stop it.
pub(super) fn learn_on_device(
    network: &mut Network,
    gpu: &Gpu,
    lesson: &mut Lesson<'_>,
    n_neurons: usize,
    progress: &dyn Progress,
) -> Result<Stopped, GngError> {
    loop {
        let mut visit = Visit::begin(network, gpu, lesson.rates)?;
        let mut stopped = None;
        for _ in 0..INSERTED {
            let n = lesson.course.next();
            let mut signals = vec![[0.0; 3]; n as usize];
            lesson.signals.fill(&mut signals)?;
            lesson.course.did(n, visit.learn(&signals)?, progress);
            stopped = lesson.course.end(visit.n_neurons, n_neurons);
            if stopped.is_some() {
                break;
            }
            visit.insert()?;
            progress.advance(1)?;
        }
        *network = visit.end()?;
        network.bury(&mut Nobody);
        // Neurons that went are grown again.
        let is_short = stopped == Some(Stopped::Count) && network.neurons.len() < n_neurons;
        if let Some(stopped) = stopped.filter(|_| !is_short) {
            return Ok(stopped);
        }
    }
}

/// The time of a signal on the device [ns], by some of them that the network then does not know.
pub(super) fn ns_per_signal(
    network: &Network,
    gpu: &Gpu,
    rates: Rates,
    signals: &[Place],
) -> Result<f64, GngError> {
    let mut visit = Visit::begin(network, gpu, rates)?;
    // Kernels are compiled when they first run.
    visit.learn(&signals[..1])?;
    let begin = Instant::now();
    visit.learn(signals)?;
    Ok(begin.elapsed().as_nanos() as f64 / signals.len() as f64)
}

/// A network on a device, with room for some neurons more.
struct Visit<'a> {
    gpu: &'a Gpu,
    rates: Rates,
    n_neurons: usize,
    room: usize,
    width: usize,
    neurons: Buffer,
    wins: Buffer,
    errors: Buffer,
    n_slots: Buffer,
    slots: Buffer,
}

impl<'a> Visit<'a> {
    fn begin(network: &Network, gpu: &'a Gpu, rates: Rates) -> Result<Self, GngError> {
        let n_neurons = network.neurons.len();
        let room = n_neurons + INSERTED;
        let width = network.links.width();
        let (n_slots, slots) = network.links.rows();
        let places = network.neurons.iter().map(|neuron| vec4(neuron.at));
        let wins = network.neurons.iter().map(|neuron| neuron.wins);
        let errors = network.errors().map(|error| error as f32);
        Ok(Self {
            gpu,
            rates,
            n_neurons,
            room,
            width,
            neurons: gpu.upload("neurons", &filled(places, room))?,
            wins: gpu.upload("wins", &filled(wins, room))?,
            errors: gpu.upload("errors", &filled(errors, room))?,
            n_slots: gpu.upload("numbers of edges", &filled(n_slots.iter().copied(), room))?,
            slots: gpu.upload("edges", &filled(slots.iter().copied(), room * width))?,
        })
    }

    /// Learns the signals. The sum of their distances [mm].
    fn learn(&mut self, signals: &[Place]) -> Result<f64, GngError> {
        let all: Vec<[f32; 4]> = signals.iter().map(|signal| vec4(*signal)).collect();
        let buffer = self.gpu.upload("signals", &all)?;
        let mut at_once = TURNS / (self.n_neurons / WORKGROUP as usize + TURNS_BESIDE);
        let mut sum = 0.0;
        let mut n_learned = 0;
        while n_learned < signals.len() {
            let end = signals.len().min(n_learned + at_once.max(1));
            let outcome = self.run(&buffer, n_learned, end)?;
            sum += f64::from(outcome.distances);
            let n_before = std::mem::replace(&mut n_learned, outcome.n_learned as usize);
            if outcome.is_full == 1 {
                self.widen()?;
            } else if n_learned < end {
                if n_learned == n_before && at_once <= 1 {
                    let adapter = self.gpu.name().to_owned();
                    return Err(GngError::CutShort { adapter, n_neurons: self.n_neurons });
                }
                at_once /= 2;
            }
        }
        Ok(sum)
    }

    /// Learns the signals from `begin` up to `end`, or as many as can be.
    fn run(&self, signals: &Buffer, begin: usize, end: usize) -> Result<Outcome, GngError> {
        let Rates { winner, neighbour, max_age, decay, decay_rate, .. } = self.rates;
        let lesson = layout::Lesson {
            n_neurons: self.n_neurons as u32,
            begin: begin as u32,
            end: end as u32,
            width: self.width as u32,
            max_age,
            winner_rate: winner,
            neighbour_rate: neighbour,
            signal_decay: if decay == Decay::Signal { decay_rate as f32 } else { 1.0 },
        };
        let lesson = self.gpu.upload("lesson", &[lesson])?;
        let outcome = Outcome { n_learned: begin as u32, ..Outcome::default() };
        let outcome = self.gpu.upload("outcome", &[outcome])?;
        let buffers = [
            &lesson,
            &self.neurons,
            signals,
            &self.wins,
            &self.errors,
            &self.n_slots,
            &self.slots,
            &outcome,
        ];
        self.gpu.run(&kernels::learn(), &buffers, 1)?;
        Ok(self.gpu.download("outcome", &outcome)?[0])
    }

    /// A new neuron; there must be room.
    fn insert(&mut self) -> Result<(), GngError> {
        let Rates { split_error, decay, decay_rate, .. } = self.rates;
        let insertion = Insertion {
            n_neurons: self.n_neurons as u32,
            width: self.width as u32,
            split_error: split_error as f32,
            decay: if decay == Decay::Insertion { decay_rate as f32 } else { 1.0 },
        };
        let insertion = self.gpu.upload("insertion", &[insertion])?;
        let buffers =
            [&insertion, &self.neurons, &self.wins, &self.errors, &self.n_slots, &self.slots];
        self.gpu.run(&kernels::insert(), &buffers, 1)?;
        self.n_neurons += 1;
        Ok(())
    }

    /// Twice the room for the edges of each neuron.
    fn widen(&mut self) -> Result<(), GngError> {
        let mut links = self.links()?;
        links.widen();
        let (_, slots) = links.rows();
        self.width = links.width();
        self.slots =
            self.gpu.upload("edges", &filled(slots.iter().copied(), self.room * self.width))?;
        Ok(())
    }

    fn links(&self) -> Result<Links, GngError> {
        let mut n_slots: Vec<u32> = self.gpu.download("numbers of edges", &self.n_slots)?;
        let mut slots: Vec<Slot> = self.gpu.download("edges", &self.slots)?;
        n_slots.truncate(self.n_neurons);
        slots.truncate(self.n_neurons * self.width);
        Ok(Links::of_rows(self.width, n_slots, slots))
    }

    /// The network back from the device.
    fn end(self) -> Result<Network, GngError> {
        let places: Vec<[f32; 4]> = self.gpu.download("neurons", &self.neurons)?;
        let wins: Vec<u32> = self.gpu.download("wins", &self.wins)?;
        let errors: Vec<f32> = self.gpu.download("errors", &self.errors)?;
        let neuron =
            |(at, wins): (&[f32; 4], &u32)| Neuron { at: [at[0], at[1], at[2]], wins: *wins };
        let neurons = places.iter().zip(&wins).take(self.n_neurons).map(neuron).collect();
        let errors = errors.iter().take(self.n_neurons).map(|error| f64::from(*error)).collect();
        Ok(Network::of_parts(neurons, self.links()?, errors))
    }
}

/// All of them, then zeros up to `n`.
fn filled<T: bytemuck::Zeroable + Clone>(all: impl Iterator<Item = T>, n: usize) -> Vec<T> {
    let mut filled: Vec<T> = all.collect();
    filled.resize(n, T::zeroed());
    filled
}
