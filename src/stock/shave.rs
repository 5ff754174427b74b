//! A tool at one place over a turned part: what it takes off the rows of a stripe.
//!
//! Few of the rays beneath a tool are cut by it: most were cut lower by the place before, or a turn
//! ago. So rays are looked at by tiles, eight tiles side by side: first whether anything in all the
//! rows of a stripe reaches up to the tool, then for each row, and there whether the tool has left
//! its last place at all.

use super::layout::{At, GROUP, Layout, TILE};
use super::row::{Columns, Cut, NOISE};
use super::stripe::{Bite, STRIPE, Stripe, Turn};
use fearless_simd::{f64x8, prelude::*};
use std::f64::consts::FRAC_PI_2;
use std::ops::Range;

/// Rays side by side: always as many, so that sums have the same order, and the same bits, for
/// every width of vector instructions.
const LANES: usize = 8;
/// What rounding may do to a bound [mm or mm2].
pub(super) const MARGIN: f64 = 1e-9;
/// A tile is less than half a turn where a turn has so many.
const FEW: usize = 3;

/// A convex tool, cut into sections by the rows.
pub(super) trait Blade: Sync {
    /// What a row meets of it.
    type Section: Section;
    /// How far it reaches to either side of its axis [mm].
    fn half_width(&self) -> f64;
    /// The stretch of X it reaches when it stands `at`.
    #[inline(always)]
    fn stretch(&self, at: &At) -> [f64; 2] {
        [at.point.x - self.half_width(), at.point.x + self.half_width()]
    }
    /// X of its middle: from there on to either side rows meet less and less of it.
    #[inline(always)]
    fn middle(&self, at: &At) -> f64 {
        at.point.x
    }
    /// What a row `dx` beside it meets, within reach, when it stands `at`.
    fn section(&self, at: &At, dx: f64) -> Self::Section;
}

/// A tool at one place.
#[derive(Debug, Clone, Copy)]
pub(super) struct Placed<B> {
    pub(super) blade: B,
    pub(super) at: At,
    /// The move it is part of.
    pub(super) i_sweep: u32,
    /// The engagement that move belongs to.
    pub(super) engagement: u32,
}

/// A convex region in the plane of a row.
pub(super) trait Section: Copy {
    /// Its place nearest to the axis, or that of the region `bound` is about: y and z. None if the
    /// axis lies in the section itself.
    fn nearest(&self) -> Option<[f64; 2]>;
    /// No ray enters it before this; infinite where they pass it by. The bound is itself where rays
    /// enter some convex region, with the same place nearest to the axis.
    #[inline(always)]
    fn bound<S: Simd>(&self, simd: S, rays: &Rays<S>) -> f64x8<S> {
        let [entry, _] = self.meet(simd, rays, f64x8::splat(simd, f64::INFINITY));
        entry
    }
    /// Where rays that end at `ends` enter and leave it; infinite where they pass it by, or end
    /// before it. They enter a section that holds the axis where they begin.
    fn meet<S: Simd>(&self, simd: S, rays: &Rays<S>, ends: f64x8<S>) -> [f64x8<S>; 2];
    /// The tiles on which it lies within `last`, as bits, or some of them, if its `bound` is where
    /// rays enter it.
    fn is_within<S: Simd>(&self, last: &Self, borders: &Borders<S>, bounds: &[f64x8<S>; 2]) -> u64;
}

/// Eight rays from the axis, as cosines and sines of their angles.
pub(super) struct Rays<S: Simd> {
    pub(super) cos: f64x8<S>,
    pub(super) sin: f64x8<S>,
}

/// The borders of eight tiles: the ray each begins with, and the one after its last.
pub(super) struct Borders<S: Simd> {
    pub(super) rays: [Rays<S>; 2],
    /// Tiles are so wide that their borders say nothing.
    are_far: bool,
}

/// A tool passing by the rows of a stripe.
struct Pass<'a, B: Blade> {
    tool: &'a Placed<B>,
    last: Option<&'a Placed<B>>,
    rows: Range<usize>,
    /// The greatest section over any of the rows, and how near it comes to the axis.
    widest: B::Section,
    nearest: f64,
    /// The sections row by row.
    sections: [B::Section; STRIPE],
    /// The last place cut all that was in its way.
    was_cut_clear: [bool; STRIPE],
}

/// What was taken, each lane for itself.
struct Sums<S: Simd> {
    simd: S,
    /// Of squares of radii, times the weight of their rows.
    removed: f64x8<S>,
    depth: f64x8<S>,
    n_overhangs: u32,
}

/// Where rays enter and leave two regions that are convex together, by where they do each.
#[inline(always)]
pub(super) fn joined<S: Simd>(simd: S, [a, b]: [[f64x8<S>; 2]; 2]) -> [f64x8<S>; 2] {
    let zero = f64x8::splat(simd, 0.0);
    let exit_of = |met: [f64x8<S>; 2]| met[0].simd_lt(f64::INFINITY).select(met[1], zero);
    [a[0].min(b[0]), exit_of(a).max(exit_of(b))]
}

impl<B: Blade> Placed<B> {
    /// What the row at `x` meets of it.
    #[inline(always)]
    fn section(&self, x: f64) -> B::Section {
        self.blade.section(&self.at, x - self.at.point.x)
    }
}

impl<B: Blade> Bite for Placed<B> {
    #[inline(always)]
    fn reach(&self) -> [f64; 2] {
        self.blade.stretch(&self.at)
    }

    #[inline(always)]
    fn i_sweep(&self) -> u32 {
        self.i_sweep
    }

    #[inline(always)]
    fn bite<S: Simd>(&self, simd: S, turn: Turn<Self>, stripe: &mut Stripe, cut: &mut Cut) {
        let layout = stripe.layout;
        let pass = Pass::of(self, &turn, stripe);
        stripe.cut_clear[turn.rows.clone()].fill(turn.number);
        if stripe.highest <= pass.nearest {
            return;
        }
        let stood = pass.rows_across(stripe);
        let columns = window(layout, &pass.widest, stripe.highest);
        let zero = f64x8::splat(simd, 0.0);
        let mut sums = Sums { simd, removed: zero, depth: zero, n_overhangs: 0 };
        for range in columns.0.iter().filter(|range| !range.is_empty()) {
            for group in range.start / (TILE * GROUP)..range.end.div_ceil(TILE * GROUP) {
                pass.cut_group(group, stripe, &mut sums);
            }
        }
        cut.removed += sums.removed.as_slice().iter().sum::<f64>() / 2.0 * layout.across[1];
        cut.depth = cut.depth.max(sums.depth.reduce_max());
        cut.n_overhangs += sums.n_overhangs;
        cut.is_through |= (0..STRIPE).any(|i| stood[i] && !stripe.row(i).stands());
    }
}

/// The columns on which a convex region may lie closer to the axis than `highest`: beyond the line
/// through its nearest place, square to the way there.
#[inline(always)]
fn window<C: Section>(layout: &Layout, section: &C, highest: f64) -> Columns {
    let Some([y, z]) = section.nearest() else {
        return Columns([0..layout.n_columns, 0..0]);
    };
    let distance = (y * y + z * z).sqrt();
    if distance == 0.0 {
        return Columns([0..layout.n_columns, 0..0]);
    }
    let cos = (distance / highest).min(1.0);
    let sin_half = ((1.0 - cos) / 2.0).sqrt();
    // asin(s) / s is convex: below its chord from s = 0 to 1.
    let half = 2.0 * sin_half * (1.0 + (FRAC_PI_2 - 1.0) * sin_half * sin_half);
    Columns::around(layout, z.atan2(y), half)
}

impl<'a, B: Blade> Pass<'a, B> {
    #[inline(always)]
    fn of(tool: &'a Placed<B>, turn: &Turn<'a, Placed<B>>, stripe: &Stripe) -> Self {
        let rows = turn.rows.clone();
        let x = |i: usize| stripe.layout.row_x(stripe.first + i);
        let middle = tool.blade.middle(&tool.at);
        let widest = tool.section(middle.clamp(x(rows.start), x(rows.end - 1)));
        let mut pass = Self {
            tool,
            last: turn.last,
            widest,
            nearest: widest.nearest().map_or(0.0, |[y, z]| (y * y + z * z).sqrt() - MARGIN),
            sections: [widest; STRIPE],
            was_cut_clear: [false; STRIPE],
            rows: rows.clone(),
        };
        for i in rows {
            pass.sections[i] = tool.section(x(i));
            pass.was_cut_clear[i] = stripe.cut_clear[i] + 1 == turn.number;
        }
        pass
    }

    /// The rows with any material left that the tool comes at across the axis.
    #[inline(always)]
    fn rows_across(&self, stripe: &mut Stripe) -> [bool; STRIPE] {
        let mut stand = [false; STRIPE];
        if self.nearest <= 0.0 {
            for i in self.rows.clone().filter(|&i| self.sections[i].nearest().is_none()) {
                stand[i] = stripe.row(i).stands();
            }
        }
        stand
    }

    /// Cuts a group of tiles in all the rows.
    #[inline(always)]
    fn cut_group<S: Simd>(&self, group: usize, stripe: &mut Stripe, sums: &mut Sums<S>) {
        let simd = sums.simd;
        let layout = stripe.layout;
        let borders = Borders::of(simd, layout, group);
        let crest = f64x8::from_slice(simd, &stripe.crest[group * GROUP..][..GROUP]);
        let bounds = borders.bounds(simd, &self.widest);
        let may_be_cut = crest.simd_gt(borders.lowest(simd, &self.widest, &bounds)).to_bitmask();
        if may_be_cut == 0 {
            return;
        }
        let mut is_cut = false;
        for i in self.rows.clone() {
            let section = &self.sections[i];
            let peaks = &stripe.peaks[i * layout.tile_stride() + group * GROUP..][..GROUP];
            let peaks = f64x8::from_slice(simd, peaks);
            let bounds = borders.bounds(simd, section);
            let lowest = borders.lowest(simd, section, &bounds);
            let mut tiles = may_be_cut & peaks.simd_gt(lowest).to_bitmask();
            if let Some(last) = self.last
                && tiles != 0
                && self.was_cut_clear[i]
                && !borders.are_far
            {
                let last = last.section(layout.row_x(stripe.first + i));
                tiles &= !section.is_within(&last, &borders, &bounds);
            }
            if tiles == 0 {
                continue;
            }
            is_cut = true;
            stripe.row(i).engage(self.tool.engagement);
            let n_overhangs = sums.n_overhangs;
            while tiles != 0 {
                let tile = group * GROUP + tiles.trailing_zeros() as usize;
                tiles &= tiles - 1;
                shave(section, stripe, [i, tile], sums);
            }
            if sums.n_overhangs > n_overhangs {
                stripe.cut_clear[i] = 0;
            }
        }
        if is_cut {
            stripe.renew_crest(simd, group);
        }
    }
}

/// Shaves off what `section` takes from a tile of row `i`.
#[inline(always)]
fn shave<S: Simd, C: Section>(
    section: &C,
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
        let rays = Rays { cos: load(cos), sin: load(sin) };
        let [entry, exit] = section.meet(simd, &rays, old);
        let is_met = entry.simd_lt(old);
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

impl<S: Simd> Borders<S> {
    #[inline(always)]
    fn of(simd: S, layout: &Layout, group: usize) -> Self {
        let [cos, sin] = &layout.edges;
        let load = |from: &[f64], first: usize| f64x8::from_slice(simd, &from[first..][..GROUP]);
        let rays = |first: usize| Rays { cos: load(cos, first), sin: load(sin, first) };
        let first = group * GROUP;
        Self { rays: [rays(first), rays(first + 1)], are_far: layout.n_tiles() < FEW }
    }

    #[inline(always)]
    fn bounds<C: Section>(&self, simd: S, section: &C) -> [f64x8<S>; 2] {
        let [first, second] = &self.rays;
        [section.bound(simd, first), section.bound(simd, second)]
    }

    /// No ray of a tile enters `section` before this. Seen from the axis a convex region only
    /// recedes to either side of its nearest place: the directions in which it is closer than
    /// something have no gap, as those to a convex region have none.
    #[inline(always)]
    fn lowest<C: Section>(&self, simd: S, section: &C, bounds: &[f64x8<S>; 2]) -> f64x8<S> {
        let Some([y, z]) = section.nearest() else { return f64x8::splat(simd, 0.0) };
        let nearest = f64x8::splat(simd, (y * y + z * z).sqrt());
        let [first, second] = &self.rays;
        let aside = [first.cos * z - first.sin * y, second.cos * z - second.sin * y];
        // Another half turn on this is true as well, and does no harm.
        let is_over_nearest = (aside[0] * aside[1]).simd_le(0.0);
        let lowest = is_over_nearest.select(nearest, bounds[0].min(bounds[1]));
        (if self.are_far { nearest } else { lowest }) - MARGIN
    }
}
