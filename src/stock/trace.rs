//! The lowest that a ball or a flat end comes over a ray while it goes straight from one place to
//! another: both in closed form, for eight rays at once.

use crate::geom::{Point3, Vector3};
use fearless_simd::{f64x8, prelude::*};

/// The end of a tool that attacks along the rays: y from the part to the tool.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum End {
    /// A ball, and how far over the programmed point its centre is.
    Ball { radius: f64, centre: f64 },
    /// A disc, and how far over the programmed point it lies.
    Flat { radius: f64, rise: f64 },
}

/// An end on its way.
#[derive(Debug, Clone, Copy)]
pub(super) struct Trace {
    end: End,
    /// Where it begins: x and z, and its height.
    from: [f64; 2],
    height: f64,
    /// The way across the rays, its length, and how far it climbs.
    way: [f64; 2],
    length: f64,
    climb: f64,
}

impl Trace {
    /// Of `end` on a tool whose programmed point goes `way` from `from`.
    pub(super) fn new(end: End, from: &Point3, way: &Vector3) -> Self {
        let (End::Ball { centre: above, .. } | End::Flat { rise: above, .. }) = end;
        Self {
            end,
            from: [from.x, from.z],
            height: from.y + above,
            way: [way.x, way.z],
            length: way.x.hypot(way.z),
            climb: way.y,
        }
    }

    /// Over rays at `x` and `z`; infinite where it passes them by.
    #[inline(always)]
    pub(super) fn lowest<S: Simd>(&self, simd: S, x: f64, z: f64x8<S>) -> f64x8<S> {
        // The ray's place along the way and beside it; a plunge has its whole way in one place.
        let (dx, dz) = (x - self.from[0], z - self.from[1]);
        let is_plunge = self.length == 0.0;
        let per_length = if is_plunge { 0.0 } else { 1.0 / self.length };
        let [way_x, way_z] = self.way.map(|way| way * per_length);
        let along = dz * way_z + dx * way_x;
        let beside2 = dz * dz + dx * dx - along * along;
        let (End::Ball { radius, .. } | End::Flat { radius, .. }) = self.end;
        let half2 = beside2 * -1.0 + radius * radius;
        let half = half2.max(0.0).sqrt();
        // The stretch of the way on which the shadow is over the ray.
        let first = (along - half).max(0.0);
        let last = (along + half).min(self.length);
        let is_met = half2.simd_ge(0.0) & first.simd_le(last);
        let slope = self.climb * per_length;
        let start = self.height + if is_plunge { self.climb.min(0.0) } else { 0.0 };
        let lowest = match self.end {
            End::Flat { .. } => {
                let place = if slope < 0.0 { last } else { first };
                place * slope + start
            }
            End::Ball { .. } => {
                // Where the climb of the way and the curve of the ball balance.
                let best = along - half * (slope / (1.0 + slope * slope).sqrt());
                let place = best.max(first).min(last);
                let out = place - along;
                place * slope + start - (half2 - out * out).max(0.0).sqrt()
            }
        };
        is_met.select(lowest, f64x8::splat(simd, f64::INFINITY))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tool::{Cutter, HeightFunction, Profile};
    use fearless_simd::{Level, dispatch};

    #[test]
    fn a_trace_is_the_lowest_of_many_places_on_the_way() {
        let ends = [
            (Profile::Ball { radius: 6.0 }, End::Ball { radius: 6.0, centre: 6.0 }),
            (Profile::Flat { radius: 5.0 }, End::Flat { radius: 5.0, rise: 0.0 }),
        ];
        let ways =
            [[20.0, -7.0, 3.0], [0.5, 4.0, 0.0], [0.0, 3.0, -9.0], [0.0, -3.0, 0.0], [0.0; 3]];
        for (profile, end) in ends {
            let Cutter::Mill(mill) = profile.cutter(0.0) else { unreachable!("a mill") };
            for way in ways.map(Vector3::from) {
                let from = Point3::new(-3.0, 10.0, 2.0);
                for x in [-7.5, -2.0, 1.5, 7.0] {
                    let z: [f64; 8] = std::array::from_fn(|i| 2.3 * i as f64 - 7.0);
                    let lowest: [f64; 8] = dispatch!(Level::new(), simd => {
                        let z = f64x8::from_slice(simd, &z);
                        *Trace::new(end, &from, &way).lowest(simd, x, z)
                    });
                    for (z, lowest) in z.into_iter().zip(lowest) {
                        let at = |s: f64| {
                            let place = from + way * s;
                            mill.height(x - place.x, z - place.z).map(|u| place.y - u)
                        };
                        let n = 20_000;
                        let sampled = (0..=n).filter_map(|i| at(f64::from(i) / f64::from(n)));
                        let sampled = sampled.fold(f64::INFINITY, f64::min);
                        let is_same =
                            lowest == sampled || (-1e-9..0.02).contains(&(sampled - lowest));
                        assert!(is_same, "{profile} {way} {x} {z}: {lowest} {sampled}");
                    }
                }
            }
        }
    }
}
