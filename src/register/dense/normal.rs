//! Normal equations of the weighted residuals, and their cost.
//!
//! With a step from the left, `x' = exp(w) x + v`, a point `x` moves by `w × x + v`. A picture `f` seen in
//! the direction `(u, v) = (x/z, y/z)` changes by `(f_u, f_v, -(f_u u + f_v v)) / z` with it, and what
//! stands for its own inverse depth by `1/z²` along z.

use super::noise::{NU, Noise, Whitening};
use super::points::BATCH;
use super::warp::Batch;
use nalgebra::{Matrix6, SymmetricEigen, Vector6};
use rayon::prelude::*;

/// Points side by side.
const LANES: usize = 8;
/// Entries of the lower triangle of a 6 x 6 matrix, and of its right side.
const ENTRIES: usize = 21 + 6;

/// Noise of brightness, of two pictures together, in poor light (0 to 1).
const GRAIN: f64 = 0.01;

/// The normal equations: turn before shift.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Normal {
    pub(super) h: Matrix6<f64>,
    pub(super) g: Vector6<f64>,
}

/// The weighted normal equations of what was seen.
pub(super) fn normal(batches: &[Batch], noise: &Noise) -> Normal {
    let white = noise.whitening();
    let parts: Vec<[f64; ENTRIES]> =
        batches.par_iter().map(|batch| of_batch(batch, &white)).collect();
    let mut total = [0.0; ENTRIES];
    for part in parts {
        total.iter_mut().zip(part).for_each(|(total, part)| *total += part);
    }
    let (mut h, mut g) = (Matrix6::zeros(), Vector6::zeros());
    let mut entries = total.into_iter();
    for a in 0..6 {
        for b in 0..=a {
            let entry = entries.next().unwrap_or(0.0);
            (h[(a, b)], h[(b, a)]) = (entry, entry);
        }
    }
    for (value, entry) in g.iter_mut().zip(entries) {
        *value = entry;
    }
    Normal { h, g }
}

/// Minus the logarithm of the likelihood for each residual, and how many there are.
pub(super) fn cost(batches: &[Batch], noise: &Noise) -> (f64, f64) {
    let white = noise.whitening();
    let part = |batch: &Batch| -> (f64, f64) {
        let (mut sum, mut count) = ([0.0_f32; LANES], 0.0);
        for start in (0..BATCH).step_by(LANES) {
            for (lane, sum) in sum.iter_mut().enumerate() {
                let i = start + lane;
                let ([e1, e2], n) = white.residuals(batch, i);
                let square = (e1 * e1 + e2 * e2) / NU;
                *sum += batch.seen[i] * 0.5 * (NU + n) * (1.0 + square).ln();
                count += batch.seen[i] * n;
            }
        }
        (sum.iter().map(|s| f64::from(*s)).sum(), f64::from(count))
    };
    let parts: Vec<(f64, f64)> = batches.par_iter().map(part).collect();
    let (sum, n) = parts.iter().fold((0.0, 0.0), |(s, n), part| (s + part.0, n + part.1));
    (if n > 0.0 { sum / n } else { f64::INFINITY }, n)
}

/// What brightness and depth tell of the motion, without what noise feigns.
///
/// Where a picture changes by nothing but noise, that looks like something to hold on to. If residuals are
/// noise, half of their variance is each picture's. A change of brightness is half the difference of two
/// pixels, so the square of its noise is a quarter of a residual's; one of inverse depth is the mean of
/// three such, and has a twelfth. But brightness is mostly off because paint lies between pixels, and
/// pictures have no more noise of their own than [`GRAIN`].
pub(super) fn information(batches: &[Batch], noise: &Noise, focal: [f64; 2]) -> Matrix6<f64> {
    let white = noise.whitening();
    let grain = (GRAIN / noise.sigmas()[0]).powi(2).min(1.0);
    let part = |batch: &Batch| -> [Matrix6<f64>; 4] {
        let mut sums = [Matrix6::zeros(); 4];
        for i in (0..BATCH).filter(|&i| batch.seen[i] > 0.0) {
            let weight = f64::from(white.weight(batch, i));
            let mut add = |k: usize, row: [f32; 6], scale: f64, share: f64| {
                let row = Vector6::from(row).map(f64::from) * scale;
                sums[k] += row * row.transpose() * (share * weight);
            };
            let (grey, depth) = slopes(batch, i);
            let held = f64::from(batch.held[i]);
            add(0, grey, f64::from(white.alone * white.gain), 1.0);
            add(1, depth, f64::from(white.c), held);
            for (focal, along) in focal.iter().zip([[1.0, 0.0], [0.0, 1.0]]) {
                let row = direction([batch.u[i], batch.v[i], batch.near[i]], along, 0.0);
                add(2, row, *focal, grain / 4.0);
                add(3, row, *focal, held / 12.0);
            }
        }
        sums
    };
    let parts: Vec<[Matrix6<f64>; 4]> = batches.par_iter().map(part).collect();
    let total = |k: usize| parts.iter().map(|part| part[k]).sum::<Matrix6<f64>>();
    above(&total(0), &total(2)) + above(&total(1), &total(3))
}

/// What is left of one matrix without another: nothing where the other is greater.
fn above(all: &Matrix6<f64>, feigned: &Matrix6<f64>) -> Matrix6<f64> {
    // Comparable units, so that rounding of turns does not count for shifts.
    let units = (all + feigned).diagonal().map(|value| value.max(1e-30).sqrt());
    let apart = Matrix6::from_diagonal(&units.map(f64::recip));
    let eigen = SymmetricEigen::new(apart * (all - feigned) * apart);
    let values = Matrix6::from_diagonal(&eigen.eigenvalues.map(|value| value.max(0.0)));
    let together = Matrix6::from_diagonal(&units) * eigen.eigenvectors;
    together * values * together.transpose()
}

fn of_batch(batch: &Batch, white: &Whitening) -> [f64; ENTRIES] {
    let mut sums = [[0.0_f32; LANES]; ENTRIES];
    for start in (0..BATCH).step_by(LANES) {
        let mut rows = [[[0.0_f32; LANES]; 6]; 2];
        let mut residuals = [[0.0_f32; LANES]; 2];
        let mut weights = [0.0_f32; LANES];
        for lane in 0..LANES {
            let i = start + lane;
            let ([e1, e2], n) = white.residuals(batch, i);
            weights[lane] = batch.seen[i] * (NU + n) / (NU + e1 * e1 + e2 * e2);
            (residuals[0][lane], residuals[1][lane]) = (e1, e2);
            let held = batch.held[i];
            let (grey, depth) = slopes(batch, i);
            let a = (held * white.a + (1.0 - held) * white.alone) * white.gain;
            for k in 0..6 {
                rows[0][k][lane] = a * grey[k] + white.b * depth[k];
                rows[1][k][lane] = white.c * depth[k];
            }
        }
        for (row, residual) in rows.iter().zip(&residuals) {
            let mut weighted = [[0.0_f32; LANES]; 6];
            for k in 0..6 {
                for lane in 0..LANES {
                    weighted[k][lane] = weights[lane] * row[k][lane];
                }
            }
            let mut sums = sums.iter_mut();
            for (a, weighted) in weighted.iter().enumerate() {
                for (row, sum) in row[..=a].iter().zip(&mut sums) {
                    for lane in 0..LANES {
                        sum[lane] += weighted[lane] * row[lane];
                    }
                }
            }
            for (weighted, sum) in weighted.iter().zip(&mut sums) {
                for lane in 0..LANES {
                    sum[lane] += weighted[lane] * residual[lane];
                }
            }
        }
    }
    sums.map(|lanes| lanes.iter().map(|lane| f64::from(*lane)).sum())
}

/// How brightness (before the gain) and inverse depth change with a step: turn before shift.
#[inline(always)]
fn slopes(batch: &Batch, i: usize) -> ([f32; 6], [f32; 6]) {
    let at = [batch.u[i], batch.v[i], batch.near[i]];
    let grey = direction(at, [batch.grey_u[i], batch.grey_v[i]], 0.0);
    let own = batch.held[i] * batch.near[i];
    (grey, direction(at, [batch.near_u[i], batch.near_v[i]], own))
}

/// How a picture that changes by `p` and `q` along the direction `(u, v)` changes with a step, less an
/// own inverse depth of `own`.
#[inline(always)]
fn direction([u, v, near]: [f32; 3], [p, q]: [f32; 2], own: f32) -> [f32; 6] {
    let s = own - (p * u + q * v);
    [v * s - q, p - u * s, u * q - v * p, near * p, near * q, near * s]
}

#[cfg(test)]
mod tests {
    use super::super::points::Points;
    use super::super::pyramid::Level;
    use super::super::warp::Warp;
    use super::*;
    use crate::geom::{Pose, Vector3};
    use crate::register::icp::taken;
    use crate::rgbd::{Camera, Image};

    /// The gradient against differences of the cost, where pictures change evenly, so that what lies
    /// between pixels is exact: a lens that distorts, a light that is off, some points without depth.
    #[test]
    fn the_gradient_is_the_slope_of_the_cost() {
        let camera = Camera::FREIBURG1.halved().halved();
        let (width, height) = (camera.width, camera.height);
        let ramp = |a: f32, b: f32, c: f32| {
            let pixels =
                (0..width * height).map(|i| a + b * (i % width) as f32 + c * (i / width) as f32);
            Image::new(width, height, pixels.collect()).unwrap()
        };
        let near = ramp(8e-4, 1.5e-6, -9e-7);
        let mut depth = near.map(|near| 1.0 / near);
        depth[(100, 60)] = 0.0;
        let level = Level::new(&ramp(0.2, 0.004, 0.003), &depth, &camera);
        let points: Vec<[f32; 4]> = (0..600)
            .map(|i| {
                let at = [20.0 + f64::from(i % 30) * 4.0, 20.0 + f64::from(i / 30) * 4.0];
                let point = camera.unproject(at, 900.0 + 3.0 * f64::from(i % 7));
                let grey = 0.45 + 0.001 * f64::from(i % 11);
                [point.x as f32, point.y as f32, point.z as f32, grey as f32]
            })
            .collect();
        let points = Points::new(&points);
        let noise = Noise { gain: 1.1, offset: -0.05, scale: [0.01, 4e-9, 2e-6] };
        let pose = Pose::new(Vector3::new(20.0, -15.0, 30.0), Vector3::new(0.02, 0.03, -0.04));
        let seen = |pose: &Pose| {
            let mut batches = Vec::new();
            Warp::into(&level, true).look(&points, pose, &mut batches);
            batches
        };
        let batches = seen(&pose);
        let n_held: f32 = batches.iter().flat_map(|batch| batch.held).sum();
        assert!((300.0..600.0).contains(&n_held), "{n_held} of 600 have a depth");
        let sum = |pose: &Pose| {
            let (mean, n) = cost(&seen(pose), &noise);
            mean * n
        };
        let found = normal(&batches, &noise);
        for k in 0..6 {
            let mut nudge = Vector6::zeros();
            // Small, but not for single precision.
            nudge[k] = if k < 3 { 2e-4 } else { 0.2 };
            let ahead = sum(&taken(&pose, &nudge));
            let behind = sum(&taken(&pose, &-nudge));
            let slope = (ahead - behind) / (2.0 * nudge[k]);
            let size = found.g.fixed_rows::<3>(if k < 3 { 0 } else { 3 }).norm();
            assert!((slope - found.g[k]).abs() < 0.01 * size, "{k}: {slope}, {}", found.g[k]);
        }
    }
}
