//! Which pixels of a frame are looked for in another one.

use super::pyramid::{GREY, GREY_X, GREY_Y, HELD, Level, NEAR};
use crate::rgbd::Camera;
use rayon::prelude::*;

/// Points that are worked on together, and the unit of every sum: results do not depend on threads.
pub(super) const BATCH: usize = 256;

/// Points of a frame, as its camera saw them.
#[derive(Debug, Clone)]
pub(super) struct Points {
    pub(super) batches: Vec<PointBatch>,
    pub(super) count: usize,
    /// Median depth [mm]: it makes turns and shifts comparable.
    pub(super) depth: f64,
}

/// A handful of them, coordinate by coordinate.
#[derive(Debug, Clone)]
pub(super) struct PointBatch {
    /// How many there are; what comes after is all 0.
    pub(super) n: usize,
    pub(super) x: [f32; BATCH],
    pub(super) y: [f32; BATCH],
    pub(super) z: [f32; BATCH],
    pub(super) grey: [f32; BATCH],
}

impl Points {
    /// At most about `most` pixels that lie on one surface: of every square of pixels the one where the
    /// brightness changes most. So bright corners do not have all the say, and bare walls have some.
    pub(super) fn chosen(level: &Level, most: usize) -> Self {
        let texels = &level.texels;
        let (width, height) = (texels.width(), texels.height());
        let side = ((width * height) as f64 / most.max(1) as f64).sqrt().ceil().max(1.0) as usize;
        let best_of = |row: usize, column: usize| {
            let mut best: Option<(f32, [usize; 2])> = None;
            for y in row * side..((row + 1) * side).min(height) {
                for x in column * side..((column + 1) * side).min(width) {
                    let texel = &texels[(x, y)];
                    let change = texel[GREY_X].powi(2) + texel[GREY_Y].powi(2);
                    if texel[HELD] > 0.0 && best.is_none_or(|(most, _)| change > most) {
                        best = Some((change, [x, y]));
                    }
                }
            }
            best.map(|(_, at)| seen(&level.camera, at, &texels[(at[0], at[1])]))
        };
        let row = |row: usize| -> Vec<[f32; 4]> {
            (0..width.div_ceil(side)).filter_map(|column| best_of(row, column)).collect()
        };
        let rows: Vec<Vec<[f32; 4]>> =
            (0..height.div_ceil(side)).into_par_iter().map(row).collect();
        Self::new(&rows.concat())
    }

    /// Points by x, y, z [mm] and brightness.
    pub(super) fn new(points: &[[f32; 4]]) -> Self {
        let batch = |points: &[[f32; 4]]| {
            let mut batch = PointBatch::EMPTY;
            batch.n = points.len();
            for (i, [x, y, z, grey]) in points.iter().enumerate() {
                (batch.x[i], batch.y[i], batch.z[i], batch.grey[i]) = (*x, *y, *z, *grey);
            }
            batch
        };
        let mut depths: Vec<f32> = points.iter().map(|p| p[2]).collect();
        let middle = depths.len() / 2;
        let depth = if depths.is_empty() {
            1000.0
        } else {
            f64::from(*depths.select_nth_unstable_by(middle, f32::total_cmp).1)
        };
        let batches = points.chunks(BATCH).map(batch).collect();
        Self { batches, count: points.len(), depth }
    }
}

impl PointBatch {
    const EMPTY: Self =
        Self { n: 0, x: [0.0; BATCH], y: [0.0; BATCH], z: [0.0; BATCH], grey: [0.0; BATCH] };
}

/// The point in column `x` of row `y`.
fn seen(camera: &Camera, [x, y]: [usize; 2], texel: &[f32; 8]) -> [f32; 4] {
    let depth = 1.0 / f64::from(texel[NEAR]);
    let point = camera.unproject([x as f64, y as f64], depth);
    [point.x as f32, point.y as f32, point.z as f32, texel[GREY]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rgbd::Image;

    fn level(depth: &Image<f32>) -> Level {
        let (width, height) = (depth.width(), depth.height());
        // Bright from column 13 on.
        let pixels = (0..width * height).map(|i| if i % width < 13 { 0.2 } else { 0.8 });
        let grey = Image::new(width, height, pixels.collect()).unwrap();
        let camera = Camera::pinhole([width, height], [50.0, 50.0], [20.0, 15.0]);
        Level::new(&grey, depth, &camera)
    }

    #[test]
    fn every_square_gives_the_pixel_where_brightness_changes_most() {
        let level = level(&Image::filled(40, 32, 500.0));
        let points = Points::chosen(&level, 80);
        assert_eq!(points.count, 80);
        assert!((points.depth - 500.0).abs() < 1e-3, "rounding of its inverse: {}", points.depth);
        let pixels: Vec<[f64; 2]> = (0..80)
            .map(|i| {
                let batch = &points.batches[0];
                let point = [batch.x[i], batch.y[i], batch.z[i]].map(f64::from);
                level.camera.project(&point.into()).unwrap()
            })
            .collect();
        let at_edge = pixels.iter().filter(|p| (p[0] - 12.5).abs() < 1.0).count();
        assert_eq!(at_edge, 8, "one for each row of squares: {pixels:?}");
        assert_eq!(Points::chosen(&level, 1 << 20).count, 38 * 30, "all but the rim");
    }

    #[test]
    fn nothing_is_chosen_beside_an_edge_of_depth_or_a_hole() {
        let pixels = (0..40 * 32).map(|i| if i % 40 < 20 { 500.0 } else { 900.0 });
        let mut depth = Image::new(40, 32, pixels.collect()).unwrap();
        depth[(5, 5)] = 0.0;
        let points = Points::chosen(&level(&depth), 1 << 20);
        assert_eq!(points.count, 38 * 30 - 2 * 30 - 9);
        assert_eq!(Points::chosen(&level(&Image::filled(40, 32, 0.0)), 99).count, 0);
    }
}
