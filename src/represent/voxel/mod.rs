//! One point for each cell of a grid, or as many points as asked for.
//!
//! [M] and PCL call the result a voxel grid if the points are centroids; other points of a cell may stand for it
//! too: [`Rule`]. A corner of the grid lies in the middle of the cloud's box.

mod count;
mod median;
mod nearest;
mod sums;

pub use count::Reached;

use crate::geom::{
    Aabb, Cells, CloudParts, PartError, Point3, PointCloud, VoxelError, box_of_parts,
};
use crate::progress::{Cancelled, Progress};
use clap::ValueEnum;
use serde::{Deserialize, Serialize};
pub(super) use sums::{CellSum, cell_sums};

/// Which point stands for a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Rule {
    /// The middle of the cell.
    Centre,
    /// The mean of the points in it.
    Centroid,
    /// That of the points in it which is nearest to their mean.
    Nearest,
    /// The median of the points in it, coordinate by coordinate.
    Median,
}

/// How many cells there are to be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CellSize {
    /// As many as come of this side [mm].
    Side(f64),
    /// As near to this many as can be reached.
    Count(u64),
}

/// A cloud with a point for each cell.
#[derive(Debug, Clone, PartialEq)]
pub struct VoxelCloud {
    /// The points, in the order of the cells; normals and colours are means.
    pub cloud: PointCloud,
    /// The cells.
    pub cells: Cells,
    /// How their size was found, if it was looked for.
    pub reached: Option<Reached>,
}

/// Why a cloud could not be put into cells.
#[derive(Debug, thiserror::Error)]
pub enum ReduceError {
    /// There is nothing to reduce.
    #[error("the cloud has no points: there is nothing to reduce")]
    Empty,
    /// Nothing was asked for.
    #[error("0 points were asked for; give a count of at least 1")]
    NoCount,
    /// More points than there are.
    #[error("{count} points were asked for, but the cloud has only {n_points}; ask for fewer")]
    TooMany {
        /// Points asked for.
        count: u64,
        /// Points there are.
        n_points: u64,
    },
    /// The cells.
    #[error(transparent)]
    Voxel(#[from] VoxelError),
    /// The cloud could not be gone through.
    #[error(transparent)]
    Part(#[from] PartError),
    /// The caller asked to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// A point for each cell that has any.
pub fn voxel_grid(
    parts: &mut dyn CloudParts,
    size: CellSize,
    rule: Rule,
    progress: &dyn Progress,
) -> Result<VoxelCloud, ReduceError> {
    let (cells, reached) = cells_for(parts, size, progress)?;
    progress.start("sorting into cells", parts.n_points());
    let sums = cell_sums(parts, &cells, progress)?;
    let mean = |sum: &CellSum| cells.middle(sum.key) + sum.shift / sum.n as f64;
    let mut points: Vec<Point3> = sums.iter().map(mean).collect();
    match rule {
        Rule::Centroid => {}
        Rule::Centre => points = sums.iter().map(|sum| cells.middle(sum.key)).collect(),
        Rule::Nearest => nearest::to_nearest(&mut points, &sums, parts, &cells, progress)?,
        Rule::Median => median::to_median(&mut points, &sums, parts, &cells, progress)?,
    }
    let cloud = CellSum::cloud_of(points, sums.iter());
    Ok(VoxelCloud { cloud, cells, reached })
}

/// The cells for a cloud.
pub(super) fn cells_for(
    parts: &mut dyn CloudParts,
    size: CellSize,
    progress: &dyn Progress,
) -> Result<(Cells, Option<Reached>), ReduceError> {
    let n_points = parts.n_points();
    match size {
        _ if n_points == 0 => return Err(ReduceError::Empty),
        CellSize::Count(0) => return Err(ReduceError::NoCount),
        CellSize::Count(count) if n_points < count => {
            return Err(ReduceError::TooMany { count, n_points });
        }
        _ => {}
    }
    let aabb = box_of_parts(parts)?;
    match size {
        CellSize::Side(side) => Ok((cells_about(&aabb, side)?, None)),
        CellSize::Count(count) => {
            let (cells, reached) = count::cells_of_count(parts, &aabb, count, progress)?;
            Ok((cells, Some(reached)))
        }
    }
}

fn cells_about(aabb: &Aabb, side: f64) -> Result<Cells, VoxelError> {
    let middle: Point3 = aabb.center();
    Cells::new(middle, side, aabb.size().max() / 2.0)
}

#[cfg(test)]
mod tests;
