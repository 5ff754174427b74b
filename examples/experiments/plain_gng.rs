//! Growing neural gas as one writes it down: neurons in a row, all of them tried for every signal, edges that are
//! counted older, errors that are multiplied. What our own is measured against.

use horma::represent::gng::NeuronGraph;
use std::time::{Duration, Instant};

type Place = [f32; 3];

/// The thesis' rates, errors decaying with every new neuron, so that none becomes a denormal and slows it down.
const WINNER_RATE: f32 = 0.1;
const NEIGHBOUR_RATE: f32 = 0.001;
const MAX_AGE: u32 = 250;
const SPLIT_ERROR: f32 = 0.5;
const DECAY: f32 = 0.95;

struct Neuron {
    at: Place,
    error: f32,
    /// Neighbours, and how old the edges are.
    edges: Vec<(usize, u32)>,
}

/// A network as the books have it.
pub(crate) struct PlainGng {
    neurons: Vec<Neuron>,
}

/// Time taken by the stages of figure 4.2 of Morell (2014).
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Stages {
    /// 2: a signal is drawn.
    pub(crate) signal: Duration,
    /// 3: the winner and the second are looked for.
    pub(crate) winners: Duration,
    /// 4 to 7: edges, errors, places.
    pub(crate) adapt: Duration,
    /// 8: a neuron is inserted.
    pub(crate) insert: Duration,
    /// 9: errors decay.
    pub(crate) decay: Duration,
}

impl Stages {
    /// All of them.
    pub(crate) fn all(&self) -> [Duration; 5] {
        [self.signal, self.winners, self.adapt, self.insert, self.decay]
    }
}

impl PlainGng {
    /// The network `graph`, `origin` being where it counts from.
    pub(crate) fn of_graph(graph: &NeuronGraph, origin: &horma::geom::Point3) -> Self {
        let neuron = |(i, point): (usize, &horma::geom::Point3)| {
            let out = point - origin;
            let error = graph.errors[i] as f32;
            Neuron { at: [out.x as f32, out.y as f32, out.z as f32], error, edges: Vec::new() }
        };
        let mut neurons: Vec<Neuron> =
            graph.neurons.points.iter().enumerate().map(neuron).collect();
        for edge in &graph.edges {
            let [a, b] = edge.ends.map(|end| end as usize);
            neurons[a].edges.push((b, edge.age));
            neurons[b].edges.push((a, edge.age));
        }
        Self { neurons }
    }

    /// Learns `signals`, then inserts a neuron; the time each stage took.
    pub(crate) fn learn(&mut self, signals: impl Iterator<Item = Place>) -> Stages {
        let mut stages = Stages::default();
        let mut clock = Instant::now();
        let mut lap = |stage: &mut Duration| {
            let now = Instant::now();
            *stage += now - clock;
            clock = now;
        };
        for signal in signals {
            lap(&mut stages.signal);
            let (first, second, square) = self.winners(signal);
            lap(&mut stages.winners);
            self.adapt(signal, first, second, square);
            lap(&mut stages.adapt);
        }
        self.insert();
        lap(&mut stages.insert);
        for neuron in &mut self.neurons {
            neuron.error *= DECAY;
        }
        lap(&mut stages.decay);
        stages
    }

    fn winners(&self, signal: Place) -> (usize, usize, f32) {
        let (mut first, mut second) = ((f32::INFINITY, 0), (f32::INFINITY, 0));
        for (i, neuron) in self.neurons.iter().enumerate() {
            let out = [0, 1, 2].map(|k| neuron.at[k] - signal[k]);
            let square = out[0] * out[0] + out[1] * out[1] + out[2] * out[2];
            if square < first.0 {
                second = first;
                first = (square, i);
            } else if square < second.0 {
                second = (square, i);
            }
        }
        (first.1, second.1, first.0)
    }

    fn adapt(&mut self, signal: Place, first: usize, second: usize, square: f32) {
        self.neurons[first].error += square;
        self.pull(first, signal, WINNER_RATE);
        for k in 0..self.neurons[first].edges.len() {
            let (other, _) = self.neurons[first].edges[k];
            self.pull(other, signal, NEIGHBOUR_RATE);
            self.neurons[first].edges[k].1 += 1;
            if let Some(edge) = self.neurons[other].edges.iter_mut().find(|edge| edge.0 == first) {
                edge.1 += 1;
            }
        }
        for (a, b) in [(first, second), (second, first)] {
            match self.neurons[a].edges.iter_mut().find(|edge| edge.0 == b) {
                Some(edge) => edge.1 = 0,
                None => self.neurons[a].edges.push((b, 0)),
            }
        }
        let old: Vec<usize> = self.neurons[first]
            .edges
            .iter()
            .filter(|edge| MAX_AGE < edge.1)
            .map(|edge| edge.0)
            .collect();
        for other in old {
            self.cut(first, other);
            if self.neurons[other].edges.is_empty() {
                self.remove(other);
            }
        }
    }

    fn pull(&mut self, i: usize, to: Place, rate: f32) {
        for (x, to) in self.neurons[i].at.iter_mut().zip(to) {
            *x += rate * (to - *x);
        }
    }

    fn cut(&mut self, a: usize, b: usize) {
        self.neurons[a].edges.retain(|edge| edge.0 != b);
        self.neurons[b].edges.retain(|edge| edge.0 != a);
    }

    fn remove(&mut self, i: usize) {
        let last = self.neurons.len() - 1;
        self.neurons.swap_remove(i);
        for neuron in &mut self.neurons {
            for edge in neuron.edges.iter_mut().filter(|edge| edge.0 == last) {
                edge.0 = i;
            }
        }
    }

    fn insert(&mut self) {
        let worst =
            |a: &usize, b: &usize| self.neurons[*a].error.total_cmp(&self.neurons[*b].error);
        let Some(q) = (0..self.neurons.len()).max_by(worst) else { return };
        let Some(f) = self.neurons[q].edges.iter().map(|edge| edge.0).max_by(worst) else { return };
        for i in [q, f] {
            self.neurons[i].error *= SPLIT_ERROR;
        }
        let at = [0, 1, 2].map(|k| 0.5 * (self.neurons[q].at[k] + self.neurons[f].at[k]));
        let r = self.neurons.len();
        let error = self.neurons[q].error;
        self.neurons.push(Neuron { at, error, edges: vec![(q, 0), (f, 0)] });
        self.cut(q, f);
        self.neurons[q].edges.push((r, 0));
        self.neurons[f].edges.push((r, 0));
    }
}
