//! A wheel at work on a turned part.
//!
//! At a station `dx` beside the wheel's centre its section is a disc of radius
//! `A = R + sqrt(r^2 - dx^2)`. Whatever way it attacks, a ray from the spindle axis meets the disc at
//! `p -+ sqrt(p^2 - k)`, with `p` the way along the ray to the place nearest the disc's centre,
//! `k = D^2 - A^2` and `D` the distance of that centre from the axis.
//!
//! Few of the rays beneath a wheel are cut by it: most were cut lower by the place before, or a turn
//! ago. So rays are looked at by tiles, eight tiles side by side: first whether anything in all the
//! rows of a stripe reaches up to the disc, then for each row, and there whether the disc has left
//! the one before at all.

use super::layout::{At, GROUP, Layout, TILE};
use super::row::{Columns, Cut, NOISE};
use super::stripe::{Bite, STRIPE, Stripe, Turn};
use crate::tool::Wheel;
use fearless_simd::{f64x8, prelude::*};
use std::ops::Range;

/// Rays side by side: always as many, so that sums have the same order, and the same bits, for
/// every width of vector instructions.
const LANES: usize = 8;
/// What rounding may do to a bound [mm or mm2].
const MARGIN: f64 = 1e-9;
/// A tile is less than half a turn where a turn has so many.
const FEW: usize = 3;

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

/// The section of a wheel at one station.
#[derive(Debug, Clone, Copy, Default)]
struct Disc {
    radius: f64,
    /// Its least distance from the axis; negative if it lies across.
    nearest: f64,
    /// The square of where the rays that touch it end.
    k: f64,
}

/// A wheel passing by the rows of a stripe.
struct Pass<'a> {
    number: usize,
    last: Option<&'a WheelBite>,
    rows: Range<usize>,
    /// The greatest section over any of the rows.
    widest: Disc,
    /// Row by row where it is, and the section there.
    x: [f64; STRIPE],
    discs: [Disc; STRIPE],
    /// The last place cut all that was in its way.
    was_cut_clear: [bool; STRIPE],
}

/// Eight tiles: the ray each begins with, and the one after its last.
struct Borders<S: Simd> {
    cos: [f64x8<S>; 2],
    sin: [f64x8<S>; 2],
    /// A tile is so wide that its borders say nothing.
    are_far: bool,
}

/// What was taken, each lane for itself.
struct Sums<S: Simd> {
    simd: S,
    /// Of squares of radii, times the weight of their rows.
    removed: f64x8<S>,
    depth: f64x8<S>,
    n_overhangs: u32,
}

impl WheelBite {
    pub(super) fn new(wheel: Wheel, at: &At, i_sweep: u32, engagement: u32) -> Self {
        let (x, y, z) = (at.point.x, at.point.y, at.point.z);
        let (distance, angle) = (y.hypot(z), z.atan2(y));
        Self { wheel, x, y, z, distance, angle, i_sweep, engagement }
    }

    /// The section `dx` beside the centre, within reach.
    #[inline(always)]
    fn disc(&self, dx: f64) -> Disc {
        let nose = (self.wheel.minor * self.wheel.minor - dx * dx).max(0.0).sqrt();
        let radius = self.wheel.major + nose;
        let nearest = self.distance - radius;
        Disc { radius, nearest, k: nearest * (self.distance + radius) }
    }

    /// The angle from the wheel's centre up to which `disc` lies closer to the axis than `peak`, or
    /// a little more [rad].
    #[inline(always)]
    fn half_window(&self, disc: &Disc, peak: f64) -> f64 {
        if disc.nearest <= 0.0 {
            return std::f64::consts::PI;
        }
        // The rays that touch the disc end at sqrt(k).
        let peak2 = (peak * peak).min(disc.k);
        let cos = if peak2 < disc.k {
            (disc.k + peak2) / (2.0 * self.distance * peak)
        } else {
            disc.k.sqrt() / self.distance
        };
        let sin_half = ((1.0 - cos) / 2.0).clamp(0.0, 1.0).sqrt();
        // asin(s) / s is convex: below its chord from s = 0 to 1.
        2.0 * sin_half * (1.0 + (std::f64::consts::FRAC_PI_2 - 1.0) * sin_half * sin_half)
    }

    /// Where the rays on the borders of tiles enter `disc`; infinite where they pass it by.
    #[inline(always)]
    fn entries<S: Simd>(&self, simd: S, borders: &Borders<S>, disc: &Disc) -> [f64x8<S>; 2] {
        let outside = f64x8::splat(simd, f64::INFINITY);
        let entry = |side: usize| {
            let p = borders.cos[side] * self.y + borders.sin[side] * self.z;
            let q = p * p - disc.k;
            let is_met = q.simd_ge(0.0) & p.simd_gt(0.0);
            is_met.select(p - q.max(0.0).sqrt(), outside)
        };
        [entry(0), entry(1)]
    }

    /// No ray of a tile enters `disc` before this.
    #[inline(always)]
    fn lowest<S: Simd>(&self, simd: S, borders: &Borders<S>, disc: &Disc) -> f64x8<S> {
        let nearest = f64x8::splat(simd, disc.nearest);
        if borders.are_far {
            return nearest - MARGIN;
        }
        let entries = self.entries(simd, borders, disc);
        // Away from the ray through the centre a disc only recedes.
        let aside = |side: usize| borders.cos[side] * self.z - borders.sin[side] * self.y;
        let is_around_centre = (aside(0) * aside(1)).simd_le(0.0);
        is_around_centre.select(nearest, entries[0].min(entries[1])) - MARGIN
    }

    /// The tiles on which the disc of row `i` lies within that of the wheel's last place, so that
    /// what it could cut is gone.
    ///
    /// On the disc's rim the power of a point with respect to the other disc is linear in the point.
    /// Over an arc of at most half a turn it exceeds the greater of its ends by no more than the
    /// arc's height times its slope, and an arc is no higher than its chord squared over `4 A`.
    #[inline(always)]
    fn is_behind<S: Simd>(&self, simd: S, borders: &Borders<S>, pass: &Pass, i: usize) -> u64 {
        let Some(last) = pass.last.filter(|_| !borders.are_far) else { return 0 };
        let disc = &pass.discs[i];
        let last_disc = last.disc(pass.x[i] - last.x);
        let entries = self.entries(simd, borders, disc);
        let slope = [2.0 * (self.y - last.y), 2.0 * (self.z - last.z)];
        let (y, z) = (
            [borders.cos[0] * entries[0], borders.cos[1] * entries[1]],
            [borders.sin[0] * entries[0], borders.sin[1] * entries[1]],
        );
        let power = |side: usize| y[side] * slope[0] + z[side] * slope[1];
        let (dy, dz) = (y[0] - y[1], z[0] - z[1]);
        let bulge = (dy * dy + dz * dz) * (slope[0].hypot(slope[1]) / (4.0 * disc.radius));
        // A border that passes the disc by makes this infinite or no number: not behind.
        let greatest = power(0).max(power(1)) + bulge;
        greatest.simd_le(disc.k - last_disc.k - MARGIN).to_bitmask()
    }

    /// Cuts a group of tiles in all rows of `pass`.
    #[inline(always)]
    fn cut_group<S: Simd>(
        &self,
        group: usize,
        pass: &Pass,
        stripe: &mut Stripe,
        sums: &mut Sums<S>,
    ) {
        let simd = sums.simd;
        let layout = stripe.layout;
        let borders = Borders::of(simd, layout, group);
        let crest = f64x8::from_slice(simd, &stripe.crest[group * GROUP..][..GROUP]);
        let lowest = self.lowest(simd, &borders, &pass.widest);
        let may_be = crest.simd_gt(lowest).to_bitmask();
        if may_be == 0 {
            return;
        }
        let mut is_cut = false;
        for i in pass.rows.clone().filter(|&i| pass.discs[i].nearest > 0.0) {
            let peaks = &stripe.peaks[i * layout.tile_stride() + group * GROUP..][..GROUP];
            let peaks = f64x8::from_slice(simd, peaks);
            let lowest = self.lowest(simd, &borders, &pass.discs[i]);
            let mut tiles = may_be & peaks.simd_gt(lowest).to_bitmask();
            if tiles != 0 && pass.was_cut_clear[i] {
                tiles &= !self.is_behind(simd, &borders, pass, i);
            }
            if tiles == 0 {
                continue;
            }
            is_cut = true;
            stripe.row(i).engage(self.engagement);
            let n_overhangs = sums.n_overhangs;
            while tiles != 0 {
                let tile = group * GROUP + tiles.trailing_zeros() as usize;
                tiles &= tiles - 1;
                self.shave(&pass.discs[i], stripe, [i, tile], sums);
            }
            if sums.n_overhangs > n_overhangs {
                stripe.cut_clear[i] = 0;
            }
        }
        if is_cut {
            stripe.renew_crest(simd, group);
        }
    }

    /// Shaves off what `disc` takes from a tile of row `i`.
    #[inline(always)]
    fn shave<S: Simd>(
        &self,
        disc: &Disc,
        stripe: &mut Stripe,
        [i, tile]: [usize; 2],
        sums: &mut Sums<S>,
    ) {
        let simd = sums.simd;
        let layout = stripe.layout;
        let weight = layout.row_weight(stripe.first + i);
        let start = i * layout.n_columns + tile * TILE;
        let (ends, before) = (&mut stripe.ends[start..][..TILE], &stripe.before[start..][..TILE]);
        let [cos, sin] = &layout.turns;
        let (cos, sin) = (&cos[tile * TILE..][..TILE], &sin[tile * TILE..][..TILE]);
        let mut peak = f64x8::splat(simd, f64::NEG_INFINITY);
        for lane in (0..TILE).step_by(LANES) {
            let load = |from: &[f64]| f64x8::from_slice(simd, &from[lane..][..LANES]);
            let old = load(ends);
            let p = load(cos) * self.y + load(sin) * self.z;
            let q = p * p - disc.k;
            let root = q.max(0.0).sqrt();
            let (entry, exit) = (p - root, p + root);
            let is_met = q.simd_ge(0.0) & p.simd_gt(0.0) & entry.simd_lt(old);
            let is_beneath = old.simd_gt(exit);
            let new = (is_met & !is_beneath).select(entry, old);
            new.store_slice(&mut ends[lane..][..LANES]);
            peak = peak.max(new);
            sums.removed += (old * old - new * new) * weight;
            let is_cut = (old - new).simd_gt(NOISE);
            sums.depth = is_cut.select(sums.depth.max(load(before) - new), sums.depth);
            sums.n_overhangs += (is_met & is_beneath).to_bitmask().count_ones();
        }
        stripe.peaks[i * layout.tile_stride() + tile] = peak.reduce_max();
    }
}

impl<'a> Pass<'a> {
    #[inline(always)]
    fn of(bite: &WheelBite, turn: Turn<'a, WheelBite>, stripe: &Stripe) -> Self {
        let Turn { number, last, rows } = turn;
        let layout = stripe.layout;
        let mut pass = Self {
            number,
            last,
            widest: Disc::default(),
            x: [0.0; STRIPE],
            discs: [Disc::default(); STRIPE],
            was_cut_clear: [false; STRIPE],
            rows: rows.clone(),
        };
        for i in rows.clone() {
            pass.x[i] = layout.row_x(stripe.first + i);
            pass.discs[i] = bite.disc(pass.x[i] - bite.x);
            pass.was_cut_clear[i] = last.is_some() && stripe.cut_clear[i] + 1 == number;
        }
        let nearest = bite.x.clamp(pass.x[rows.start], pass.x[rows.end - 1]);
        pass.widest = bite.disc(nearest - bite.x);
        pass
    }
}

impl<S: Simd> Borders<S> {
    #[inline(always)]
    fn of(simd: S, layout: &Layout, group: usize) -> Self {
        let [cos, sin] = &layout.edges;
        let first = group * GROUP;
        let load = |from: &[f64]| f64x8::from_slice(simd, &from[..GROUP]);
        Self {
            cos: [load(&cos[first..]), load(&cos[first + 1..])],
            sin: [load(&sin[first..]), load(&sin[first + 1..])],
            are_far: layout.n_tiles() < FEW,
        }
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
    fn bite<S: Simd>(&self, simd: S, turn: Turn<Self>, stripe: &mut Stripe, cut: &mut Cut) {
        let layout = stripe.layout;
        let pass = Pass::of(self, turn, stripe);
        stripe.cut_clear[pass.rows.clone()].fill(pass.number);
        if stripe.highest <= pass.widest.nearest {
            return;
        }
        if pass.widest.nearest <= 0.0 {
            for i in pass.rows.clone().filter(|&i| pass.discs[i].nearest <= 0.0) {
                stripe.row(i).clear(self.engagement, cut);
            }
        }
        let window = self.half_window(&pass.widest, stripe.highest);
        let columns = Columns::around(layout, self.angle, window);
        let zero = f64x8::splat(simd, 0.0);
        let mut sums = Sums { simd, removed: zero, depth: zero, n_overhangs: 0 };
        for range in columns.0.iter().filter(|range| !range.is_empty()) {
            for group in range.start / (TILE * GROUP)..range.end.div_ceil(TILE * GROUP) {
                self.cut_group(group, &pass, stripe, &mut sums);
            }
        }
        cut.removed += sums.removed.as_slice().iter().sum::<f64>() / 2.0 * layout.across[1];
        cut.depth = cut.depth.max(sums.depth.reduce_max());
        cut.n_overhangs += sums.n_overhangs;
    }
}
