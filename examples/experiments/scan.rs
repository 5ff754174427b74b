//! The thesis' own way: every point of the surface at every step of the spiral.
//!
//! Morell (2014), algorithm 5 with eq. 4.7, in `f32` or `f64`, one pair after the other, and in `f32`
//! sixteen side by side: what a device and a search are held against.

use fearless_simd::{Level, dispatch, f32x16, prelude::*};
use nalgebra::RealField;
use rayon::prelude::*;

/// One step of the spiral: where the wheel stands along the spindle, and how the part is turned.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Step {
    /// Along the spindle [mm].
    pub(crate) x: f64,
    /// Of the part about it [rad].
    pub(crate) turn: f64,
}

/// A cloud in numbers of one kind, and the radii of the wheel that comes down on it.
pub(crate) struct Scan<T> {
    points: Vec<[T; 3]>,
    major: T,
    minor: T,
}

impl<T: RealField + Copy + Send + Sync> Scan<T> {
    pub(crate) fn new(points: &[[f64; 3]], [major, minor]: [f64; 2]) -> Self {
        let real = |number: f64| nalgebra::convert::<f64, T>(number);
        let points = points.iter().map(|point| point.map(real)).collect();
        Self { points, major: real(major), minor: real(minor) }
    }

    /// The height of the wheel's centre at each step, on all threads of the pool; the least of
    /// numbers where it meets nothing.
    pub(crate) fn heights(&self, steps: &[Step]) -> Vec<T> {
        steps.par_iter().map(|step| self.height(step)).collect()
    }

    fn height(&self, step: &Step) -> T {
        let (sin, cos) = step.turn.sin_cos();
        let [at, sin, cos] = [step.x, sin, cos].map(nalgebra::convert::<f64, T>);
        let zero = T::zero();
        let mut best = T::min_value().unwrap_or(zero);
        for &[x, y, z] in &self.points {
            let dx = x - at;
            let nose = self.minor * self.minor - dx * dx;
            let radius = self.major + nose.max(zero).sqrt();
            let across = y * sin + z * cos;
            let reach = radius * radius - across * across;
            let height = y * cos - z * sin + reach.max(zero).sqrt();
            if zero <= nose && zero <= reach && best < height {
                best = height;
            }
        }
        best
    }
}

/// Lanes of a vector.
const WIDE: usize = 16;

/// The same cloud by columns, sixteen points at a time.
pub(crate) struct WideScan {
    columns: [Vec<f32>; 3],
    radii: [f32; 2],
}

impl WideScan {
    pub(crate) fn new(points: &[[f64; 3]], radii: [f64; 2]) -> Self {
        // The last vector is filled up with a point that is there already.
        let n = points.len().next_multiple_of(WIDE);
        let filled = || points.iter().chain(std::iter::repeat(&points[0])).take(n);
        let columns = [0, 1, 2].map(|axis| filled().map(|point| point[axis] as f32).collect());
        Self { columns, radii: radii.map(|radius| radius as f32) }
    }

    /// The same as [`Scan::heights`].
    pub(crate) fn heights(&self, steps: &[Step]) -> Vec<f32> {
        let height = |step| dispatch!(Level::new(), simd => self.height(simd, step));
        steps.par_iter().map(height).collect()
    }

    #[inline(always)]
    fn height<S: Simd>(&self, simd: S, step: &Step) -> f32 {
        let splat = |value: f32| f32x16::splat(simd, value);
        let (sin, cos) = step.turn.sin_cos();
        let [at, sin, cos] = [step.x, sin, cos].map(|number| splat(number as f32));
        let [major, minor] = self.radii.map(splat);
        let (zero, never) = (splat(0.0), splat(f32::MIN));
        let [x, y, z] = self.columns.each_ref().map(|column| column.chunks_exact(WIDE));
        let mut best = never;
        for ((x, y), z) in x.zip(y).zip(z) {
            let [x, y, z] = [x, y, z].map(|lanes| f32x16::from_slice(simd, lanes));
            let dx = x - at;
            let nose = minor * minor - dx * dx;
            let radius = major + nose.max(zero).sqrt();
            let across = y * sin + z * cos;
            let reach = radius * radius - across * across;
            let height = y * cos - z * sin + reach.max(zero).sqrt();
            let touches = nose.simd_ge(zero) & reach.simd_ge(zero);
            best = best.max(touches.select(height, never));
        }
        best.as_slice().iter().copied().fold(f32::MIN, f32::max)
    }
}
