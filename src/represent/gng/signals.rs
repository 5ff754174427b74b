//! Signals: points drawn at random, the same ones for the same seed whether the cloud lies in memory or comes
//! in parts.

use super::network::Place;
use crate::geom::{Aabb, CloudParts, PartError, Point3};
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;

/// Clouds of no more points than this are held [12 bytes each].
const HELD: u64 = 1 << 25;
/// Signals of a larger cloud picked out in one pass through it [20 bytes each].
const BLOCK: usize = 1 << 24;

/// A stream of signals without end.
pub(super) struct Signals<'a> {
    origin: Point3,
    n_points: u64,
    draws: Pcg64Mcg,
    points: Points<'a>,
}

enum Points<'a> {
    Held(Vec<Place>),
    Streamed {
        parts: &'a mut dyn CloudParts,
        /// The signals of the last pass, and how many of them were given away.
        block: Vec<Place>,
        n_given: usize,
        n_block: usize,
    },
}

impl<'a> Signals<'a> {
    /// Signals from the points of `parts`, in the box `aabb`.
    pub(super) fn new(
        parts: &'a mut dyn CloudParts,
        aabb: &Aabb,
        seed: u64,
    ) -> Result<Self, PartError> {
        let is_held = parts.n_points() <= HELD;
        Self::with(parts, aabb, seed, is_held, BLOCK)
    }

    fn with(
        parts: &'a mut dyn CloudParts,
        aabb: &Aabb,
        seed: u64,
        is_held: bool,
        n_block: usize,
    ) -> Result<Self, PartError> {
        let origin = aabb.center();
        let n_points = parts.n_points();
        let draws = Pcg64Mcg::seed_from_u64(seed);
        let points = if is_held {
            let mut held = Vec::with_capacity(n_points as usize);
            parts.each_part(&mut |part| {
                held.par_extend(part.points.par_iter().map(|point| place(point, &origin)));
                Ok(())
            })?;
            Points::Held(held)
        } else {
            Points::Streamed { parts, block: Vec::new(), n_given: 0, n_block }
        };
        Ok(Self { origin, n_points, draws, points })
    }

    /// The next signals.
    pub(super) fn fill(&mut self, signals: &mut [Place]) -> Result<(), PartError> {
        let n_points = self.n_points;
        match &mut self.points {
            // Draws first, points after: so the waits for memory overlap.
            Points::Held(points) => {
                for signal in signals {
                    *signal = points[draw(&mut self.draws, n_points) as usize];
                }
            }
            Points::Streamed { parts, block, n_given, n_block } => {
                let mut rest = signals;
                while !rest.is_empty() {
                    if *n_given == block.len() {
                        pick(block, *n_block, *parts, &self.origin, &mut self.draws)?;
                        *n_given = 0;
                    }
                    let n = rest.len().min(block.len() - *n_given);
                    let (now, later) = rest.split_at_mut(n);
                    now.copy_from_slice(&block[*n_given..*n_given + n]);
                    *n_given += n;
                    rest = later;
                }
            }
        }
        Ok(())
    }
}

/// Where a point is from the middle of the cloud.
pub(super) fn place(point: &Point3, origin: &Point3) -> Place {
    let out = point - origin;
    [out.x as f32, out.y as f32, out.z as f32]
}

/// A number below `n`.
fn draw(draws: &mut Pcg64Mcg, n: u64) -> u64 {
    ((u128::from(draws.next_u64()) * u128::from(n)) >> 64) as u64
}

/// The next `n_block` signals, picked out of the cloud in one pass: they are drawn first, sorted by where they
/// are in the cloud, and each is put where it was drawn.
fn pick(
    block: &mut Vec<Place>,
    n_block: usize,
    parts: &mut dyn CloudParts,
    origin: &Point3,
    draws: &mut Pcg64Mcg,
) -> Result<(), PartError> {
    let n_points = parts.n_points();
    block.resize(n_block, [0.0; 3]);
    let mut wanted: Vec<(u64, u32)> =
        (0..n_block as u32).map(|slot| (draw(draws, n_points), slot)).collect();
    wanted.par_sort_unstable();
    let mut wanted = wanted.into_iter().peekable();
    let mut n_before = 0;
    parts.each_part(&mut |part| {
        let n_after = n_before + part.points.len() as u64;
        while let Some((i, slot)) = wanted.next_if(|(i, _)| *i < n_after) {
            block[slot as usize] = place(&part.points[(i - n_before) as usize], origin);
        }
        n_before = n_after;
        Ok(())
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::{CloudPart, PointCloud};

    /// A cloud that comes in parts of seven points.
    pub(in super::super) struct Sevens(pub PointCloud);

    impl CloudParts for Sevens {
        fn n_points(&self) -> u64 {
            self.0.points.len() as u64
        }

        fn each_part(
            &mut self,
            take: &mut dyn FnMut(CloudPart<'_>) -> Result<(), PartError>,
        ) -> Result<(), PartError> {
            self.0
                .points
                .chunks(7)
                .try_for_each(|points| take(CloudPart { points, normals: None, colors: None }))
        }
    }

    #[test]
    fn signals_are_the_same_from_memory_and_from_parts() {
        let points = (0..100).map(|i| Point3::new(f64::from(i), 0.0, 1.0)).collect();
        let cloud = PointCloud { points, ..PointCloud::default() };
        let aabb = cloud.aabb();
        let drawn = |parts: &mut dyn CloudParts, is_held| {
            let mut signals = Signals::with(parts, &aabb, 5, is_held, 64).unwrap();
            let mut all = [[0.0; 3]; 150];
            let (first, second) = all.split_at_mut(41);
            signals.fill(first).unwrap();
            signals.fill(second).unwrap();
            all
        };
        let held = drawn(&mut &cloud, true);
        assert_eq!(held, drawn(&mut Sevens(cloud.clone()), false));
        assert_eq!(held, drawn(&mut Sevens(cloud.clone()), true));
        let n_low = held.iter().filter(|place| place[0] < 0.0).count();
        assert!((50..100).contains(&n_low), "drawn evenly: {n_low} of 150 in the lower half");
    }
}
