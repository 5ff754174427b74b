//! The material itself: one number a ray.

use super::layout::{Kind, Layout, TILE};
use rayon::prelude::*;

/// What is left of a block; see the [module](super).
#[derive(Debug, Clone)]
pub struct Stock {
    pub(super) layout: Layout,
    /// Where the material of each ray ends, row by row [mm].
    pub(super) ends: Vec<f64>,
    /// The same before the engagement that is going on began, in the rows it has cut so far.
    pub(super) before: Vec<f64>,
    /// Which engagement that was, row by row.
    pub(super) engaged: Vec<u32>,
    /// How many engagements there were.
    pub(super) n_engagements: u32,
    /// Upper bounds of `ends`, a tile of columns each, whole groups of tiles a row.
    pub(super) peaks: Vec<f64>,
    /// How much too little moves have taken away so far, at most, along the normal [mm].
    pub(super) sweep_error: f64,
}

impl Stock {
    /// A block whose rays end at `ends`, row by row.
    pub(super) fn new(layout: Layout, ends: Vec<f64>) -> Self {
        let stride = layout.tile_stride();
        let mut stock = Self {
            before: ends.clone(),
            engaged: vec![0; layout.n_rows],
            n_engagements: 0,
            peaks: vec![f64::NEG_INFINITY; layout.n_rows * stride],
            sweep_error: 0.0,
            layout,
            ends,
        };
        let rows = stock.ends.par_chunks(stock.layout.n_columns);
        rows.zip(stock.peaks.par_chunks_mut(stride)).for_each(|(ends, peaks)| {
            for (tile, peak) in ends.chunks(TILE).zip(peaks) {
                *peak = tile.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            }
        });
        stock
    }

    /// Where its rays stand.
    pub fn layout(&self) -> &Layout {
        &self.layout
    }

    /// Where the material of a ray ends: radius about the spindle axis, or height along the attack
    /// axis [mm]; `None` where nothing is left.
    pub fn end(&self, row: usize, column: usize) -> Option<f64> {
        let end = self.ends[row * self.layout.n_columns + column];
        (end > self.layout.floor).then_some(end)
    }

    /// Radius at `x` and angle (or height at X and Z, in the layout's frame), between the rays
    /// linearly; `None` outside the block [mm].
    pub fn height_at(&self, x: f64, across: f64) -> Option<f64> {
        let Layout { along, n_rows, n_columns, kind, .. } = self.layout;
        let row = (x - along[0]) / along[1];
        let mut column = (across - self.layout.across[0]) / self.layout.across[1];
        if kind == Kind::Turned {
            column = column.rem_euclid(n_columns as f64);
        }
        let last_column = if kind == Kind::Turned { n_columns } else { n_columns - 1 };
        let inside = (0.0..=(n_rows - 1) as f64).contains(&row)
            && (0.0..=last_column as f64).contains(&column);
        if !inside {
            return None;
        }
        let (i, j) = ((row as usize).min(n_rows - 2), column as usize);
        let end = |i: usize, j: usize| {
            let j = if kind == Kind::Turned { j % n_columns } else { j.min(n_columns - 1) };
            self.ends[i * n_columns + j]
        };
        let (s, t) = (row - i as f64, column - j as f64);
        let on_row = |i: usize| end(i, j) * (1.0 - t) + end(i, j + 1) * t;
        Some(on_row(i) * (1.0 - s) + on_row(i + 1) * s)
    }

    /// How much material there is [mm3].
    pub fn volume(&self) -> f64 {
        let n = self.layout.n_columns;
        let row = |(row, ends): (usize, &[f64])| {
            let columns = ends.iter().enumerate();
            let area: f64 = columns
                .map(|(j, &end)| self.layout.content(end) * self.layout.column_weight(j))
                .sum();
            area * self.layout.row_weight(row)
        };
        // Summed in the order of rows, for the same bits on any number of threads.
        let rows: Vec<f64> = self.ends.par_chunks(n).enumerate().map(row).collect();
        rows.iter().sum()
    }

    /// The greatest height of `self` over `other` along a ray: how deep a pass cut, if `other` is
    /// the stock after it. Both must have the same layout [mm].
    pub fn deepest_below(&self, other: &Self) -> f64 {
        let pairs = self.ends.iter().zip(&other.ends);
        pairs.map(|(ours, theirs)| ours - theirs).fold(0.0, f64::max)
    }

    /// Moves between two places of the tool that were followed one by one left at most this much
    /// too much material, along the surface's normal where that leans by no more than 60 degrees
    /// along X [mm].
    pub fn sweep_error(&self) -> f64 {
        self.sweep_error
    }

    /// Row by row, how far out its material reaches.
    pub(super) fn tops(&self) -> Vec<f64> {
        let rows = self.peaks.par_chunks(self.layout.tile_stride());
        rows.map(|peaks| peaks.iter().copied().fold(f64::NEG_INFINITY, f64::max)).collect()
    }

    /// The rows of `range` as a stock of their own, to try things on; X stays as it is.
    #[must_use]
    pub fn excerpt(&self, range: std::ops::Range<usize>) -> Self {
        let n = self.layout.n_columns;
        let mut layout = self.layout.clone();
        layout.along[0] = self.layout.row_x(range.start);
        layout.n_rows = range.len();
        Self::new(layout, self.ends[range.start * n..range.end * n].to_vec())
    }
}
