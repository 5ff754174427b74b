//! The size of the cells for a number of points.

use super::{ReduceError, cells_about};
use crate::geom::{Aabb, Cells, CloudParts, PartError};
use crate::progress::Progress;
use rayon::prelude::*;

/// How a size was looked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
pub struct Reached {
    /// Points asked for.
    pub asked: u64,
    /// Points there are.
    pub count: u64,
    /// True if that is within half a percent.
    pub is_near: bool,
}

/// A count this near, as a share, is near enough.
const NEAR: f64 = 0.005;
/// Sizes tried at most.
const MOST_TRIES: usize = 40;
/// Sizes that differ by less, as a share, are the same.
const SAME: f64 = 1e-6;
/// Cells sorted at a time.
const CHUNK: usize = 1 << 22;

/// The cells that make as near to `count` points as can be: the count falls about with the square of the side, so
/// the next side is where the power law through the ends of the bracket says, or their mean where that hardly
/// narrows it.
pub(super) fn cells_of_count(
    parts: &mut dyn CloudParts,
    aabb: &Aabb,
    count: u64,
    progress: &dyn Progress,
) -> Result<(Cells, Reached), ReduceError> {
    let extent = aabb.size().max();
    if extent == 0.0 {
        let cells = cells_about(aabb, 1.0)?;
        return Ok((cells, Reached::at(1, count)));
    }
    let widest = 4.0 * extent;
    let mut low = (extent / f64::from(1_u32 << 19), parts.n_points());
    let mut high = (widest, 1);
    let mut side = (extent / (count as f64).sqrt()).clamp(low.0, high.0);
    let mut best: Option<(Cells, u64)> = None;
    progress.start("looking for the size", MOST_TRIES as u64);
    for i_try in 0..MOST_TRIES {
        let cells = cells_about(aabb, side)?;
        let n = n_cells(parts, &cells)?;
        progress.advance(1)?;
        progress.tell(&format!("{side:.4} mm: {n} cells"));
        if best.is_none_or(|(_, before)| n.abs_diff(count) < before.abs_diff(count)) {
            best = Some((cells, n));
        }
        let bracket = if n < count { &mut high } else { &mut low };
        *bracket = (side, n);
        let is_narrow = high.0 < low.0 * (1.0 + SAME);
        if Reached::at(n, count).is_near || is_narrow {
            break;
        }
        side = next_side(low, high, count, i_try % 3 == 2);
    }
    let Some((cells, n)) = best else { return Err(ReduceError::Empty) };
    Ok((cells, Reached::at(n, count)))
}

fn next_side(low: (f64, u64), high: (f64, u64), count: u64, halve: bool) -> f64 {
    let middle = (low.0 * high.0).sqrt();
    let [n_low, n_high, n] = [low.1, high.1, count].map(|n| (n as f64).ln());
    if halve || n_low <= n_high {
        return middle;
    }
    let share = ((n_low - n) / (n_low - n_high)).clamp(0.02, 0.98);
    (low.0.ln() * (1.0 - share) + high.0.ln() * share).exp()
}

impl Reached {
    fn at(count: u64, asked: u64) -> Self {
        let is_near = count.abs_diff(asked) as f64 <= NEAR * asked as f64;
        Self { asked, count, is_near }
    }
}

/// How many cells have points.
fn n_cells(parts: &mut dyn CloudParts, cells: &Cells) -> Result<u64, PartError> {
    let mut all: Vec<u64> = Vec::new();
    parts.each_part(&mut |part| {
        for chunk in part.points.chunks(CHUNK) {
            let mut keys: Vec<u64> = chunk.par_iter().map(|point| cells.key(point)).collect();
            keys.par_sort_unstable();
            keys.dedup();
            all.extend(keys);
            // Runs that are sorted already merge quickly.
            all.par_sort();
            all.dedup();
        }
        Ok(())
    })?;
    Ok(all.len() as u64)
}
