//! Both clouds on few points, and the starts that they propose.

use super::fpfh::{self, Feature, flipped, fpfh};
use super::matching::{Hypothesis, Matched, matches};
use super::planes::Walls;
use super::trial::{Start, distinct};
use super::{Coarse, CoarseOptions, StartedFrom, axes, gnc, ransac};
use crate::geom::{KdTree, Point3, PointCloud, Vector3, orient_alike};
use crate::progress::Progress;
use crate::register::icp::{IcpError, Role, View, ViewOptions};

/// Neighbours a normal is taken from, and a side handed on to.
const NEIGHBOURS: [usize; 2] = [20, 8];
/// Places described at most.
const MOST_FEATURES: usize = 6000;
/// With fewer pairs, those that are alike for one side only count too.
const FEW_MATCHES: usize = 50;
/// Poses kept of a method before those that are nearly the same are dropped, for one that stays.
const SPARE: usize = 8;
/// Pairs nearer than this agree with a pose [voxels].
const TOLERANCE: f64 = 1.5;

/// Both clouds on few points, about the centroids of the finer ones.
pub(super) struct Rough {
    source: View,
    target: View,
    /// Over the places that features of the target are at.
    pub(super) targets: KdTree,
}

impl Rough {
    pub(super) fn new(
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
        let targets = KdTree::build(&places(&target));
        Ok(Self { source, target, targets })
    }

    pub(super) fn views(&self) -> [&View; 2] {
        [&self.source, &self.target]
    }

    /// Places that look alike: once for each side that the source's normals may point to.
    pub(super) fn matched(
        &self,
        radius: f64,
        progress: &dyn Progress,
    ) -> Result<Vec<Matched>, IcpError> {
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
    pub(super) fn starts(
        &self,
        (matched, walls): (&[Matched], Option<&Walls>),
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
        if let Some(walls) = walls {
            let all = walls.hypotheses().into_iter();
            let all = all.map(|found| Start { pose: found.pose, from: StartedFrom::Planes });
            let kept = distinct(all, radius, self.source.voxel);
            starts.extend(kept.into_iter().take(options.hypotheses));
            progress.advance(0)?;
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
