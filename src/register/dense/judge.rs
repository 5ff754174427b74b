//! What speaks for a motion and what against it.

use super::descend::{ALIKE, Descent, LEAST_POINTS};
use super::normal::information;
use super::verdict::{BACK, DenseReason, LIKE, OPEN, OVERLAP, THROUGH};
use super::warp::{Batch, Warp};
use super::{DenseOptions, Pyramid};
use crate::geom::{Point3, Pose};
use crate::register::icp::{FreeMotion, Verdict, free_motions};
use crate::register::small_motion::surety;
use nalgebra::{Matrix6, SymmetricEigen, Vector6};

/// A point that should be this much nearer than what is seen is seen through [share of depth].
const BEHIND: f32 = 0.08;
/// Brightness that scatters less than this is all the same: there is nothing to correlate.
const CONTRAST: f64 = 0.015;

/// The motion between two frames, and whether to believe it.
#[derive(Debug, Clone, PartialEq)]
pub struct DenseMotion {
    /// Takes points of the reference's camera into the next one's [mm].
    pub next_from_reference: Pose,
    /// Whether to believe it.
    pub verdict: Verdict,
    /// What speaks against it.
    pub reasons: Vec<DenseReason>,
    /// Steps taken.
    pub n_iterations: u32,
    /// True if the last step was small.
    pub converged: bool,
    /// Share of the reference's points that lie in the next picture.
    pub overlap: f64,
    /// Correlation of the brightness of those points with what is seen there; 1 if all is as bright.
    pub correlation: f64,
    /// Scale of the residuals of brightness (0 to 1).
    pub grey_sigma: f64,
    /// Scale of the residuals of depth, at the median depth [mm]; only if depth is compared.
    pub depth_sigma: Option<f64>,
    /// Share of the points that should hide what is seen behind them.
    pub seen_through: f64,
    /// The next picture's brightness, times the first, plus the second, is the reference's.
    pub light: [f64; 2],
    /// There and back again leads this far off: turn [rad], shift [mm].
    pub there_and_back: [f64; 2],
    /// Information of a step from the left, turn [rad] before shift [mm], about the next camera: the
    /// inverse covariance, without what noise feigns, and if a hundred neighbouring pixels tell as much as one that errs on its own.
    pub information: Matrix6<f64>,
    /// Median depth of the points [mm].
    pub depth: f64,
}

impl DenseMotion {
    /// The covariance of the motion, turn [rad] before shift [mm]; `None` where it is not held.
    pub fn covariance(&self) -> Option<Matrix6<f64>> {
        self.information.try_inverse()
    }

    /// Minus the differential entropy of the motion, but for a constant: half the logarithm of the
    /// information's determinant.
    pub fn surety(&self) -> f64 {
        surety(&self.information)
    }
}

/// Looks at where a descent ended; `back` is where one from there in the other direction ended.
pub(super) fn judge(
    frames: [&Pyramid; 2],
    descent: &Descent,
    back: &Pose,
    options: &DenseOptions,
) -> DenseMotion {
    let [reference, next] = frames.map(|frame| &frame.levels[0]);
    let points = reference.points(options.points);
    let mut batches = Vec::new();
    // Depths are looked at even where only brightness was compared.
    Warp::into(next, true).look(points, &descent.pose, &mut batches);
    let seen = Seen::of(&batches);
    let [grey_sigma, near_sigma] = descent.noise.sigmas();
    let with_depth = options.residuals == super::Residuals::BrightnessAndDepth;
    let off = back * descent.pose;
    let focal = [next.camera.fx, next.camera.fy];
    let mut motion = DenseMotion {
        next_from_reference: descent.pose,
        verdict: Verdict::Ok,
        reasons: Vec::new(),
        n_iterations: descent.n_iterations,
        converged: descent.converged,
        overlap: seen.n / points.count.max(1) as f64,
        correlation: seen.correlation,
        grey_sigma,
        depth_sigma: with_depth.then(|| near_sigma * points.depth.powi(2)),
        seen_through: seen.n_through / seen.n_held.max(1.0),
        light: [descent.noise.gain, descent.noise.offset],
        there_and_back: [off.rotation.angle(), off.translation.vector.norm()],
        information: information(&descent.batches, &descent.noise, focal) / ALIKE,
        depth: points.depth,
    };
    motion.reasons = reasons(&motion, points.count, descent.last_step);
    let verdicts = motion.reasons.iter().map(DenseReason::verdict);
    motion.verdict = verdicts.max().unwrap_or(Verdict::Ok);
    motion
}

fn reasons(motion: &DenseMotion, n_points: usize, last_step: f64) -> Vec<DenseReason> {
    if (n_points as f64) < LEAST_POINTS {
        return vec![DenseReason::NoPoints { n_points }];
    }
    let overlap = motion.overlap;
    if overlap < OVERLAP[0] || overlap * (n_points as f64) < LEAST_POINTS {
        // Of so few points nothing else can be told.
        return vec![DenseReason::LittleOverlap { overlap: overlap.min(OVERLAP[0] / 2.0) }];
    }
    let mut reasons = Vec::new();
    if overlap < OVERLAP[1] {
        reasons.push(DenseReason::LittleOverlap { overlap });
    }
    let (free, weak, open) = held(&motion.information, motion.depth);
    if !free.is_empty() {
        reasons.push(DenseReason::Free(free));
    }
    if !weak.is_empty() {
        reasons.push(DenseReason::Weak { motions: weak, open });
    }
    if !motion.converged {
        reasons.push(DenseReason::NotConverged { step: last_step });
    }
    let correlation = motion.correlation;
    if correlation < LIKE[1] {
        reasons.push(DenseReason::Unlike { correlation });
    }
    if motion.seen_through > THROUGH[1] {
        reasons.push(DenseReason::SeenThrough { share: motion.seen_through });
    }
    let [turn, shift] = motion.there_and_back;
    if turn > BACK[0] || shift > BACK[1] * motion.depth {
        reasons.push(DenseReason::NotBack { turn_deg: turn.to_degrees(), shift });
    }
    reasons
}

/// Motions that are free, those that are weakly held, and how far the least held of them is open [mm].
fn held(information: &Matrix6<f64>, depth: f64) -> (Vec<FreeMotion>, Vec<FreeMotion>, f64) {
    let lever = 1.0 / depth;
    let scale = Matrix6::from_diagonal(&Vector6::new(lever, lever, lever, 1.0, 1.0, 1.0));
    let eigen = SymmetricEigen::new(scale * information * scale);
    // Exact pictures have next to no residuals; rounding is no hold all the same.
    let rounding = 1e-9 * eigen.eigenvalues.max();
    let is_free = |k: usize| {
        let value = eigen.eigenvalues[k];
        value <= rounding || value < (OPEN[0] * depth).powi(-2)
    };
    let is_weak = |k: usize| !is_free(k) && eigen.eigenvalues[k] < (OPEN[1] * depth).powi(-2);
    let motions = |of: &dyn Fn(usize) -> bool| {
        let directions: Vec<Vector6<f64>> =
            (0..6).filter(|&k| of(k)).map(|k| eigen.eigenvectors.column(k).into_owned()).collect();
        free_motions(&directions, depth, &Point3::origin())
    };
    let least = (0..6).filter(|&k| is_weak(k)).map(|k| eigen.eigenvalues[k]);
    let open = least.fold(f64::INFINITY, f64::min).powf(-0.5);
    (motions(&is_free), motions(&is_weak), open)
}

/// Sums over what was seen.
struct Seen {
    n: f64,
    n_held: f64,
    n_through: f64,
    correlation: f64,
}

impl Seen {
    fn of(batches: &[Batch]) -> Self {
        let (mut n, mut n_held, mut n_through) = (0.0_f64, 0.0, 0.0);
        let mut sums = [0.0_f64; 5];
        for batch in batches {
            for i in (0..batch.seen.len()).filter(|&i| batch.seen[i] > 0.0) {
                n += 1.0;
                n_held += f64::from(batch.held[i]);
                if batch.held[i] > 0.0 && batch.off[i] < -BEHIND * batch.near[i] {
                    n_through += 1.0;
                }
                let (a, b) = (f64::from(batch.own[i]), f64::from(batch.grey[i]));
                for (sum, term) in sums.iter_mut().zip([a, b, a * a, b * b, a * b]) {
                    *sum += term;
                }
            }
        }
        let [a, b, aa, bb, ab] = sums.map(|sum| sum / n.max(1.0));
        let spreads = [aa - a * a, bb - b * b].map(|square| square.max(0.0).sqrt());
        let is_plain = spreads.iter().all(|spread| *spread < CONTRAST);
        let product = (spreads[0] * spreads[1]).max(1e-12);
        let correlation = if is_plain { 1.0 } else { (ab - a * b) / product };
        Self { n, n_held, n_through, correlation }
    }
}
