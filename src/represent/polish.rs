//! Representatives brought to the middle of the points they stand for.

use super::assign::assign;
use super::mean_error::{Distances, MeanError};
use crate::geom::{CloudParts, KdTree, Nearest, PartError, Point3, PointCloud, Vector3};
use crate::progress::Progress;
use clap::ValueEnum;
use serde::{Deserialize, Serialize};

/// How representatives are brought to the middle of their points.
#[derive(Debug, Clone, Copy, PartialEq, clap::Args, Serialize, Deserialize)]
#[serde(default, rename_all = "kebab-case", deny_unknown_fields)]
pub struct PolishOptions {
    /// Sweeps in which each representative goes to the middle of the points nearest to it.
    #[arg(long = "polish", value_name = "N", default_value_t = Self::default().sweeps)]
    pub sweeps: u32,
    /// Which middle.
    #[arg(long = "polish-to", value_name = "MIDDLE", default_value = "median")]
    pub middle: Middle,
}

/// The middle of some points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Middle {
    /// Their mean: squares of distances become least. Lloyd (1982).
    Mean,
    /// Their geometric median, a step towards it each sweep: distances become least, and with them the mean
    /// error. Weiszfeld (1937).
    Median,
}

impl Default for PolishOptions {
    fn default() -> Self {
        Self { sweeps: 0, middle: Middle::Median }
    }
}

/// Sums over the points a representative stands for.
#[derive(Debug, Clone, Copy, Default)]
struct Share {
    n: u32,
    weight: f64,
    shift: Vector3,
    normal: Vector3,
    color: [u64; 3],
}

/// Sweeps through the cloud as `options` say, then once more: representatives get the mean normal and colour of the
/// points that each stands for, and how far off those are is told. One that no point is nearest to stays where it
/// is.
pub fn polish(
    representatives: &mut PointCloud,
    parts: &mut dyn CloudParts,
    options: &PolishOptions,
    progress: &dyn Progress,
) -> Result<Option<MeanError>, PartError> {
    if representatives.points.is_empty() || parts.n_points() == 0 {
        return Ok(None);
    }
    if 0 < options.sweeps {
        progress.start("polishing", u64::from(options.sweeps) * parts.n_points());
    }
    for _ in 0..options.sweeps {
        let places = &mut representatives.points;
        let (shares, _) = share(parts, places, options.middle, progress)?;
        for (place, share) in places.iter_mut().zip(&shares).filter(|(_, share)| 0 < share.n) {
            *place += share.shift / share.weight;
        }
    }
    progress.start("measuring", parts.n_points());
    let (mut shares, looks) = share(parts, &representatives.points, options.middle, progress)?;
    lend(&mut shares, &representatives.points);
    representatives.normals = looks.has_normals.then(|| {
        shares.iter().map(|s| s.normal.try_normalize(1e-9).unwrap_or_else(Vector3::z)).collect()
    });
    representatives.colors = looks.has_colors.then(|| shares.iter().map(Share::color).collect());
    Ok(looks.distances.finish())
}

/// What was seen in a sweep.
#[derive(Debug, Default)]
struct Looks {
    distances: Distances,
    has_normals: bool,
    has_colors: bool,
}

fn share(
    parts: &mut dyn CloudParts,
    places: &[Point3],
    middle: Middle,
    progress: &dyn Progress,
) -> Result<(Vec<Share>, Looks), PartError> {
    let mut shares = vec![Share::default(); places.len()];
    let mut looks = Looks::default();
    assign(parts, places, progress, &mut |part, found| {
        looks.has_normals = part.normals.is_some();
        looks.has_colors = part.colors.is_some();
        for (i, (point, neighbour)) in part.points.iter().zip(found).enumerate() {
            looks.distances.take(neighbour.distance);
            let share = &mut shares[neighbour.index as usize];
            let shift = point - places[neighbour.index as usize];
            let weight = match middle {
                Middle::Mean => 1.0,
                // A point at the very place would hold it there.
                Middle::Median => 1.0 / shift.norm().max(NEAREST),
            };
            share.n += 1;
            share.weight += weight;
            share.shift += shift * weight;
            if let Some(normals) = part.normals {
                share.normal += normals[i];
            }
            if let Some(colors) = part.colors {
                for (sum, color) in share.color.iter_mut().zip(colors[i]) {
                    *sum += u64::from(color);
                }
            }
        }
    })?;
    Ok((shares, looks))
}

/// Who stands for no point looks like the nearest that does.
fn lend(shares: &mut [Share], places: &[Point3]) {
    let (empty, full): (Vec<usize>, Vec<usize>) =
        (0..shares.len()).partition(|&i| shares[i].n == 0);
    if empty.is_empty() || full.is_empty() {
        return;
    }
    let tree = KdTree::build(&full.iter().map(|&i| places[i]).collect::<Vec<_>>());
    for i in empty {
        if let Some(near) = tree.nearest(&places[i], f64::INFINITY) {
            shares[i] = shares[full[near.index as usize]];
        }
    }
}

/// Points nearer than this weigh no more than at this distance [mm].
const NEAREST: f64 = 1e-6;

impl Share {
    fn color(&self) -> [u8; 3] {
        let n = u64::from(self.n.max(1));
        self.color.map(|sum| ((sum + n / 2) / n) as u8)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::progress::Silent;

    fn cloud(xs: &[f64]) -> PointCloud {
        PointCloud {
            points: xs.iter().map(|x| Point3::new(*x, 0.0, 0.0)).collect(),
            normals: Some(vec![Vector3::y(); xs.len()]),
            colors: Some(xs.iter().map(|x| [*x as u8, 10, 0]).collect()),
        }
    }

    fn polished(at: &[f64], xs: &[f64], options: PolishOptions) -> (PointCloud, MeanError) {
        let mut few = PointCloud { points: cloud(at).points, ..PointCloud::default() };
        let error = polish(&mut few, &mut &cloud(xs), &options, &Silent).unwrap().unwrap();
        (few, error)
    }

    #[test]
    fn a_sweep_to_the_mean_ends_in_the_middle_of_the_nearest_points() {
        let options = PolishOptions { sweeps: 1, middle: Middle::Mean };
        let (few, error) = polished(&[1.0, 9.0], &[0.0, 2.0, 3.0, 10.0, 12.0], options);
        let xs: Vec<f64> = few.points.iter().map(|p| p.x).collect();
        assert!((xs[0] - 5.0 / 3.0).abs() < 1e-6 && (xs[1] - 11.0).abs() < 1e-6, "{xs:?}");
        assert!((error.mean - (5.0 / 3.0 + 1.0 / 3.0 + 4.0 / 3.0 + 2.0) / 5.0).abs() < 1e-5);
        assert_eq!(few.colors, Some(vec![[2, 10, 0], [11, 10, 0]]));
        assert_eq!(few.normals, Some(vec![Vector3::y(); 2]));
    }

    #[test]
    fn sweeps_to_the_median_leave_a_lone_point_behind() {
        let options = PolishOptions { sweeps: 60, middle: Middle::Median };
        let (few, _) = polished(&[3.0], &[0.0, 1.0, 2.0, 3.0, 40.0], options);
        assert!((few.points[0].x - 2.0).abs() < 0.05, "{}", few.points[0].x);
    }

    #[test]
    fn one_that_stands_for_nothing_stays() {
        let options = PolishOptions { sweeps: 3, middle: Middle::Mean };
        let (few, _) = polished(&[0.0, 500.0], &[0.0, 1.0], options);
        assert_eq!(few.points[1].x, 500.0);
        assert_eq!(few.colors.unwrap()[1], [1, 10, 0], "it looks like its neighbour");
    }
}
