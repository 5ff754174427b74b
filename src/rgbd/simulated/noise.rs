//! What a sensor does to the depth it measures.

use super::texture::mixed;
use crate::rgbd::{Image, KinectDisparity};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::f64::consts::TAU;

/// The noise of a simulated sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    /// Of which kind.
    pub kind: NoiseKind,
    /// Standard deviation of a depth of 0.8 m [mm].
    pub sigma: f64,
    /// Another seed, other noise.
    pub seed: u64,
}

/// How the noise of a sensor behaves.
#[derive(
    Debug,
    Clone,
    Copy,
    Default,
    PartialEq,
    Eq,
    serde::Serialize,
    serde::Deserialize,
    clap::ValueEnum,
)]
#[serde(rename_all = "kebab-case")]
pub enum NoiseKind {
    /// None: depth is exact.
    #[default]
    None,
    /// The same everywhere.
    Gaussian,
    /// Of disparity, which is then rounded: grows with depth squared. Readings at edges and on surfaces
    /// seen aslant drop out, and so does what is nearer than 0.45 m or farther than 5 m.
    Kinect,
}

impl Default for Noise {
    fn default() -> Self {
        Self { kind: NoiseKind::None, sigma: 1.0, seed: 0 }
    }
}

/// Where [`Noise::sigma`] is told [mm].
const TOLD_AT: f64 = 800.0;
/// What a Kinect can measure [mm].
const RANGE: std::ops::RangeInclusive<f32> = 450.0..=5000.0;
/// A neighbour this much nearer or farther is another surface [share of depth].
const EDGE: f32 = 0.03;
/// The share of readings beside an edge that drop out.
const LOST_AT_EDGES: f64 = 0.5;
/// Depth that changes by more than this from pixel to pixel belongs to a surface seen too aslant [share
/// of depth]: about 84 degrees for the focal length of a Kinect.
const ASLANT: f32 = 0.018;

impl Noise {
    /// `depth` as the sensor would tell it in the frame `number`.
    pub(super) fn added_to(&self, depth: &Image<f32>, number: usize) -> Image<f32> {
        if self.kind == NoiseKind::None {
            return depth.clone();
        }
        let frame = mixed(self.seed ^ mixed(number as u64));
        Image::from_rows(depth.width(), depth.height(), 0.0, |y, row| {
            // Draws of a row of its own: rows are made side by side.
            let mut draw = Pcg64Mcg::seed_from_u64(mixed(frame ^ y as u64));
            for (x, told) in row.iter_mut().enumerate() {
                let exact = depth[(x, y)];
                // The draws are made for every pixel, so that one more reading changes no other.
                let (error, luck) = (normal(&mut draw), draw.random::<f64>());
                if exact > 0.0 {
                    *told = match self.kind {
                        NoiseKind::None => exact,
                        NoiseKind::Gaussian => (f64::from(exact) + self.sigma * error) as f32,
                        NoiseKind::Kinect if is_lost(depth, [x, y], luck) => 0.0,
                        NoiseKind::Kinect => self.through_disparity(exact, error),
                    }
                    .max(0.0);
                }
            }
        })
    }

    /// The depth that a disparity, off by `error` standard deviations and rounded, stands for.
    fn through_disparity(&self, exact: f32, error: f64) -> f32 {
        let kinect = KinectDisparity::default();
        // dkd/dz = 8 b f / z^2.
        let slope = 8.0 * kinect.baseline * kinect.focal_px / (TOLD_AT * TOLD_AT);
        let told = kinect.disparity(exact.into()) + self.sigma * slope * error;
        // What rounds to nothing or beyond the sensor's numbers is no reading.
        let told = told.round().clamp(0.0, f64::from(KinectDisparity::NO_READING)) as u16;
        kinect.depth(told).map_or(0.0, |depth| depth as f32)
    }
}

/// True if a Kinect would have no reading there.
fn is_lost(depth: &Image<f32>, [x, y]: [usize; 2], luck: f64) -> bool {
    let own = depth[(x, y)];
    if !RANGE.contains(&own) {
        return true;
    }
    let at = |dx: isize, dy: isize| {
        depth.get(x.checked_add_signed(dx)?, y.checked_add_signed(dy)?).copied()
    };
    let steps = [[1, 0], [-1, 0], [0, 1], [0, -1]]
        .into_iter()
        .filter_map(|[dx, dy]| Some((at(dx, dy)? - own).abs() / own));
    let (mut is_edge, mut n_aslant, mut n) = (false, 0, 0);
    for step in steps {
        is_edge |= step > EDGE;
        n_aslant += usize::from(step > ASLANT);
        n += 1;
    }
    // On a surface seen aslant both neighbours along the slope are that far away; at an edge one is.
    (is_edge && luck < LOST_AT_EDGES) || (n_aslant >= 2 && n_aslant * 2 >= n)
}

/// A draw of mean 0 and standard deviation 1 (G. Box and M. Muller, 1958).
fn normal(draw: &mut Pcg64Mcg) -> f64 {
    let (u, v): (f64, f64) = (draw.random(), draw.random());
    // 1 - u is never 0, whose logarithm is none.
    (-2.0 * (1.0 - u).ln()).sqrt() * (TAU * v).cos()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Mean and standard deviation of the error on a wall at `depth`.
    fn statistics(noise: Noise, depth: f32) -> (f64, f64) {
        let wall = Image::filled(200, 200, depth);
        let told = noise.added_to(&wall, 1);
        assert!(told.pixels().iter().all(|z| *z > 0.0));
        let n = told.pixels().len() as f64;
        let errors = || told.pixels().iter().map(|z| f64::from(z - depth));
        let mean = errors().sum::<f64>() / n;
        (mean, (errors().map(|e| (e - mean).powi(2)).sum::<f64>() / n).sqrt())
    }

    #[test]
    fn gaussian_noise_is_the_same_at_every_depth() {
        let noise = Noise { kind: NoiseKind::Gaussian, sigma: 2.0, seed: 3 };
        for depth in [500.0, 800.0, 3000.0] {
            let (mean, sigma) = statistics(noise, depth);
            // 40,000 draws: standard errors 0.01 and 0.007.
            assert!(mean.abs() < 0.05 && (sigma - 2.0).abs() < 0.035, "{depth}: {mean} {sigma}");
        }
    }

    #[test]
    fn kinect_noise_grows_with_depth_squared_and_comes_in_steps() {
        let noise = Noise { kind: NoiseKind::Kinect, sigma: 1.5, seed: 3 };
        for depth in [600.0_f32, 800.0, 1600.0, 3200.0] {
            let (mean, sigma) = statistics(noise, depth);
            let scale = f64::from(depth / 800.0).powi(2);
            // Rounding to steps of 640000 / 348000 = 1.84 mm (at 0.8 m) adds a twelfth of their square.
            let expected = scale * (1.5_f64.powi(2) + 1.84_f64.powi(2) / 12.0).sqrt();
            assert!((sigma / expected - 1.0).abs() < 0.03, "{depth}: {sigma} for {expected}");
            assert!(mean.abs() < 0.1 * expected, "{depth}: {mean}");
        }
        let told = noise.added_to(&Image::filled(100, 100, 800.0), 1);
        let mut values = told.into_pixels();
        values.sort_by(f32::total_cmp);
        values.dedup();
        assert!(values.len() < 12, "{} different depths", values.len());
    }

    #[test]
    fn a_kinect_loses_edges_and_what_is_out_of_its_range_and_nothing_else() {
        let noise = Noise { kind: NoiseKind::Kinect, sigma: 1.0, seed: 3 };
        let pixels = (0..100 * 200).map(|i| if i % 100 < 50 { 800.0 } else { 1000.0 });
        let told = noise.added_to(&Image::new(100, 200, pixels.collect()).unwrap(), 0);
        let lost_in = |x: usize| (0..200).filter(|&y| told[(x, y)] == 0.0).count();
        for x in 0..100 {
            let lost = lost_in(x);
            let expected = if x == 49 || x == 50 { 70..130 } else { 0..1 };
            assert!(expected.contains(&lost), "column {x}: {lost}");
        }
        for depth in [440.0, 5100.0] {
            let told = noise.added_to(&Image::filled(9, 9, depth), 0);
            assert!(told.pixels().iter().all(|z| *z == 0.0), "{depth}");
        }
    }

    #[test]
    fn without_noise_depth_is_exact() {
        let depth = Image::new(2, 1, vec![0.0, 812.345]).unwrap();
        assert_eq!(Noise::default().added_to(&depth, 9), depth);
    }
}
