//! All views together: the turntable under which their surfaces lie on each other best.
//!
//! Gauss-Newton over the tilt of the axis, its place, and the step, point to plane (Chen and Medioni,
//! 1992), pairs of points found anew at every step, residuals weighed after Geman and `McClure`.

use super::Turntable;
use super::fit::median;
use super::pairs::ViewPair;
use crate::geom::{Nearest, Point3, Pose, Vector3};
use crate::register::icp::View;
use nalgebra::{SMatrix, SVector, Unit, UnitQuaternion};
use rayon::prelude::*;

/// What may be refined: two tilts of the axis, two shifts of it, and the step.
pub(super) const N: usize = 5;
type Row = SVector<f64, N>;
type Square = SMatrix<f64, N, N>;

/// Points of a view that look for a partner, about.
const SAMPLES: usize = 600;
/// Steps at most.
const ITERATIONS: usize = 30;
/// Normals of a pair of points enclose no more than this: 37 degrees.
const COSINE: f64 = 0.8;
/// By this the turntable is nudged to see how points move [rad], and its axis [mm].
const NUDGE: [f64; 2] = [1e-6, 1e-4];
/// A step that moves no point farther than this share of a voxel is the last.
const STILL: f64 = 1e-4;
/// Residuals lose weight from this many times their median on.
const DOUBTFUL: f64 = 3.0;

/// Views, and which are laid over each other.
pub(super) struct Refinement<'a> {
    /// None of a view that shows nothing.
    pub(super) views: &'a [Option<View>],
    pub(super) pairs: &'a [ViewPair],
    /// False if the step is known.
    pub(super) has_free_step: bool,
}

/// What the pairs say of a turntable.
#[derive(Debug, Clone)]
pub(super) struct Sums {
    squares: Square,
    gradient: Row,
    /// Of rows, unweighted: how the pairs hold each motion.
    pub(super) information: Square,
    pub(super) n: usize,
    /// Median distance from the tangent planes: of pairs that close a turn, and of the others [mm].
    pub(super) closing: Option<f64>,
    pub(super) open: f64,
}

/// A pair of points: how the residual changes, and what it is.
struct Told {
    row: Row,
    residual: f64,
    is_closing: bool,
}

impl Refinement<'_> {
    /// From `turntable` to the best there is; points farther apart than `within` are no pair.
    pub(super) fn run(&self, turntable: &Turntable, within: f64) -> (Turntable, Sums) {
        let mut best = *turntable;
        for _ in 0..ITERATIONS {
            let sums = self.sums(&best, within);
            let Some(step) = sums.step(self.has_free_step) else { return (best, sums) };
            let next = best.nudged(&step);
            let is_still = self.moved(&best, &next) < STILL * within;
            best = next;
            if is_still {
                break;
            }
        }
        let sums = self.sums(&best, within);
        (best, sums)
    }

    /// Over all pairs of points.
    pub(super) fn sums(&self, turntable: &Turntable, within: f64) -> Sums {
        let of_pairs: Vec<Vec<Told>> =
            self.pairs.par_iter().map(|pair| self.told(*pair, turntable, within)).collect();
        let told: Vec<&Told> = of_pairs.iter().flatten().collect();
        let sizes = |is_closing: bool| -> Vec<f64> {
            let those = told.iter().filter(|told| told.is_closing == is_closing);
            those.map(|told| told.residual.abs()).collect()
        };
        let (closing, open) = (sizes(true), sizes(false));
        let scale = DOUBTFUL * median(&open).max(median(&closing)).max(f64::MIN_POSITIVE);
        let mut sums = Sums {
            squares: Square::zeros(),
            gradient: Row::zeros(),
            information: Square::zeros(),
            n: told.len(),
            closing: (!closing.is_empty()).then(|| median(&closing)),
            open: median(&open),
        };
        for Told { row, residual, .. } in told {
            let weight = (1.0 + (residual / scale).powi(2)).powi(-2);
            sums.squares += row * row.transpose() * weight;
            sums.gradient += row * (weight * residual);
            sums.information += row * row.transpose();
        }
        sums
    }

    fn told(&self, pair: ViewPair, turntable: &Turntable, within: f64) -> Vec<Told> {
        let (Some(source), Some(target)) = (&self.views[pair.source], &self.views[pair.target])
        else {
            return Vec::new();
        };
        let motion = turntable.turned(pair.n_steps());
        let nudged = nudges().map(|[by, size]| {
            let [more, less] = [by, -by].map(|by| turntable.nudged(&by).turned(pair.n_steps()));
            (more, less, 0.5 / size[0])
        });
        let every = source.points.len().div_ceil(SAMPLES).max(1);
        let mut told = Vec::new();
        for i in (0..source.points.len()).step_by(every) {
            let point = source.points[i] + source.center.coords;
            let here = motion * point - target.center.coords;
            let Some(partner) = target.tree.nearest(&here, within) else { continue };
            let (place, normal) =
                (target.points[partner.index as usize], target.normals[partner.index as usize]);
            let own = motion.rotation * source.normals[i];
            let between = here - place;
            let residual = normal.dot(&between);
            // Beside the partner, not before or behind it: the target ends there.
            let is_beside = (between - normal * residual).norm() > 2.0 * target.voxel;
            if own.dot(&normal) < COSINE || is_beside {
                continue;
            }
            let change = |(more, less, share): &(Pose, Pose, f64)| {
                normal.dot(&((more * point) - (less * point))) * share
            };
            let row = Row::from(nudged.each_ref().map(change));
            told.push(Told { row, residual, is_closing: pair.is_closing });
        }
        told
    }

    /// How far the middle of the views goes at the farthest, from one turntable to another [mm].
    fn moved(&self, from: &Turntable, to: &Turntable) -> f64 {
        let ways = self.pairs.iter().filter_map(|pair| {
            let view = self.views[pair.source].as_ref()?;
            let [a, b] = [from, to].map(|turntable| turntable.turned(pair.n_steps()));
            let turn = a.rotation.angle_to(&b.rotation) * view.radius;
            Some((a * view.center - b * view.center).norm() + turn)
        });
        ways.fold(0.0, f64::max)
    }
}

/// One nudge of each kind, and its size.
fn nudges() -> [[Row; 2]; N] {
    std::array::from_fn(|k| {
        let size = if k == 2 || k == 3 { NUDGE[1] } else { NUDGE[0] };
        let mut by = Row::zeros();
        by[k] = size;
        [by, Row::repeat(size)]
    })
}

impl Turntable {
    /// The turntable with its axis tilted and shifted across itself, and its step changed.
    fn nudged(&self, by: &Row) -> Self {
        let across = self.across();
        let tilt = UnitQuaternion::from_scaled_axis(across[0] * by[0] + across[1] * by[1]);
        Self {
            axis: Unit::new_normalize(tilt * self.axis).into_inner(),
            through: self.through + across[0] * by[2] + across[1] * by[3],
            step: self.step + by[4],
        }
    }

    /// Two directions across the axis, and each other.
    fn across(&self) -> [Vector3; 2] {
        let least = Vector3::ith(self.axis.iamin(), 1.0);
        let first = self.axis.cross(&least).normalize();
        [first, self.axis.cross(&first)]
    }

    /// The same axis, named by its point nearest to `place`.
    pub(super) fn near(&self, place: &Point3) -> Self {
        let along = self.axis.dot(&(place - self.through));
        Self { through: self.through + self.axis * along, ..*self }
    }
}

impl Sums {
    fn step(&self, has_free_step: bool) -> Option<Row> {
        let (mut squares, mut gradient) = (self.squares, self.gradient);
        if !has_free_step {
            squares.row_mut(N - 1).fill(0.0);
            squares.column_mut(N - 1).fill(0.0);
            squares[(N - 1, N - 1)] = 1.0;
            gradient[N - 1] = 0.0;
        }
        // What nothing holds stays where it is.
        for k in 0..N {
            squares[(k, k)] = squares[(k, k)] * (1.0 + 1e-9) + f64::MIN_POSITIVE;
        }
        let step = squares.cholesky()?.solve(&-gradient);
        step.iter().all(|c| c.is_finite()).then_some(step)
    }
}
