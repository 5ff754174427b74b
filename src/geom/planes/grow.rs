//! A region grows from a seed over neighbours that lie on its plane.

use super::PlaneOptions;
use super::flat::{Fit, bend, wave};
use crate::geom::{KdTree, Point3, Vector3};
use crate::progress::{Cancelled, Progress};

/// Neighbours that a region goes on to.
const LINKS: usize = 8;
/// The first reach of a region: the farthest neighbour of its seed, times this. Far enough that the
/// first fit knows its normal better than the seed did.
const FIRST_REACH: f64 = 4.0;
/// Fits of a region at most once it has reached all of it; a few points may go to and fro.
const LAST_FITS: u32 = 3;
/// A region is bent if its height waves by more than this share of the tolerance, root mean square: what
/// grew over a round surface until that stopped it waves by 0.45 (along a cylinder) to 0.58 (on a ball) of
/// it, and a wall before a depth camera, whose noise neighbours share, by up to 0.33;
const WAVES: f64 = 0.4;
/// or if its normals turn by more than this share of the angle: round ones that the angle stopped by 0.58
/// to 0.71;
const BENDS: f64 = 0.45;
/// or by more than this that their noise does not explain, walls by less than 0.08. Of the round ones that the
/// tolerance stopped it tells all that are not very wide, whose few rows of points say little about
/// waves.
const PLAINLY_BENDS: f64 = 0.12;
/// No link, and not in any plane.
pub(super) const NONE: u32 = u32::MAX;

/// The cloud, what hangs together in it, and what is taken.
pub(super) struct Ground<'a> {
    points: &'a [Point3],
    normals: &'a [Vector3],
    options: PlaneOptions,
    links: Vec<[u32; LINKS]>,
    /// The plane each point belongs to.
    owner: Vec<u32>,
    /// True for points of regions that were grown already.
    is_tried: Vec<bool>,
    /// The last walk that came by.
    visited: Vec<u32>,
    n_walks: u32,
}

impl<'a> Ground<'a> {
    pub(super) fn new(
        (points, normals): (&'a [Point3], &'a [Vector3]),
        tree: &KdTree,
        options: PlaneOptions,
        progress: &dyn Progress,
    ) -> Result<Self, Cancelled> {
        progress.start("planes", points.len() as u64);
        let links = tree.map_neighbourhoods(points, LINKS + 1, progress, |i, found| {
            let mut links = [NONE; LINKS];
            let others = found.iter().map(|neighbour| neighbour.index).filter(|&j| j != i as u32);
            links.iter_mut().zip(others).for_each(|(link, j)| *link = j);
            links
        })?;
        Ok(Self {
            points,
            normals,
            options,
            links,
            owner: vec![NONE; points.len()],
            is_tried: vec![false; points.len()],
            visited: vec![0; points.len()],
            n_walks: 0,
        })
    }

    /// All points whose neighbours' normals agree with theirs on the mean, the smoothest first.
    pub(super) fn seeds(&self) -> Vec<u32> {
        let most = 1.0 - self.options.angle.cos();
        let bend = |i: u32| {
            let normal = &self.normals[i as usize];
            let bends = self.linked(i).map(|j| 1.0 - self.normals[j as usize].dot(normal).abs());
            bends.sum::<f64>() / self.linked(i).count().max(1) as f64
        };
        let mut seeds: Vec<(f64, u32)> = (0..self.points.len() as u32)
            .map(|i| (bend(i), i))
            .filter(|(b, _)| *b < most)
            .collect();
        seeds.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        seeds.into_iter().map(|(_, i)| i).collect()
    }

    /// True if a region with this point was grown already.
    pub(super) fn is_tried(&self, i: u32) -> bool {
        self.is_tried[i as usize]
    }

    /// The region about a seed when it has settled, and its plane; `None` if there is hardly any.
    pub(super) fn grown(&mut self, seed: u32) -> Option<(Fit, Vec<u32>)> {
        let here = self.points[seed as usize];
        let nearest = self.linked(seed).map(|j| (self.points[j as usize] - here).norm());
        // Of places that many points share the nearest are no way off.
        let least = self.options.tolerance.max(f64::MIN_POSITIVE);
        let mut reach = (FIRST_REACH * nearest.fold(0.0, f64::max)).max(least);
        let mut fit = Fit::tangent(here, self.normals[seed as usize]);
        let mut before: Vec<u32> = Vec::new();
        self.is_tried[seed as usize] = true;
        let mut n_last = 0;
        while n_last < LAST_FITS {
            let (members, is_all) = self.connected(seed, &fit, reach);
            // What is tried already comes to the same again: this seed is of its fringe.
            let n_tried = members.iter().filter(|&&i| self.is_tried[i as usize]).count();
            if members.len() < 3 || 2 * n_tried > members.len() + 2 {
                return None;
            }
            fit = Fit::of(self.points, &members);
            if is_all {
                n_last = if members == before { LAST_FITS } else { n_last + 1 };
            }
            before = members;
            reach *= 2.0;
        }
        for &i in &before {
            self.is_tried[i as usize] = true;
        }
        Some((fit, before))
    }

    /// What hangs together with `seed` on a plane, as far as `reach`, and whether that is all of it.
    fn connected(&mut self, seed: u32, fit: &Fit, reach: f64) -> (Vec<u32>, bool) {
        self.n_walks += 1;
        let least = self.options.angle.cos();
        let start = self.points[seed as usize];
        let (mut members, mut is_all) = (vec![seed], true);
        self.visited[seed as usize] = self.n_walks;
        let mut next = 0;
        while next < members.len() {
            for link in self.links[members[next] as usize] {
                let i = link as usize;
                if link == NONE || self.visited[i] == self.n_walks || self.owner[i] != NONE {
                    continue;
                }
                self.visited[i] = self.n_walks;
                let point = &self.points[i];
                let is_on = fit.distance(point).abs() <= self.options.tolerance
                    && self.normals[i].dot(&fit.normal).abs() >= least;
                if is_on && (point - start).norm() > reach {
                    is_all = false;
                } else if is_on {
                    members.push(link);
                }
            }
            next += 1;
        }
        (members, is_all)
    }

    /// True unless the region bends so far that only the limits ended it, or is a mere line.
    pub(super) fn is_flat(&mut self, fit: &Fit, members: &[u32]) -> bool {
        if fit.width() < self.options.tolerance {
            return false;
        }
        self.n_walks += 1;
        for &i in members {
            self.visited[i as usize] = self.n_walks;
        }
        let height = |i: u32| fit.distance(&self.points[i as usize]);
        let pairs = members.iter().flat_map(|&i| self.linked(i).map(move |j| (i, j)));
        let pairs = pairs.filter(|(_, j)| self.visited[*j as usize] == self.n_walks);
        let [bends, plainly] = bend(fit, self.points, self.normals, members);
        wave(pairs.map(|(i, j)| height(i) * height(j))) <= WAVES * self.options.tolerance
            && bends <= BENDS * self.options.angle
            && plainly <= PLAINLY_BENDS * self.options.angle
    }

    /// Gives the points to a plane.
    pub(super) fn taken(&mut self, members: Vec<u32>, i_plane: u32) -> Vec<u32> {
        for &i in &members {
            self.owner[i as usize] = i_plane;
        }
        members
    }

    /// The planes that touch, each two once, by their numbers.
    pub(super) fn touching(&self) -> Vec<[u32; 2]> {
        let mut pairs: Vec<[u32; 2]> = (0..self.points.len() as u32)
            .flat_map(|i| self.linked(i).map(move |j| (i, j)))
            .map(|(i, j)| [self.owner[i as usize], self.owner[j as usize]])
            .filter(|[a, b]| a != b && *a != NONE && *b != NONE)
            .map(|[a, b]| [a.min(b), a.max(b)])
            .collect();
        pairs.sort_unstable();
        pairs.dedup();
        pairs
    }

    /// The plane through these points, if all of it lies within the limits and does not bend.
    pub(super) fn as_one(&mut self, members: &[u32]) -> Option<Fit> {
        let fit = Fit::of(self.points, members);
        let is_on =
            |i: &&u32| fit.distance(&self.points[**i as usize]).abs() <= self.options.tolerance;
        let n_off = members.len() - members.iter().filter(is_on).count();
        // Each piece lay within the limits of its own plane; of the common one a few may be beyond.
        (50 * n_off <= members.len() && self.is_flat(&fit, members)).then_some(fit)
    }

    fn linked(&self, i: u32) -> impl Iterator<Item = u32> {
        self.links[i as usize].into_iter().filter(|&j| j != NONE)
    }
}
