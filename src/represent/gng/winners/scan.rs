//! Winners by trying every neuron, sixteen side by side.

use super::super::links::Links;
use super::super::network::{Neuron, Place};
use super::{Two, Winners, Won};
use fearless_simd::{Level, Simd, dispatch, prelude::*};

const WIDTH: usize = 16;

pub(in super::super) struct Scan {
    level: Level,
    /// x, y and z of all neurons, filled up to whole rows with what is infinitely far off.
    at: [Vec<f32>; 3],
}

impl Scan {
    pub(in super::super) fn over(neurons: &[Neuron]) -> Self {
        let mut scan = Self { level: Level::new(), at: [Vec::new(), Vec::new(), Vec::new()] };
        for i in 0..neurons.len() {
            scan.added(i as u32, &neurons[..=i]);
        }
        scan
    }
}

#[inline(always)]
fn least<S: Simd>(simd: S, at: [&[f32]; 3], signal: Place) -> Two {
    use fearless_simd::{f32x16, u32x16};
    let s = signal.map(|x| f32x16::splat(simd, x));
    let mut squares = [f32x16::splat(simd, f32::INFINITY); 2];
    let mut numbers = [u32x16::splat(simd, u32::MAX); 2];
    let mut i = u32x16::from_slice(simd, &[0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15]);
    let step = u32x16::splat(simd, WIDTH as u32);
    let rows =
        at[0].chunks_exact(WIDTH).zip(at[1].chunks_exact(WIDTH)).zip(at[2].chunks_exact(WIDTH));
    for ((x, y), z) in rows {
        let out = [
            f32x16::from_slice(simd, x) - s[0],
            f32x16::from_slice(simd, y) - s[1],
            f32x16::from_slice(simd, z) - s[2],
        ];
        let d = out[0] * out[0] + out[1] * out[1] + out[2] * out[2];
        let is_first = d.simd_lt(squares[0]);
        let is_second = d.simd_lt(squares[1]);
        squares[1] = is_first.select(squares[0], is_second.select(d, squares[1]));
        numbers[1] = is_first.select(numbers[0], is_second.select(i, numbers[1]));
        squares[0] = is_first.select(d, squares[0]);
        numbers[0] = is_first.select(i, numbers[0]);
        i += step;
    }
    let mut two = Two::NONE;
    for k in 0..2 {
        let (mut d, mut n) = ([0.0; WIDTH], [0; WIDTH]);
        squares[k].store_slice(&mut d);
        numbers[k].store_slice(&mut n);
        for (d, n) in d.into_iter().zip(n) {
            two.take(d, n);
        }
    }
    two
}

impl Winners for Scan {
    fn look(&self, signal: Place, _neurons: &[Neuron], _links: &Links) -> Won {
        let [x, y, z] = &self.at;
        let two = dispatch!(self.level, simd => least(simd, [x, y, z], signal));
        two.into()
    }

    #[inline(always)]
    fn moved(&mut self, i: u32, _from: Place, to: Place) {
        for (all, x) in self.at.iter_mut().zip(to) {
            all[i as usize] = x;
        }
    }

    fn added(&mut self, i: u32, neurons: &[Neuron]) {
        for (k, all) in self.at.iter_mut().enumerate() {
            if all.len() < neurons.len() {
                all.resize(neurons.len().next_multiple_of(WIDTH), f32::INFINITY);
            }
            all[i as usize] = neurons[i as usize].at[k];
        }
    }

    fn removed(&mut self, i: u32, last: u32, _neurons: &[Neuron]) {
        for all in &mut self.at {
            all[i as usize] = all[last as usize];
            all[last as usize] = f32::INFINITY;
        }
    }
}
