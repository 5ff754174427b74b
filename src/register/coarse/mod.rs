//! Coarse registration: two clouds laid on each other, wherever they are.
//!
//! Places whose surroundings look alike are paired ([`fpfh`], [`matching`]); most pairs are wrong. Poses
//! that many agree with are proposed by [`ransac`] or [`gnc`], others by the principal [`axes`]; [`trial`]
//! refines them on few points and looks how much of the clouds then lies on each other. The best go
//! through the fine stage, with its verdict, and what they lay on each other decides again.
//!
//! Where there are walls, [`planes`] laid on planes propose poses too: in rooms surroundings look
//! alike everywhere, and there are few planes.
//!
//! Which side a normal points to is unknown in most scans. Neighbours' sides are made to agree; then
//! the source is described for both sides, and both sets of pairs make proposals.
//!
//! A pose is doubtful also if another, quite different one is as good: a cube fits in 24 ways.

mod axes;
mod consistency;
mod fpfh;
mod gnc;
mod matching;
mod options;
mod planes;
mod ransac;
mod rough;
mod support;
mod trial;

pub use options::{Coarse, CoarseOptions};
pub use planes::PlaneSupport;
pub use support::Support;

use super::icp::{
    self, Alignment, IcpError, IcpOptions, Reason, Settled, Verdict, View, align_views,
};
use crate::geom::{PointCloud, Pose};
use crate::progress::Progress;
use matching::between;
use planes::Walls;
use rough::Rough;
use serde::Serialize;
use std::fmt;
pub(super) use trial::fit;
use trial::{Start, Tried, tried};

/// Voxels of features along the diagonal of the smaller cloud.
const FINENESS: f64 = 60.0;
/// Their least side [fine voxels]: normals of fewer points are noise.
const LEAST_VOXEL: f64 = 2.0;
/// How far a feature looks [voxels].
const RADIUS: f64 = 5.0;
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
    /// Planes laid on planes.
    Planes,
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
    /// What speaks for it among the planes, where they were looked for.
    pub planes: Option<PlaneSupport>,
}

/// Lays `source` over `target`, beginning at `start`, or where features, planes and axes say, or both.
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
        return Ok(Found { n_starts: 1, fit, ..Found::of(alignment) });
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
    let walls = match method {
        Coarse::Planes => Some(Walls::new(views, voxel, progress)?),
        // On few points it shows at little cost whether there are any to speak of.
        Coarse::Auto if Walls::new(rough.views(), voxel, progress)?.are_a_part() => {
            Some(Walls::new(views, voxel, progress)?)
        }
        _ => None,
    };
    let given = Start { pose: icp::about_centers(&given, views), from: StartedFrom::Given };
    // Beside other methods, only planes that fix a pose on their own.
    let proposing = walls.as_ref().filter(|walls| method == Coarse::Planes || walls.hold());
    let starts =
        rough.starts((&matched, proposing), given, (method, coarse, fine.seed), progress)?;
    let mut tried = tried(rough.views(), &starts, fine.seed, progress)?;
    let shown = |pose: &Pose| {
        walls.as_ref().map(|walls| PlaneSupport::of(pose, walls, 2.0 * target.radius))
    };
    let is_shown = |pose: &Pose| shown(pose).is_some_and(|planes| planes.is_enough());
    // A wrong pose that lays a few great walls on others lays more of the clouds on each other than the
    // right one does where these share little; but the other planes do not agree with it.
    tried.sort_by_cached_key(|tried| !is_shown(&tried.pose));
    let finals = finals(views, &tried, (&settled, fine), &is_shown, progress)?;
    let Some((best, others)) = finals.split_first() else {
        let alignment = align_views(views, &Pose::identity(), &settled, fine, progress)?;
        return Ok(Found::nothing(alignment, walls.as_ref()));
    };
    let support = matched
        .iter()
        .map(|matched| Support::of(&best.pose, matched, &rough.targets))
        .max_by_key(|support| support.n_agreeing);
    let mut found = Found {
        alignment: best.alignment.clone(),
        started_from: best.from,
        n_starts: starts.len(),
        fit: best.fit,
        support,
        planes: shown(&best.pose),
    };
    found.object(best.rival(others, source.radius));
    Ok(found)
}

impl Found {
    /// What an alignment from where the caller had it says.
    fn of(alignment: Alignment) -> Self {
        let started_from = StartedFrom::Given;
        Self { alignment, started_from, n_starts: 0, fit: 0.0, support: None, planes: None }
    }

    /// No method had anything to propose.
    fn nothing(mut alignment: Alignment, walls: Option<&Walls>) -> Self {
        let few = |walls: &Walls| Reason::NoPlanes { n_planes: walls.n_planes() };
        alignment.object(walls.map_or(Reason::NoStart, few));
        Self::of(alignment)
    }

    /// Says what speaks against a pose that was found: another that is as good, and chance.
    fn object(&mut self, rival: Option<&Final>) {
        if let Some(rival) = rival {
            let turn = self.alignment.target_from_source.rotation;
            let turn = rival.alignment.target_from_source.rotation.angle_to(&turn);
            let fits = [self.fit, rival.fit];
            self.alignment.object(Reason::Ambiguous { turn_deg: turn.to_degrees(), fits });
        }
        let is_alike = self.support.is_some_and(|support| support.is_enough());
        let is_shown = self.planes.is_some_and(|planes| planes.is_enough());
        match (self.started_from, self.support, self.planes) {
            (StartedFrom::FpfhRansac | StartedFrom::FpfhGnc, Some(support), _) if !is_alike => {
                let Support { n_matches, n_agreeing, by_chance } = support;
                self.alignment.object(Reason::Unsupported { n_matches, n_agreeing, by_chance });
            }
            (StartedFrom::Planes, _, Some(planes)) if !is_alike && !is_shown => {
                let PlaneSupport { n_planes, n_agreeing, by_chance } = planes;
                let reason = Reason::UnsupportedPlanes { n_planes, n_agreeing, by_chance };
                self.alignment.object(reason);
            }
            _ => {}
        }
    }
}

/// A start after the fine stage.
struct Final {
    alignment: Alignment,
    /// About the clouds' centroids.
    pose: Pose,
    from: StartedFrom,
    fit: f64,
    /// True if planes speak for it.
    is_shown: bool,
}

impl Final {
    /// One of `others` that is as good, but lays points of a cloud of this size far elsewhere.
    fn rival<'a>(&self, others: &'a [Self], radius: f64) -> Option<&'a Self> {
        others.iter().find(|other| {
            between(&other.pose, &self.pose, radius) > DIFFERENT * radius
                && other.is_shown >= self.is_shown
                && other.fit >= RIVAL * self.fit
        })
    }
}

/// The best starts through the fine stage, the best first: one that has not failed before one that
/// has, one that planes show before one that they do not, and then what lays more of the clouds on each
/// other.
///
/// The verdict alone would not do: it says whether a pose may be believed, not which of two is the
/// better, and a wrong one may be easier to believe than the right one.
fn finals(
    views: [&View; 2],
    tried: &[Tried],
    (settled, fine): (&Settled, &IcpOptions),
    is_shown: &dyn Fn(&Pose) -> bool,
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
        let is_shown = is_shown(&pose);
        finals.push(Final { alignment, pose, from: tried.start.from, fit, is_shown });
    }
    finals.sort_by(|a, b| {
        let has_failed = |one: &Final| one.alignment.verdict == Verdict::Failed;
        let first = has_failed(a).cmp(&has_failed(b)).then(b.is_shown.cmp(&a.is_shown));
        first.then(b.fit.total_cmp(&a.fit))
    });
    Ok(finals)
}

impl fmt::Display for StartedFrom {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Given => "given",
            Self::FpfhRansac => "fpfh-ransac",
            Self::FpfhGnc => "fpfh-gnc",
            Self::Planes => "planes",
            Self::Axes => "axes",
        })
    }
}

#[cfg(test)]
mod tests;
