//! Planes of a cloud: walls, floors, tables, the faces of boxes and fixtures.
//!
//! From the smoothest places a region grows over neighbours that lie on its plane, normals and all
//! ([`grow`]); so nothing is drawn, and a plane never takes the strip of a surface that it crosses. A
//! region that bends as far as it is allowed to is a piece of something round, and is none ([`flat`]);
//! nor is one that is hardly wider than thick.
//! Pieces that touch and lie on one plane become one; those that do not touch stay apart, even on
//! one plane: what lies between them is not known, and whoever wants them as one can see that they are.
//!
//! Region growing after Poppinga, Vaskevicius, Birk and Pathak (2008), with the refit at every
//! doubling of the reach instead of at every point.

mod flat;
mod grow;
mod merge;

use super::{KdTree, Matrix3, Point3, Vector3};
use crate::progress::{Cancelled, Progress};
use flat::{Fit, width};
use grow::Ground;
use merge::merged;
use std::cmp::Reverse;

/// A plane, and which points lie on it.
#[derive(Debug, Clone, PartialEq)]
pub struct Plane {
    /// Unit normal, to the side that most of its members' normals point to: what those do not say,
    /// this does not either.
    pub normal: Vector3,
    /// Where it is along the normal: `normal . p` of its points [mm].
    pub offset: f64,
    /// The mean of its members.
    pub centroid: Point3,
    /// Its members' covariance about the centroid [mm2].
    pub covariance: Matrix3,
    /// How far its members lie off it, root mean square [mm].
    pub roughness: f64,
    /// Places of its points in the cloud, rising.
    pub members: Vec<u32>,
}

/// What counts as a plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaneOptions {
    /// Its points lie no farther off [mm]; some three times the noise.
    pub tolerance: f64,
    /// Their normals enclose no greater angle with its own.
    pub angle: f64,
    /// It has no fewer points.
    pub least_points: usize,
    /// Those with the most points are kept, no more than this.
    pub most_planes: usize,
}

/// The planes of a cloud, those with the most points first.
///
/// `tree` was built over the finite `points`; the side that `normals` point to is no matter. The
/// cloud should be about evenly dense, as after a voxel grid: of places many points share, nothing
/// grows.
pub fn planes(
    (points, normals): (&[Point3], &[Vector3]),
    tree: &KdTree,
    options: &PlaneOptions,
    progress: &dyn Progress,
) -> Result<Vec<Plane>, Cancelled> {
    let mut ground = Ground::new((points, normals), tree, *options, progress)?;
    let mut found = Vec::new();
    for seed in ground.seeds() {
        if ground.is_tried(seed) {
            continue;
        }
        progress.advance(0)?;
        let Some((fit, members)) = ground.grown(seed) else { continue };
        if members.len() >= options.least_points.max(3) && ground.is_flat(&fit, &members) {
            found.push((fit, ground.taken(members, found.len() as u32)));
        }
    }
    let mut found: Vec<Plane> = merged(&mut ground, found)
        .into_iter()
        .map(|(fit, mut members)| {
            members.sort_unstable();
            Plane::new(&fit, members, normals)
        })
        .collect();
    found.sort_by_key(|plane| (Reverse(plane.members.len()), plane.members[0]));
    found.truncate(options.most_planes);
    Ok(found)
}

impl Plane {
    fn new(fit: &Fit, members: Vec<u32>, normals: &[Vector3]) -> Self {
        let sides: f64 = members.iter().map(|&i| normals[i as usize].dot(&fit.normal)).sum();
        let normal = if sides < 0.0 { -fit.normal } else { fit.normal };
        Self {
            normal,
            offset: normal.dot(&fit.centroid.coords),
            centroid: fit.centroid,
            covariance: fit.covariance,
            roughness: fit.roughness,
            members,
        }
    }

    /// How wide it is across its longer direction, root mean square of its members [mm].
    pub fn width(&self) -> f64 {
        width(&self.covariance, &self.normal)
    }

    /// How far a point lies off, along the normal [mm].
    pub fn distance(&self, point: &Point3) -> f64 {
        self.normal.dot(&(point - self.centroid))
    }
}

#[cfg(test)]
mod tests;
