//! Pictures of half the size, for methods that go from coarse to fine. [`Camera::halved`] is theirs.
//!
//! [`Camera::halved`]: super::Camera::halved

use super::Image;

/// Of four depths, those this much deeper than the nearest are another surface [share of depth].
const EDGE: f32 = 0.05;

/// The means of 2 x 2 pixels. An odd last column or row is left out.
pub fn halved_grey(image: &Image<f32>) -> Image<f32> {
    halved(image, |four| four.iter().sum::<f32>() / 4.0)
}

/// The means of 2 x 2 depths, of the nearest surface alone where there is an edge among them; 0 where
/// none of the four has a reading. An odd last column or row is left out.
pub fn halved_depth(depth: &Image<f32>) -> Image<f32> {
    halved(depth, |four| {
        let readings = || four.into_iter().filter(|depth| *depth > 0.0);
        let nearest = readings().fold(f32::INFINITY, f32::min);
        let one_surface = readings().filter(|depth| *depth <= nearest * (1.0 + EDGE));
        let (sum, n) = one_surface.fold((0.0, 0.0), |(sum, n), depth| (sum + depth, n + 1.0));
        if n > 0.0 { sum / n } else { 0.0 }
    })
}

fn halved(image: &Image<f32>, of_four: impl Fn([f32; 4]) -> f32 + Sync) -> Image<f32> {
    Image::from_rows(image.width() / 2, image.height() / 2, 0.0, |y, row| {
        let (above, below) = (image.row(2 * y), image.row(2 * y + 1));
        for (x, pixel) in row.iter_mut().enumerate() {
            *pixel = of_four([above[2 * x], above[2 * x + 1], below[2 * x], below[2 * x + 1]]);
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grey_is_averaged_and_an_odd_column_left_out() {
        let image = Image::new(3, 2, vec![0.0, 0.2, 9.0, 0.4, 0.6, 9.0]).unwrap();
        let half = halved_grey(&image);
        assert_eq!((half.width(), half.height()), (1, 1));
        assert!((half[(0, 0)] - 0.3).abs() < 1e-7);
    }

    #[test]
    fn depth_is_never_averaged_over_an_edge_or_a_hole() {
        let rows = [1000.0, 1010.0, 0.0, 0.0, 1000.0, 2000.0, 1020.0, 0.0, 0.0, 0.0, 1000.0, 0.0];
        let image = Image::new(6, 2, rows.to_vec()).unwrap();
        assert_eq!(halved_depth(&image).pixels(), [1010.0, 0.0, 1000.0]);
    }
}
