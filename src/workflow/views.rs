//! Many scans laid over each other at once: where each is, what is to be known about it, and all as one
//! cloud.

use crate::geom::{LengthUnit, PointCloud, Pose};
use crate::progress::Progress;
use crate::register::coarse::CoarseOptions;
use crate::register::icp::{IcpOptions, Verdict};
use crate::register::pose_graph::GraphOptions;
use crate::register::views::{
    Pair, PairOutcome, ViewsAligned, ViewsError, ViewsResidual, align_all,
};
use serde::Serialize;

/// What is laid over each other.
#[derive(Debug)]
pub struct ViewsJob<'a> {
    /// The scans, each with what it is called.
    pub views: Vec<(String, &'a PointCloud)>,
    /// The unit the report gives matrices in.
    pub unit: LengthUnit,
    /// What the user must know about the inputs.
    pub notes: Vec<String>,
    /// How a start is found.
    pub coarse: &'a CoarseOptions,
    /// How it is refined.
    pub fine: &'a IcpOptions,
    /// How all are weighed against each other.
    pub graph: &'a GraphOptions,
}

/// What is told about it; lengths in mm but for the matrices.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct ViewsReport {
    /// Failed if no two lie together, doubtful if some are left out, else ok.
    pub verdict: Verdict,
    /// The scan that stays where it is.
    pub stays: String,
    /// The unit of the matrices: that of the last scan's file.
    pub unit: LengthUnit,
    /// Every scan.
    pub views: Vec<ViewReport>,
    /// Every two scans.
    pub pairs: Vec<PairReport>,
    /// How well all lie on each other.
    pub residual: ViewsResidual,
    /// Rounds in which all were paired again.
    pub n_rounds: u32,
    /// True if the last one moved nothing worth mentioning.
    pub converged: bool,
    /// Side of the voxels.
    pub voxel: f64,
    /// What the user must know about the inputs.
    pub notes: Vec<String>,
}

/// Where a scan is.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct ViewReport {
    /// What it is called.
    pub name: String,
    /// The motion that lays it over the one that stays, row by row; nothing if it is left out.
    pub stays_from_view: Option<[[f64; 4]; 4]>,
    /// Why it is left out.
    pub reasons: Vec<String>,
}

/// What became of two scans.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct PairReport {
    /// The one that was moved.
    pub source: String,
    /// The one that stayed.
    pub target: String,
    /// The share of both that lies on each other, where they were laid.
    pub fit: f64,
    /// What became of it.
    pub result: PairResult,
    /// What speaks against it.
    pub reasons: Vec<String>,
}

/// What became of two scans.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum PairResult {
    /// They hold each other.
    Kept,
    /// They do, and were found when the others had brought them near each other.
    Joined,
    /// They do not fit the others.
    Dropped,
    /// They are not believed to lie on each other.
    Refused,
}

/// Lays all over each other.
pub fn register_views(
    job: ViewsJob,
    progress: &dyn Progress,
) -> Result<(ViewsAligned, ViewsReport), ViewsError> {
    let clouds: Vec<&PointCloud> = job.views.iter().map(|(_, cloud)| *cloud).collect();
    let aligned = align_all(&clouds, (job.coarse, job.fine, job.graph), progress)?;
    let names: Vec<String> = job.views.iter().map(|(name, _)| name.clone()).collect();
    let view = |(i, name): (usize, &String)| {
        let stays_from_view = aligned.stays_from_view[i].as_ref();
        ViewReport {
            name: name.clone(),
            stays_from_view: stays_from_view.map(|pose| rows(pose, job.unit)),
            reasons: if stays_from_view.is_none() { why_out(&aligned, i) } else { Vec::new() },
        }
    };
    let report = ViewsReport {
        verdict: aligned.verdict(),
        stays: names[aligned.stays].clone(),
        unit: job.unit,
        views: names.iter().enumerate().map(view).collect(),
        pairs: aligned.pairs.iter().map(|pair| PairReport::of(pair, &names)).collect(),
        residual: aligned.residual,
        n_rounds: aligned.n_rounds,
        converged: aligned.converged,
        voxel: aligned.voxel,
        notes: job.notes,
    };
    Ok((aligned, report))
}

/// All that were placed as one cloud, in the frame of the one that stays; with normals and colours where
/// all have them.
pub fn merged_views(views: &[&PointCloud], stays_from_view: &[Option<Pose>]) -> PointCloud {
    let mut placed =
        views.iter().zip(stays_from_view).filter_map(|(view, pose)| Some((view, (*pose)?)));
    let moved = |(view, pose): (&&PointCloud, Pose)| PointCloud {
        points: view.points.iter().map(|point| pose * point).collect(),
        normals: view
            .normals
            .as_ref()
            .map(|normals| normals.iter().map(|normal| pose.rotation * normal).collect()),
        colors: view.colors.clone(),
    };
    let Some(mut all) = placed.next().map(moved) else { return PointCloud::default() };
    for view in placed.map(moved) {
        all.points.extend(view.points);
        all.normals = all.normals.zip(view.normals).map(|(all, own)| [all, own].concat());
        all.colors = all.colors.zip(view.colors).map(|(all, own)| [all, own].concat());
    }
    all
}

impl PairReport {
    fn of(pair: &Pair, names: &[String]) -> Self {
        let (result, reasons) = match &pair.outcome {
            PairOutcome::Kept => (PairResult::Kept, Vec::new()),
            PairOutcome::Joined => (PairResult::Joined, Vec::new()),
            PairOutcome::Dropped { off } => {
                let why = format!("it is {off:.1} standard deviations off the others");
                (PairResult::Dropped, vec![why])
            }
            PairOutcome::Refused { reasons, .. } => (PairResult::Refused, reasons.clone()),
        };
        let [source, target] = [pair.source, pair.target].map(|i| names[i].clone());
        Self { source, target, fit: pair.fit, result, reasons }
    }
}

/// What was said of the best pair of a view that is left out.
pub(super) fn why_out(aligned: &ViewsAligned, view: usize) -> Vec<String> {
    let with = aligned.pairs.iter().filter(|pair| pair.source == view || pair.target == view);
    let best = with.max_by(|a, b| a.fit.total_cmp(&b.fit));
    match best.map(|pair| &pair.outcome) {
        Some(PairOutcome::Refused { reasons, .. }) => reasons.clone(),
        Some(PairOutcome::Dropped { .. }) => vec!["it does not fit the others".to_owned()],
        Some(PairOutcome::Kept | PairOutcome::Joined) => {
            vec!["it lies only with scans that are left out too".to_owned()]
        }
        None => Vec::new(),
    }
}

fn rows(pose: &Pose, unit: LengthUnit) -> [[f64; 4]; 4] {
    let mut matrix = pose.to_homogeneous();
    for k in 0..3 {
        matrix[(k, 3)] /= unit.in_mm();
    }
    std::array::from_fn(|a| std::array::from_fn(|b| matrix[(a, b)]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::{Point3, Vector3};

    #[test]
    fn all_that_are_placed_become_one_cloud_with_what_all_have() {
        let one = |x: f64, color: Option<Vec<[u8; 3]>>| PointCloud {
            points: vec![Point3::new(x, 0.0, 0.0)],
            normals: Some(vec![Vector3::x()]),
            colors: color,
        };
        let views = [one(1.0, Some(vec![[1; 3]])), one(2.0, None), one(3.0, Some(vec![[3; 3]]))];
        let views: Vec<&PointCloud> = views.iter().collect();
        let turned = Pose::new(Vector3::zeros(), Vector3::z() * std::f64::consts::PI);
        let all = merged_views(&views, &[Some(turned), None, Some(Pose::identity())]);
        assert!((all.points[0] - Point3::new(-1.0, 0.0, 0.0)).norm() < 1e-12);
        assert_eq!(all.points[1], Point3::new(3.0, 0.0, 0.0));
        assert!((all.normals.unwrap()[0] + Vector3::x()).norm() < 1e-12);
        assert_eq!(all.colors.unwrap(), [[1; 3], [3; 3]]);
        let some = merged_views(&views, &[Some(turned), Some(turned), None]);
        assert_eq!((some.points.len(), some.colors), (2, None));
        assert_eq!(merged_views(&views, &[None; 3]), PointCloud::default());
    }
}
