//! Whether a turntable that was found may be believed.

use super::Turntable;
use super::fit::{median, off};
use super::pairs::ViewPair;
use super::refine::{N, Sums};
use crate::geom::Pose;
use crate::register::icp::{Verdict, View};
use nalgebra::{SVector, SymmetricEigen};
use std::fmt;

/// Neighbours that disagree, above this share: there is no turntable.
const MOST_ASTRAY: f64 = 0.2;
/// A view that goes elsewhere by this many voxels, and by [`FAR`] times the median, is astray.
const ASTRAY: f64 = 2.0;
const FAR: f64 = 4.0;
/// After a whole turn surfaces may be apart this many times what neighbours are.
const OPEN: f64 = 2.0;
/// A step that differs from the one given by more than this share is another.
const OTHER_STEP: f64 = 0.05;
/// As `icp` has it: a motion that a pair opposes by less than this on average is free.
const FREE: f64 = 2e-3;

/// What speaks against a turntable.
#[derive(Debug, Clone, PartialEq)]
pub enum TurntableDoubt {
    /// Views that turn otherwise than the others.
    Astray {
        /// Pairs of neighbours that do.
        n_astray: usize,
        /// All of them.
        n_pairs: usize,
        /// The view that the first of them leads to, counted from 1.
        first: usize,
        /// How far it leads astray [mm].
        off: f64,
    },
    /// After a whole turn the part is not where it was.
    Open {
        /// How far its surfaces are apart there, in the median [mm].
        apart: f64,
        /// And between neighbours [mm].
        usual: f64,
    },
    /// The views turn by another step than the one given.
    OtherStep {
        /// That of neighbours [deg].
        found_deg: f64,
        /// The one given [deg].
        given_deg: f64,
    },
    /// The views leave something open.
    Free(Vec<Looseness>),
}

/// What views may leave open.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Looseness {
    /// The direction of the axis.
    Tilt,
    /// Where the axis is.
    Place,
    /// The turn from view to view.
    Step,
}

impl TurntableDoubt {
    /// How much it speaks against the turntable.
    pub fn verdict(&self) -> Verdict {
        match self {
            Self::Astray { n_astray, n_pairs, .. }
                if *n_astray as f64 > MOST_ASTRAY * *n_pairs as f64 =>
            {
                Verdict::Failed
            }
            Self::Free(_) | Self::OtherStep { .. } => Verdict::Failed,
            _ => Verdict::Doubtful,
        }
    }
}

impl fmt::Display for TurntableDoubt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Astray { n_astray, n_pairs, first, off } => write!(
                f,
                "{n_astray} of {n_pairs} neighbouring views turn otherwise than the others, the first into view \
                 {first}, by {off:.2} mm: is it one turn, by even steps, before a camera that stands still?"
            ),
            Self::Open { apart, usual } => write!(
                f,
                "after a whole turn surfaces are {apart:.2} mm apart, between neighbours {usual:.2} mm"
            ),
            Self::OtherStep { found_deg, given_deg } => write!(
                f,
                "from view to view the part turns by {found_deg:.2} deg, not by {given_deg:.2} (--turntable-step)"
            ),
            Self::Free(what) => {
                let what: Vec<&str> = what.iter().map(|what| what.in_words()).collect();
                write!(
                    f,
                    "degenerate: the part looks alike from all sides, which leaves {} open; calibrate with \
                     another part",
                    what.join(" and ")
                )
            }
        }
    }
}

impl Looseness {
    fn in_words(self) -> &'static str {
        match self {
            Self::Tilt => "the direction of the axis",
            Self::Place => "the place of the axis",
            Self::Step => "the step",
        }
    }
}

/// What is held against what was found.
pub(super) struct Evidence<'a> {
    pub(super) views: &'a [Option<View>],
    pub(super) pairs: &'a [ViewPair],
    /// How each neighbour was laid over the next by itself: the view it leads to, counted from 1.
    pub(super) motions: &'a [(usize, Pose)],
    pub(super) sums: &'a Sums,
    /// Of the step, if it was given [rad].
    pub(super) given: Option<f64>,
    /// That of the neighbours alone [rad].
    pub(super) found: f64,
    pub(super) voxel: f64,
}

impl Evidence<'_> {
    pub(super) fn doubts(&self, turntable: &Turntable) -> Vec<TurntableDoubt> {
        let mut doubts = Vec::new();
        let free = self.free(turntable);
        if !free.is_empty() {
            doubts.push(TurntableDoubt::Free(free));
        }
        if let Some(given) = self.given
            && (self.found - given).abs() > OTHER_STEP * given
        {
            let [found_deg, given_deg] = [self.found, given].map(f64::to_degrees);
            doubts.push(TurntableDoubt::OtherStep { found_deg, given_deg });
        }
        doubts.extend(self.astray(turntable));
        if let Some(apart) = self.sums.closing
            && apart > OPEN * self.sums.open
        {
            doubts.push(TurntableDoubt::Open { apart, usual: self.sums.open });
        }
        doubts
    }

    fn astray(&self, turntable: &Turntable) -> Option<TurntableDoubt> {
        let off: Vec<(usize, f64)> = self
            .motions
            .iter()
            .filter_map(|(number, motion)| {
                let view = self.views[*number - 2].as_ref()?;
                Some((*number, off(motion, turntable, &view.center, view.radius)))
            })
            .collect();
        let sizes: Vec<f64> = off.iter().map(|(_, off)| *off).collect();
        let limit = (ASTRAY * self.voxel).max(FAR * median(&sizes));
        // Where most disagree the median is no measure.
        let limit = limit.min(2.0 * ASTRAY * self.voxel);
        let astray: Vec<_> = off.iter().filter(|(_, off)| *off > limit).collect();
        let (first, off) = **astray.first()?;
        let (n_astray, n_pairs) = (astray.len(), self.motions.len());
        Some(TurntableDoubt::Astray { n_astray, n_pairs, first, off })
    }

    /// What the pairs leave open, once each nudge is measured by how far it takes points.
    fn free(&self, turntable: &Turntable) -> Vec<Looseness> {
        let radii: Vec<f64> = self.views.iter().flatten().map(|view| view.radius).collect();
        let lever = median(&radii).max(f64::MIN_POSITIVE);
        let mean = |of: &dyn Fn(f64) -> f64| {
            let sum: f64 = self.pairs.iter().map(|pair| of(pair.n_steps()).powi(2)).sum();
            (sum / self.pairs.len().max(1) as f64).sqrt()
        };
        let chord = mean(&|n| 2.0 * (0.5 * n * turntable.step).sin());
        let turned = mean(&|n| n);
        let [tilt, place, step] = [lever * chord, chord, lever * turned];
        let scale = SVector::<f64, N>::from([tilt, tilt, place, place, step])
            .map(|size| 1.0 / size.max(1e-12));
        let scale = nalgebra::SMatrix::<f64, N, N>::from_diagonal(&scale);
        let mut held = scale * self.sums.information * scale / self.sums.n.max(1) as f64;
        if self.given.is_some() {
            held.row_mut(N - 1).fill(0.0);
            held.column_mut(N - 1).fill(0.0);
            held[(N - 1, N - 1)] = 1.0;
        }
        let eigen = SymmetricEigen::new(held);
        let kinds =
            [Looseness::Tilt, Looseness::Tilt, Looseness::Place, Looseness::Place, Looseness::Step];
        let mut free: Vec<Looseness> = Vec::new();
        for k in (0..N).filter(|&k| eigen.eigenvalues[k] < FREE) {
            let kind = kinds[eigen.eigenvectors.column(k).iamax()];
            if !free.contains(&kind) {
                free.push(kind);
            }
        }
        free
    }
}
