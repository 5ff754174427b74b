//! How far a cloud is from what stands for it.

use super::assign::assign;
use crate::geom::{CloudParts, PartError, Point3};
use crate::progress::{Cancelled, Progress};
use serde::Serialize;

/// Distances from the points of a cloud to the nearest representative [mm].
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct MeanError {
    /// How many points the cloud has.
    pub n_points: u64,
    /// Their mean: Morell (2014), eq. 3.5.
    pub mean: f64,
    /// Root of the mean square.
    pub rms: f64,
    /// Half of the points are no farther; to a thousandth of the distance, as all percentiles.
    pub median: f64,
    /// 90 of 100 are no farther.
    pub percentile_90: f64,
    /// 95 of 100 are no farther.
    pub percentile_95: f64,
    /// 99 of 100 are no farther.
    pub percentile_99: f64,
    /// The farthest.
    pub max: f64,
}

/// Why no mean error can be told.
#[derive(Debug, thiserror::Error)]
pub enum MeanErrorError {
    /// Nothing stands for the cloud.
    #[error("the reduced cloud has no points: nothing is near to anything")]
    NoRepresentatives,
    /// Nothing to stand for.
    #[error("the cloud has no points: there is nothing to be far off")]
    NoPoints,
    /// The cloud could not be gone through.
    #[error(transparent)]
    Part(#[from] PartError),
    /// The caller asked to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// How far the points of `parts` are from the nearest of `representatives`.
pub fn mean_error(
    representatives: &[Point3],
    parts: &mut dyn CloudParts,
    progress: &dyn Progress,
) -> Result<MeanError, MeanErrorError> {
    if representatives.is_empty() {
        return Err(MeanErrorError::NoRepresentatives);
    }
    progress.start("measuring", parts.n_points());
    let mut distances = Distances::default();
    assign(parts, representatives, progress, &mut |_, found| {
        for neighbour in found {
            distances.take(neighbour.distance);
        }
    })?;
    distances.finish().ok_or(MeanErrorError::NoPoints)
}

/// Distances as they come; how many there are of each, to a thousandth.
#[derive(Debug, Default)]
pub(super) struct Distances {
    n: u64,
    sum: f64,
    sum_of_squares: f64,
    max: f64,
    counts: Vec<u64>,
}

/// Bits of an `f32` left out to count it with its likes: those left tell it to a thousandth.
const LEFT_OUT: u32 = 13;

impl Distances {
    pub(super) fn take(&mut self, distance: f64) {
        self.n += 1;
        self.sum += distance;
        self.sum_of_squares += distance * distance;
        self.max = self.max.max(distance);
        // Bits of positive floats are in their order.
        let bin = ((distance as f32).to_bits() >> LEFT_OUT) as usize;
        if self.counts.len() <= bin {
            self.counts.resize(bin + 1, 0);
        }
        self.counts[bin] += 1;
    }

    /// What they come to; nothing if there was none.
    pub(super) fn finish(&self) -> Option<MeanError> {
        let n = self.n as f64;
        (0 < self.n).then(|| MeanError {
            n_points: self.n,
            mean: self.sum / n,
            rms: (self.sum_of_squares / n).sqrt(),
            median: self.percentile(0.5),
            percentile_90: self.percentile(0.9),
            percentile_95: self.percentile(0.95),
            percentile_99: self.percentile(0.99),
            max: self.max,
        })
    }

    fn percentile(&self, share: f64) -> f64 {
        let wanted = (share * self.n as f64).ceil() as u64;
        let mut n_so_far = 0;
        let reaches = |count: &u64| {
            n_so_far += count;
            wanted <= n_so_far
        };
        let bin = self.counts.iter().position(reaches).unwrap_or(0) as u32;
        // The end of the bin: no fewer points are this near.
        f64::from(f32::from_bits(((bin + 1) << LEFT_OUT) - 1)).min(self.max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::PointCloud;
    use crate::progress::Silent;

    #[test]
    fn distances_along_a_line_have_the_mean_and_the_percentiles_of_a_ramp() {
        let points = (0..1001).map(|i| Point3::new(f64::from(i), 0.0, 0.0)).collect();
        let cloud = PointCloud { points, ..PointCloud::default() };
        let error = mean_error(&[Point3::origin()], &mut &cloud, &Silent).unwrap();
        assert_eq!((error.n_points, error.max), (1001, 1000.0));
        assert!((error.mean - 500.0).abs() < 1e-3, "{error:?}");
        assert!((error.rms - 577.5).abs() < 0.1, "{error:?}");
        for (found, expected) in
            [(error.median, 500.0), (error.percentile_90, 900.0), (error.percentile_99, 990.0)]
        {
            assert!((found - expected).abs() < 1e-3 * expected + 1.0, "{found} {expected}");
        }
    }

    #[test]
    fn a_cloud_is_no_distance_from_itself() {
        let cloud =
            PointCloud { points: vec![Point3::new(1.0, 2.0, 3.0)], ..PointCloud::default() };
        let error = mean_error(&cloud.points, &mut &cloud, &Silent).unwrap();
        assert_eq!((error.mean, error.max, error.percentile_99), (0.0, 0.0, 0.0));
    }

    #[test]
    fn nothing_to_measure_is_refused() {
        let none = PointCloud::default();
        let one = PointCloud { points: vec![Point3::origin()], ..PointCloud::default() };
        let error = mean_error(&[], &mut &one, &Silent).unwrap_err();
        assert!(matches!(error, MeanErrorError::NoRepresentatives));
        let error = mean_error(&one.points, &mut &none, &Silent).unwrap_err();
        assert!(matches!(error, MeanErrorError::NoPoints));
    }
}
