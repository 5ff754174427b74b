//! Winners by a grid of cells, about one neuron in each that has any.

use super::super::links::Links;
use super::super::network::{Neuron, Place, square};
use super::{Two, Winners, Won};

/// No neuron.
const NONE: u32 = u32::MAX;
/// More cells than this are not made: larger ones are taken instead.
const MOST_CELLS: f64 = (1_u32 << 26) as f64;
/// Side of a cell, of what the cloud's longest side is by the root of the number of neurons: on a surface they
/// are about so far apart.
const SIDE: f64 = 0.85;

/// A grid over the cloud's box.
pub(in super::super) struct Grid {
    low: Place,
    high: Place,
    side: f32,
    per_side: f32,
    n: [i32; 3],
    cells: Vec<Cell>,
    /// The neuron after each one in its cell.
    next: Vec<u32>,
    n_made_for: usize,
    /// What rounding may hide of a distance along an axis [mm].
    slack: f32,
}

#[derive(Debug, Clone, Copy)]
struct Cell {
    head: u32,
    /// Who won here last.
    hint: u32,
}

impl Grid {
    pub(in super::super) fn over(low: Place, high: Place, neurons: &[Neuron]) -> Self {
        let mut grid = Self {
            low,
            high,
            side: 0.0,
            per_side: 0.0,
            n: [1; 3],
            cells: Vec::new(),
            next: Vec::new(),
            n_made_for: 0,
            slack: 0.0,
        };
        grid.make(neurons);
        grid
    }

    fn make(&mut self, neurons: &[Neuron]) {
        let extent = [0, 1, 2].map(|k| f64::from(self.high[k] - self.low[k]));
        let longest = extent.iter().copied().fold(0.0, f64::max);
        let mut side = longest * SIDE / (neurons.len() as f64).sqrt();
        let n_cells = |side: f64| extent.iter().map(|e| (e / side).floor() + 1.0).product::<f64>();
        while MOST_CELLS < n_cells(side) {
            side *= 1.25;
        }
        self.side = side as f32;
        self.per_side = 1.0 / self.side;
        self.n = extent.map(|e| (e as f32 * self.per_side).floor() as i32 + 1);
        self.slack = longest as f32 * 4.0 * f32::EPSILON;
        let n = self.n.map(|n| n as usize);
        self.cells.clear();
        self.cells.resize(n[0] * n[1] * n[2], Cell { head: NONE, hint: NONE });
        self.next.clear();
        self.next.resize(neurons.len(), NONE);
        for (i, neuron) in neurons.iter().enumerate() {
            self.put(i as u32, neuron.at);
        }
        self.n_made_for = neurons.len();
    }

    #[inline(always)]
    fn along(&self, x: f32, k: usize) -> i32 {
        // Monotone in x; what lies outside the box belongs to the cells at its side.
        (((x - self.low[k]) * self.per_side) as i32).clamp(0, self.n[k] - 1)
    }

    #[inline(always)]
    fn cell(&self, at: Place) -> usize {
        self.number(self.along(at[0], 0), self.along(at[1], 1), self.along(at[2], 2))
    }

    #[inline(always)]
    fn number(&self, x: i32, y: i32, z: i32) -> usize {
        (z * self.n[1] + y) as usize * self.n[0] as usize + x as usize
    }

    fn put(&mut self, i: u32, at: Place) {
        let cell = self.cell(at);
        self.next[i as usize] = self.cells[cell].head;
        self.cells[cell].head = i;
    }

    fn take(&mut self, i: u32, at: Place) {
        let cell = self.cell(at);
        let next = self.next[i as usize];
        if self.cells[cell].head == i {
            self.cells[cell].head = next;
            return;
        }
        let mut before = self.cells[cell].head;
        while self.next[before as usize] != i {
            before = self.next[before as usize];
        }
        self.next[before as usize] = next;
    }

    /// How far off the second of two neurons is, squared, that need not be the nearest: looks into ever wider
    /// boxes of cells until two were met.
    #[cold]
    fn widening(&self, signal: Place, neurons: &[Neuron]) -> f32 {
        let mut reach = self.side;
        loop {
            let second = self.within(signal, reach, neurons).second.0;
            if second < f32::INFINITY {
                return second;
            }
            reach *= 2.0;
        }
    }

    /// The two nearest of the neurons in the cells about the signal.
    #[inline(always)]
    fn within(&self, signal: Place, reach: f32, neurons: &[Neuron]) -> Two {
        let [lows, highs] = self.around(signal, reach);
        let mut two = Two::NONE;
        for z in lows[2]..=highs[2] {
            for y in lows[1]..=highs[1] {
                let row = self.number(0, y, z);
                for cell in &self.cells[row + lows[0] as usize..=row + highs[0] as usize] {
                    let mut i = cell.head;
                    while i != NONE {
                        two.take(square(signal, neurons[i as usize].at), i);
                        i = self.next[i as usize];
                    }
                }
            }
        }
        two
    }

    #[inline(always)]
    fn around(&self, signal: Place, reach: f32) -> [[i32; 3]; 2] {
        // Not `map`: it is not always inlined, and this is the innermost loop.
        let at = |k: usize, out: f32| self.along(signal[k] + out, k);
        [[at(0, -reach), at(1, -reach), at(2, -reach)], [at(0, reach), at(1, reach), at(2, reach)]]
    }
}

impl Winners for Grid {
    #[inline]
    fn look(&self, signal: Place, neurons: &[Neuron], links: &Links) -> Won {
        let hint = self.cells[self.cell(signal)].hint;
        let bound = match neurons.get(hint as usize) {
            Some(_) => second_of(signal, hint, neurons, links),
            None => f32::INFINITY,
        };
        let bound = if bound < f32::INFINITY { bound } else { self.widening(signal, neurons) };
        let reach = bound.sqrt() * (1.0 + 4.0 * f32::EPSILON) + self.slack;
        self.within(signal, reach, neurons).into()
    }

    #[inline(always)]
    fn remember(&mut self, signal: Place, won: Won) {
        let own = self.cell(signal);
        self.cells[own].hint = won.first;
    }

    #[inline(always)]
    fn moved(&mut self, i: u32, from: Place, to: Place) {
        if self.cell(from) != self.cell(to) {
            self.take(i, from);
            self.put(i, to);
        }
    }

    fn added(&mut self, i: u32, neurons: &[Neuron]) {
        if 3 * self.n_made_for < 2 * neurons.len() {
            self.make(neurons);
        } else {
            self.next.push(NONE);
            self.put(i, neurons[i as usize].at);
        }
    }

    fn removed(&mut self, i: u32, last: u32, neurons: &[Neuron]) {
        self.take(i, neurons[i as usize].at);
        if i != last {
            self.take(last, neurons[last as usize].at);
            self.put(i, neurons[last as usize].at);
        }
        self.next.pop();
    }
}

/// How far off the second of two neurons is, squared, that need not be the nearest: of the neuron `hint` and those
/// joined to it.
#[inline]
fn second_of(signal: Place, hint: u32, neurons: &[Neuron], links: &Links) -> f32 {
    let mut least = [square(signal, neurons[hint as usize].at), f32::INFINITY];
    for slot in links.of(hint) {
        let other = square(signal, neurons[slot.to as usize].at);
        least = [least[0].min(other), least[1].min(least[0].max(other))];
    }
    least[1]
}
