//! Growing neural gas: a network of neurons that learns where a cloud is, and how it hangs together.
//!
//! Signals are drawn from the cloud. The neuron nearest to a signal comes nearer, its neighbours a little; the
//! two nearest are joined; edges that no signal confirms wither. After every lambda signals a new neuron appears
//! where the error is greatest, until there are as many as asked for.
//!
//! The network is Fritzke's to the letter; only how it is computed is our own: winners are looked for in a
//! grid of cells, errors decay by one product for all, edges grow older without being touched. Trying every
//! neuron instead ([`Search::Scan`]) gives the same network, bit for bit.
//!
//! Fritzke (1995), "A Growing Neural Gas Network Learns Topologies"; Morell (2014), sections 3.2 and 4.3.

mod error;
mod gpu;
mod graph;
mod grow;
mod learn;
mod links;
mod network;
mod options;
mod reduction;
mod signals;
mod winners;

pub use error::GngError;
pub use graph::{GraphEdge, NeuronGraph};
pub use grow::{Grown, LearnedOn, grow};
pub use learn::Stopped;
pub use options::{Decay, GngOptions, OptionError, Preset, Search};
pub use reduction::two_minimum;

#[cfg(test)]
mod tests;
