//! Two frames laid over each other by a motion: does each see what the other does?
//!
//! No method is asked, and so every method can be judged by it. A point that one camera sees, and that
//! lies well before what the other sees there, would have been in its way: it saw through it.

use super::Look;
use crate::geom::Pose;
use rayon::prelude::*;

/// Every so many pixels of every so many rows are looked at.
const STEP: usize = 4;
/// Depths that differ by no more than this share are one surface: noise, edges, and a depth that is not
/// of the same moment as its colour.
const SAME: f64 = 0.03;
/// Fewer points say nothing.
const LEAST: usize = 100;
/// Brightness differing by this much says no more than that it is different.
const MOST_DIFFERENT: f32 = 0.25;

/// How well two frames agree.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Agreement {
    /// The share of the previous frame's points, and of the next one's, that the other shows too.
    pub overlap: [f64; 2],
    /// Of the points that the other frame has depth for, the share it saw through; the larger of both
    /// directions.
    pub seen_through: f64,
    /// Mean difference of brightness where surfaces agree, after the mean of each is taken away, 0 to 1;
    /// NaN without colours.
    pub brightness: f64,
}

/// Counts of one direction.
#[derive(Debug, Clone, Copy, Default)]
struct Counts {
    n_points: usize,
    n_fits: usize,
    n_through: usize,
    brightness: [f64; 2],
    difference: f64,
}

/// Lays `next` over `previous` and compares; `None` if too few points come to lie in both.
pub fn agreement(previous: &Look, next: &Look, previous_from_next: &Pose) -> Option<Agreement> {
    let sides =
        [(next, previous, *previous_from_next), (previous, next, previous_from_next.inverse())];
    let sides = sides.map(|(from, onto, onto_from_here)| {
        let first = counted(from, onto, &onto_from_here, 0.0);
        // Once more with what exposure has changed taken away.
        let n = first.n_fits.max(1) as f64;
        counted(from, onto, &onto_from_here, (first.brightness[1] - first.brightness[0]) / n)
    });
    if sides.iter().any(|counts| counts.n_fits + counts.n_through < LEAST) {
        return None;
    }
    let share = |n: usize, of: usize| n as f64 / of.max(1) as f64;
    let [back, there] = sides.map(|c| share(c.n_fits, c.n_points));
    let through = sides.map(|c| share(c.n_through, c.n_fits + c.n_through));
    let n_fits = sides[0].n_fits + sides[1].n_fits;
    Some(Agreement {
        overlap: [there, back],
        seen_through: through[0].max(through[1]),
        brightness: (sides[0].difference + sides[1].difference) / n_fits.max(1) as f64,
    })
}

fn counted(from: &Look, onto: &Look, onto_from_here: &Pose, brighter: f64) -> Counts {
    let depth = &from.frame.depth;
    let rows: Vec<usize> = (0..depth.height()).step_by(STEP).collect();
    let of_row = |&y: &usize| {
        let mut counts = Counts::default();
        for x in (0..depth.width()).step_by(STEP) {
            let z = f64::from(depth[(x, y)]);
            if z <= 0.0 {
                continue;
            }
            counts.n_points += 1;
            let point = onto_from_here * from.camera.unproject([x as f64, y as f64], z);
            let Some(at) = onto.camera.project(&point).filter(|at| onto.camera.sees(*at)) else {
                continue;
            };
            let [u, v] = at.map(|c| c.round().max(0.0) as usize);
            let Some(&other) = onto.frame.depth.get(u, v).filter(|other| **other > 0.0) else {
                continue;
            };
            let other = f64::from(other);
            if point.z < other * (1.0 - SAME) {
                counts.n_through += 1;
            } else if point.z <= other * (1.0 + SAME) {
                counts.n_fits += 1;
                let (Some(here), Some(there)) = (from.grey(), onto.grey()) else {
                    counts.difference = f64::NAN;
                    continue;
                };
                let (here, there) = (here[(x, y)], there.between(at[0], at[1]));
                let there = there.unwrap_or(onto.grey().map_or(0.0, |grey| grey[(u, v)]));
                counts.brightness[0] += f64::from(here);
                counts.brightness[1] += f64::from(there);
                let difference = (there - here - brighter as f32).abs().min(MOST_DIFFERENT);
                counts.difference += f64::from(difference);
            }
        }
        counts
    };
    let counts: Vec<Counts> = rows.par_iter().map(of_row).collect();
    counts.iter().fold(Counts::default(), |sum, row| Counts {
        n_points: sum.n_points + row.n_points,
        n_fits: sum.n_fits + row.n_fits,
        n_through: sum.n_through + row.n_through,
        brightness: [0, 1].map(|k| sum.brightness[k] + row.brightness[k]),
        difference: sum.difference + row.difference,
    })
}
