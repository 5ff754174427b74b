//! Surfaces and other evidence of a pose, made small at once.
//!
//! Henry et al. (2012), *RGB-D mapping*, eq. 4: the mean square of what features are off is added to that
//! of what surfaces are off. Both are taken in standard deviations here, so that neither has a unit;
//! that of the surfaces is told by the median of what their pairs are off.

use super::cost::{Cost, Motion, Normal};
use super::pair::Pair;
use crate::geom::Pose;
use crate::register::small_motion::adjoint;
use nalgebra::Translation3;

/// Surfaces are known no better than to this share of a voxel.
const EXACT: f64 = 1e-3;

/// What else is known of a pose.
pub(in crate::register) trait Evidence {
    /// The mean square of what is off at `target_from_source`, in standard deviations, and its normal
    /// equations for a small step from the left.
    fn mean_square(&self, target_from_source: &Pose) -> Normal;
}

/// Evidence that is asked beside the surfaces.
#[derive(Clone, Copy)]
pub(in crate::register) struct Beside<'a> {
    pub(in crate::register) evidence: &'a dyn Evidence,
    /// What the surfaces' mean square counts for where that of the evidence counts for 1.
    pub(in crate::register) surfaces: f64,
}

/// All that is made small; poses are about the views' centres.
pub(super) struct Objective<'a> {
    cost: Cost<'a>,
    pairs: &'a [Pair],
    joined: Option<Joined<'a>>,
}

struct Joined<'a> {
    evidence: &'a dyn Evidence,
    /// What a squared residual of the surfaces counts for, of a pair of weight 1 [1/mm²].
    scale: f64,
}

impl<'a> Objective<'a> {
    /// What `pairs` cost, and what is `beside` it; `noise` is the standard deviation of pairs that fit
    /// [mm].
    pub(super) fn new(
        cost: Cost<'a>,
        pairs: &'a [Pair],
        beside: Option<&Beside<'a>>,
        noise: f64,
    ) -> Self {
        let noise = noise.max(EXACT * cost.target.voxel);
        let total: f64 = pairs.iter().map(|pair| pair.weight).sum();
        let joined = beside.map(|beside| Joined {
            evidence: beside.evidence,
            scale: beside.surfaces / (noise.powi(2) * total.max(f64::MIN_POSITIVE)),
        });
        Self { cost, pairs, joined }
    }

    /// The normal equations of a small step from the left of `pose`.
    pub(super) fn normal(&self, pose: &Pose) -> Normal {
        let surfaces = self.cost.normal(&Motion::from(pose), self.pairs);
        let Some(joined) = &self.joined else { return surfaces };
        let (surfaces, other) = (surfaces * joined.scale, self.other(joined, pose));
        // A step about the target's centre is this step about its origin.
        let carry = adjoint(&Translation3::from(self.cost.target.center.coords).into());
        Normal {
            h: surfaces.h + carry.transpose() * other.h * carry,
            g: surfaces.g + carry.transpose() * other.g,
            cost: surfaces.cost + other.cost,
        }
    }

    /// What is made small, at `pose`.
    pub(super) fn sum(&self, pose: &Pose) -> f64 {
        let surfaces = self.cost.sum(&Motion::from(pose), self.pairs);
        let Some(joined) = &self.joined else { return surfaces };
        surfaces * joined.scale + self.other(joined, pose).cost
    }

    fn other(&self, joined: &Joined, pose: &Pose) -> Normal {
        let views = [self.cost.source, self.cost.target];
        joined.evidence.mean_square(&super::from_centers(pose, views))
    }
}

#[cfg(test)]
mod tests {
    use super::super::options::Metric;
    use super::super::tests::{options, relief};
    use super::super::{IcpOptions, Role, Settled, Verdict, View, align_views_beside, taken};
    use super::*;
    use crate::geom::{Point3, PointCloud, Vector3};
    use crate::progress::Silent;
    use nalgebra::{Matrix6, Vector6};

    /// Where the sheet begins, along x: a step about its middle is not one about the origin.
    const FAR: f64 = 1e3;

    /// Points that are to come to lie on others.
    struct Marks(Vec<[Point3; 2]>);

    impl Marks {
        /// The corners of a square, where `pose` takes them.
        fn of(pose: &Pose) -> Self {
            let corners = [[0.0, 0.0], [40.0, 0.0], [40.0, 40.0], [0.0, 40.0]];
            let corners = corners.map(|[x, y]| Point3::new(FAR + x, y, 5.0));
            Self(corners.iter().map(|corner| [*corner, pose * corner]).collect())
        }
    }

    impl Evidence for Marks {
        fn mean_square(&self, pose: &Pose) -> Normal {
            let mut sum = Normal { h: Matrix6::zeros(), g: Vector6::zeros(), cost: 0.0 };
            for [mark, place] in &self.0 {
                let there = pose * mark;
                for (axis, off) in
                    [Vector3::x(), Vector3::y(), Vector3::z()].iter().zip(&(there - place))
                {
                    let turn = there.coords.cross(axis);
                    let row = Vector6::new(turn.x, turn.y, turn.z, axis.x, axis.y, axis.z);
                    sum.h += row * row.transpose();
                    sum.g += row * *off;
                    sum.cost += off * off;
                }
            }
            sum * (1.0 / self.0.len() as f64)
        }
    }

    fn view(cloud: &PointCloud) -> View {
        View::new(cloud, Role::Target, options(0.8), &Silent).unwrap()
    }

    #[test]
    fn the_joint_gradient_is_the_slope_of_the_joint_sum() {
        let view = view(&relief(2000));
        let pairs: Vec<Pair> = (0..view.len() as u32 - 3)
            .map(|i| Pair {
                source: i,
                target: i + 3,
                distance: 0.0,
                weight: 1.0,
                is_turned: false,
            })
            .collect();
        let cost =
            Cost { source: &view, target: &view, metric: Metric::PointToPlane, colour_scale: 0.0 };
        let marks = Marks::of(&Pose::translation(1.0, 2.0, -1.0));
        let beside = Beside { evidence: &marks, surfaces: 0.7 };
        let objective = Objective::new(cost, &pairs, Some(&beside), 0.4);
        let pose = Pose::new(Vector3::new(0.3, -0.2, 0.1), Vector3::new(0.02, 0.01, -0.03));
        let normal = objective.normal(&pose);
        assert!((normal.cost / objective.sum(&pose) - 1.0).abs() < 1e-12);
        for k in 0..6 {
            let mut nudge = Vector6::zeros();
            nudge[k] = 1e-6;
            let [ahead, behind] = [nudge, -nudge].map(|step| objective.sum(&taken(&pose, &step)));
            let slope = (ahead - behind) / 4e-6;
            assert!((slope - normal.g[k]).abs() < 1e-6 * normal.g.amax(), "{k}: {slope}");
        }
    }

    #[test]
    fn marks_hold_a_sheet_where_its_surface_lets_it_slide() {
        let place = |i: u32| {
            let [x, z] = [0.618_034, 0.754_878].map(|share| (f64::from(i) * share).fract());
            Point3::new(FAR + 40.0 * x, f64::from(i) / 50.0, 5.0 + 0.1 * z)
        };
        let source = PointCloud { points: (0..2000).map(place).collect(), ..PointCloud::default() };
        let truth = Pose::new(Vector3::new(2.0, -1.5, 0.7), Vector3::new(0.0, 0.0, 0.03));
        let points = source.points.iter().map(|point| truth * point).collect();
        let target = PointCloud { points, ..PointCloud::default() };
        let marks = Marks::of(&truth);
        let views = [&view(&source), &view(&target)];
        // Right but for a shift along the sheet.
        let start = Pose::translation(1.0, 1.0, 0.0) * truth;
        let icp = IcpOptions { voxel: Some(0.8), ..IcpOptions::default() };
        let settled = Settled::new(&source, &target, &icp).unwrap();
        let aligned = |beside: Option<&Beside>| {
            let found =
                align_views_beside(views, &start, (&settled, &icp), beside, &Silent).unwrap();
            // The surfaces say what they hold, whatever is beside them.
            assert_eq!(found.verdict, Verdict::Failed);
            let off = found.target_from_source * source.points[0] - truth * source.points[0];
            off.norm()
        };
        let beside = Beside { evidence: &marks, surfaces: 1.0 };
        let (alone, together) = (aligned(None), aligned(Some(&beside)));
        assert!(alone > 0.5, "{alone} mm");
        assert!(together < 0.1 * alone, "{together} mm, and {alone} mm without marks");
    }
}
