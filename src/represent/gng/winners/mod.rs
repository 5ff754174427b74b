//! Who wins a signal: the two neurons nearest to it.
//!
//! [`Scan`] tries every neuron, [`Grid`] looks where they can be. Both say the same, to the last bit: distances
//! are computed by [`square`](super::network::square) alone, and of equals the lower number wins.

mod grid;
mod scan;

pub(super) use grid::Grid;
pub(super) use scan::Scan;

use super::error::GngError;
use super::links::Links;
use super::network::{Neuron, Place};
use rayon::prelude::*;

/// Winners a thread looks for at least.
const FEWEST: usize = 64;

/// The two nearest neurons, and how far off the first is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Won {
    pub(super) first: u32,
    pub(super) second: u32,
    /// The squared distance to the first [mm^2].
    pub(super) square: f32,
}

/// Finds winners, and is told what becomes of the neurons.
pub(super) trait Winners {
    /// The two neurons nearest to the signal; there are at least two.
    fn look(&self, signal: Place, neurons: &[Neuron], links: &Links) -> Won;

    /// [`look`](Self::look) for each of the signals, on all threads.
    fn look_all(
        &self,
        signals: &[Place],
        neurons: &[Neuron],
        links: &Links,
    ) -> Result<Vec<Won>, GngError>
    where
        Self: Sync,
    {
        let look = |signal: &Place| self.look(*signal, neurons, links);
        Ok(signals.par_iter().with_min_len(FEWEST).map(look).collect())
    }

    /// Keeps in mind who won, if that helps with the next signal nearby.
    fn remember(&mut self, _signal: Place, _won: Won) {}

    /// [`look`](Self::look), then [`remember`](Self::remember).
    #[inline(always)]
    fn find(&mut self, signal: Place, neurons: &[Neuron], links: &Links) -> Won {
        let won = self.look(signal, neurons, links);
        self.remember(signal, won);
        won
    }

    /// The neuron `i` went from one place to another.
    fn moved(&mut self, i: u32, from: Place, to: Place);

    /// The last neuron, `i`, is new.
    fn added(&mut self, i: u32, neurons: &[Neuron]);

    /// The neuron `i` goes, and `last` gets its number; `neurons` are as before.
    fn removed(&mut self, i: u32, last: u32, neurons: &[Neuron]);
}

/// Nobody looks for winners: a network changes where no search need know of it.
pub(super) struct Nobody;

impl Nobody {
    const WON: Won = Won { first: 0, second: 1, square: f32::INFINITY };
}

impl Winners for Nobody {
    fn look(&self, _signal: Place, _neurons: &[Neuron], _links: &Links) -> Won {
        Self::WON
    }

    fn moved(&mut self, _i: u32, _from: Place, _to: Place) {}

    fn added(&mut self, _i: u32, _neurons: &[Neuron]) {}

    fn removed(&mut self, _i: u32, _last: u32, _neurons: &[Neuron]) {}
}

/// The two least of pairs of squared distance and number.
#[derive(Debug, Clone, Copy)]
pub(super) struct Two {
    first: (f32, u32),
    second: (f32, u32),
}

impl Two {
    pub(super) const NONE: Self =
        Self { first: (f32::INFINITY, u32::MAX), second: (f32::INFINITY, u32::MAX) };

    /// Takes another pair into account, which must not be one it has.
    #[inline(always)]
    pub(super) fn take(&mut self, square: f32, i: u32) {
        if is_before((square, i), self.second) {
            if is_before((square, i), self.first) {
                self.second = self.first;
                self.first = (square, i);
            } else {
                self.second = (square, i);
            }
        }
    }
}

#[inline(always)]
fn is_before(a: (f32, u32), b: (f32, u32)) -> bool {
    a.0 < b.0 || (a.0 == b.0 && a.1 < b.1)
}

impl From<Two> for Won {
    fn from(two: Two) -> Self {
        Self { first: two.first.1, second: two.second.1, square: two.first.0 }
    }
}
