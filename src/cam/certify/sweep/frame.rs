//! Places, speeds and their changes of sixteen things side by side.

use crate::cam::certify::motion::Affine;
use crate::geom::Lanes;
use fearless_simd::{f32x16, prelude::*};

/// Rounding of a product of factors that are themselves bounds.
pub(super) const SLACK: f32 = 1.0 + 1e-4;

/// x, y and z of sixteen points or directions.
pub(super) type Vectors<S> = [f32x16<S>; 3];

/// Where something is in the middle of the move, how fast it moves there, and how that changes.
pub(super) type Run<T> = [[T; 3]; 3];

/// An affine function, sixteen times.
pub(super) struct Map<S: Simd> {
    rows: [Vectors<S>; 3],
    shift: Vectors<S>,
    /// Lengths of the rows: how much each coordinate varies over a ball of radius 1.
    lengths: Vectors<S>,
}

impl<S: Simd> Map<S> {
    #[inline(always)]
    pub(super) fn new(simd: S, map: &Affine) -> Self {
        let zero = f32x16::splat(simd, 0.0);
        let mut lanes = Self { rows: [[zero; 3]; 3], shift: [zero; 3], lengths: [zero; 3] };
        for i in 0..3 {
            for j in 0..3 {
                lanes.rows[i][j] = f32x16::splat(simd, map.linear[(i, j)] as f32);
            }
            lanes.shift[i] = f32x16::splat(simd, map.shift[i] as f32);
            lanes.lengths[i] = f32x16::splat(simd, map.linear.row(i).norm() as f32 * SLACK);
        }
        lanes
    }

    /// Of points.
    #[inline(always)]
    pub(super) fn of(&self, points: Vectors<S>) -> Vectors<S> {
        let [x, y, z] = self.turned(points);
        [x + self.shift[0], y + self.shift[1], z + self.shift[2]]
    }

    /// Of directions.
    #[inline(always)]
    pub(super) fn turned(&self, [x, y, z]: Vectors<S>) -> Vectors<S> {
        let [p, q, r] = &self.rows;
        [
            p[0].mul_add(x, p[1].mul_add(y, p[2] * z)),
            q[0].mul_add(x, q[1].mul_add(y, q[2] * z)),
            r[0].mul_add(x, r[1].mul_add(y, r[2] * z)),
        ]
    }

    /// How much each coordinate varies over balls of `radius`, and by `more`.
    #[inline(always)]
    pub(super) fn spread(&self, radius: f32x16<S>, more: f32x16<S>) -> Vectors<S> {
        let [x, y, z] = self.lengths;
        [x.mul_add(radius, more), y.mul_add(radius, more), z.mul_add(radius, more)]
    }
}

#[inline(always)]
pub(super) fn load<S: Simd>(simd: S, [x, y, z]: &[Lanes; 3]) -> Vectors<S> {
    [f32x16::from_slice(simd, x), f32x16::from_slice(simd, y), f32x16::from_slice(simd, z)]
}

/// How much a direction climbs together with the plane over it.
#[inline(always)]
pub(super) fn climb<S: Simd>(slope: [f32x16<S>; 2], way: Vectors<S>) -> f32x16<S> {
    slope[0].mul_add(way[0], slope[1].mul_add(way[2], way[1]))
}
