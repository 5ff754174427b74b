//! A growing neural gas, and what one signal does to it.

use super::error::GngError;
use super::graph::{GraphEdge, NeuronGraph};
use super::links::{Links, Slot};
use super::options::{Decay, Rates};
use super::signals::place;
use super::winners::{Winners, Won};
use crate::geom::{Point3, PointCloud, Vector3};

/// Where a signal or a neuron is, from the middle of the cloud [mm].
pub(super) type Place = [f32; 3];

/// A neuron: where it is, and how often it has won.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Neuron {
    pub(super) at: Place,
    pub(super) wins: u32,
}

/// Neurons, their edges, their errors.
///
/// Errors are kept divided by what they have decayed by since the beginning: then decay is one product for the
/// whole network, their order is that of the true ones, and none fades into a denormal.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Network {
    pub(super) neurons: Vec<Neuron>,
    pub(super) links: Links,
    errors: Vec<f64>,
    /// What a new error is multiplied by: one over the decay so far.
    scale: f64,
    /// Neurons that lost an edge, perhaps their last.
    bereft: Vec<u32>,
}

/// Scales beyond this are divided out of all errors.
const GREATEST_SCALE: f64 = 1e250;

/// The squared distance of two places. Every search computes it so, to the last bit.
#[inline(always)]
pub(super) fn square(a: Place, b: Place) -> f32 {
    let out = [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    out[0] * out[0] + out[1] * out[1] + out[2] * out[2]
}

impl Network {
    /// Two neurons, not yet joined.
    pub(super) fn of_two(places: [Place; 2]) -> Self {
        let mut network = Self::empty();
        for at in places {
            network.add(at, 0.0);
        }
        network
    }

    fn empty() -> Self {
        Self {
            neurons: Vec::new(),
            links: Links::new(),
            errors: Vec::new(),
            scale: 1.0,
            bereft: Vec::new(),
        }
    }

    /// A neuron more, with an error as it is kept. Its number.
    fn add(&mut self, at: Place, error: f64) -> u32 {
        self.neurons.push(Neuron { at, wins: 0 });
        self.links.add();
        self.errors.push(error);
        self.neurons.len() as u32 - 1
    }

    /// What a signal does: the winner and its neighbours come nearer, the winner and the second are joined, edges
    /// not confirmed for long are cut. Fritzke (1995), steps 3 to 7, but for the neurons left without an edge:
    /// [`bury`](Self::bury) takes them out.
    #[inline]
    pub(super) fn adapt(
        &mut self,
        signal: Place,
        won: Won,
        rates: &Rates,
        winners: &mut impl Winners,
    ) {
        let Won { first, second, square } = won;
        let winner = &mut self.neurons[first as usize];
        winner.wins = winner.wins.wrapping_add(1);
        let wins = winner.wins;
        self.errors[first as usize] += f64::from(square) * self.scale;
        self.pull(first, signal, rates.winner, winners);
        let n_bereft = self.bereft.len();
        for k in 0..self.links.of(first).len() {
            let slot = self.links.of(first)[k];
            self.pull(slot.to, signal, rates.neighbour, winners);
            let age = slot.age([wins, self.neurons[slot.to as usize].wins]);
            if rates.max_age < age && slot.to != second {
                self.bereft.push(slot.to);
            }
        }
        let both = wins.wrapping_add(self.neurons[second as usize].wins);
        self.links.confirm(first, second, both);
        for &old in &self.bereft[n_bereft..] {
            self.links.cut(first, old);
        }
        if rates.decay == Decay::Signal {
            self.fade(rates.decay_rate);
        }
    }

    #[inline(always)]
    fn pull(&mut self, i: u32, to: Place, rate: f32, winners: &mut impl Winners) {
        let neuron = &mut self.neurons[i as usize];
        let from = neuron.at;
        for (x, (a, b)) in neuron.at.iter_mut().zip(from.into_iter().zip(to)) {
            *x = a + rate * (b - a);
        }
        winners.moved(i, from, neuron.at);
    }

    /// Takes out neurons that have lost their last edge. Fritzke (1995), step 7.
    #[inline]
    pub(super) fn bury(&mut self, winners: &mut impl Winners) {
        if !self.bereft.is_empty() {
            self.bury_all(winners);
        }
    }

    #[cold]
    fn bury_all(&mut self, winners: &mut impl Winners) {
        let mut alone = std::mem::take(&mut self.bereft);
        alone.retain(|&i| self.links.of(i).is_empty());
        // From the highest number down: whoever gets a number is not itself to go.
        alone.sort_unstable_by(|a, b| b.cmp(a));
        alone.dedup();
        for &i in &alone {
            winners.removed(i, self.neurons.len() as u32 - 1, &self.neurons);
            self.links.swap_remove(i);
            self.neurons.swap_remove(i as usize);
            self.errors.swap_remove(i as usize);
        }
        alone.clear();
        self.bereft = alone;
    }

    /// A new neuron halfway between the one with the greatest error and its neighbour with the greatest.
    /// Fritzke (1995), step 8; [M] writes "a further neighbour" in its place.
    pub(super) fn insert(&mut self, rates: &Rates, winners: &mut impl Winners) {
        let Some(q) = self.worst() else { return };
        let error = |slot: &&Slot| self.errors[slot.to as usize];
        let by_error = |a: &&Slot, b: &&Slot| error(a).total_cmp(&error(b)).then(b.to.cmp(&a.to));
        let Some(f) = self.links.of(q).iter().max_by(by_error).map(|slot| slot.to) else { return };
        for i in [q, f] {
            self.errors[i as usize] *= rates.split_error;
        }
        let [a, b] = [q, f].map(|i| self.neurons[i as usize]);
        let at = [0, 1, 2].map(|k| 0.5 * (a.at[k] + b.at[k]));
        let r = self.add(at, self.errors[q as usize]);
        self.links.cut(q, f);
        self.links.confirm(q, r, a.wins);
        self.links.confirm(f, r, b.wins);
        winners.added(r, &self.neurons);
        if rates.decay == Decay::Insertion {
            self.fade(rates.decay_rate);
        }
    }

    /// The neuron with the greatest error, the first of several.
    fn worst(&self) -> Option<u32> {
        let mut worst = None;
        let mut greatest = f64::NEG_INFINITY;
        for (i, &error) in self.errors.iter().enumerate() {
            // Who is about to be buried has no neighbour to be halfway to.
            if greatest < error && !self.links.of(i as u32).is_empty() {
                (worst, greatest) = (Some(i as u32), error);
            }
        }
        worst
    }

    /// The errors as they are.
    pub(super) fn errors(&self) -> impl Iterator<Item = f64> + '_ {
        self.errors.iter().map(|error| error / self.scale)
    }

    /// The network of these neurons, those without edges to be buried.
    pub(super) fn of_parts(neurons: Vec<Neuron>, links: Links, errors: Vec<f64>) -> Self {
        let bereft = (0..neurons.len() as u32).filter(|i| links.of(*i).is_empty()).collect();
        Self { neurons, links, errors, scale: 1.0, bereft }
    }

    /// All errors are multiplied by `rate`.
    fn fade(&mut self, rate: f64) {
        self.scale /= rate;
        if GREATEST_SCALE < self.scale {
            for error in &mut self.errors {
                *error /= self.scale;
            }
            self.scale = 1.0;
        }
    }

    /// The network as others see it, `origin` being where it counts from.
    pub(super) fn to_graph(&self, origin: &Point3) -> NeuronGraph {
        let point = |neuron: &Neuron| origin + Vector3::from(neuron.at.map(f64::from));
        let wins = |i: u32| self.neurons[i as usize].wins;
        let edges_of = |i: u32| {
            let row = self.links.of(i).iter().filter(move |slot| i < slot.to);
            row.map(move |slot| GraphEdge {
                ends: [i, slot.to],
                age: slot.age([wins(i), wins(slot.to)]),
            })
        };
        let mut edges: Vec<GraphEdge> = (0..self.neurons.len() as u32).flat_map(edges_of).collect();
        edges.sort_unstable();
        NeuronGraph {
            neurons: PointCloud {
                points: self.neurons.iter().map(point).collect(),
                ..PointCloud::default()
            },
            edges,
            errors: self.errors().collect(),
        }
    }

    /// The network that `graph` is, to grow on about `origin`.
    pub(super) fn of_graph(graph: &NeuronGraph, origin: &Point3) -> Result<Self, GngError> {
        let refused = |problem: String| Err(GngError::Graph { problem });
        let n = graph.neurons.points.len();
        if n < 2 {
            return refused(format!("it has {n} neurons"));
        }
        let mut network = Self::empty();
        for (i, point) in graph.neurons.points.iter().enumerate() {
            network.add(place(point, origin), graph.errors.get(i).copied().unwrap_or(0.0));
        }
        for edge in &graph.edges {
            let [a, b] = edge.ends;
            if a == b || a.max(b) as usize >= n {
                return refused(format!("an edge joins neurons {a} and {b} of {n}"));
            }
            network.links.confirm(a, b, 0_u32.wrapping_sub(edge.age));
        }
        match (0..n).find(|i| network.links.of(*i as u32).is_empty()) {
            Some(alone) => refused(format!("neuron {} has no edge", alone + 1)),
            None => Ok(network),
        }
    }
}
