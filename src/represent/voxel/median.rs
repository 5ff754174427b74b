//! The median of the points of each cell.

use super::nearest::rank;
use super::sums::CellSum;
use crate::geom::{Cells, CloudParts, PartError, Point3};
use crate::progress::Progress;
use rayon::prelude::*;
use std::ops::Range;

/// Points of cells that are held together, unless one cell has more.
const HELD: u64 = 1 << 24;

/// Puts the median of its cell, coordinate by coordinate, in the place of each mean. Of a cloud that is
/// larger than what is held some cells are looked at in each pass.
pub(super) fn to_median(
    means: &mut [Point3],
    sums: &[CellSum],
    parts: &mut dyn CloudParts,
    cells: &Cells,
    progress: &dyn Progress,
) -> Result<(), PartError> {
    let groups = groups(sums, HELD);
    progress.start("looking for medians", groups.len() as u64 * parts.n_points());
    for group in groups {
        let mut held: Vec<(usize, Point3)> = Vec::new();
        parts.each_part(&mut |part| {
            let of_group = |point: &Point3| {
                let i = rank(sums, cells.key(point)).filter(|i| group.contains(i))?;
                Some((i, *point))
            };
            held.par_extend(part.points.par_iter().filter_map(of_group));
            Ok(progress.advance(part.points.len() as u64)?)
        })?;
        held.par_sort_by_key(|(i, _)| *i);
        for run in held.chunk_by(|a, b| a.0 == b.0) {
            means[run[0].0] =
                Point3::from([0, 1, 2].map(|k| median(run.iter().map(|(_, p)| p[k]))));
        }
    }
    Ok(())
}

/// Neighbouring cells that together have no more than `most` points.
fn groups(sums: &[CellSum], most: u64) -> Vec<Range<usize>> {
    let mut groups = Vec::new();
    let (mut begin, mut n_points) = (0, 0);
    for (i, sum) in sums.iter().enumerate() {
        if begin < i && most < n_points + sum.n {
            groups.push(begin..i);
            (begin, n_points) = (i, 0);
        }
        n_points += sum.n;
    }
    groups.push(begin..sums.len());
    groups
}

/// The middle one, or the mean of the two.
fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    let half = values.len() / 2;
    let is_even = values.len().is_multiple_of(2);
    let (below, middle, _) = values.select_nth_unstable_by(half, f64::total_cmp);
    if is_even {
        let before = below.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        f64::midpoint(before, *middle)
    } else {
        *middle
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Vector3;

    #[test]
    fn the_median_is_in_the_middle() {
        assert_eq!(median([5.0, 1.0, 9.0].into_iter()), 5.0);
        assert_eq!(median([5.0, 1.0, 9.0, 6.0].into_iter()), 5.5);
        assert_eq!(median([7.0].into_iter()), 7.0);
    }

    #[test]
    fn groups_hold_no_more_than_they_may_unless_a_cell_does() {
        let cell = |n| CellSum { key: 0, n, shift: Vector3::zeros(), normal: None, color: None };
        let sums = [3, 4, 9, 1, 1, 1].map(cell);
        assert_eq!(groups(&sums, 7), [0..2, 2..3, 3..6]);
    }
}
