//! Whole moves of a tool through the stock.
//!
//! On a table the lowest place a move reaches over a ray is found exactly. Round a spindle a move is
//! followed in as many places of the tool as keep what lies between them below a fiftieth of the
//! resolution; [`Stock::sweep_error`] says what came of it.

use super::dexels::Stock;
use super::layout::{At, Kind, TILT};
use super::over_table::TableBite;
use super::places::Places;
use super::row::Cut;
use super::shave::{Blade, Placed};
use super::strip::Flat;
use super::stripe::{Bite, STRIPE, Stripe};
use super::trace::End;
use super::under_ball::Ball;
use super::under_leaning_mill::LeaningMill;
use super::{Stance, StockError};
use crate::machine::{AxisValues, Machine};
use crate::progress::Progress;
use crate::tool::{Cutter, HeightFunction, Mill};
use fearless_simd::{Level, dispatch};
use rayon::prelude::*;

/// Moves taken together: memory for their places stays small whatever the program's length.
const BATCH: usize = 16_384;

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

impl Sweep {
    /// The words after a share of the move; those of its ends exactly.
    pub fn at(&self, share: f64) -> AxisValues {
        if share == 1.0 {
            return self.to;
        }
        std::array::from_fn(|axis| self.from[axis] + (self.to[axis] - self.from[axis]) * share)
    }
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
        let reach = self.layout.reach_along(cutter);
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
        let (layout, tops) = (&self.layout, &self.tops()[..]);
        let of = |sweep: &Sweep| Places::of((layout, tops), machine, cutter, sweep);
        let places = sweeps.par_iter().map(of);
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
            (Kind::Turned, Cutter::Wheel(wheel)) => self.turn(wheel, steps, cuts),
            (Kind::Turned, Cutter::Mill(mill)) if self.layout.lean.abs() > TILT => {
                let end = end_of(&mill);
                self.turn(LeaningMill { mill, end, top: self.layout.top }, steps, cuts);
            }
            (Kind::Turned, Cutter::Mill(mill)) => match end_of(&mill) {
                Some(End::Ball { radius, centre }) => {
                    self.turn(Ball { radius, centre }, steps, cuts);
                }
                Some(End::Flat { radius, .. }) => self.turn(Flat { radius }, steps, cuts),
                None => self.turn(mill, steps, cuts),
            },
            (Kind::Table, Cutter::Wheel(wheel)) => {
                let bites = steps.map(|(at, i, e)| TableBite::new((wheel, None), at, i, e));
                self.bite(&bites.collect::<Vec<_>>(), cuts);
            }
            (Kind::Table, Cutter::Mill(mill)) => {
                let tool = (mill, end_of(&mill));
                let bites = steps.map(|(at, i, e)| TableBite::new(tool, at, i, e));
                self.bite(&bites.collect::<Vec<_>>(), cuts);
            }
        }
    }

    /// Cuts a turned part with `blade` at one place after the other.
    fn turn<B: Blade + Copy>(
        &mut self,
        blade: B,
        steps: impl Iterator<Item = ([At; 2], u32, u32)>,
        cuts: &mut [Cut],
    ) {
        let placed = |([_, at], i_sweep, engagement): ([At; 2], u32, u32)| Placed {
            blade,
            at,
            i_sweep,
            engagement,
        };
        self.bite(&steps.map(placed).collect::<Vec<_>>(), cuts);
    }

    fn bite<B: Bite>(&mut self, bites: &[B], cuts: &mut [Cut]) {
        let Self { layout, ends, before, engaged, peaks, .. } = self;
        let (n_columns, stride) = (layout.n_columns, layout.tile_stride());
        let stripes = ends
            .par_chunks_mut(STRIPE * n_columns)
            .zip(before.par_chunks_mut(STRIPE * n_columns))
            .zip(peaks.par_chunks_mut(STRIPE * stride))
            .zip(engaged.par_chunks_mut(STRIPE))
            .enumerate();
        let layout = &*layout;
        let reaches = bites.iter().map(Bite::reach);
        let reach = reaches.reduce(|[a, b], [c, d]| [a.min(c), b.max(d)]);
        let rows = reach.map_or(0..0, |reach| layout.rows_within(reach));
        let reached = stripes.filter(|(i, _)| {
            let first = i * STRIPE;
            first < rows.end && rows.start < first + STRIPE
        });
        let taken = reached.map(|(i, (((ends, before), peaks), engaged))| {
            let stripe = Stripe::new(layout, i * STRIPE, [ends, before, peaks], engaged);
            dispatch!(Level::new(), simd => stripe.run(simd, bites))
        });
        // In the order of stripes, so that sums are the same for any number of threads.
        for (i_sweep, cut) in taken.collect::<Vec<_>>().into_iter().flatten() {
            cuts[i_sweep as usize].add(&cut);
        }
    }
}

/// The end of a mill that is a ball, or flat, and nothing else.
fn end_of(mill: &Mill) -> Option<End> {
    let ball = mill.ball_radius();
    let ball = ball.map(|radius| End::Ball { radius, centre: radius - mill.reach().top });
    ball.or_else(|| mill.flat_radius().map(|radius| End::Flat { radius, rise: 0.0 }))
}
