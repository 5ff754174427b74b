//! A wheel at work on a turned part.
//!
//! At a station `dx` beside the wheel's centre its section is a disc of radius
//! `A = R + sqrt(r^2 - dx^2)`. Whatever way it attacks, a ray from the spindle axis meets the disc at
//! `p -+ sqrt(p^2 - k)`, with `p` the way along the ray to the place nearest the disc's centre,
//! `k = D^2 - A^2` and `D` the distance of that centre from the axis.

use super::layout::At;
use super::row::{Bite, Columns, Cut, NOISE, Row};
use crate::tool::Wheel;

/// Rays taken side by side.
const LANES: usize = 8;

/// A wheel at one place.
#[derive(Debug, Clone, Copy)]
pub(super) struct WheelBite {
    wheel: Wheel,
    x: f64,
    y: f64,
    z: f64,
    /// Of the wheel's centre from the axis, and its angle about it.
    distance: f64,
    angle: f64,
    i_sweep: u32,
    engagement: u32,
}

impl WheelBite {
    pub(super) fn new(wheel: Wheel, at: &At, i_sweep: u32, engagement: u32) -> Self {
        let (x, y, z) = (at.point.x, at.point.y, at.point.z);
        let (distance, angle) = (y.hypot(z), z.atan2(y));
        Self { wheel, x, y, z, distance, angle, i_sweep, engagement }
    }

    /// The angle from the wheel's centre up to which the disc of radius `section` lies closer to
    /// the axis than `peak`, or a little more [rad].
    #[inline(always)]
    fn half_window(&self, k: f64, peak: f64) -> f64 {
        // The rays that touch the disc end at sqrt(k).
        let peak2 = (peak * peak).min(k);
        let cos = if peak2 < k {
            (k + peak2) / (2.0 * self.distance * peak)
        } else {
            k.sqrt() / self.distance
        };
        let sin_half = ((1.0 - cos) / 2.0).clamp(0.0, 1.0).sqrt();
        // asin(s) / s is convex: below its chord from s = 0 to 1.
        2.0 * sin_half * (1.0 + (std::f64::consts::FRAC_PI_2 - 1.0) * sin_half * sin_half)
    }
}

impl Bite for WheelBite {
    #[inline(always)]
    fn reach(&self) -> [f64; 2] {
        [self.x - self.wheel.minor, self.x + self.wheel.minor]
    }

    #[inline(always)]
    fn i_sweep(&self) -> u32 {
        self.i_sweep
    }

    #[inline(always)]
    fn bite(&self, row: &mut Row, cut: &mut Cut) {
        let dx = row.x - self.x;
        let nose = self.wheel.minor * self.wheel.minor - dx * dx;
        if nose < 0.0 {
            return;
        }
        let section = self.wheel.major + nose.sqrt();
        let nearest = self.distance - section;
        if row.highest <= nearest {
            return;
        }
        if nearest <= 0.0 {
            row.clear(self.engagement, cut);
            return;
        }
        let k = nearest * (self.distance + section);
        // First where any material could be met, then where what really stands there is.
        let wide = Columns::around(row.layout, self.angle, self.half_window(k, row.highest));
        let peak = row.peak(&wide);
        if peak <= nearest {
            return;
        }
        let columns = Columns::around(row.layout, self.angle, self.half_window(k, peak));
        row.engage(self.engagement);
        let mut sums = Sums::default();
        let [cos, sin] = &row.layout.turns;
        for range in &columns.0 {
            let rays = Rays {
                ends: &mut row.ends[range.clone()],
                before: &row.before[range.clone()],
                cos: &cos[range.clone()],
                sin: &sin[range.clone()],
            };
            sums.shave(rays, [self.y, self.z, k]);
        }
        let removed = sums.removed.iter().sum::<f64>();
        if removed > 0.0 {
            cut.removed += removed / 2.0 * row.weight * row.layout.across[1];
            cut.depth = cut.depth.max(sums.depth.iter().copied().fold(0.0, f64::max));
            row.renew_peaks(&columns);
        }
        cut.n_overhangs += sums.overhangs.iter().sum::<f64>() as u32;
    }
}

/// Rays beside each other, none of them twice.
struct Rays<'a> {
    ends: &'a mut [f64],
    before: &'a [f64],
    cos: &'a [f64],
    sin: &'a [f64],
}

/// What the lanes took, each for itself: always as many, so that the order of summing is the same
/// for every width of vector instructions.
#[derive(Default)]
struct Sums {
    /// Of squares of radii.
    removed: [f64; LANES],
    depth: [f64; LANES],
    overhangs: [f64; LANES],
}

impl Sums {
    /// Shaves off what a disc takes, given by its centre and `k`.
    #[inline(always)]
    fn shave(&mut self, rays: Rays, disc: [f64; 3]) {
        let Rays { ends, before, cos, sin } = rays;
        let (ends, ends_rest) = ends.as_chunks_mut::<LANES>();
        let (before, before_rest) = before.as_chunks::<LANES>();
        let (cos, cos_rest) = cos.as_chunks::<LANES>();
        let (sin, sin_rest) = sin.as_chunks::<LANES>();
        for (((ends, before), cos), sin) in ends.iter_mut().zip(before).zip(cos).zip(sin) {
            for lane in 0..LANES {
                self.shave_one(lane, &mut ends[lane], [before[lane], cos[lane], sin[lane]], disc);
            }
        }
        for (lane, end) in ends_rest.iter_mut().enumerate() {
            self.shave_one(lane, end, [before_rest[lane], cos_rest[lane], sin_rest[lane]], disc);
        }
    }

    #[inline(always)]
    fn shave_one(
        &mut self,
        lane: usize,
        end: &mut f64,
        [before, cos, sin]: [f64; 3],
        [y, z, k]: [f64; 3],
    ) {
        let old = *end;
        let p = y * cos + z * sin;
        let q = p * p - k;
        let root = q.max(0.0).sqrt();
        let (entry, exit) = (p - root, p + root);
        let meets = q >= 0.0 && p > 0.0 && entry < old;
        let new = if meets && old <= exit { entry } else { old };
        *end = new;
        self.removed[lane] += old * old - new * new;
        let depth = if old - new > NOISE { before - new } else { 0.0 };
        self.depth[lane] = self.depth[lane].max(depth);
        self.overhangs[lane] += if meets && old > exit { 1.0 } else { 0.0 };
    }
}
