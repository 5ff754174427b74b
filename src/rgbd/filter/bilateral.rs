//! The bilateral filter: smooth on a surface, blind across an edge.
//!
//! C. Tomasi and R. Manduchi (1998), as `KinectFusion` uses it on depth. The width over depth grows
//! with depth squared, as the noise of triangulating sensors does.

use crate::rgbd::Image;

/// How wide [`bilateral`] looks.
#[derive(Debug, Clone, PartialEq, clap::Args, serde::Serialize, serde::Deserialize)]
#[serde(default, rename_all = "kebab-case", deny_unknown_fields)]
pub struct BilateralOptions {
    /// Standard deviation over the picture; the window reaches twice as far, 16 pixels at most [px].
    #[arg(long, value_name = "PX", default_value_t = Self::default().smooth_px)]
    pub smooth_px: f64,
    /// Standard deviation over depth, 1 m away [mm]; it grows with depth squared.
    #[arg(long, value_name = "MM", default_value_t = Self::default().smooth_depth)]
    pub smooth_depth: f64,
}

impl Default for BilateralOptions {
    fn default() -> Self {
        Self { smooth_px: 1.5, smooth_depth: 5.0 }
    }
}

/// Farther a window never reaches [px].
const WIDEST: usize = 16;
/// exp(-x) is taken as (1 - x / N)^N, 0 from N on: three squarings where the exponential is a call, and
/// the window over depth gets an end.
const N: f32 = 8.0;

/// The weighted mean of the readings around each reading; places without one stay so.
pub fn bilateral(depth: &Image<f32>, options: &BilateralOptions) -> Image<f32> {
    let sigma = options.smooth_px;
    let reach = ((2.0 * sigma).ceil() as usize).min(WIDEST);
    let over_picture = |d: usize| (-0.5 * (d as f64 / sigma).powi(2)).exp() as f32;
    let weights: Vec<f32> = (0..=reach).map(over_picture).collect();
    let (width, height) = (depth.width(), depth.height());
    Image::from_rows(width, height, 0.0, |y, row| {
        let centers = depth.row(y);
        let sharpness: Vec<f32> = centers.iter().map(|z| options.sharpness(*z)).collect();
        let mut total = vec![0.0_f32; width];
        let rows = y.saturating_sub(reach)..(y + reach + 1).min(height);
        for (other, dy) in rows.map(|other| (depth.row(other), weights[other.abs_diff(y)])) {
            // One shift after the other, all columns side by side: what a compiler can vectorise.
            for dx in 0..=reach.min(width.saturating_sub(1)) {
                let weight = dy * weights[dx];
                let n = width - dx;
                let ahead = [&centers[..n], &sharpness[..n], &other[dx..]];
                add(ahead, weight, &mut row[..n], &mut total[..n]);
                if dx > 0 {
                    let behind = [&centers[dx..], &sharpness[dx..], &other[..n]];
                    add(behind, weight, &mut row[dx..], &mut total[dx..]);
                }
            }
        }
        for ((sum, total), center) in row.iter_mut().zip(total).zip(centers) {
            *sum = if *center > 0.0 { center + *sum / total } else { 0.0 };
        }
    })
}

/// Adds the weighted differences of `others` from `centers`. Sums of differences lose no digits.
fn add(
    [centers, sharpness, others]: [&[f32]; 3],
    weight: f32,
    sums: &mut [f32],
    total: &mut [f32],
) {
    let columns = centers.iter().zip(sharpness).zip(others).zip(sums.iter_mut().zip(total));
    for (((center, sharpness), other), (sum, total)) in columns {
        let difference = other - center;
        let base = (1.0 - difference * difference * sharpness).max(0.0);
        let fourth = (base * base) * (base * base);
        let share = if *other > 0.0 { weight * fourth * fourth } else { 0.0 };
        *sum += share * difference;
        *total += share;
    }
}

impl BilateralOptions {
    /// 1 / (2 sigma^2 N) of the window over depth around a reading.
    fn sharpness(&self, depth: f32) -> f32 {
        let metres = f64::from(depth) / 1000.0;
        let sigma = self.smooth_depth * metres * metres;
        (0.5 / (sigma * sigma).max(1e-12)) as f32 / N
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    #[test]
    fn it_is_the_weighted_mean_of_its_formula() {
        let mut draw = Pcg64Mcg::seed_from_u64(7);
        let pixels =
            (0..40 * 30).map(|i| if i % 11 == 0 { 0.0 } else { draw.random_range(995.0..1005.0) });
        let depth = Image::new(40, 30, pixels.collect()).unwrap();
        let options = BilateralOptions { smooth_px: 1.2, smooth_depth: 4.0 };
        let smooth = bilateral(&depth, &options);
        for (x, y) in [(20, 15), (0, 0), (39, 29), (1, 28)] {
            let center = f64::from(depth[(x, y)]);
            let sigma = 4.0 * (center / 1000.0).powi(2);
            let (mut sum, mut total) = (0.0, 0.0);
            for v in 0..30_usize {
                for u in 0..40_usize {
                    let (dx, dy) = (u.abs_diff(x), v.abs_diff(y));
                    let z = f64::from(depth[(u, v)]);
                    if dx.max(dy) <= 3 && z > 0.0 {
                        let apart = (dx * dx + dy * dy) as f64 / (2.0 * 1.2 * 1.2);
                        let base = 1.0 - (z - center).powi(2) / (2.0 * sigma * sigma * 8.0);
                        let weight = (-apart).exp() * base.max(0.0).powi(8);
                        sum += weight * z;
                        total += weight;
                    }
                }
            }
            let expected = if center > 0.0 { sum / total } else { 0.0 };
            assert!((f64::from(smooth[(x, y)]) - expected).abs() < 1e-3, "{x} {y}");
        }
    }

    #[test]
    fn an_edge_stays_where_it_is_and_a_hole_stays_a_hole() {
        let pixels = (0..20 * 9).map(|i| if i % 20 < 10 { 800.0 } else { 1000.0 });
        let mut depth = Image::new(20, 9, pixels.collect()).unwrap();
        depth[(4, 4)] = 0.0;
        assert_eq!(bilateral(&depth, &BilateralOptions::default()), depth);
    }

    #[test]
    fn noise_gets_smaller_and_a_small_picture_is_no_trouble() {
        let mut draw = Pcg64Mcg::seed_from_u64(1);
        let pixels = (0..100 * 100).map(|_| 1000.0 + draw.random_range(-1.7..1.7_f32));
        let depth = Image::new(100, 100, pixels.collect()).unwrap();
        let spread = |image: &Image<f32>| {
            let square = |z: &f32| f64::from(z - 1000.0).powi(2);
            (image.pixels().iter().map(square).sum::<f64>() / 1e4).sqrt()
        };
        let options = BilateralOptions::default();
        assert!(spread(&bilateral(&depth, &options)) < 0.3 * spread(&depth));
        let dot = Image::new(1, 1, vec![500.0]).unwrap();
        assert_eq!(bilateral(&dot, &options), dot);
        assert_eq!(bilateral(&Image::filled(0, 0, 0.0), &options).pixels(), [0.0; 0]);
    }
}
