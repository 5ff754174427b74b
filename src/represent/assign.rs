//! Which representative each point of a cloud is nearest to.

use crate::geom::{CloudPart, CloudParts, KdTree, Nearest, Neighbour, PartError, Point3};
use crate::progress::Progress;
use rayon::prelude::*;

/// Points looked up at a time.
const CHUNK: usize = 1 << 18;

/// Hands every point of the cloud to `take`, in order, with its nearest of `places`; there is at least one.
pub(super) fn assign(
    parts: &mut dyn CloudParts,
    places: &[Point3],
    progress: &dyn Progress,
    take: &mut dyn FnMut(CloudPart<'_>, &[Neighbour]),
) -> Result<(), PartError> {
    let tree = KdTree::build(places);
    let mut found: Vec<Neighbour> = Vec::new();
    parts.each_part(&mut |part| {
        for begin in (0..part.points.len()).step_by(CHUNK) {
            let chunk = part.range(begin, CHUNK);
            let nearest = |point: &Point3| {
                // No more than one: there is a place, and every point is within reach of it.
                tree.nearest(point, f64::INFINITY).unwrap_or(Neighbour { index: 0, distance: 0.0 })
            };
            chunk.points.par_iter().map(nearest).collect_into_vec(&mut found);
            take(chunk, &found);
            progress.advance(chunk.points.len() as u64)?;
        }
        Ok(())
    })
}
