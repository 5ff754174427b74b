//! What the options leave open, settled by the clouds.

use super::error::{IcpError, Role};
use super::options::{IcpOptions, Metric};
use crate::geom::PointCloud;
use serde::Serialize;

/// Voxels along the diagonal of the smaller cloud.
const FINENESS: f64 = 200.0;
/// The first distance, in voxels.
const FAR: f64 = 10.0;
/// The last distance, in voxels.
const NEAR: f64 = 3.0;
/// The last step, in voxels.
const STILL: f64 = 1e-3;

/// What the options leave open, settled by the clouds.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct Settled {
    /// What is made small.
    pub metric: Metric,
    /// Side of the cells that become one point each [mm].
    pub voxel: f64,
    /// Greatest distance of a pair at the start [mm].
    pub max_distance: f64,
    /// Greatest distance of a pair at the end [mm].
    pub final_distance: f64,
    /// The step that ends it [mm].
    pub translation_eps: f64,
}

impl Settled {
    /// The options for these two clouds.
    pub fn new(
        source: &PointCloud,
        target: &PointCloud,
        options: &IcpOptions,
    ) -> Result<Self, IcpError> {
        let without = |cloud: &PointCloud| cloud.colors.is_none();
        let metric = options.fine.unwrap_or(if without(source) || without(target) {
            Metric::Generalised
        } else {
            Metric::Coloured
        });
        for (cloud, role) in [(source, Role::Source), (target, Role::Target)] {
            if metric == Metric::Coloured && without(cloud) {
                return Err(IcpError::NoColours { role });
            }
        }
        let diagonal = [source, target].map(|cloud| cloud.aabb().size().norm());
        let smaller = diagonal[0].min(diagonal[1]);
        // Of a single point, or none: `View::new` says what is wrong with it.
        let detail = if smaller > 0.0 && smaller.is_finite() { smaller / FINENESS } else { 1.0 };
        let voxel = options.voxel.unwrap_or(detail);
        let max_distance = options.max_distance.unwrap_or(FAR * voxel);
        let final_distance = options.final_distance.unwrap_or((NEAR * voxel).min(max_distance));
        if final_distance > max_distance {
            return Err(IcpError::Option {
                option: "--final-distance",
                value: final_distance,
                must: format!("at most --max-distance, {max_distance}"),
            });
        }
        let translation_eps = options.translation_eps.unwrap_or(STILL * voxel);
        Ok(Self { metric, voxel, max_distance, final_distance, translation_eps })
    }

    /// The greatest distance of a pair at a level: from the first to the last by equal ratios.
    pub(super) fn distance(&self, level: u32, n_levels: u32) -> f64 {
        if level + 1 == n_levels {
            return self.final_distance;
        }
        let share = f64::from(level) / f64::from(n_levels - 1);
        self.max_distance * (self.final_distance / self.max_distance).powf(share)
    }

    /// The turn and the shift below which a level ends.
    pub(super) fn eps(&self, options: &IcpOptions, is_last: bool) -> [f64; 2] {
        let [turn, shift] = [options.rotation_eps_deg.to_radians(), self.translation_eps];
        if is_last {
            return [turn, shift];
        }
        // What a level leaves over, the next one finds.
        let coarse = (super::COARSE_EPS * self.voxel).max(shift);
        [turn * coarse / shift, coarse]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Point3;

    fn cloud(side: f64, is_coloured: bool) -> PointCloud {
        let points = vec![Point3::origin(), Point3::new(0.6 * side, 0.8 * side, 0.0)];
        let colors = is_coloured.then(|| vec![[0; 3]; 2]);
        PointCloud { points, normals: None, colors }
    }

    #[test]
    fn lengths_follow_the_smaller_cloud_and_colours_are_used_where_both_have_them() {
        let options = IcpOptions::default();
        let settled = Settled::new(&cloud(400.0, true), &cloud(200.0, true), &options).unwrap();
        assert_eq!(settled.metric, Metric::Coloured);
        assert_eq!([settled.voxel, settled.max_distance, settled.final_distance], [1.0, 10.0, 3.0]);
        let plain = Settled::new(&cloud(400.0, true), &cloud(200.0, false), &options).unwrap();
        assert_eq!(plain.metric, Metric::Generalised);
        let asked = IcpOptions { fine: Some(Metric::Coloured), ..options };
        let error = Settled::new(&cloud(1.0, true), &cloud(1.0, false), &asked).unwrap_err();
        assert_eq!(error, IcpError::NoColours { role: Role::Target });
    }

    #[test]
    fn distances_shrink_by_equal_ratios() {
        let options = IcpOptions {
            max_distance: Some(16.0),
            final_distance: Some(1.0),
            ..IcpOptions::default()
        };
        let settled = Settled::new(&cloud(1.0, false), &cloud(1.0, false), &options).unwrap();
        assert_eq!([0, 1, 2].map(|level| settled.distance(level, 3)), [16.0, 4.0, 1.0]);
        assert_eq!(settled.distance(0, 1), 1.0);
        let wrong = IcpOptions { final_distance: Some(17.0), ..options };
        let error = Settled::new(&cloud(1.0, false), &cloud(1.0, false), &wrong).unwrap_err();
        assert!(error.to_string().contains("at most --max-distance, 16"), "{error}");
    }
}
