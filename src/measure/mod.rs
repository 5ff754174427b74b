//! What a program does to a block, and how far what is left is from the part.
//!
//! [`simulate()`] replays a program, as it was read back from its file, on a
//! [`Stock`](crate::stock::Stock); [`deviation()`] compares what is left with the part, and tells
//! material the tool is too large for from material its path did not go to; [`blame()`] finds the line
//! that cut a place.

mod blame;
mod deviation;
mod limit;
mod ridge;
mod simulate;

pub use blame::blame;
pub use deviation::{Bin, Deviation, DeviationReport, Spot, Target, Within, deviation};
pub use limit::limit;
pub use simulate::{
    Blank, BodiesReport, CheckedBody, Collision, CollisionKind, Extreme, Fixture, Fixtures,
    ResolutionReport, SimulateError, Simulation, SimulationReport, simulate,
};
