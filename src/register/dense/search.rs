//! Where to begin when nothing is known: turns of the camera, tried one by one on tiny pictures.
//!
//! In one second a hand turns a camera through its whole field of view, but moves it by a small part of
//! the distance to what it sees. So what is new in a frame is, roughly, where the camera looks. After Klein
//! and Murray, *Improving the agility of keyframe-based SLAM* (2008), with all turns instead of a descent.

use super::pyramid::{GREY, Level, NEAR, Pyramid};
use super::warp::Lens;
use crate::geom::{Matrix3, Pose, Vector3};
use nalgebra::UnitQuaternion;
use rayon::prelude::*;

/// Turns are tried this far apart [px of the tiny picture].
const STEP: f64 = 2.0;
/// Turns to either side, as a share of the field of view, and about the optical axis [rad].
const ASIDE: f64 = 0.7;
const ROLLS: [f64; 5] = [-0.4, -0.2, 0.0, 0.2, 0.4];
/// Where less than this share of a picture is in the other, agreement is luck.
const LEAST_SHARE: f64 = 0.2;

/// A tiny picture's pixel: its direction, brightness and inverse depth.
struct Ray {
    direction: [f32; 3],
    grey: f32,
    near: f32,
}

/// The turns under which `reference` looks most like `next`, best first, `n_best` at most.
pub(super) fn turns([reference, next]: [&Pyramid; 2], n_best: usize) -> Vec<Pose> {
    let [from, into] = [&reference.tiny, &next.tiny];
    let rays = rays(from);
    let lens = Lens::new(&into.camera);
    let step = STEP / into.camera.fx;
    let count = |pixels: usize, focal: f64| {
        (ASIDE * 2.0 * (pixels as f64 / 2.0 / focal).atan() / step).ceil() as i32
    };
    let across = count(into.camera.width, into.camera.fx);
    let along = count(into.camera.height, into.camera.fy);
    let places: Vec<[i32; 2]> =
        (-along..=along).flat_map(|y| (-across..=across).map(move |x| [x, y])).collect();
    let score = |&[x, y]: &[i32; 2]| -> Vec<(f64, UnitQuaternion<f64>)> {
        // A turn about y moves the picture along rows.
        let aside =
            UnitQuaternion::from_scaled_axis(Vector3::new(f64::from(y), f64::from(x), 0.0) * step);
        let turns = ROLLS.map(|roll| UnitQuaternion::from_scaled_axis(Vector3::z() * roll) * aside);
        turns.map(|turn| (likeness(&rays, &turn, into, &lens), turn)).to_vec()
    };
    let mut scored: Vec<_> = places.par_iter().flat_map_iter(score).collect();
    // Stable: of two as good the one tried first.
    scored.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut best: Vec<UnitQuaternion<f64>> = Vec::new();
    for (score, turn) in scored {
        if best.len() == n_best || score <= 0.0 {
            break;
        }
        if best.iter().all(|other| other.angle_to(&turn) > 2.5 * step) {
            best.push(turn);
        }
    }
    best.into_iter().map(|turn| Pose::from_parts(Vector3::zeros().into(), turn)).collect()
}

fn rays(level: &Level) -> Vec<Ray> {
    let (width, height) = (level.texels.width(), level.texels.height());
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    pixels
        .map(|(x, y)| {
            let [u, v] = level.camera.ray([x as f64, y as f64]);
            let texel = &level.texels[(x, y)];
            Ray { direction: [u as f32, v as f32, 1.0], grey: texel[GREY], near: texel[NEAR] }
        })
        .collect()
}

/// How sure it is that both pictures show the same under a turn: the correlations of brightness and of
/// inverse depth, by Fisher's transform, for as many pixels as are compared.
fn likeness(rays: &[Ray], turn: &UnitQuaternion<f64>, into: &Level, lens: &Lens) -> f64 {
    let matrix: Matrix3 = turn.to_rotation_matrix().into_inner();
    let rows = [0, 1, 2].map(|i| [0, 1, 2].map(|j| matrix[(i, j)] as f32));
    let (width, height) = (into.texels.width() as f32, into.texels.height() as f32);
    let (mut grey, mut near) = (Correlation::default(), Correlation::default());
    for ray in rays {
        let [x, y, z] = rows.map(|row| (0..3).map(|k| row[k] * ray.direction[k]).sum::<f32>());
        let (u, v) = (x / z, y / z);
        if !(z > 0.0 && u * u + v * v <= lens.widest) {
            continue;
        }
        let [px, py] = lens.pixel(u, v);
        let (px, py) = (px + 0.5, py + 0.5);
        if 0.0 <= px && px < width && 0.0 <= py && py < height {
            let texel = &into.texels[(px as usize, py as usize)];
            grey.add(ray.grey, texel[GREY]);
            if ray.near > 0.0 && texel[NEAR] > 0.0 {
                // Seen from the side, by z of the other camera.
                near.add(ray.near * 1000.0 / z, texel[NEAR] * 1000.0);
            }
        }
    }
    if f64::from(grey.n) < LEAST_SHARE * rays.len() as f64 {
        return 0.0;
    }
    grey.surety() + near.surety()
}

/// Sums for a coefficient of correlation.
#[derive(Debug, Clone, Copy, Default)]
struct Correlation {
    n: f32,
    sums: [f32; 5],
}

impl Correlation {
    #[inline(always)]
    fn add(&mut self, a: f32, b: f32) {
        self.n += 1.0;
        for (sum, term) in self.sums.iter_mut().zip([a, b, a * a, b * b, a * b]) {
            *sum += term;
        }
    }

    fn surety(&self) -> f64 {
        let n = f64::from(self.n);
        let [a, b, aa, bb, ab] = self.sums.map(|sum| f64::from(sum) / n.max(1.0));
        let spread = ((aa - a * a) * (bb - b * b)).sqrt();
        // A comparison that NaN fails.
        let is_told = self.n >= 4.0 && spread > 1e-9;
        if !is_told {
            return 0.0;
        }
        ((ab - a * b) / spread).clamp(-0.99, 0.99).atanh() * (n - 3.0).sqrt()
    }
}
