//! Whether planes speak for a pose, or lie on each other by chance.

use super::Walls;
use super::consensus::Meetings;
use crate::geom::Pose;
use serde::Serialize;
use std::collections::BTreeSet;

/// Planes that fix a pose: these lie on each other at any that was made from them.
const MADE_FROM: f64 = 3.0;
/// So many more must agree,
const LEAST: f64 = 2.0;
/// and this many times what chance gives.
const BUNCH: f64 = 2.0;
/// A plane agrees after the fine stage if it is no farther off than this share of the tolerance that
/// starts are found with.
const FINE: f64 = 0.5;

/// How many planes a pose lays on each other, and how many it would by chance.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PlaneSupport {
    /// Planes of the source and of the target.
    pub n_planes: [usize; 2],
    /// Those that the pose lays on each other, along the planes too.
    pub n_agreeing: usize,
    /// How many planes would agree after any shift along their normals.
    pub by_chance: f64,
}

impl PlaneSupport {
    /// Of `pose` by `walls`, which lie somewhere within `size`.
    pub(in crate::register::coarse) fn of(pose: &Pose, walls: &Walls, size: f64) -> Self {
        let meetings = Meetings::new(walls, pose.rotation);
        let shift = &pose.translation.vector;
        let tolerance = FINE * walls.tolerance;
        let (mut agreeing, mut by_chance) = ([BTreeSet::new(), BTreeSet::new()], 0.0);
        for run in meetings.all.chunk_by(|a, b| a.places[0] == b.places[0]) {
            let over = || run.iter().filter(|meeting| meeting.overlap(shift) > 0.0);
            by_chance += (over().count() as f64 * 2.0 * tolerance / size).min(1.0);
            for meeting in over().filter(|meeting| meeting.apart(shift) < tolerance) {
                agreeing.iter_mut().zip(meeting.places).for_each(|(side, i)| {
                    side.insert(i);
                });
            }
        }
        let n_agreeing = agreeing.iter().map(BTreeSet::len).fold(usize::MAX, usize::min);
        Self { n_planes: walls.n_planes(), n_agreeing, by_chance }
    }

    /// True if neither chance nor the making of the pose explains it.
    pub fn is_enough(&self) -> bool {
        self.n_agreeing as f64 >= MADE_FROM + LEAST + BUNCH * self.by_chance
    }
}
