//! How much of a ridge dexels may miss.

use crate::stock::Stock;

/// This share of the rays must not decide: the ends of the part are steps, not ridges.
const SHARE: f64 = 0.99;

/// Ridges along the rows may stand higher between two rays than either shows, by no more than this
/// on 99 % of the rays [mm].
///
/// Between two straight flanks the peak lies no higher over its neighbours than half the bend it
/// makes there, the second difference of the rays.
pub(super) fn ridge_error(stock: &Stock) -> f64 {
    let layout = stock.layout();
    let mut bends = Vec::new();
    for row in 1..layout.n_rows().saturating_sub(1) {
        for column in 0..layout.n_columns() {
            let ends = [row - 1, row, row + 1].map(|row| stock.end(row, column));
            if let [Some(before), Some(here), Some(after)] = ends {
                bends.push((2.0 * here - before - after).max(0.0));
            }
        }
    }
    if bends.is_empty() {
        return 0.0;
    }
    let place = ((bends.len() - 1) as f64 * SHARE) as usize;
    let (_, bend, _) = bends.select_nth_unstable_by(place, f64::total_cmp);
    *bend / 2.0
}
