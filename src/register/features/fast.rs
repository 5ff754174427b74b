//! FAST corners: nine pixels in a row, on a ring of sixteen, all brighter or all darker than the
//! middle.
//!
//! E. Rosten and T. Drummond, *Machine learning for high-speed corner detection* (ECCV 2006); here
//! without its decision tree.

use super::FeatureOptions;
use crate::rgbd::Image;
use rayon::prelude::*;

/// The ring, clockwise from above.
const RING: [(isize, isize); 16] = [
    (0, -3),
    (1, -3),
    (2, -2),
    (3, -1),
    (3, 0),
    (3, 1),
    (2, 2),
    (1, 3),
    (0, 3),
    (-1, 3),
    (-2, 2),
    (-3, 1),
    (-3, 0),
    (-3, -1),
    (-2, -2),
    (-1, -3),
];
/// So many in a row make a corner.
const ARC: usize = 9;
/// Side of the cells that corners are spread over [px].
const CELL: usize = 32;

/// A corner of a picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Corner {
    /// Column and row, between pixels [px].
    pub at: [f64; 2],
    /// The greatest contrast with which it still is a corner [of 255].
    pub strength: u8,
}

impl Corner {
    /// The pixel it lies in.
    pub fn pixel(&self) -> [usize; 2] {
        self.at.map(|c| c.round() as usize)
    }
}

/// The corners of `image` at least `border` pixels inside it: the strongest of every cell, and then the
/// strongest of those left.
pub(super) fn corners(image: &Image<u8>, options: &FeatureOptions, border: usize) -> Vec<Corner> {
    let (width, height) = (image.width(), image.height());
    let border = border.max(4);
    if width <= 2 * border || height <= 2 * border {
        return Vec::new();
    }
    // One more on every side, so that maxima are told at the border too.
    let strengths = Image::from_rows(width, height, 0, |y, row| {
        if (border - 1..=height - border).contains(&y) {
            let inner = row.iter_mut().enumerate().take(width - border + 1).skip(border - 1);
            for (x, pixel) in inner {
                *pixel = strength(image, x, y, options.contrast);
            }
        }
    });
    let rows: Vec<Vec<[usize; 2]>> = (border..height - border)
        .into_par_iter()
        .map(|y| {
            let row = (border..width - border).map(|x| [x, y]);
            row.filter(|&at| is_peak(&strengths, at)).collect()
        })
        .collect();
    let chosen = spread(&strengths, rows.concat(), options.n_features);
    chosen.into_iter().map(|at| between_pixels(&strengths, at)).collect()
}

/// The greatest contrast with which a pixel still is a corner; 0 below `least`.
fn strength(image: &Image<u8>, x: usize, y: usize, least: u8) -> u8 {
    let middle = i16::from(image[(x, y)]);
    let at = |i: usize| {
        let (dx, dy) = RING[i];
        i16::from(image[(x.wrapping_add_signed(dx), y.wrapping_add_signed(dy))]) - middle
    };
    // An arc of nine covers one of two opposite pixels, always.
    let least = i16::from(least).max(1);
    let is_flat = |i: usize| at(i).abs() < least && at(i + 8).abs() < least;
    if is_flat(0) || is_flat(4) {
        return 0;
    }
    let ring: [i16; 16] = std::array::from_fn(at);
    let weakest = |begin: usize, sign: i16| {
        (begin..begin + ARC).map(|i| sign * ring[i % 16]).min().unwrap_or(0)
    };
    let best = (0..16).map(|i| weakest(i, 1).max(weakest(i, -1))).max().unwrap_or(0);
    if best >= least { best.min(255) as u8 } else { 0 }
}

/// True of a pixel stronger than those around it; of equal ones the first.
fn is_peak(strengths: &Image<u8>, [x, y]: [usize; 2]) -> bool {
    let own = strengths[(x, y)];
    if own == 0 {
        return false;
    }
    let before = [(x - 1, y - 1), (x, y - 1), (x + 1, y - 1), (x - 1, y)];
    let after = [(x + 1, y), (x - 1, y + 1), (x, y + 1), (x + 1, y + 1)];
    before.into_iter().all(|at| strengths[at] < own)
        && after.into_iter().all(|at| strengths[at] <= own)
}

/// At most `n` of `peaks`: of each cell its share, and more where other cells have less.
fn spread(strengths: &Image<u8>, mut peaks: Vec<[usize; 2]>, n: usize) -> Vec<[usize; 2]> {
    let n_columns = strengths.width().div_ceil(CELL);
    let n_cells = n_columns * strengths.height().div_ceil(CELL);
    let share = n.div_ceil(n_cells.max(1));
    let strength = |at: &[usize; 2]| strengths[(at[0], at[1])];
    peaks.sort_by_key(|at| (std::cmp::Reverse(strength(at)), at[1], at[0]));
    let mut taken = vec![0; n_cells];
    let (mut first, rest): (Vec<_>, Vec<_>) = peaks.into_iter().partition(|at| {
        let cell = at[0] / CELL + n_columns * (at[1] / CELL);
        taken[cell] += 1;
        taken[cell] <= share
    });
    first.truncate(n);
    let missing = n - first.len();
    first.extend(rest.into_iter().take(missing));
    first
}

/// The peak of the parabolas through a pixel's strength and its neighbours'.
fn between_pixels(strengths: &Image<u8>, [x, y]: [usize; 2]) -> Corner {
    let s = |x: usize, y: usize| f64::from(strengths[(x, y)]);
    let peak = |before: f64, own: f64, after: f64| {
        let bend = before + after - 2.0 * own;
        if bend < 0.0 { ((before - after) / (2.0 * bend)).clamp(-0.5, 0.5) } else { 0.0 }
    };
    let dx = peak(s(x - 1, y), s(x, y), s(x + 1, y));
    let dy = peak(s(x, y - 1), s(x, y), s(x, y + 1));
    Corner { at: [x as f64 + dx, y as f64 + dy], strength: strengths[(x, y)] }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A bright square on dark ground.
    fn square() -> Image<u8> {
        Image::from_rows(60, 60, 40, |y, row| {
            if (20..40).contains(&y) {
                row[20..40].fill(140);
            }
        })
    }

    #[test]
    fn a_square_has_four_corners_and_its_sides_none() {
        let options = FeatureOptions { n_features: 100, contrast: 20 };
        let mut found: Vec<[usize; 2]> =
            corners(&square(), &options, 5).iter().map(Corner::pixel).collect();
        found.sort_unstable();
        assert_eq!(found.len(), 4, "{found:?}");
        for corner in [[20, 20], [20, 39], [39, 20], [39, 39]] {
            let is_near =
                |at: &[usize; 2]| at[0].abs_diff(corner[0]) + at[1].abs_diff(corner[1]) < 3;
            assert!(found.iter().any(is_near), "{corner:?} of {found:?}");
        }
    }

    #[test]
    fn strength_is_the_contrast_up_to_which_it_is_a_corner() {
        let image = square();
        assert_eq!(strength(&image, 20, 20, 20), 100);
        assert_eq!(strength(&image, 20, 20, 101), 0);
        assert_eq!(strength(&image, 30, 20, 20), 0, "the middle of a side");
        assert_eq!(strength(&image, 30, 30, 20), 0, "the inside");
    }

    #[test]
    fn each_cell_gets_its_share_before_any_gets_more() {
        // Four corners in one cell and one weak one far away.
        let mut image = square();
        image[(10, 50)] = 70;
        let options = FeatureOptions { n_features: 2, contrast: 20 };
        assert_eq!(corners(&image, &options, 5).len(), 2);
        let all = FeatureOptions { n_features: 5, contrast: 20 };
        let found = corners(&image, &all, 5);
        assert_eq!(found.len(), 5);
        assert!(found.iter().any(|corner| corner.pixel() == [10, 50]), "{found:?}");
    }
}
