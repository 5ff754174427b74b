//! Roughing: from the block down to what finishing leaves for itself, layer by layer.
//!
//! One trajectory serves all layers. At each of its positions two heights are known exactly: where
//! the roughing tool, grown by the allowance, would stop on the part, and where it would stop on
//! the block. A layer brings the tool down to its level or to the part, whichever comes first; and
//! since the layer above did the same, no position is lowered by more than a layer is thick. Where
//! the tool would meet no stock, it is not sent: stock stands no higher than the layer above left
//! it, and no higher than the block.

use std::ops::Range;

/// Less than this is not worth a cut [mm].
const LEAST_CUT: f64 = 0.01;
/// Gaps of no more positions than this are cut through: lifting takes longer.
const BRIDGE: usize = 4;

/// How deep and how safe.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RoughOptions {
    /// What the tool may take at once, along the attack axis [mm].
    pub max_depth: f64,
    /// Between tool and stock on links [mm].
    pub clearance: f64,
    /// The least height the tool may go to: the table [mm].
    pub floor: f64,
}

/// Why nothing can be roughed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RoughError {
    /// The depth of cut is none.
    #[error("--max-depth is {0} mm; it must be a number above 0")]
    Depth(f64),
    /// More layers than anybody wants.
    #[error("{layers:.0} layers of {max_depth} mm are too many; take a greater --max-depth")]
    TooMany {
        /// How many it would take.
        layers: f64,
        /// The depth asked for [mm].
        max_depth: f64,
    },
    /// The block is no larger than the part with its allowance.
    #[error(
        "the block leaves nothing to rough: nowhere does it stand out of the part and its allowance"
    )]
    Nothing,
}

/// More layers than this are refused.
const MOST_LAYERS: f64 = 1000.0;

/// Cuts in their order, over the positions of one trajectory.
#[derive(Debug, Clone, PartialEq)]
pub struct Roughing<'a> {
    part: &'a [Option<f64>],
    /// The height of each layer, from the top down [mm].
    pub levels: Vec<f64>,
    /// The cuts of all layers.
    pub cuts: Vec<Cut>,
}

/// Positions cut in one go.
#[derive(Debug, Clone, PartialEq)]
pub struct Cut {
    /// Which layer it belongs to.
    pub layer: usize,
    /// The positions.
    pub positions: Range<usize>,
    /// The tool may come here as fast as it can from where the last cut ended, at this height [mm].
    pub link: f64,
    /// Down to this height over its first position it meets nothing [mm].
    pub above: f64,
}

impl<'a> Roughing<'a> {
    /// The cuts that bring a block down to the part.
    ///
    /// `part` and `block` are the heights at which the tool stops on either, position by position;
    /// a turn, a ring or a row is `per_row` positions long.
    pub fn new(
        part: &'a [Option<f64>],
        block: &[Option<f64>],
        per_row: usize,
        options: &RoughOptions,
    ) -> Result<Self, RoughError> {
        let levels = levels(part, block, options)?;
        let mut roughing = Self { part, levels, cuts: Vec::new() };
        let mut stock = block.to_vec();
        let mut from = None;
        for layer in 0..roughing.levels.len() {
            let is_cut =
                |i: usize| stock[i].is_some_and(|top| roughing.height(layer, i) + LEAST_CUT < top);
            let runs = runs(part.len(), is_cut);
            // Of before the layer: what it has cut itself is lower, which is the safe side.
            let (tops, n_cuts) = (Tops::new(&stock), roughing.cuts.len());
            for positions in runs {
                let lead = from.unwrap_or(positions.start);
                let rows = lead.min(positions.start).saturating_sub(per_row)
                    ..(lead.max(positions.start) + per_row + 1).min(part.len());
                let link = tops.highest(rows).unwrap_or(f64::NEG_INFINITY) + options.clearance;
                let top = tops.highest(positions.start..positions.start + 1);
                let above = top.unwrap_or(link).min(link - options.clearance) + options.clearance;
                from = Some(positions.end - 1);
                roughing.cuts.push(Cut { layer, positions, link, above });
            }
            for i in roughing.cuts[n_cuts..].iter().flat_map(|cut| cut.positions.clone()) {
                stock[i] = stock[i].map(|top| top.min(roughing.height(layer, i)));
            }
        }
        if roughing.cuts.is_empty() { Err(RoughError::Nothing) } else { Ok(roughing) }
    }

    /// Where the tool goes at a position in a layer [mm].
    pub fn height(&self, layer: usize, i: usize) -> f64 {
        self.levels[layer].max(part_or_low(self.part[i]))
    }

    /// Does the tool stop on the part there, rather than at the layer's level?
    pub fn is_on_part(&self, layer: usize, i: usize) -> bool {
        self.part[i].is_some_and(|height| self.levels[layer] <= height)
    }
}

fn part_or_low(height: Option<f64>) -> f64 {
    height.unwrap_or(f64::NEG_INFINITY)
}

/// The heights of the layers: evenly from the top of the block to the lowest place of the part.
fn levels(
    part: &[Option<f64>],
    block: &[Option<f64>],
    options: &RoughOptions,
) -> Result<Vec<f64>, RoughError> {
    let max_depth = options.max_depth;
    if !(max_depth > 0.0 && max_depth.is_finite()) {
        return Err(RoughError::Depth(max_depth));
    }
    let top = block.iter().flatten().copied().fold(f64::NEG_INFINITY, f64::max);
    let lowest = part.iter().flatten().copied().fold(f64::INFINITY, f64::min).max(options.floor);
    let stands_out = lowest + LEAST_CUT < top;
    if !stands_out {
        return Err(RoughError::Nothing);
    }
    let layers = ((top - lowest) / max_depth).ceil();
    if layers > MOST_LAYERS {
        return Err(RoughError::TooMany { layers, max_depth });
    }
    Ok((1..=layers as usize).map(|k| top - (top - lowest) * k as f64 / layers).collect())
}

/// The runs of positions that are cut, small gaps bridged.
fn runs(n: usize, is_cut: impl Fn(usize) -> bool) -> Vec<Range<usize>> {
    let mut runs: Vec<Range<usize>> = Vec::new();
    for i in (0..n).filter(|&i| is_cut(i)) {
        match runs.last_mut() {
            Some(run) if i <= run.end + BRIDGE => run.end = i + 1,
            _ => runs.push(i..i + 1),
        }
    }
    // The tool comes from where nothing is cut and goes there.
    for run in &mut runs {
        *run = run.start.saturating_sub(1)..(run.end + 1).min(n);
    }
    runs
}

/// The highest of any stretch of heights, found in no time: a table of stretches of every power of
/// two.
struct Tops(Vec<Vec<f64>>);

impl Tops {
    fn new(heights: &[Option<f64>]) -> Self {
        let mut rows: Vec<Vec<f64>> =
            vec![heights.iter().map(|&height| part_or_low(height)).collect()];
        let mut width = 1;
        while 2 * width <= heights.len() {
            let last = &rows[rows.len() - 1];
            let next = last.iter().zip(&last[width..]).map(|(a, b)| a.max(*b)).collect();
            rows.push(next);
            width *= 2;
        }
        Self(rows)
    }

    /// `None` if nothing stands there.
    fn highest(&self, range: Range<usize>) -> Option<f64> {
        let row = range.len().checked_ilog2()? as usize;
        let heights = &self.0[row];
        let top = heights[range.start].max(heights[range.end - (1 << row)]);
        (top > f64::NEG_INFINITY).then_some(top)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    const OPTIONS: RoughOptions =
        RoughOptions { max_depth: 4.0, clearance: 2.0, floor: f64::NEG_INFINITY };

    /// Hills of a part, a block above most of them, and here and there neither.
    fn random_heights(seed: u64) -> (Vec<Option<f64>>, Vec<Option<f64>>) {
        let mut random = Pcg64Mcg::seed_from_u64(seed);
        let hill: [f64; 3] = [0; 3].map(|_| random.random_range(0.005..0.05));
        let height = |i: usize| {
            let at = i as f64;
            50.0 + 10.0 * (hill[0] * at).sin() + 6.0 * (hill[1] * at).cos() + (hill[2] * at).sin()
        };
        let part = (0..3000).map(|i| (i % 397 != 3).then(|| height(i))).collect();
        let block = (0..3000).map(|i| (i % 600 > 80).then_some(63.0 + f64::from(i % 7))).collect();
        (part, block)
    }

    /// Follows the cuts; the stock they leave.
    fn follow(
        roughing: &Roughing,
        block: &[Option<f64>],
        mut each: impl FnMut(&Cut, usize, f64, Option<f64>),
    ) -> Vec<Option<f64>> {
        let mut stock = block.to_vec();
        for cut in &roughing.cuts {
            for i in cut.positions.clone() {
                let height = roughing.height(cut.layer, i);
                each(cut, i, height, stock[i]);
                stock[i] = stock[i].map(|top| top.min(height));
            }
        }
        stock
    }

    #[test]
    fn no_cut_is_deeper_than_asked_and_none_goes_into_the_part() {
        for seed in 0..20 {
            let (part, block) = random_heights(seed);
            let roughing = Roughing::new(&part, &block, 60, &OPTIONS).unwrap();
            let left = follow(&roughing, &block, |_, i, height, stock| {
                let depth = stock.map_or(0.0, |top| top - height);
                assert!(depth <= OPTIONS.max_depth + 1e-9, "{depth} mm deep at {i}");
                assert!(part[i].is_none_or(|part| part <= height), "into the part at {i}");
            });
            for (i, left) in left.iter().enumerate() {
                if let (Some(left), Some(part)) = (left, part[i]) {
                    assert!(*left <= part + LEAST_CUT, "{left} left on {part} at {i}");
                }
            }
        }
    }

    #[test]
    fn hardly_a_position_meets_nothing() {
        for seed in 0..20 {
            let (part, block) = random_heights(seed);
            let roughing = Roughing::new(&part, &block, 60, &OPTIONS).unwrap();
            let (mut n, mut n_air) = (0, 0);
            follow(&roughing, &block, |_, _, height, stock| {
                n += 1;
                n_air += usize::from(stock.is_none_or(|top| top - height < LEAST_CUT));
            });
            assert!(n_air * 100 < 12 * n, "{n_air} of {n}");
        }
    }

    #[test]
    fn links_stay_above_all_that_stands_between_two_cuts() {
        for seed in 0..20 {
            let (part, block) = random_heights(seed);
            let roughing = Roughing::new(&part, &block, 60, &OPTIONS).unwrap();
            let mut stock = block.clone();
            let mut last: Option<Cut> = None;
            for cut in &roughing.cuts {
                let start = cut.positions.start;
                let lead = last.map_or(start, |last| last.positions.end - 1);
                let near =
                    lead.min(start).saturating_sub(60)..(lead.max(start) + 61).min(stock.len());
                let is_clear = |top: &f64| top + 1.999 <= cut.link;
                assert!(stock[near].iter().flatten().all(is_clear), "link to {start}");
                assert!(stock[start].is_none_or(|top| top + 1.999 <= cut.above));
                assert!(cut.above <= cut.link);
                for i in cut.positions.clone() {
                    stock[i] = stock[i].map(|top| top.min(roughing.height(cut.layer, i)));
                }
                last = Some(cut.clone());
            }
        }
    }

    #[test]
    fn what_cannot_be_roughed_is_refused() {
        let (part, block) = random_heights(1);
        let error = |options| Roughing::new(&part, &block, 60, &options).unwrap_err().to_string();
        assert!(error(RoughOptions { max_depth: 0.0, ..OPTIONS }).contains("--max-depth is 0 mm"));
        assert!(error(RoughOptions { max_depth: 1e-3, ..OPTIONS }).contains("are too many"));
        let small = vec![Some(20.0); part.len()];
        let error = Roughing::new(&part, &small, 60, &OPTIONS).unwrap_err();
        assert_eq!(error, RoughError::Nothing);
    }
}
