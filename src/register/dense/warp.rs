//! Points of one frame, moved, and what another frame shows where they come to lie.

use super::points::{BATCH, PointBatch, Points};
use super::pyramid::{GREY, GREY_X, GREY_Y, HELD, Level, NEAR, NEAR_X, NEAR_Y, Texel};
use crate::geom::Pose;
use crate::rgbd::{Camera, Distortion, Image};
use rayon::prelude::*;

/// Between pixels a depth is one surface's if all four pixels are.
const ALL_HELD: f32 = 0.999;

/// A handful of points in the other frame, number by number. Where a point is not seen all is 0.
#[derive(Debug, Clone)]
pub(super) struct Batch {
    /// Its direction (u, v, 1) and its inverse depth, as moved.
    pub(super) u: [f32; BATCH],
    pub(super) v: [f32; BATCH],
    pub(super) near: [f32; BATCH],
    /// Its own brightness, and what is seen.
    pub(super) own: [f32; BATCH],
    pub(super) grey: [f32; BATCH],
    /// How what is seen changes with u and v.
    pub(super) grey_u: [f32; BATCH],
    pub(super) grey_v: [f32; BATCH],
    /// What is seen of inverse depth, less its own.
    pub(super) off: [f32; BATCH],
    pub(super) near_u: [f32; BATCH],
    pub(super) near_v: [f32; BATCH],
    /// 1 where the point is in the picture.
    pub(super) seen: [f32; BATCH],
    /// 1 where there is a depth to compare it with.
    pub(super) held: [f32; BATCH],
}

impl Batch {
    pub(super) const EMPTY: Self = Self {
        u: [0.0; BATCH],
        v: [0.0; BATCH],
        near: [0.0; BATCH],
        own: [0.0; BATCH],
        grey: [0.0; BATCH],
        grey_u: [0.0; BATCH],
        grey_v: [0.0; BATCH],
        off: [0.0; BATCH],
        near_u: [0.0; BATCH],
        near_v: [0.0; BATCH],
        seen: [0.0; BATCH],
        held: [0.0; BATCH],
    };
}

/// The camera and what it sees, as the loops want them.
pub(super) struct Warp<'a> {
    level: &'a Level,
    lens: Lens,
    with_depth: bool,
}

/// A camera in single precision.
pub(super) struct Lens {
    focal: [f32; 2],
    center: [f32; 2],
    distortion: [f32; 5],
    /// Directions farther off the axis (squared) than any in the picture: the distortion may fold them
    /// back into it.
    pub(super) widest: f32,
}

impl<'a> Warp<'a> {
    /// Into the picture of `level`; `with_depth` compares depths too.
    pub(super) fn into(level: &'a Level, with_depth: bool) -> Self {
        Self { level, lens: Lens::new(&level.camera), with_depth }
    }

    /// Where `points` come to lie by `next_from_reference`, and what is seen there, into `batches`.
    pub(super) fn look(
        &self,
        points: &Points,
        next_from_reference: &Pose,
        batches: &mut Vec<Batch>,
    ) {
        batches.resize(points.batches.len(), Batch::EMPTY);
        let matrix = next_from_reference.to_homogeneous();
        let motion = [0, 1, 2].map(|i| [0, 1, 2, 3].map(|j| matrix[(i, j)] as f32));
        points
            .batches
            .par_iter()
            .zip(batches.par_iter_mut())
            .for_each(|(points, batch)| self.look_at(points, &motion, batch));
    }

    fn look_at(&self, points: &PointBatch, motion: &[[f32; 4]; 3], batch: &mut Batch) {
        let (mut px, mut py) = ([0.0_f32; BATCH], [0.0_f32; BATCH]);
        for i in 0..BATCH {
            let [x, y, z] = [points.x[i], points.y[i], points.z[i]];
            let [x, y, z] = motion.map(|[a, b, c, t]| a * x + b * y + c * z + t);
            let near = 1.0 / z;
            let (u, v) = (x * near, y * near);
            [px[i], py[i]] = self.lens.pixel(u, v);
            (batch.u[i], batch.v[i], batch.near[i]) = (u, v, near);
            let is_before = z > 0.0 && u * u + v * v <= self.lens.widest;
            batch.seen[i] = if is_before { 1.0 } else { 0.0 };
        }
        let texels = &self.level.texels;
        for i in 0..BATCH {
            let texel = if i < points.n && batch.seen[i] > 0.0 {
                between(texels, px[i], py[i])
            } else {
                None
            };
            batch.seen[i] = if texel.is_some() { 1.0 } else { 0.0 };
            let texel = texel.unwrap_or_default();
            batch.own[i] = points.grey[i] * batch.seen[i];
            batch.grey[i] = texel[GREY];
            (batch.grey_u[i], batch.grey_v[i]) = (texel[GREY_X], texel[GREY_Y]);
            let is_held = self.with_depth && texel[HELD] > ALL_HELD;
            batch.held[i] = if is_held { 1.0 } else { 0.0 };
            (batch.near_u[i], batch.near_v[i]) = (texel[NEAR_X], texel[NEAR_Y]);
            batch.off[i] = texel[NEAR];
        }
        for i in 0..BATCH {
            // From changes by pixels to changes by directions. What is not seen may be no number.
            let is_seen = batch.seen[i] > 0.0;
            let pick = |value: f32| if is_seen { value } else { 0.0 };
            let (u, v) = (pick(batch.u[i]), pick(batch.v[i]));
            let near = pick(batch.near[i]);
            let [[a, b], [c, d]] = self.lens.slopes(u, v);
            let (gx, gy) = (batch.grey_u[i], batch.grey_v[i]);
            (batch.grey_u[i], batch.grey_v[i]) = (gx * a + gy * c, gx * b + gy * d);
            let held = batch.held[i];
            let (wx, wy) = (held * batch.near_u[i], held * batch.near_v[i]);
            (batch.near_u[i], batch.near_v[i]) = (wx * a + wy * c, wx * b + wy * d);
            batch.off[i] = held * (batch.off[i] - near);
            (batch.u[i], batch.v[i], batch.near[i]) = (u, v, near);
        }
    }
}

/// What a picture shows between its pixels, bilinear; `None` outside and at the rim, where changes are
/// not known.
#[inline(always)]
fn between(texels: &Image<Texel>, x: f32, y: f32) -> Option<Texel> {
    let (width, height) = (texels.width(), texels.height());
    // A comparison that NaN fails.
    let is_inside = 1.0 <= x && x < (width - 2) as f32 && 1.0 <= y && y < (height - 2) as f32;
    if !is_inside {
        return None;
    }
    let (left, top) = (x as usize, y as usize);
    let (dx, dy) = (x - left as f32, y - top as f32);
    let above = &texels.row(top)[left..left + 2];
    let below = &texels.row(top + 1)[left..left + 2];
    let shares = [(1.0 - dx) * (1.0 - dy), dx * (1.0 - dy), (1.0 - dx) * dy, dx * dy];
    let mut sum = [0.0; 8];
    for k in 0..8 {
        sum[k] = shares[0] * above[0][k]
            + shares[1] * above[1][k]
            + shares[2] * below[0][k]
            + shares[3] * below[1][k];
    }
    Some(sum)
}

impl Lens {
    pub(super) fn new(camera: &Camera) -> Self {
        let Distortion { k1, k2, p1, p2, k3 } = camera.distortion;
        let (right, below) = (camera.width as f64 - 1.0, camera.height as f64 - 1.0);
        let corners = [[0.0, 0.0], [right, 0.0], [0.0, below], [right, below]];
        let widest = corners
            .map(|corner| camera.ray(corner))
            .iter()
            .fold(0.0, |most: f64, [u, v]| most.max(u * u + v * v));
        Self {
            focal: [camera.fx as f32, camera.fy as f32],
            center: [camera.cx as f32, camera.cy as f32],
            distortion: [k1, k2, p1, p2, k3].map(|k| k as f32),
            widest: widest as f32,
        }
    }

    #[inline(always)]
    pub(super) fn pixel(&self, u: f32, v: f32) -> [f32; 2] {
        let [k1, k2, p1, p2, k3] = self.distortion;
        let s = u * u + v * v;
        let radial = 1.0 + s * (k1 + s * (k2 + s * k3));
        let x = u * radial + 2.0 * p1 * u * v + p2 * (s + 2.0 * u * u);
        let y = v * radial + p1 * (s + 2.0 * v * v) + 2.0 * p2 * u * v;
        [self.focal[0] * x + self.center[0], self.focal[1] * y + self.center[1]]
    }

    /// How the pixel changes (rows) with u and v (columns).
    #[inline(always)]
    fn slopes(&self, u: f32, v: f32) -> [[f32; 2]; 2] {
        let [k1, k2, p1, p2, k3] = self.distortion;
        let s = u * u + v * v;
        let radial = 1.0 + s * (k1 + s * (k2 + s * k3));
        let by_s = k1 + s * (2.0 * k2 + s * 3.0 * k3);
        let mixed = 2.0 * (u * v * by_s + p1 * u + p2 * v);
        let [fx, fy] = self.focal;
        [
            [fx * (radial + 2.0 * (u * u * by_s + p1 * v + 3.0 * p2 * u)), fx * mixed],
            [fy * mixed, fy * (radial + 2.0 * (v * v * by_s + 3.0 * p1 * v + p2 * u))],
        ]
    }
}
