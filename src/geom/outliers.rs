//! Points of a cloud that belong to no surface.

use super::{KdTree, Point3, PointCloud};
use crate::progress::{Cancelled, Progress};
use clap::ValueEnum;
use serde::{Deserialize, Serialize};

/// What is taken for an outlier of a cloud.
#[derive(Debug, Clone, PartialEq, clap::Args, Serialize, Deserialize)]
#[serde(default, rename_all = "kebab-case")]
pub struct OutlierFilter {
    /// What is taken for an outlier, and left out.
    #[arg(long, value_enum, default_value_t = Self::default().outliers)]
    pub outliers: OutlierKind,
    /// Neighbours that a point is judged by.
    #[arg(long, value_name = "N", default_value_t = Self::default().outlier_neighbours)]
    pub outlier_neighbours: usize,
    /// For `statistical`: by how many standard deviations neighbours may be farther off than they are
    /// from other points.
    #[arg(long, value_name = "SIGMAS", default_value_t = Self::default().outlier_sigma)]
    pub outlier_sigma: f64,
    /// For `radius`: how far off as many neighbours may be [mm; default: 4 voxels].
    #[arg(long, value_name = "MM")]
    pub outlier_radius: Option<f64>,
}

/// What is taken for an outlier.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum OutlierKind {
    /// Nothing.
    None,
    /// A point whose neighbours are much farther off, on the mean, than those of others. Rusu et al.
    /// (2008).
    Statistical,
    /// A point without enough neighbours around it.
    Radius,
}

impl Default for OutlierFilter {
    fn default() -> Self {
        let outliers = OutlierKind::Statistical;
        Self { outliers, outlier_neighbours: 16, outlier_sigma: 2.0, outlier_radius: None }
    }
}

impl OutlierFilter {
    /// The cloud without its outliers, and how many there were. `radius` is what [`OutlierKind::Radius`]
    /// goes by if no other was asked for [mm]. The points must be finite.
    pub fn apply(
        &self,
        cloud: PointCloud,
        radius: f64,
        progress: &dyn Progress,
    ) -> Result<(PointCloud, usize), Cancelled> {
        if self.outliers == OutlierKind::None || cloud.points.len() <= self.outlier_neighbours {
            return Ok((cloud, 0));
        }
        progress.start("outliers", cloud.points.len() as u64);
        let tree = KdTree::build(&cloud.points);
        let stays = match self.outliers {
            OutlierKind::None => return Ok((cloud, 0)),
            OutlierKind::Statistical => self.near_enough(&cloud.points, &tree, progress)?,
            OutlierKind::Radius => {
                let radius = self.outlier_radius.unwrap_or(radius);
                // The point itself is the first of its neighbours.
                let k = self.outlier_neighbours + 1;
                let is_crowded = |_: usize, found: &[super::Neighbour]| {
                    found.len() == k && found.last().is_some_and(|last| last.distance <= radius)
                };
                tree.map_neighbourhoods(&cloud.points, k, progress, is_crowded)?
            }
        };
        let n_outliers = stays.iter().filter(|stays| !**stays).count();
        Ok((kept(&cloud, &stays), n_outliers))
    }

    /// True of points whose neighbours are no farther off, on the mean, than the limit.
    fn near_enough(
        &self,
        points: &[Point3],
        tree: &KdTree,
        progress: &dyn Progress,
    ) -> Result<Vec<bool>, Cancelled> {
        let k = self.outlier_neighbours;
        let mean = |_: usize, found: &[super::Neighbour]| {
            found.iter().map(|neighbour| neighbour.distance).sum::<f64>() / k as f64
        };
        let means = tree.map_neighbourhoods(points, k + 1, progress, mean)?;
        let n = means.len() as f64;
        let mean = means.iter().sum::<f64>() / n;
        let variance = means.iter().map(|own| (own - mean).powi(2)).sum::<f64>() / n;
        let limit = mean + self.outlier_sigma * variance.sqrt();
        Ok(means.iter().map(|own| *own <= limit).collect())
    }
}

/// The points that stay, with all they have.
fn kept(cloud: &PointCloud, stays: &[bool]) -> PointCloud {
    fn of<T: Clone>(all: &[T], stays: &[bool]) -> Vec<T> {
        all.iter().zip(stays).filter(|(_, stays)| **stays).map(|(one, _)| one.clone()).collect()
    }
    PointCloud {
        points: of(&cloud.points, stays),
        normals: cloud.normals.as_ref().map(|all| of(all, stays)),
        colors: cloud.colors.as_ref().map(|all| of(all, stays)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::progress::Silent;

    /// A plane of 20 x 20 points a millimetre apart, and three that hang before it.
    fn cloud() -> PointCloud {
        let plane = (0..400).map(|i| Point3::new(f64::from(i % 20), f64::from(i / 20), 0.0));
        let stray = [[5.0, 5.0, 9.0], [12.0, 3.0, -14.0], [40.0, 0.0, 0.0]].map(Point3::from);
        let points: Vec<Point3> = plane.chain(stray).collect();
        let colors = (0..points.len()).map(|i| [(i % 256) as u8; 3]).collect();
        PointCloud { points, normals: None, colors: Some(colors) }
    }

    #[test]
    fn points_that_hang_in_the_air_are_left_out_and_planes_are_kept_whole() {
        for outliers in [OutlierKind::Statistical, OutlierKind::Radius] {
            let filter =
                OutlierFilter { outliers, outlier_neighbours: 5, ..OutlierFilter::default() };
            let (left, n_outliers) = filter.apply(cloud(), 2.5, &Silent).unwrap();
            assert_eq!(n_outliers, 3, "{outliers:?}");
            assert_eq!(left.points, cloud().points[..400], "{outliers:?}");
            assert_eq!(left.colors.unwrap().len(), 400);
        }
    }

    #[test]
    fn nothing_is_left_out_where_nothing_is_asked_for_and_of_next_to_nothing() {
        let none = OutlierFilter { outliers: OutlierKind::None, ..OutlierFilter::default() };
        assert_eq!(none.apply(cloud(), 1.0, &Silent).unwrap(), (cloud(), 0));
        let few = PointCloud { points: vec![Point3::origin(); 3], ..PointCloud::default() };
        assert_eq!(OutlierFilter::default().apply(few.clone(), 1.0, &Silent).unwrap(), (few, 0));
    }
}
