//! Whole moves of a tool through the stock.
//!
//! On a table the lowest place a move reaches over a ray is found exactly. Round a spindle a move is
//! followed in as many places of the tool as keep what lies between them below a fiftieth of the
//! resolution; [`Stock::sweep_error`] says what came of it.

use super::dexels::Stock;
use super::layout::{At, Kind, Layout, TILE};
use super::over_table::TableBite;
use super::row::{Bite, Cut, Row};
use super::under_mill::MillBite;
use super::under_wheel::WheelBite;
use super::{Stance, StockError};
use crate::machine::{AxisValues, Machine};
use crate::progress::Progress;
use crate::tool::Cutter;
use fearless_simd::{Level, Simd, dispatch};
use rayon::prelude::*;

/// Moves taken together: memory for their places stays small whatever the program's length.
const BATCH: usize = 16_384;
/// Rows one thread takes at a time. Never depends on the number of threads.
const STRIPE: usize = 16;
/// What may stay between two places of a tool on a move, as a share of the resolution.
const SWEEP_SHARE: f64 = 0.02;
/// A tool with a sharp edge leaves steps instead: its places are this share of the resolution apart.
const SHARP_SHARE: f64 = 0.25;
/// A move that takes more places of the tool than this is refused.
const MOST_POSES: f64 = 1e6;

/// A move of all axes at once, each linear in time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sweep {
    /// Words it begins at [mm or rad].
    pub from: AxisValues,
    /// Words it ends at.
    pub to: AxisValues,
    /// A new engagement begins: depths are counted from the stock as it is before this move.
    pub engages: bool,
}

/// The places of a tool on one move.
struct Places {
    from: At,
    to: At,
    /// How many steps lie between them; 0 if the tool is clear of all the stock.
    n_steps: usize,
    error: f64,
}

impl Stock {
    /// Takes away what `cutter` sweeps over, move by move; what each took.
    ///
    /// A follower axis is not looked at: the stock is that of the leader. All threads of the current
    /// pool work; their number changes no bit.
    pub fn remove(
        &mut self,
        machine: &Machine,
        cutter: &Cutter,
        sweeps: &[Sweep],
        progress: &dyn Progress,
    ) -> Result<Vec<Cut>, StockError> {
        let mut cuts = Vec::with_capacity(sweeps.len());
        for batch in sweeps.chunks(BATCH) {
            cuts.append(&mut self.remove_batch(machine, cutter, batch)?);
            progress.advance(batch.len() as u64)?;
        }
        Ok(cuts)
    }

    /// Takes away what `cutter` covers at each of `stances`; nothing in between.
    pub fn remove_at(
        &mut self,
        cutter: &Cutter,
        stances: &[Stance],
        progress: &dyn Progress,
    ) -> Result<(), StockError> {
        self.n_engagements += 1;
        for batch in stances.chunks(BATCH) {
            let at = batch.iter().map(|stance| self.layout.locate(stance));
            let at = at.collect::<Result<Vec<At>, _>>()?;
            let engagement = self.n_engagements;
            self.cut(cutter, at.iter().map(|&at| ([at, at], 0, engagement)), &mut [Cut::default()]);
            progress.advance(batch.len() as u64)?;
        }
        Ok(())
    }

    /// How deep `cutter` would go into the stock on `sweep`, without taking anything away; infinite
    /// if it would go through. A cutter grown by an allowance asks for that much clearance [mm].
    pub fn depth_of(
        &self,
        machine: &Machine,
        cutter: &Cutter,
        sweep: &Sweep,
    ) -> Result<f64, StockError> {
        let reach = cutter.reach().x;
        let [from, to] =
            [&sweep.from, &sweep.to].map(|values| self.layout.locate(&Stance::at(machine, values)));
        let x = [from?.point.x, to?.point.x];
        let range = self.layout.rows_within([x[0].min(x[1]) - reach, x[0].max(x[1]) + reach]);
        if range.is_empty() {
            return Ok(0.0);
        }
        let sweep = Sweep { engages: true, ..*sweep };
        let cuts = self.excerpt(range).remove_batch(machine, cutter, &[sweep])?;
        Ok(cuts.iter().fold(
            0.0,
            |depth: f64, cut| {
                if cut.is_through { f64::INFINITY } else { depth.max(cut.depth) }
            },
        ))
    }

    fn remove_batch(
        &mut self,
        machine: &Machine,
        cutter: &Cutter,
        sweeps: &[Sweep],
    ) -> Result<Vec<Cut>, StockError> {
        let layout = &self.layout;
        let places = sweeps.par_iter().map(|sweep| Places::of(layout, machine, cutter, sweep));
        let places = places.collect::<Result<Vec<_>, _>>()?;
        let errors = places.iter().map(|places| places.error);
        self.sweep_error = errors.fold(self.sweep_error, f64::max);
        let mut steps = Vec::new();
        let mut last_to = None;
        for (i, (sweep, places)) in sweeps.iter().zip(&places).enumerate() {
            self.n_engagements += u32::from(sweep.engages || self.n_engagements == 0);
            let (i_sweep, engagement) = (i as u32, self.n_engagements);
            if self.layout.kind == Kind::Table {
                steps.push(([places.from, places.to], i_sweep, engagement));
                continue;
            }
            // Where the last move ended the stock is cut already.
            let first = usize::from(!sweep.engages && last_to == Some(sweep.from));
            for step in first..=places.n_steps {
                if places.n_steps > 0 {
                    let at = places.at(machine, &self.layout, sweep, step)?;
                    steps.push(([at, at], i_sweep, engagement));
                }
            }
            last_to = (places.n_steps > 0).then_some(sweep.to);
        }
        let mut cuts = vec![Cut::default(); sweeps.len()];
        self.cut(cutter, steps.into_iter(), &mut cuts);
        Ok(cuts)
    }

    /// Cuts with the tool on its way from one place to another, for each of `steps`: the places, the
    /// index among `cuts`, the engagement.
    fn cut(
        &mut self,
        cutter: &Cutter,
        steps: impl Iterator<Item = ([At; 2], u32, u32)>,
        cuts: &mut [Cut],
    ) {
        match (self.layout.kind, *cutter) {
            (Kind::Turned, Cutter::Wheel(wheel)) => {
                let bites = steps.map(|(at, i, e)| WheelBite::new(wheel, &at[1], i, e));
                self.bite(&bites.collect::<Vec<_>>(), cuts);
            }
            (Kind::Turned, Cutter::Mill(mill)) => {
                let bites = steps.map(|(at, i, e)| MillBite::new(mill, &at[1], i, e));
                self.bite(&bites.collect::<Vec<_>>(), cuts);
            }
            (Kind::Table, Cutter::Wheel(wheel)) => {
                let bites = steps.map(|(at, i, e)| TableBite::new(wheel, at, i, e));
                self.bite(&bites.collect::<Vec<_>>(), cuts);
            }
            (Kind::Table, Cutter::Mill(mill)) => {
                let bites = steps.map(|(at, i, e)| TableBite::new(mill, at, i, e));
                self.bite(&bites.collect::<Vec<_>>(), cuts);
            }
        }
    }

    fn bite<B: Bite>(&mut self, bites: &[B], cuts: &mut [Cut]) {
        let Self { layout, ends, before, engaged, peaks, .. } = self;
        let (n_columns, n_tiles) = (layout.n_columns, layout.n_columns.div_ceil(TILE));
        let stripes = ends
            .par_chunks_mut(STRIPE * n_columns)
            .zip(before.par_chunks_mut(STRIPE * n_columns))
            .zip(peaks.par_chunks_mut(STRIPE * n_tiles))
            .zip(engaged.par_chunks_mut(STRIPE))
            .enumerate();
        let layout = &*layout;
        let taken = stripes.map(|(i, (((ends, before), peaks), engaged))| {
            let stripe = Stripe { layout, first: i * STRIPE, ends, before, peaks, engaged };
            dispatch!(Level::new(), simd => stripe.run(simd, bites))
        });
        // In the order of stripes, so that sums are the same for any number of threads.
        for (i_sweep, cut) in taken.collect::<Vec<_>>().into_iter().flatten() {
            cuts[i_sweep as usize].add(&cut);
        }
    }
}

/// Some rows, all the moves, one thread.
struct Stripe<'a> {
    layout: &'a Layout,
    first: usize,
    ends: &'a mut [f64],
    before: &'a mut [f64],
    peaks: &'a mut [f64],
    engaged: &'a mut [u32],
}

impl Stripe<'_> {
    /// Inlined with all it calls, so that it is compiled for each level of vector instructions.
    #[inline(always)]
    fn run<S: Simd, B: Bite>(self, _simd: S, bites: &[B]) -> Vec<(u32, Cut)> {
        let (n_columns, n_tiles) = (self.layout.n_columns, self.layout.n_columns.div_ceil(TILE));
        let mine = self.first..self.first + self.engaged.len();
        let highest = self.peaks.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let mut taken: Vec<(u32, Cut)> = Vec::new();
        for bite in bites {
            let rows = self.layout.rows_within(bite.reach());
            let mut cut = Cut::default();
            for row in rows.start.max(mine.start)..rows.end.min(mine.end) {
                let i = row - self.first;
                let mut row = Row {
                    layout: self.layout,
                    x: self.layout.row_x(row),
                    weight: self.layout.row_weight(row),
                    highest,
                    ends: &mut self.ends[i * n_columns..][..n_columns],
                    before: &mut self.before[i * n_columns..][..n_columns],
                    peaks: &mut self.peaks[i * n_tiles..][..n_tiles],
                    engaged: &mut self.engaged[i],
                };
                bite.bite(&mut row, &mut cut);
            }
            if !cut.is_nothing() {
                match taken.last_mut() {
                    Some((i_sweep, whole)) if *i_sweep == bite.i_sweep() => whole.add(&cut),
                    _ => taken.push((bite.i_sweep(), cut)),
                }
            }
        }
        taken
    }
}

impl Places {
    fn of(
        layout: &Layout,
        machine: &Machine,
        cutter: &Cutter,
        sweep: &Sweep,
    ) -> Result<Self, StockError> {
        let [from, to] = [&sweep.from, &sweep.to].map(|v| layout.locate(&Stance::at(machine, v)));
        let (from, to) = (from?, to?);
        if layout.kind == Kind::Table {
            return Ok(Self { from, to, n_steps: 1, error: 0.0 });
        }
        let turn = machine.spindle.map_or(0.0, |spindle| {
            let axis = &machine.axes[spindle];
            axis.motion(sweep.to[spindle]) - axis.motion(sweep.from[spindle])
        });
        let gaps = Gaps::between(&from, &to, turn.abs());
        if gaps.is_clear(layout, cutter) {
            return Ok(Self { from, to, n_steps: 0, error: 0.0 });
        }
        let (n_steps, error) = gaps.steps(layout, cutter);
        if n_steps > MOST_POSES {
            return Err(StockError::TooLong { poses: n_steps, most: MOST_POSES });
        }
        Ok(Self { from, to, n_steps: n_steps as usize, error })
    }

    fn at(
        &self,
        machine: &Machine,
        layout: &Layout,
        sweep: &Sweep,
        step: usize,
    ) -> Result<At, StockError> {
        match step {
            0 => Ok(self.from),
            _ if step == self.n_steps => Ok(self.to),
            _ => {
                let share = step as f64 / self.n_steps as f64;
                let mut values = sweep.from;
                for (value, to) in values.iter_mut().zip(&sweep.to) {
                    *value += (to - *value) * share;
                }
                layout.locate(&Stance::at(machine, &values))
            }
        }
    }
}

/// How far a tool goes on a move, seen without the part's turn.
struct Gaps {
    /// Along X, and square to it [mm].
    along: f64,
    square: f64,
    /// Of the part [rad].
    turn: f64,
    /// Least and greatest distance of the programmed point from the axis [mm].
    distance: [f64; 2],
    /// Its least height along the attack direction [mm].
    lowest: f64,
}

impl Gaps {
    fn between(from: &At, to: &At, turn: f64) -> Self {
        // The attack direction stands still while the part turns.
        let still = |at: &At| {
            let (sin, cos) = at.attack.sin_cos();
            let (y, z) = (at.point.y, at.point.z);
            [y * cos + z * sin, z * cos - y * sin]
        };
        let (a, b) = (still(from), still(to));
        let way = [b[0] - a[0], b[1] - a[1]];
        let square = way[0].hypot(way[1]);
        let nearest = if square > 0.0 {
            (-(a[0] * way[0] + a[1] * way[1]) / (square * square)).clamp(0.0, 1.0)
        } else {
            0.0
        };
        let least = (a[0] + nearest * way[0]).hypot(a[1] + nearest * way[1]);
        let greatest = a[0].hypot(a[1]).max(b[0].hypot(b[1]));
        Self {
            along: (to.point.x - from.point.x).abs(),
            square,
            turn,
            distance: [least, greatest],
            lowest: a[0].min(b[0]),
        }
    }

    fn is_clear(&self, layout: &Layout, cutter: &Cutter) -> bool {
        match cutter {
            Cutter::Wheel(wheel) => self.distance[0] - wheel.major - wheel.minor >= layout.top,
            Cutter::Mill(_) => self.lowest - cutter.reach().top >= layout.top,
        }
    }

    /// Into how many steps to part the move, and what then lies between them at most.
    ///
    /// Two places of a convex tool, each rolling over a ball of radius `r`, leave `way^2 / (8 r)`
    /// between them along the normal. Round its own axis a wheel rolls over `R + r`, and the way of
    /// its centre around the part bends with the part: that much less is left. Along X it rolls over
    /// `r`, at a normal that leans 60 degrees over half of it.
    fn steps(&self, layout: &Layout, cutter: &Cutter) -> (f64, f64) {
        let real = layout.resolution();
        let resolution = real.along.min(real.across);
        let body = self.along + self.square + self.turn * layout.top;
        let whole = match cutter {
            Cutter::Wheel(wheel) => {
                let around = self.turn * self.distance[1];
                let way2 = around * around + self.square * self.square;
                let cos = if way2 > 0.0 { around / way2.sqrt() } else { 0.0 };
                let bend = self.distance[0] * self.turn * self.turn * cos / 8.0;
                let between = (way2 / (8.0 * (wheel.major + wheel.minor)) - bend).max(0.0);
                between + self.along * self.along / (2.0 * wheel.minor)
            }
            Cutter::Mill(mill) => match mill.ball_radius() {
                Some(radius) if radius > 0.0 => body * body / (8.0 * radius),
                _ => {
                    let n_steps = (body / (SHARP_SHARE * resolution)).ceil().max(1.0);
                    return (n_steps, body / n_steps / 2.0);
                }
            },
        };
        let n_steps = (whole / (SWEEP_SHARE * resolution)).sqrt().ceil().max(1.0);
        (n_steps, whole / (n_steps * n_steps))
    }
}
