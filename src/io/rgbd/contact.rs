//! A contact sheet: what a scan shows at a glance.

use crate::io::report::{Raster, heat};
use crate::rgbd::RgbdFrame;

/// Width of a picture on the sheet [px].
const WIDTH: usize = 192;
/// Frames side by side.
const COLUMNS: usize = 4;
/// Between pictures, and what is there [px].
const GAP: usize = 4;
const PAPER: [u8; 3] = [240, 241, 243];
const NO_READING: [u8; 3] = [28, 29, 32];

/// The colours of `frames`, each with its depth below (near is bright), smaller than they are.
pub fn contact_sheet(frames: &[RgbdFrame]) -> Raster {
    let Some(first) = frames.first() else {
        return Raster { width: 1, height: 1, pixels: vec![PAPER] };
    };
    let height = (WIDTH * first.depth.height()).div_ceil(first.depth.width().max(1)).max(1);
    let (n_columns, n_rows) = (COLUMNS.min(frames.len()), frames.len().div_ceil(COLUMNS));
    let cell = [WIDTH + GAP, 2 * height + 2 * GAP];
    let [width, total] = [n_columns * cell[0] + GAP, n_rows * cell[1] + GAP];
    let mut pixels = vec![PAPER; width * total];
    let range = depth_range(frames);
    for (i, frame) in frames.iter().enumerate() {
        let [left, top] = [GAP + i % COLUMNS * cell[0], GAP + i / COLUMNS * cell[1]];
        for y in 0..height {
            for x in 0..WIDTH {
                let from = |size: usize, at: usize, of: usize| (at * size / of).min(size - 1);
                let (u, v) =
                    (from(frame.depth.width(), x, WIDTH), from(frame.depth.height(), y, height));
                let color = frame.color.as_ref().map_or(PAPER, |color| color[(u, v)]);
                pixels[(top + y) * width + left + x] = color;
                let depth = shade(frame.depth[(u, v)], range);
                pixels[(top + height + y) * width + left + x] = depth;
            }
        }
    }
    Raster { width: width as u32, height: total as u32, pixels }
}

/// The nearest and the farthest reading.
fn depth_range(frames: &[RgbdFrame]) -> [f32; 2] {
    let readings =
        frames.iter().flat_map(|frame| frame.depth.pixels()).filter(|depth| **depth > 0.0);
    readings.fold([f32::INFINITY, 0.0], |[near, far], depth| [near.min(*depth), far.max(*depth)])
}

fn shade(depth: f32, [near, far]: [f32; 2]) -> [u8; 3] {
    // Equal steps of nearness, as triangulating sensors see it.
    let nearness = |depth: f32| 1.0 / f64::from(depth);
    if depth > 0.0 {
        let least = nearness(far);
        heat((nearness(depth) - least) / (nearness(near) - least).max(1e-12))
    } else {
        NO_READING
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rgbd::Image;

    #[test]
    fn near_is_brighter_than_far_and_no_reading_is_dark() {
        let depth = Image::new(2, 1, vec![500.0, 2000.0]).unwrap();
        let color = Some(Image::filled(2, 1, [200, 10, 10]));
        let frame = RgbdFrame { stamp: 0.0, color, depth, confidence: None };
        let sheet = contact_sheet(&[frame.clone(), frame]);
        let width = sheet.width as usize;
        assert_eq!(sheet.pixels.len(), width * sheet.height as usize);
        let at = |x: usize, y: usize| sheet.pixels[y * width + x];
        assert_eq!(at(GAP, GAP), [200, 10, 10]);
        assert_eq!(at(GAP, GAP + WIDTH / 2 + 1), heat(1.0));
        assert_eq!(at(GAP + WIDTH - 1, GAP + WIDTH / 2 + 1), heat(0.0));
        assert_eq!(shade(0.0, [1.0, 2.0]), NO_READING);
    }

    #[test]
    fn a_sheet_of_nothing_is_a_picture_too() {
        assert_eq!(contact_sheet(&[]).pixels.len(), 1);
    }
}
