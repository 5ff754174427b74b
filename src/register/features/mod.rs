//! Visual features: places of a picture that are found again in another one.
//!
//! Corners by FAST (Rosten and Drummond 2006), what is around them by BRIEF (Calonder et al. 2010),
//! matched by the number of bits that differ: the "visual features" of Morell (2014), section 2.3.2.
//! Descriptors are upright: between the frames of a camera that is walked around a part, the horizon
//! hardly turns.

mod brief;
mod fast;
mod matching;

pub use brief::Descriptor;
pub use fast::Corner;
pub use matching::{Match, MatchOptions, matches};

use crate::rgbd::Image;

/// Corners and what is around each.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Features {
    /// Where they are, the strongest of each part of the picture first.
    pub corners: Vec<Corner>,
    /// What is around them, in the same order.
    pub descriptors: Vec<Descriptor>,
}

/// How [`Features::of`] looks at a picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FeatureOptions {
    /// How many are looked for, spread over the picture.
    pub n_features: usize,
    /// How much brighter or darker than its middle the ring around a corner is, at least [of 255].
    pub contrast: u8,
}

impl Default for FeatureOptions {
    fn default() -> Self {
        Self { n_features: 1500, contrast: 8 }
    }
}

impl Features {
    /// The features of a picture whose brightness runs from 0 to 1.
    pub fn of(grey: &Image<f32>, options: &FeatureOptions) -> Self {
        let bytes = grey.map(|value| (value * 255.0).round().clamp(0.0, 255.0) as u8);
        // One pixel more: a corner between pixels may be nearest to the next one out.
        let corners = fast::corners(&bytes, options, brief::REACH + 1);
        let descriptors = brief::describe(grey, &corners);
        Self { corners, descriptors }
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.corners.len()
    }

    /// True if nothing was found.
    pub fn is_empty(&self) -> bool {
        self.corners.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    /// Squares of random brightness, 12 pixels a side, behind a window at `(left, top)`.
    fn patches(left: usize, top: usize) -> Image<f32> {
        let shade = |x: usize, y: usize| {
            let cell = ((x + left) / 12 + 1000 * ((y + top) / 12)) as u64;
            Pcg64Mcg::seed_from_u64(cell).random_range(0.0..1.0)
        };
        Image::from_rows(240, 180, 0.0, |y, row| {
            row.iter_mut().enumerate().for_each(|(x, pixel)| *pixel = shade(x, y));
        })
    }

    #[test]
    fn a_shifted_picture_has_its_features_shifted() {
        let options = FeatureOptions { n_features: 300, ..FeatureOptions::default() };
        let [one, other] =
            [patches(0, 0), patches(7, 4)].map(|picture| Features::of(&picture, &options));
        let found = matches(&one.descriptors, &other.descriptors, &MatchOptions::default());
        assert!(found.len() > 80, "{} matches", found.len());
        let is_right = |m: &&Match| {
            let [a, b] = [one.corners[m.first].at, other.corners[m.second].at];
            (a[0] - b[0] - 7.0).hypot(a[1] - b[1] - 4.0) < 1.0
        };
        let n_right = found.iter().filter(is_right).count();
        assert!(n_right as f64 > 0.95 * found.len() as f64, "{n_right} of {}", found.len());
    }

    #[test]
    fn a_bare_picture_has_no_features_and_a_tiny_one_neither() {
        let options = FeatureOptions::default();
        assert!(Features::of(&Image::filled(200, 150, 0.5), &options).is_empty());
        for size in [0, 1, 7, 20] {
            assert!(Features::of(&Image::filled(size, size, 0.5), &options).is_empty());
        }
    }

    #[test]
    fn any_number_of_threads_finds_the_same() {
        let picture = patches(3, 5);
        let find = |n_threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads).build().unwrap();
            pool.install(|| Features::of(&picture, &FeatureOptions::default()))
        };
        assert_eq!(find(1), find(3));
    }
}
