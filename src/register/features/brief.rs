//! BRIEF: 256 comparisons of brightness around a corner.
//!
//! M. Calonder et al., *BRIEF: Binary Robust Independent Elementary Features* (ECCV 2010): pairs of
//! places drawn from a normal distribution, on a smoothed picture.

use super::Corner;
use crate::rgbd::Image;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;

/// Pixels from a corner to the farthest place that is looked at.
pub(super) const REACH: usize = 20;
/// Half the side of the squares whose means are compared, taken twice [px].
const BLUR: usize = 2;
/// Comparisons.
const N_BITS: usize = 256;
/// Standard deviation of the places [px].
const SPREAD: f64 = 8.0;
/// The pattern must be the same in every program: descriptors may be kept.
const SEED: u64 = 256;

/// What is around a corner: one bit for each comparison.
pub type Descriptor = [u64; N_BITS / 64];

/// The descriptors of `corners`, all of which are at least [`REACH`] inside the picture.
pub(super) fn describe(grey: &Image<f32>, corners: &[Corner]) -> Vec<Descriptor> {
    let smooth = blurred(&blurred(grey));
    let pattern = pattern();
    corners.par_iter().map(|corner| descriptor(&smooth, corner, &pattern)).collect()
}

fn descriptor(smooth: &Image<f32>, corner: &Corner, pattern: &[[(isize, isize); 2]]) -> Descriptor {
    let [x, y] = corner.pixel();
    let at =
        |(dx, dy): (isize, isize)| smooth[(x.wrapping_add_signed(dx), y.wrapping_add_signed(dy))];
    let mut bits = Descriptor::default();
    for (i, &[one, other]) in pattern.iter().enumerate() {
        bits[i / 64] |= u64::from(at(one) < at(other)) << (i % 64);
    }
    bits
}

/// Pairs of places around a corner.
fn pattern() -> Vec<[(isize, isize); 2]> {
    let mut random = Pcg64Mcg::seed_from_u64(SEED);
    let mut coordinate = || {
        // Twelve even draws add up to a normal one, near enough, by arithmetic that is the same everywhere.
        let normal = (0..12).map(|_| random.random_range(-0.5..0.5)).sum::<f64>();
        let reach = REACH as f64;
        (normal * SPREAD).round().clamp(-reach, reach) as isize
    };
    let mut pattern = Vec::with_capacity(N_BITS);
    while pattern.len() < N_BITS {
        let [one, other] = [(); 2].map(|()| (coordinate(), coordinate()));
        if one != other {
            pattern.push([one, other]);
        }
    }
    pattern
}

/// Means over squares, along rows and then along columns; at the rim of what there is.
fn blurred(image: &Image<f32>) -> Image<f32> {
    let (width, height) = (image.width(), image.height());
    let mean = |values: &mut dyn Iterator<Item = f32>| {
        let (sum, n) = values.fold((0.0, 0.0), |(sum, n), value| (sum + value, n + 1.0_f32));
        sum / n.max(1.0)
    };
    let along = Image::from_rows(width, height, 0.0, |y, row| {
        let from = image.row(y);
        for (x, pixel) in row.iter_mut().enumerate() {
            let near = x.saturating_sub(BLUR)..(x + BLUR + 1).min(width);
            *pixel = mean(&mut from[near].iter().copied());
        }
    });
    Image::from_rows(width, height, 0.0, |y, row| {
        let near = y.saturating_sub(BLUR)..(y + BLUR + 1).min(height);
        for (x, pixel) in row.iter_mut().enumerate() {
            *pixel = mean(&mut near.clone().map(|y| along[(x, y)]));
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_brighter_picture_has_the_same_descriptor_and_its_negative_the_opposite() {
        let noise = Image::from_rows(64, 64, 0.0_f32, |y, row| {
            let mut random = Pcg64Mcg::seed_from_u64(y as u64);
            for pixel in row {
                *pixel = random.random_range(0.0..1.0);
            }
        });
        let corner = [Corner { at: [32.0, 32.0], strength: 9 }];
        let of = |image: &Image<f32>| describe(image, &corner)[0];
        let same = of(&noise);
        // Powers of two: not even the last bit changes.
        assert_eq!(of(&noise.map(|value| value * 0.5)), same);
        let negative = of(&noise.map(|value| -value));
        let n_different: u32 = same.iter().zip(negative).map(|(a, b)| (a ^ b).count_ones()).sum();
        assert_eq!(n_different, 256);
        let n_ones: u32 = same.iter().map(|bits| bits.count_ones()).sum();
        assert!((64..192).contains(&n_ones), "{n_ones} of 256 bits are set");
    }

    #[test]
    fn the_mean_of_a_square_is_taken() {
        let mut image = Image::filled(11, 11, 0.0_f32);
        image[(5, 5)] = 25.0;
        let means = blurred(&image);
        assert_eq!((means[(5, 5)], means[(7, 3)], means[(8, 5)]), (1.0, 1.0, 0.0));
    }
}
