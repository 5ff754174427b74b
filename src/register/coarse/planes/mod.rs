//! Planes laid on planes: starts for rooms, fixtures and machine tables, where surroundings look alike.
//!
//! Which plane is which, and which side of it is out, is unknown. Two planes of the one cloud laid on two
//! of the other that enclose the same angle make a turn ([`turns`]); under a turn, every two planes that
//! then are parallel say how far the cloud is to go along their normal, and three such directions make a
//! shift ([`shifts`]). What counts is how much of the planes then comes to lie on each other, along them
//! too ([`consensus`]).
//!
//! After Pathak, Birk, Vaskevicius and Poppinga (2010), who weigh planes by how well they are known and
//! look for the largest consistent set, and the interpretation trees of Grimson and Lozano-Perez (1987),
//! of which this is the first levels, each bounded; Viejo and Cazorla (2014) follow a camera by such
//! patches.

mod consensus;
mod evidence;
mod shifts;
mod turns;

pub use evidence::PlaneSupport;

use super::matching::Hypothesis;
use crate::geom::{Matrix3, Plane, PlaneOptions, Point3, Vector3, planes};
use crate::progress::{Cancelled, Progress};
use crate::register::icp::View;
use consensus::Meetings;
use rayon::prelude::*;

/// Points lie on a plane up to this share of a voxel,
const OFF: f64 = 0.5;
/// or up to this many times the roughness, should that be more.
const ROUGH: f64 = 4.0;
/// Their normals enclose less than this with its own [deg].
const TILT_DEG: f64 = 20.0;
/// A plane has this many voxels,
const LEAST_POINTS: usize = 30;
/// and there are no more than these.
const MOST_PLANES: usize = 30;
/// Normals are parallel that enclose less than this: the sine of 8 degrees.
const PARALLEL: f64 = 0.139;
/// Nothing is known better than to this: half a degree, by which depth cameras bend walls,
const LEAST_TILT: f64 = 0.009;
/// and this share of a voxel.
const LEAST_OFF: f64 = 0.1;
/// Three directions are independent if their volume is at least this.
const INDEPENDENT: f64 = 0.3;
/// Where planes propose poses beside other methods, this share of either cloud lies on some: of a statue
/// a seventh at most, of a desk with all that is on it a third.
const PART: f64 = 0.3;
/// Poses kept of a turn.
const OF_A_TURN: usize = 8;

/// The planes of two clouds, about their centroids.
#[derive(Debug)]
pub(super) struct Walls {
    source: Vec<Patch>,
    target: Vec<Patch>,
    /// True if the sides of both clouds' normals are known.
    is_oriented: bool,
    /// Planes nearer than this agree with a pose [mm].
    tolerance: f64,
    /// The share of the points that lie on planes, of the cloud with less.
    share: f64,
}

/// What matters of a plane.
#[derive(Debug, Clone, Copy)]
struct Patch {
    normal: Vector3,
    middle: Point3,
    covariance: Matrix3,
    area: f64,
    /// How well the normal is known: its variance [rad2].
    tilt: f64,
    /// How well it is known where the middle is along the normal: its variance [mm2].
    off: f64,
}

impl Walls {
    /// The planes of `views`; those nearer than `tolerance` to each other agree.
    pub(super) fn new(
        views: [&View; 2],
        tolerance: f64,
        progress: &dyn Progress,
    ) -> Result<Self, Cancelled> {
        let [source, target] = views;
        let (from, onto) = rayon::join(|| patches(source, progress), || patches(target, progress));
        let (from, onto) = (from?, onto?);
        let is_oriented = source.is_oriented && target.is_oriented;
        let share = |patches: &[Patch], view: &View| {
            let area: f64 = patches.iter().map(|patch| patch.area).sum();
            area / (view.len() as f64 * view.voxel.powi(2))
        };
        let share = share(&from, source).min(share(&onto, target));
        Ok(Self { source: from, target: onto, is_oriented, tolerance, share })
    }

    /// How many planes were found, of the source and of the target.
    pub(super) fn n_planes(&self) -> [usize; 2] {
        [self.source.len(), self.target.len()]
    }

    /// True if a good part of either cloud lies on planes.
    pub(super) fn are_a_part(&self) -> bool {
        self.share >= PART
    }

    /// True if the planes of either cloud are a good part of it and hold all motions: three of
    /// them look different ways.
    pub(super) fn hold(&self) -> bool {
        let hold = |patches: &Vec<Patch>| {
            let normals: Vec<Vector3> = patches.iter().map(|patch| patch.normal).collect();
            let do_three = |a: usize, b: usize, c: usize| {
                normals[a].dot(&normals[b].cross(&normals[c])).abs() > INDEPENDENT
            };
            let n = normals.len();
            (0..n).any(|a| (0..a).any(|b| (0..b).any(|c| do_three(a, b, c))))
        };
        self.are_a_part() && hold(&self.source) && hold(&self.target)
    }

    /// Poses that lay planes on planes, those first that lay the most of them.
    pub(super) fn hypotheses(&self) -> Vec<Hypothesis> {
        let of_a_turn = |turn: &nalgebra::UnitQuaternion<f64>| {
            let meetings = Meetings::new(self, *turn);
            let mut found: Vec<Hypothesis> = shifts::shifts(&meetings, self.tolerance)
                .into_iter()
                .map(|shift| meetings.hypothesis(shift, self.tolerance))
                .collect();
            found.sort_by(|a, b| b.score.total_cmp(&a.score));
            found.truncate(OF_A_TURN);
            found.into_iter().map(|found| self.refitted(found)).collect::<Vec<_>>()
        };
        let turns = turns::turns(&self.source, &self.target, self.is_oriented);
        let found: Vec<Vec<Hypothesis>> = turns.par_iter().map(of_a_turn).collect();
        let mut all: Vec<Hypothesis> = found.into_iter().flatten().collect();
        all.retain(|hypothesis| hypothesis.score > 0.0);
        all.sort_by(|a, b| b.score.total_cmp(&a.score));
        all
    }
}

/// The planes of a view, largest first, with how well each is known.
fn patches(view: &View, progress: &dyn Progress) -> Result<Vec<Patch>, Cancelled> {
    let options = PlaneOptions {
        tolerance: (OFF * view.voxel).max(ROUGH * view.roughness),
        angle: TILT_DEG.to_radians(),
        least_points: LEAST_POINTS,
        most_planes: MOST_PLANES,
    };
    let found = planes((&view.points, &view.normals), &view.tree, &options, progress)?;
    Ok(found.iter().map(|plane| Patch::new(plane, view.voxel)).collect())
}

impl Patch {
    fn new(plane: &Plane, voxel: f64) -> Self {
        let n = plane.members.len() as f64;
        let narrow = plane.width().max(voxel);
        let mean = plane.roughness.powi(2) / n;
        Self {
            normal: plane.normal,
            middle: plane.centroid,
            covariance: plane.covariance,
            area: n * voxel * voxel,
            tilt: mean / narrow.powi(2) + LEAST_TILT.powi(2),
            off: mean + (LEAST_OFF * voxel).powi(2),
        }
    }
}

#[cfg(test)]
mod tests;
