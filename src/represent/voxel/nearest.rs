//! The point of each cell that is nearest to their mean.

use super::sums::CellSum;
use crate::geom::{Cells, CloudParts, PartError, Point3};
use crate::progress::Progress;
use rayon::prelude::*;

/// Puts the nearest point of its cell in the place of each mean; the first of equals.
pub(super) fn to_nearest(
    means: &mut [Point3],
    sums: &[CellSum],
    parts: &mut dyn CloudParts,
    cells: &Cells,
    progress: &dyn Progress,
) -> Result<(), PartError> {
    progress.start("looking for the nearest points", parts.n_points());
    let mut nearest: Vec<(f64, Point3)> = means.iter().map(|mean| (f64::INFINITY, *mean)).collect();
    let centroids: &[Point3] = means;
    parts.each_part(&mut |part| {
        let look = |point: &Point3| {
            let i = rank(sums, cells.key(point))?;
            Some((i, (point - centroids[i]).norm_squared()))
        };
        let found: Vec<Option<(usize, f64)>> = part.points.par_iter().map(look).collect();
        for ((i, square), point) in
            found.iter().zip(part.points).filter_map(|(f, p)| Some(((*f)?, p)))
        {
            if square < nearest[i].0 {
                nearest[i] = (square, *point);
            }
        }
        Ok(progress.advance(part.points.len() as u64)?)
    })?;
    for (place, (_, point)) in means.iter_mut().zip(nearest) {
        *place = point;
    }
    Ok(())
}

/// Where a cell is among the sums.
pub(super) fn rank(sums: &[CellSum], key: u64) -> Option<usize> {
    sums.binary_search_by_key(&key, |sum| sum.key).ok()
}
