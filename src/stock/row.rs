//! One row of dexels under a tool, and what is taken from it.

use super::layout::{Layout, TILE};
use std::ops::Range;

/// Less than this taken off a ray is rounding and no cut [mm].
pub(super) const NOISE: f64 = 1e-4;

/// What a tool takes away on a move.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Cut {
    /// Volume [mm3].
    pub removed: f64,
    /// How deep it is in the material: the greatest height, along a ray it cuts on this move, that
    /// the material had over the tool when its engagement began. An engagement ends where a
    /// [`Sweep`](super::Sweep) begins a new one [mm].
    pub depth: f64,
    /// Rays whose material stands over the tool with air in between; they were kept whole.
    pub n_overhangs: u32,
    /// The tool took the last material about the spindle axis somewhere, or went below the block.
    pub is_through: bool,
}

/// A row of dexels, to be cut.
pub(super) struct Row<'a> {
    pub(super) layout: &'a Layout,
    pub(super) x: f64,
    pub(super) weight: f64,
    /// Nothing in any row of its stripe ends farther out.
    pub(super) highest: f64,
    pub(super) ends: &'a mut [f64],
    pub(super) before: &'a mut [f64],
    pub(super) peaks: &'a mut [f64],
    pub(super) engaged: &'a mut u32,
}

impl Cut {
    /// Both together.
    pub(crate) fn add(&mut self, other: &Self) {
        self.removed += other.removed;
        self.depth = self.depth.max(other.depth);
        self.n_overhangs += other.n_overhangs;
        self.is_through |= other.is_through;
    }

    /// True if nothing happened.
    pub(super) fn is_nothing(&self) -> bool {
        self.removed == 0.0 && !self.is_through && self.n_overhangs == 0
    }
}

impl Row<'_> {
    /// Remembers how the row was, if `engagement` cuts it for the first time.
    #[inline(always)]
    pub(super) fn engage(&mut self, engagement: u32) {
        if *self.engaged != engagement {
            *self.engaged = engagement;
            self.before.copy_from_slice(self.ends);
        }
    }

    /// No ray of `columns` (of a whole turn, wherever it begins) ends farther out than this.
    #[inline(always)]
    pub(super) fn peak(&self, columns: &Columns) -> f64 {
        let mut peak = f64::NEG_INFINITY;
        for range in &columns.0 {
            if range.start < range.end {
                for tile in &self.peaks[range.start / TILE..range.end.div_ceil(TILE)] {
                    peak = peak.max(*tile);
                }
            }
        }
        peak
    }

    /// Renews the bounds over `columns`, after a cut.
    #[inline(always)]
    pub(super) fn renew_peaks(&mut self, columns: &Columns) {
        for range in columns.0.iter().filter(|range| range.start < range.end) {
            for tile in range.start / TILE..range.end.div_ceil(TILE) {
                let end = ((tile + 1) * TILE).min(self.ends.len());
                let ends = &self.ends[tile * TILE..end];
                self.peaks[tile] = ends.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            }
        }
    }

    /// Lowers one ray to `end`, if that is lower.
    #[inline(always)]
    pub(super) fn lower(&mut self, column: usize, end: f64, cut: &mut Cut) {
        let old = self.ends[column];
        if end < old {
            self.ends[column] = end;
            let weight = self.weight * self.layout.column_weight(column);
            cut.removed += (self.layout.content(old) - self.layout.content(end)) * weight;
            if old - end > NOISE {
                cut.depth = cut.depth.max(self.before[column] - end);
            }
        }
    }

    /// True if any material is left.
    pub(super) fn stands(&self) -> bool {
        self.ends.iter().any(|&end| end > self.layout.floor)
    }
}

/// Columns of a turn, as ranges that do not run over its end.
pub(super) struct Columns(pub(super) [Range<usize>; 2]);

impl Columns {
    /// Those within `half` of `angle`; all of them for half a turn and more [rad].
    #[inline(always)]
    pub(super) fn around(layout: &Layout, angle: f64, half: f64) -> Self {
        Self::between(layout, angle - half, angle + half)
    }

    /// Those from one angle to another, greater one [rad].
    #[inline(always)]
    pub(super) fn between(layout: &Layout, from: f64, to: f64) -> Self {
        let n = layout.n_columns_signed();
        let step = layout.across[1];
        // A hair more: a ray on the very border must not be lost to rounding.
        let first = (from / step - 1e-6).ceil() as i64;
        let last = (to / step + 1e-6).floor() as i64;
        if last < first {
            return Self([0..0, 0..0]);
        }
        if last - first + 1 >= n {
            return Self([0..n as usize, 0..0]);
        }
        let (start, length) = (first.rem_euclid(n), last - first + 1);
        let before_end = length.min(n - start);
        Self([start as usize..(start + before_end) as usize, 0..(length - before_end) as usize])
    }
}
