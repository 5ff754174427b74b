//! Some rows of a picture being drawn: triangles and lines into colours and depths.

use super::shade::lit;

/// Samples per pixel, each way.
pub(super) const SAMPLES: usize = 2;
/// Rows of the picture that are made together.
pub(super) const BAND: usize = 32;
/// Background at top and bottom.
pub(super) const BACKGROUND: [[f32; 3]; 2] = [[250.0, 251.0, 253.0], [228.0, 232.0, 238.0]];

/// A triangle on the way to the screen.
pub(super) struct Facet {
    pub(super) corners: [[f32; 3]; 3],
    pub(super) normals: [[f32; 3]; 3],
    pub(super) colors: [[f32; 3]; 3],
}

/// A piece of a line on the way to the screen.
pub(super) struct Stroke {
    pub(super) ends: [[f32; 3]; 2],
    pub(super) radius: f32,
    pub(super) color: [u8; 3],
}

/// Some rows of the picture, in samples.
pub(super) struct Band {
    width: usize,
    height: usize,
    /// First sample row of the band in the picture.
    top: usize,
    colors: Vec<[u8; 3]>,
    depths: Vec<f32>,
}

impl Band {
    /// Band `i_band` of a picture, nothing but background yet.
    pub(super) fn new(i_band: usize, n_rows: usize, [width, picture_height]: [u32; 2]) -> Self {
        let (width, height) = (width as usize * SAMPLES, n_rows * SAMPLES);
        let top = i_band * BAND * SAMPLES;
        let total = picture_height as usize * SAMPLES;
        let row = |row: usize| {
            let share = (top + row) as f32 / total as f32;
            let [from, to] = BACKGROUND;
            let mix = |k: usize| (from[k] + (to[k] - from[k]) * share).round() as u8;
            std::iter::repeat_n([mix(0), mix(1), mix(2)], width)
        };
        let colors = (0..height).flat_map(row).collect();
        Self { width, height, top, colors, depths: vec![f32::INFINITY; width * height] }
    }

    /// Draws a shaded triangle.
    pub(super) fn fill(&mut self, facet: &Facet) {
        let [a, b, c] = facet.corners;
        let area = cross(a, b, c);
        let Some((xs, ys)) = self.clip(&facet.corners, 0.0) else { return };
        if area == 0.0 || !area.is_finite() {
            return;
        }
        for y in ys {
            for x in xs.clone() {
                let p = [x as f32 + 0.5, (self.top + y) as f32 + 0.5, 0.0];
                let weights = [cross(p, b, c), cross(a, p, c), cross(a, b, p)].map(|w| w / area);
                // A hair over the edge, or rounding would leave pinholes between neighbours.
                if weights.iter().any(|&w| w < -1e-4) {
                    continue;
                }
                let depth = blend([[a[2]; 1], [b[2]; 1], [c[2]; 1]], weights)[0];
                let i = y * self.width + x;
                if depth < self.depths[i] {
                    self.depths[i] = depth;
                    let color = blend(facet.colors, weights);
                    self.colors[i] = lit(color, blend(facet.normals, weights));
                }
            }
        }
    }

    /// Draws a piece of a line with round ends.
    pub(super) fn stroke(&mut self, stroke: &Stroke) {
        let [a, b] = stroke.ends;
        let Some((xs, ys)) = self.clip(&stroke.ends, stroke.radius) else { return };
        let along = [b[0] - a[0], b[1] - a[1]];
        let length2 = along[0] * along[0] + along[1] * along[1];
        for y in ys {
            for x in xs.clone() {
                let to = [x as f32 + 0.5 - a[0], (self.top + y) as f32 + 0.5 - a[1]];
                let share = (to[0] * along[0] + to[1] * along[1]) / length2.max(f32::MIN_POSITIVE);
                let share = share.clamp(0.0, 1.0);
                let off = [to[0] - share * along[0], to[1] - share * along[1]];
                let depth = a[2] + (b[2] - a[2]) * share;
                let i = y * self.width + x;
                if off[0].hypot(off[1]) <= stroke.radius && depth < self.depths[i] {
                    self.depths[i] = depth;
                    self.colors[i] = stroke.color;
                }
            }
        }
    }

    /// The samples of this band that corners widened by `radius` may touch; none for corners that
    /// are not numbers.
    fn clip(
        &self,
        corners: &[[f32; 3]],
        radius: f32,
    ) -> Option<(std::ops::Range<usize>, std::ops::Range<usize>)> {
        if !corners.as_flattened().iter().all(|c| c.is_finite()) {
            return None;
        }
        let range = |k: usize, offset: usize, n: usize| {
            let values = corners.iter().map(|c| c[k] - offset as f32);
            let (min, max) = values.fold((f32::MAX, f32::MIN), |(a, b), v| (a.min(v), b.max(v)));
            // A cast of a float to an integer stops at the ends of its range.
            let start = (min - radius).floor() as usize;
            start..((max + radius).ceil() as usize).min(n)
        };
        let (xs, ys) = (range(0, 0, self.width), range(1, self.top, self.height));
        (!xs.is_empty() && !ys.is_empty()).then_some((xs, ys))
    }

    /// Averages the samples into the pixels of the band.
    pub(super) fn average_into(&self, rows: &mut [[u8; 3]]) {
        let width = self.width / SAMPLES;
        for (i, pixel) in rows.iter_mut().enumerate() {
            let (x, y) = (i % width * SAMPLES, i / width * SAMPLES);
            let samples = (0..SAMPLES * SAMPLES)
                .map(|k| self.colors[(y + k / SAMPLES) * self.width + x + k % SAMPLES]);
            let sum = samples.fold([0; 3], |sum: [usize; 3], s| {
                std::array::from_fn(|k| sum[k] + usize::from(s[k]))
            });
            *pixel = sum.map(|c| (c / (SAMPLES * SAMPLES)) as u8);
        }
    }
}

/// Twice the signed area of the triangle on the screen.
fn cross(a: [f32; 3], b: [f32; 3], c: [f32; 3]) -> f32 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

fn blend<const N: usize>(corners: [[f32; N]; 3], weights: [f32; 3]) -> [f32; N] {
    let [a, b, c] = corners;
    std::array::from_fn(|k| a[k] * weights[0] + b[k] * weights[1] + c[k] * weights[2])
}
