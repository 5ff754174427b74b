//! In how many places a tool is looked at on a move round a spindle.

use super::layout::{At, Kind, Layout};
use super::{Stance, StockError, Sweep};
use crate::machine::Machine;
use crate::tool::Cutter;
use std::f64::consts::TAU;

/// A move that takes more places of the tool than this is refused.
const MOST_POSES: f64 = 1e6;
/// A tool with a sharp edge leaves steps instead: its places are this share of the resolution apart.
const SHARP_SHARE: f64 = 0.25;
/// What may stay between two places of a tool on a move, as a share of the resolution.
const SWEEP_SHARE: f64 = 0.02;
/// Between two places the part turns no more than this, or what is said of a tool that rolls over it
/// does not hold [rad].
const MOST_TURN: f64 = TAU / 16.0;

/// The places of a tool on one move.
pub(super) struct Places {
    pub(super) from: At,
    pub(super) to: At,
    /// How many steps lie between them; 0 if the tool is clear of all the stock.
    pub(super) n_steps: usize,
    pub(super) error: f64,
}

impl Places {
    /// For a move of `cutter` over a stock whose rows have nothing farther out than `tops`.
    pub(super) fn of(
        (layout, tops): (&Layout, &[f64]),
        machine: &Machine,
        cutter: &Cutter,
        sweep: &Sweep,
    ) -> Result<Self, StockError> {
        let [from, to] = [&sweep.from, &sweep.to].map(|v| layout.locate(&Stance::at(machine, v)));
        let (from, to) = (from?, to?);
        if layout.kind == Kind::Table {
            return Ok(Self { from, to, n_steps: 1, error: 0.0 });
        }
        let turn = layout.turner.or(machine.spindle).map_or(0.0, |spindle| {
            let axis = &machine.axes[spindle];
            axis.motion(sweep.to[spindle]) - axis.motion(sweep.from[spindle])
        });
        let reach = layout.reach_along(cutter);
        let x = [from.point.x.min(to.point.x) - reach, from.point.x.max(to.point.x) + reach];
        let top = tops[layout.rows_within(x)].iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let gaps = Gaps::between(&from, &to, turn.abs(), top);
        if gaps.is_clear(layout, cutter) {
            return Ok(Self { from, to, n_steps: 0, error: 0.0 });
        }
        let (n_steps, error) = gaps.steps(layout, cutter);
        if n_steps > MOST_POSES {
            return Err(StockError::TooLong { poses: n_steps, most: MOST_POSES });
        }
        Ok(Self { from, to, n_steps: n_steps as usize, error })
    }

    pub(super) fn at(
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
                let values = sweep.at(step as f64 / self.n_steps as f64);
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
    /// Nothing in the rows it reaches ends farther out [mm].
    top: f64,
}

impl Gaps {
    fn between(from: &At, to: &At, turn: f64, top: f64) -> Self {
        // The attack direction stands still while the part turns.
        let (a, b) = (from.along_and_across(), to.along_and_across());
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
            top,
        }
    }

    fn is_clear(&self, layout: &Layout, cutter: &Cutter) -> bool {
        match cutter {
            Cutter::Wheel(wheel) => self.distance[0] - wheel.major - wheel.minor >= self.top,
            Cutter::Mill(_) => {
                self.lowest - cutter.reach().top - cutter.reach().x * layout.lean.sin().abs()
                    >= self.top
            }
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
        let body = self.along + self.square + self.turn * self.top;
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
        let rolls = (whole / (SWEEP_SHARE * resolution)).sqrt();
        let n_steps = rolls.max(self.turn / MOST_TURN).ceil().max(1.0);
        (n_steps, whole / (n_steps * n_steps))
    }
}
