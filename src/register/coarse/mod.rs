//! Coarse registration: two clouds laid on each other, wherever they are.
//!
//! Places whose surroundings look alike are paired ([`fpfh`], [`matching`]); most pairs are wrong. Poses
//! that many agree with are proposed by [`ransac`] or [`gnc`], others by the principal [`axes`]; [`trial`]
//! refines them on few points and looks how much of the clouds then lies on each other. The best go
//! through the fine stage, with its verdict, and what they lay on each other decides again.
//!
//! Which side a normal points to is unknown in most scans. Neighbours' sides are made to agree; then
//! the source is described for both sides, and both sets of pairs make proposals.
//!
//! A pose is doubtful also if another, quite different one is as good: a cube fits in 24 ways.
//!
//! Planes laid on planes are left out: they need the plane models of a later layer.

mod axes;
mod consistency;
mod fpfh;
mod gnc;
mod matching;
mod options;
mod ransac;
mod support;
mod trial;

pub use options::{Coarse, CoarseOptions};
pub use support::Support;

use super::icp::{
    self, Alignment, IcpError, IcpOptions, Reason, Role, Settled, Verdict, View, ViewOptions,
    align_views,
};
use crate::geom::{Point3, PointCloud, Pose, Vector3, orient_alike};
use crate::progress::Progress;
use fpfh::{Feature, flipped, fpfh};
use matching::{Hypothesis, Matched, between, matches};
use serde::Serialize;
use std::fmt;
pub(super) use trial::fit;
use trial::{Start, Tried, distinct, tried};

/// Voxels of features along the diagonal of the smaller cloud.
const FINENESS: f64 = 60.0;
/// Their least side [fine voxels]: normals of fewer points are noise.
const LEAST_VOXEL: f64 = 2.0;
/// How far a feature looks [voxels].
const RADIUS: f64 = 5.0;
/// Pairs nearer than this agree with a pose [voxels].
const TOLERANCE: f64 = 1.5;
/// Neighbours a normal is taken from, and a side handed on to.
const NEIGHBOURS: [usize; 2] = [20, 8];
/// Places described at most.
const MOST_FEATURES: usize = 6000;
/// With fewer pairs, those that are alike for one side only count too.
const FEW_MATCHES: usize = 50;
/// Poses kept of a method before those that are nearly the same are dropped, for one that stays.
const SPARE: usize = 8;
/// Starts that go through the fine stage.
const FINALISTS: usize = 3;
/// A finalist lays this share of what the best start does on each other, at least.
const CONTENDER: f64 = 0.8;
/// A pose is as good as another if it lays this share of what that does on each other,
const RIVAL: f64 = 0.9;
/// and quite different if it lays points this share of the cloud's size apart.
const DIFFERENT: f64 = 0.25;

/// Where the pose that won began.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum StartedFrom {
    /// Where the caller, or the files, had it.
    Given,
    /// Features and draws.
    FpfhRansac,
    /// Features and graduated non-convexity.
    FpfhGnc,
    /// The principal axes.
    Axes,
}

/// A pose from anywhere, and what is to be known about it.
#[derive(Debug, Clone, PartialEq)]
pub struct Found {
    /// The pose after the fine stage, with its verdict.
    pub alignment: Alignment,
    /// Where it began.
    pub started_from: StartedFrom,
    /// Starts that were tried out.
    pub n_starts: usize,
    /// The share of both clouds that lies on each other.
    pub fit: f64,
    /// What speaks for it among the features, where there are any.
    pub support: Option<Support>,
}

/// Lays `source` over `target`, beginning at `start`, or where features and axes say, or both.
///
/// A start that is given is believed if `coarse` does not say otherwise; without one, all methods are
/// tried. The result is the same for any number of threads.
pub fn align(
    source: &PointCloud,
    target: &PointCloud,
    start: Option<&Pose>,
    (coarse, fine): (&CoarseOptions, &IcpOptions),
    progress: &dyn Progress,
) -> Result<Found, IcpError> {
    coarse.check()?;
    let method = coarse.method(start.is_some());
    let given = start.copied().unwrap_or_else(Pose::identity);
    if !given.to_homogeneous().iter().all(|x| x.is_finite()) {
        return Err(IcpError::Start);
    }
    let settled = Settled::new(source, target, fine)?;
    let [source, target] = icp::views([source, target], &settled, fine, progress)?;
    let views = [&source, &target];
    if method == Coarse::None {
        let alignment = align_views(views, &given, &settled, fine, progress)?;
        let fit = fit(views, &icp::about_centers(&alignment.target_from_source, views));
        return Ok(Found {
            alignment,
            started_from: StartedFrom::Given,
            n_starts: 1,
            fit,
            support: None,
        });
    }
    let voxel = coarse.feature_voxel.unwrap_or_else(|| {
        let size = source.diagonal().min(target.diagonal());
        (size / FINENESS).max(LEAST_VOXEL * settled.voxel)
    });
    let rough = Rough::new(views, voxel, progress)?;
    let matched = if method.needs_features() {
        let radius = coarse.feature_radius.unwrap_or(RADIUS * voxel);
        rough.matched(radius, progress)?
    } else {
        Vec::new()
    };
    let given = Start { pose: icp::about_centers(&given, views), from: StartedFrom::Given };
    let starts = rough.starts(&matched, given, (method, coarse, fine.seed), progress)?;
    let tried = tried(rough.views(), &starts, fine.seed, progress)?;
    let finals = finals(views, &tried, (&settled, fine), progress)?;
    let Some((best, others)) = finals.split_first() else {
        return Ok(nothing(align_views(views, &Pose::identity(), &settled, fine, progress)?));
    };
    let support = matched
        .iter()
        .map(|matched| Support::of(&best.pose, matched, &rough.targets))
        .max_by_key(|support| support.n_agreeing);
    let mut alignment = best.alignment.clone();
    let is_far = |other: &&Final| {
        between(&other.pose, &best.pose, source.radius) > DIFFERENT * source.radius
    };
    let rival = others.iter().filter(is_far).find(|other| other.fit >= RIVAL * best.fit);
    if let Some(rival) = rival {
        let turn = rival.pose.rotation.angle_to(&best.pose.rotation);
        alignment
            .object(Reason::Ambiguous { turn_deg: turn.to_degrees(), fits: [best.fit, rival.fit] });
    }
    let is_proposed = matches!(best.from, StartedFrom::FpfhRansac | StartedFrom::FpfhGnc);
    if let Some(support) = support.filter(|support| is_proposed && !support.is_enough()) {
        let Support { n_matches, n_agreeing, by_chance } = support;
        alignment.object(Reason::Unsupported { n_matches, n_agreeing, by_chance });
    }
    Ok(Found { alignment, started_from: best.from, n_starts: starts.len(), fit: best.fit, support })
}

/// Both clouds on few points, about the centroids of the finer ones.
struct Rough {
    source: View,
    target: View,
    /// Over the places that features of the target are at.
    targets: crate::geom::KdTree,
}

impl Rough {
    fn new(
        [source, target]: [&View; 2],
        voxel: f64,
        progress: &dyn Progress,
    ) -> Result<Self, IcpError> {
        let options = ViewOptions {
            voxel,
            neighbours: NEIGHBOURS[0],
            with_colours: false,
            with_borders: false,
            camera: None,
        };
        let rough = |view: &View, role| {
            let normals = view.is_oriented.then(|| view.normals.clone());
            let cloud = PointCloud { points: view.points.clone(), normals, colors: None };
            View::new(&cloud, role, options, progress)
        };
        let (source, target) =
            rayon::join(|| rough(source, Role::Source), || rough(target, Role::Target));
        let (source, target) = (source?, target?);
        let targets = crate::geom::KdTree::build(&places(&target));
        Ok(Self { source, target, targets })
    }

    fn views(&self) -> [&View; 2] {
        [&self.source, &self.target]
    }

    /// Places that look alike: once for each side that the source's normals may point to.
    fn matched(&self, radius: f64, progress: &dyn Progress) -> Result<Vec<Matched>, IcpError> {
        let (source, target) = rayon::join(
            || described(&self.source, radius, progress),
            || described(&self.target, radius, progress),
        );
        let (source, target) = (source?, target?);
        let (from, onto) = (places(&self.source), places(&self.target));
        let voxel = self.source.voxel;
        let of = |source: &[Feature]| {
            let pairs = matches(source, &target, FEW_MATCHES);
            Matched {
                from: pairs.iter().map(|[i, _]| from[*i as usize]).collect(),
                onto: pairs.iter().map(|[_, j]| onto[*j as usize]).collect(),
                tolerance: TOLERANCE * voxel,
                apart: radius,
            }
        };
        if self.source.is_oriented && self.target.is_oriented {
            return Ok(vec![of(&source)]);
        }
        let inside_out: Vec<Feature> = source.iter().map(flipped).collect();
        Ok(vec![of(&source), of(&inside_out)])
    }

    /// All poses to begin with, each once.
    fn starts(
        &self,
        matched: &[Matched],
        given: Start,
        (method, options, seed): (Coarse, &CoarseOptions, u64),
        progress: &dyn Progress,
    ) -> Result<Vec<Start>, IcpError> {
        let radius = self.source.radius;
        let n_spare = options.hypotheses * SPARE;
        let mut starts = Vec::new();
        if method == Coarse::Auto {
            starts.push(given);
        }
        let mut propose = |from, of: &dyn Fn(&Matched) -> Vec<Hypothesis>| {
            let mut all: Vec<Hypothesis> = matched.iter().flat_map(of).collect();
            all.sort_by(|a, b| b.score.total_cmp(&a.score));
            let all = all.into_iter().map(|hypothesis| Start { pose: hypothesis.pose, from });
            let kept = distinct(all, radius, self.source.voxel);
            starts.extend(kept.into_iter().take(options.hypotheses));
            progress.advance(0)
        };
        if matches!(method, Coarse::FpfhGnc | Coarse::Auto) {
            propose(StartedFrom::FpfhGnc, &|matched| gnc::gnc(matched, options.hypotheses))?;
        }
        if matches!(method, Coarse::FpfhRansac | Coarse::Auto) {
            propose(StartedFrom::FpfhRansac, &|matched| {
                ransac::ransac(matched, options.draws, seed, n_spare)
            })?;
        }
        if matches!(method, Coarse::Axes | Coarse::Auto) {
            let poses = axes::axes(&places(&self.source), &places(&self.target));
            starts.extend(poses.map(|pose| Start { pose, from: StartedFrom::Axes }));
        }
        Ok(distinct(starts, radius, self.source.voxel))
    }
}

/// Where the places of a rough view are, about the centroid of the finer one.
fn places(view: &View) -> Vec<Point3> {
    view.points.iter().map(|point| point + view.center.coords).collect()
}

/// The features of a view's points; of very many, of some, the others empty.
fn described(view: &View, radius: f64, progress: &dyn Progress) -> Result<Vec<Feature>, IcpError> {
    let mut normals: Vec<Vector3> = view.normals.clone();
    if !view.is_oriented {
        orient_alike(&view.points, &mut normals, &view.tree, NEIGHBOURS[1], progress)?;
    }
    let mut features = fpfh(&view.points, &normals, &view.tree, radius, progress)?;
    let stride = features.len().div_ceil(MOST_FEATURES).max(1);
    for (i, feature) in features.iter_mut().enumerate() {
        if i % stride != 0 {
            *feature = [0.0; fpfh::WIDTH];
        }
    }
    Ok(features)
}

/// A start after the fine stage.
struct Final {
    alignment: Alignment,
    /// About the clouds' centroids.
    pose: Pose,
    from: StartedFrom,
    fit: f64,
}

/// The best starts through the fine stage, the best first: one that has not failed before one that
/// has, and then what lays more of the clouds on each other.
///
/// The verdict alone would not do: it says whether a pose may be believed, not which of two is the
/// better, and a wrong one may be easier to believe than the right one.
fn finals(
    views: [&View; 2],
    tried: &[Tried],
    (settled, fine): (&Settled, &IcpOptions),
    progress: &dyn Progress,
) -> Result<Vec<Final>, IcpError> {
    let best = tried.first().map_or(0.0, |tried| tried.fit);
    let mut finals = Vec::new();
    for tried in tried.iter().take(FINALISTS).filter(|tried| tried.fit >= CONTENDER * best) {
        // A start that was given is refined as it would be without a search.
        let is_given = tried.start.from == StartedFrom::Given;
        let start = if is_given { tried.start.pose } else { tried.pose };
        let start = icp::from_centers(&start, views);
        let alignment = align_views(views, &start, settled, fine, progress)?;
        let pose = icp::about_centers(&alignment.target_from_source, views);
        let fit = fit(views, &pose);
        finals.push(Final { alignment, pose, from: tried.start.from, fit });
    }
    finals.sort_by(|a, b| {
        let has_failed = |one: &Final| one.alignment.verdict == Verdict::Failed;
        has_failed(a).cmp(&has_failed(b)).then(b.fit.total_cmp(&a.fit))
    });
    Ok(finals)
}

/// No method had anything to propose.
fn nothing(mut alignment: Alignment) -> Found {
    alignment.object(Reason::NoStart);
    Found { alignment, started_from: StartedFrom::Given, n_starts: 0, fit: 0.0, support: None }
}

impl fmt::Display for StartedFrom {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Given => "given",
            Self::FpfhRansac => "fpfh-ransac",
            Self::FpfhGnc => "fpfh-gnc",
            Self::Axes => "axes",
        })
    }
}

#[cfg(test)]
mod tests;
