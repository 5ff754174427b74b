//! Pictures: values in rows, from the top left.

use super::RgbdError;
use rayon::prelude::*;
use std::ops::{Index, IndexMut};

/// Weights of red, green and blue in grey (ITU-R BT.601, as `OpenCV` has it).
const LUMA: [f32; 3] = [0.299, 0.587, 0.114];

/// Values in rows from the top left, `width * height` of them. `image[(x, y)]` is one.
#[derive(Debug, Clone, PartialEq)]
pub struct Image<T> {
    width: usize,
    height: usize,
    pixels: Vec<T>,
}

impl<T> Image<T> {
    /// An image of whole rows; an error if there are not `width * height` pixels.
    pub fn new(width: usize, height: usize, pixels: Vec<T>) -> Result<Self, RgbdError> {
        if width.checked_mul(height) == Some(pixels.len()) {
            Ok(Self { width, height, pixels })
        } else {
            Err(RgbdError::Pixels { n_pixels: pixels.len(), width, height })
        }
    }

    /// Pixels per row.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// All pixels, row by row.
    pub fn pixels(&self) -> &[T] {
        &self.pixels
    }

    /// All pixels, row by row, to change.
    pub fn pixels_mut(&mut self) -> &mut [T] {
        &mut self.pixels
    }

    /// The pixels alone.
    pub fn into_pixels(self) -> Vec<T> {
        self.pixels
    }

    /// The pixels of row `y`.
    pub fn row(&self, y: usize) -> &[T] {
        &self.pixels[y * self.width..(y + 1) * self.width]
    }

    /// The pixel in column `x` of row `y`; `None` outside.
    pub fn get(&self, x: usize, y: usize) -> Option<&T> {
        (x < self.width && y < self.height).then(|| &self.pixels[y * self.width + x])
    }

    /// True if `other` has as many columns and rows.
    pub fn is_as_large_as<U>(&self, other: &Image<U>) -> bool {
        (self.width, self.height) == (other.width, other.height)
    }

    /// The image of `f` of every pixel.
    pub fn map<U>(&self, f: impl Fn(&T) -> U) -> Image<U> {
        let pixels = self.pixels.iter().map(f).collect();
        Image { width: self.width, height: self.height, pixels }
    }
}

impl<T: Clone + Send> Image<T> {
    /// An image of one value.
    pub fn filled(width: usize, height: usize, value: T) -> Self {
        Self { width, height, pixels: vec![value; width * height] }
    }

    /// An image whose rows `fill` writes (it gets the row's number and `value` everywhere), side by
    /// side on all threads.
    pub fn from_rows(
        width: usize,
        height: usize,
        value: T,
        fill: impl Fn(usize, &mut [T]) + Sync,
    ) -> Self {
        let mut image = Self::filled(width, height, value);
        // Rows of no pixels cannot be told apart, and need nothing.
        let rows = image.pixels.par_chunks_mut(width.max(1));
        rows.enumerate().for_each(|(y, row)| fill(y, row));
        image
    }
}

impl Image<f32> {
    /// The value between pixels, bilinear; `None` outside the outermost pixels' centres.
    pub fn between(&self, x: f64, y: f64) -> Option<f32> {
        let (last_x, last_y) = (self.width.checked_sub(1)?, self.height.checked_sub(1)?);
        // A comparison that NaN fails.
        let is_inside = 0.0 <= x && x <= last_x as f64 && 0.0 <= y && y <= last_y as f64;
        if !is_inside {
            return None;
        }
        let (left, top) = (x as usize, y as usize);
        let (right, below) = ((left + 1).min(last_x), (top + 1).min(last_y));
        let (dx, dy) = ((x - left as f64) as f32, (y - top as f64) as f32);
        let along = |y: usize| self[(left, y)] * (1.0 - dx) + self[(right, y)] * dx;
        Some(along(top) * (1.0 - dy) + along(below) * dy)
    }
}

impl<T> Index<(usize, usize)> for Image<T> {
    type Output = T;

    fn index(&self, (x, y): (usize, usize)) -> &T {
        debug_assert!(x < self.width);
        &self.pixels[y * self.width + x]
    }
}

impl<T> IndexMut<(usize, usize)> for Image<T> {
    fn index_mut(&mut self, (x, y): (usize, usize)) -> &mut T {
        debug_assert!(x < self.width);
        &mut self.pixels[y * self.width + x]
    }
}

/// How bright a picture is, 0 (black) to 1 (white).
pub fn grey(color: &Image<[u8; 3]>) -> Image<f32> {
    color.map(|rgb| (0..3).map(|k| LUMA[k] * f32::from(rgb[k])).sum::<f32>() / 255.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_image_that_lies_about_its_size_is_refused() {
        assert!(Image::new(3, 2, vec![0; 6]).is_ok());
        let error = Image::new(3, 2, vec![0; 5]).unwrap_err().to_string();
        assert_eq!(error, "5 pixels are no picture of 3 x 2");
        assert!(Image::new(usize::MAX, 2, vec![0; 6]).is_err());
    }

    #[test]
    fn pixels_lie_in_rows_from_the_top_left() {
        let image = Image::new(3, 2, (0..6).collect()).unwrap();
        assert_eq!((image[(2, 0)], image[(0, 1)], image.row(1)), (2, 3, &[3, 4, 5][..]));
        assert_eq!((image.get(2, 1), image.get(3, 0), image.get(0, 2)), (Some(&5), None, None));
        let same = Image::from_rows(3, 2, 0, |y, row| {
            row.iter_mut().enumerate().for_each(|(x, pixel)| *pixel = 3 * y + x);
        });
        assert_eq!(same, image.map(|&i| i as usize));
        assert_eq!(Image::from_rows(0, 5, 1, |_, _| {}).pixels(), [0; 0]);
    }

    #[test]
    fn between_pixels_a_ramp_is_a_ramp_and_outside_there_is_nothing() {
        let ramp = Image::new(3, 3, (0..9).map(|i| (i % 3 + 10 * (i / 3)) as f32).collect());
        let ramp = ramp.unwrap();
        assert_eq!(ramp.between(1.25, 0.5), Some(6.25));
        assert_eq!(ramp.between(2.0, 2.0), Some(22.0));
        for (x, y) in [(-0.01, 0.0), (2.01, 0.0), (0.0, f64::NAN), (f64::INFINITY, 0.0)] {
            assert_eq!(ramp.between(x, y), None);
        }
    }

    #[test]
    fn white_is_one_and_green_is_brighter_than_blue() {
        let image = Image::new(3, 1, vec![[255; 3], [0, 255, 0], [0, 0, 255]]).unwrap();
        let grey = grey(&image);
        assert!((grey[(0, 0)] - 1.0).abs() < 1e-6 && grey[(1, 0)] > grey[(2, 0)]);
    }
}
