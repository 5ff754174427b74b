//! Neighbouring rows under all the moves, in their order, by one thread.

use super::layout::{GROUP, Layout};
use super::row::{Cut, Row};
use fearless_simd::{f64x8, prelude::*};
use std::ops::Range;

/// Rows one thread takes at a time. Never depends on the number of threads.
pub(super) const STRIPE: usize = 16;

/// Some rows of a stock.
pub(super) struct Stripe<'a> {
    pub(super) layout: &'a Layout,
    /// The number of its first row.
    pub(super) first: usize,
    pub(super) ends: &'a mut [f64],
    pub(super) before: &'a mut [f64],
    pub(super) peaks: &'a mut [f64],
    pub(super) engaged: &'a mut [u32],
    /// Nothing in the stripe ends farther out, now or later.
    pub(super) highest: f64,
    /// Upper bounds over all its rows, a tile of columns each.
    pub(super) crest: Vec<f64>,
    /// Row by row the bite after which no material was left in the tool's way: all of it was cut.
    pub(super) cut_clear: [usize; STRIPE],
}

/// What can take something off the rows of a stripe.
pub(super) trait Bite: Sync {
    /// The stretch of X it reaches.
    fn reach(&self) -> [f64; 2];
    /// The move it is part of.
    fn i_sweep(&self) -> u32;
    /// Cuts `rows`, all of them of `stripe` and within reach; adds to what was cut. `turn` numbers
    /// the bites from 1, and `last` is the one before.
    fn bite<S: Simd>(&self, simd: S, turn: Turn<Self>, stripe: &mut Stripe, cut: &mut Cut);
}

/// Whose turn it is to cut what.
pub(super) struct Turn<'a, B: ?Sized> {
    /// Bites are numbered from 1.
    pub(super) number: usize,
    /// The one before.
    pub(super) last: Option<&'a B>,
    /// Within reach, and of the stripe; counted from its first row.
    pub(super) rows: Range<usize>,
}

impl<'a> Stripe<'a> {
    pub(super) fn new(
        layout: &'a Layout,
        first: usize,
        [ends, before, peaks]: [&'a mut [f64]; 3],
        engaged: &'a mut [u32],
    ) -> Self {
        let mut crest = vec![f64::NEG_INFINITY; layout.tile_stride()];
        for peaks in peaks.chunks(layout.tile_stride()) {
            for (crest, peak) in crest.iter_mut().zip(peaks) {
                *crest = crest.max(*peak);
            }
        }
        let highest = crest.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let cut_clear = [0; STRIPE];
        Self { layout, first, ends, before, peaks, engaged, highest, crest, cut_clear }
    }

    /// What each move took that took anything. Inlined with all it calls, so that it is compiled for
    /// each level of vector instructions.
    #[inline(always)]
    pub(super) fn run<S: Simd, B: Bite>(mut self, simd: S, bites: &[B]) -> Vec<(u32, Cut)> {
        let mine = self.first..self.first + self.engaged.len();
        let mut taken: Vec<(u32, Cut)> = Vec::new();
        for (i, bite) in bites.iter().enumerate() {
            let reached = self.layout.rows_within(bite.reach());
            let rows = reached.start.max(mine.start)..reached.end.min(mine.end);
            if rows.is_empty() {
                continue;
            }
            let rows = rows.start - self.first..rows.end - self.first;
            let last = i.checked_sub(1).map(|i| &bites[i]);
            let mut cut = Cut::default();
            bite.bite(simd, Turn { number: i + 1, last, rows }, &mut self, &mut cut);
            if !cut.is_nothing() {
                match taken.last_mut() {
                    Some((i_sweep, whole)) if *i_sweep == bite.i_sweep() => whole.add(&cut),
                    _ => taken.push((bite.i_sweep(), cut)),
                }
            }
        }
        taken
    }

    /// One of its rows.
    #[inline(always)]
    pub(super) fn row(&mut self, i: usize) -> Row<'_> {
        let (n_columns, stride) = (self.layout.n_columns, self.layout.tile_stride());
        Row {
            layout: self.layout,
            x: self.layout.row_x(self.first + i),
            weight: self.layout.row_weight(self.first + i),
            highest: self.highest,
            ends: &mut self.ends[i * n_columns..][..n_columns],
            before: &mut self.before[i * n_columns..][..n_columns],
            peaks: &mut self.peaks[i * stride..][..stride],
            engaged: &mut self.engaged[i],
        }
    }

    /// Renews the bounds over a group of tiles, after a cut.
    #[inline(always)]
    pub(super) fn renew_crest<S: Simd>(&mut self, simd: S, group: usize) {
        let mut crest = f64x8::splat(simd, f64::NEG_INFINITY);
        for peaks in self.peaks.chunks_exact(self.layout.tile_stride()) {
            crest = crest.max(f64x8::from_slice(simd, &peaks[group * GROUP..][..GROUP]));
        }
        self.crest[group * GROUP..][..GROUP].copy_from_slice(crest.as_slice());
    }
}
