//! Pairing: the nearest target point of every source point that is asked.
//!
//! Between iterations a cloud hardly moves, and most answers stand. With every answer is kept how far
//! off the next target point was: as long as the source point has moved by less than what lies between
//! the two, no other point can have become the nearest, and it is not asked again. Else what was the
//! next point limits how far the new search must look.

use super::cost::{CHUNK, Motion};
use super::options::Pairing;
use super::projective::Projective;
use super::view::View;
use crate::geom::{Nearest, Point3, VoxelMap};
use rayon::prelude::*;

/// Cells of the voxel map, in voxels.
const MAP_CELL: f64 = 3.0;
/// A search looks this much farther than it must, in voxels, so that its answer lasts.
const SPARE: f64 = 1.0;
/// The trees' distances are rounded by less than this share of the cloud's size.
const ROUNDING: f64 = 1e-6;

/// A source point with the target point it belongs to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Pair {
    pub(super) source: u32,
    pub(super) target: u32,
    /// How far apart they are [mm].
    pub(super) distance: f64,
    pub(super) weight: f64,
    /// True if the target point looked for the source point.
    pub(super) is_turned: bool,
}

impl Pair {
    /// Source and target swapped.
    pub(super) fn turned(&self) -> Self {
        let is_turned = !self.is_turned;
        Self { source: self.target, target: self.source, is_turned, ..*self }
    }
}

/// Looks for partners, and remembers them.
pub(super) struct Pairs<'a> {
    source: &'a View,
    target: &'a View,
    /// What finds partners, if not the target's tree.
    finder: Option<Box<dyn Nearest + 'a>>,
    /// The source points that look for a partner.
    asked: Vec<u32>,
    known: Vec<Known>,
}

/// What the last search of a point found.
#[derive(Debug, Clone, Copy)]
struct Known {
    /// Where the point was.
    from: Point3,
    first: Option<u32>,
    second: Option<u32>,
    /// No target point but the first was nearer than this [mm].
    clear: f64,
}

impl<'a> Pairs<'a> {
    pub(super) fn new(source: &'a View, target: &'a View, pairing: Pairing) -> Self {
        let finder: Option<Box<dyn Nearest + 'a>> = match (pairing, target.camera) {
            (Pairing::VoxelMap, _) => {
                Some(Box::new(VoxelMap::build(&target.points, MAP_CELL * target.voxel)))
            }
            (Pairing::Projective, Some(camera)) => Some(Box::new(Projective::new(target, camera))),
            // Without a camera, only a direction that nobody asks for comes here.
            (Pairing::KdTree | Pairing::Projective, _) => None,
        };
        Self { source, target, finder, asked: Vec::new(), known: Vec::new() }
    }

    /// Asks for these source points from now on; what is known of others is forgotten.
    pub(super) fn ask(&mut self, asked: Vec<u32>) {
        // Moved by infinity since: whatever is asked is looked for.
        let unknown = Known {
            from: Point3::new(f64::INFINITY, 0.0, 0.0),
            first: None,
            second: None,
            clear: 0.0,
        };
        let mut by_point = vec![unknown; self.source.len()];
        for (&i, known) in self.asked.iter().zip(&self.known) {
            by_point[i as usize] = *known;
        }
        self.known = asked.iter().map(|&i| by_point[i as usize]).collect();
        self.asked = asked;
    }

    /// The pairs no longer than `within` where `motion` puts the source, in the order asked.
    pub(super) fn find(&mut self, motion: &Motion, within: f64) -> Vec<Pair> {
        let (source, target) = (self.source, self.target);
        let nearest: &dyn Nearest = self.finder.as_deref().unwrap_or(&target.tree);
        let search = Search {
            nearest,
            targets: &target.points,
            within,
            spare: SPARE * target.voxel,
            slack: ROUNDING * (target.radius + source.radius),
        };
        let chunks: Vec<Vec<Pair>> = self
            .asked
            .par_chunks(CHUNK)
            .zip(self.known.par_chunks_mut(CHUNK))
            .map(|(asked, known)| {
                let each = asked.iter().zip(known);
                each.filter_map(|(&i, known)| {
                    let at = motion.apply(&source.points[i as usize]);
                    let (target, distance) = search.partner(&at, known)?;
                    Some(Pair { source: i, target, distance, weight: 1.0, is_turned: false })
                })
                .collect()
            })
            .collect();
        chunks.concat()
    }
}

struct Search<'a> {
    nearest: &'a dyn Nearest,
    targets: &'a [Point3],
    within: f64,
    spare: f64,
    slack: f64,
}

impl Search<'_> {
    /// The target point nearest to `at`, and how far off it is.
    fn partner(&self, at: &Point3, known: &mut Known) -> Option<(u32, f64)> {
        let distance = |i: u32| (at - self.targets[i as usize]).norm();
        let moved = (at - known.from).norm();
        let clear = known.clear - moved;
        let here = known.first.map(|i| (i, distance(i)));
        match here {
            Some((_, off)) if off <= clear => {}
            None if self.within <= clear => {}
            _ => *known = self.look(at, known.second.map(distance)),
        }
        let found = known.first.map(|i| (i, distance(i)));
        found.filter(|(_, off)| *off <= self.within)
    }

    /// `next`: how far off some target point that is not the nearest lies, if one is known.
    fn look(&self, at: &Point3, next: Option<f64>) -> Known {
        let reach = self.within + self.spare;
        let limit = next.map_or(reach, |next| reach.min(next + self.slack));
        let [first, second] = self.nearest.two_nearest(at, limit);
        // The map does not look as far as it is told to.
        let seen = self.nearest.reach().min(limit);
        let clear = second.map_or(seen, |second| second.distance) - self.slack;
        let [first, second] = [first, second].map(|found| found.map(|found| found.index));
        Known { from: *at, first, second, clear }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{options, relief};
    use super::super::view::View;
    use super::*;
    use crate::geom::{Pose, Vector3};
    use crate::progress::Silent;
    use crate::register::icp::Role;

    #[test]
    fn remembered_partners_are_those_a_new_search_finds() {
        let cloud = relief(4000);
        let view = View::new(&cloud, Role::Source, options(0.8), &Silent).unwrap();
        for pairing in [Pairing::KdTree, Pairing::VoxelMap] {
            let asked: Vec<u32> = (0..view.len() as u32).collect();
            let mut remembers = Pairs::new(&view, &view, pairing);
            remembers.ask(asked.clone());
            // From far to near, as an alignment goes, with the distance shrinking too.
            for i in 0..12 {
                let share = 0.6_f64.powi(i);
                let pose = Pose::new(
                    Vector3::new(4.0, -3.0, 2.0) * share,
                    Vector3::new(0.1, 0.2, -0.1) * share,
                );
                let within = (6.0 * share).max(1.0);
                let mut forgets = Pairs::new(&view, &view, pairing);
                forgets.ask(asked.clone());
                let motion = Motion::from(&pose);
                let (old, new) = (remembers.find(&motion, within), forgets.find(&motion, within));
                assert_eq!(old.len(), new.len(), "{i}");
                for (a, b) in old.iter().zip(&new) {
                    assert_eq!(a.source, b.source);
                    assert!((a.distance - b.distance).abs() < 1e-4, "{i}: {a:?} {b:?}");
                }
            }
        }
    }
}
