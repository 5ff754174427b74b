//! One frame in halves of halves, each pixel with all that is asked of it side by side.

use super::points::Points;
use super::{DenseError, DenseOptions};
use crate::rgbd::{Camera, Image, RgbdFrame, grey, halved_depth, halved_grey};
use std::sync::OnceLock;

/// What a pixel holds, so that one place in the picture is read at once, between pixels too.
pub(super) type Texel = [f32; 8];
/// Brightness, 0 to 1, and how it changes along rows and columns [1/px].
pub(super) const GREY: usize = 0;
pub(super) const GREY_X: usize = 1;
pub(super) const GREY_Y: usize = 2;
/// Inverse depth [1/mm], and how it changes. Over a plane it changes evenly, and the noise of a sensor
/// that triangulates is even in it; depth has neither.
pub(super) const NEAR: usize = 3;
pub(super) const NEAR_X: usize = 4;
pub(super) const NEAR_Y: usize = 5;
/// 1 where the inverse depth and its change are those of one surface, else 0.
pub(super) const HELD: usize = 6;

/// Depths around a pixel that differ by more than this share belong to several surfaces.
const EDGE: f32 = 0.08;
/// The tiny picture has at most this many pixels a side.
const TINY: usize = 48;
/// The coarsest picture must still have this many pixels a side.
const LEAST: usize = 12;

/// A frame as [`align_frames`](super::align_frames) takes it: coarse pictures of it below the fine one.
#[derive(Debug)]
pub struct Pyramid {
    /// When it was taken [s].
    pub stamp: f64,
    /// Fine before coarse.
    pub(super) levels: Vec<Level>,
    /// The tiny picture that turns are tried on.
    pub(super) tiny: Level,
}

/// One of the pictures.
#[derive(Debug)]
pub(super) struct Level {
    pub(super) camera: Camera,
    pub(super) texels: Image<Texel>,
    points: OnceLock<Points>,
}

impl Pyramid {
    /// The pictures of `frame`, taken by `camera`.
    pub fn new(
        frame: &RgbdFrame,
        camera: &Camera,
        options: &DenseOptions,
    ) -> Result<Self, DenseError> {
        options.check()?;
        camera.check()?;
        frame.check(camera)?;
        frame.check_depth()?;
        let color = frame.color.as_ref().ok_or(DenseError::NoColour)?;
        let n_levels = options.levels;
        if camera.width.min(camera.height) >> (n_levels - 1) < LEAST {
            let (width, height) = (camera.width, camera.height);
            return Err(DenseError::TooSmall { width, height, levels: n_levels });
        }
        let (mut grey, mut depth, mut camera) = (grey(color), frame.depth.clone(), *camera);
        let mut levels = Vec::with_capacity(n_levels);
        for i_level in 0..n_levels {
            if i_level > 0 {
                (grey, depth) = rayon::join(|| halved_grey(&grey), || halved_depth(&depth));
                camera = camera.halved();
            }
            levels.push(Level::new(&grey, &depth, &camera));
        }
        while camera.width.max(camera.height) > TINY {
            (grey, depth, camera) = (halved_grey(&grey), halved_depth(&depth), camera.halved());
        }
        let tiny = Level::new(&blurred(&grey), &depth, &camera);
        Ok(Self { stamp: frame.stamp, levels, tiny })
    }

    /// What took it.
    pub fn camera(&self) -> &Camera {
        &self.levels[0].camera
    }
}

impl Level {
    /// The picture of a brightness and a depth of one size.
    pub(super) fn new(grey: &Image<f32>, depth: &Image<f32>, camera: &Camera) -> Self {
        let near = depth.map(|z| if *z > 0.0 { 1.0 / z } else { 0.0 });
        let (width, height) = (grey.width(), grey.height());
        let texels = Image::from_rows(width, height, [0.0; 8], |y, row| {
            let around = |image: &Image<f32>, y: usize| -> Vec<f32> { image.row(y).to_vec() };
            let is_inside = 0 < y && y + 1 < height;
            for (x, texel) in row.iter_mut().enumerate() {
                texel[GREY] = grey[(x, y)];
                texel[NEAR] = near[(x, y)];
            }
            if !is_inside {
                return;
            }
            let grey = [y - 1, y, y + 1].map(|y| around(grey, y));
            let near = [y - 1, y, y + 1].map(|y| around(&near, y));
            for x in 1..width.saturating_sub(1) {
                let texel = &mut row[x];
                texel[GREY_X] = (grey[1][x + 1] - grey[1][x - 1]) / 2.0;
                texel[GREY_Y] = (grey[2][x] - grey[0][x]) / 2.0;
                let column = |x: usize| near[0][x] + near[1][x] + near[2][x];
                let line = |y: usize| near[y][x - 1] + near[y][x] + near[y][x + 1];
                texel[NEAR_X] = (column(x + 1) - column(x - 1)) / 6.0;
                texel[NEAR_Y] = (line(2) - line(0)) / 6.0;
                let (mut least, mut most) = (f32::INFINITY, 0.0_f32);
                for line in &near {
                    for near in &line[x - 1..=x + 1] {
                        least = least.min(*near);
                        most = most.max(*near);
                    }
                }
                // No reading is an inverse depth of 0: that is another surface too.
                texel[HELD] = if least > 0.0 && most <= least * (1.0 + EDGE) { 1.0 } else { 0.0 };
            }
        });
        Self { camera: *camera, texels, points: OnceLock::new() }
    }

    /// The points that are looked for in other frames, chosen when they are first asked for.
    pub(super) fn points(&self, most: usize) -> &Points {
        self.points.get_or_init(|| Points::chosen(self, most))
    }
}

/// Every pixel mixed with those around it, by 1 2 1 both ways.
fn blurred(image: &Image<f32>) -> Image<f32> {
    let (width, height) = (image.width(), image.height());
    Image::from_rows(width, height, 0.0, |y, row| {
        let lines = [y.saturating_sub(1), y, (y + 1).min(height - 1)].map(|y| image.row(y));
        let column = |x: usize| lines[0][x] + 2.0 * lines[1][x] + lines[2][x];
        for (x, pixel) in row.iter_mut().enumerate() {
            let (left, right) = (x.saturating_sub(1), (x + 1).min(width - 1));
            *pixel = (column(left) + 2.0 * column(x) + column(right)) / 16.0;
        }
    })
}
