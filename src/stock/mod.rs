//! Stock: what is left of the raw block while tools cut it.
//!
//! The block is a bundle of *dexels*: rays in a regular [`Layout`], each with the one place at which
//! the material ends. On a machine whose spindle turns the part the rays leave the spindle axis at
//! right angles, one for every station along X and every angle about it; on a table they run along
//! the attack axis. [`Stock::remove`] takes away what a tool sweeps over on whole moves, all axes
//! running linearly as the control runs them.
//!
//! What one place a ray cannot say:
//! * a hollow *behind* material, seen from the end of the ray: a body is filled up to its outermost
//!   surface, and what stands over a tool that passes beneath it is kept whole, with what the tool
//!   took from below it ([`Cut::n_overhangs`] counts such rays);
//! * a part cut in two: a tool that takes the last of the material about the spindle axis, or goes
//!   below the block on a table, says so ([`Cut::is_through`]).
//!
//! A part turned about a table's axis under a tool of constant tilt has rays about that axis
//! ([`Layout::about`]); the tool leans along it. A part tilted between moves needs dexels in three
//! directions; it is refused ([`StockError::Tilted`]).
//!
//! Dexels after T. Van Hook, *Real-time shaded NC milling display* (1986).

mod arrange;
mod beside;
mod body;
mod dexels;
mod disc;
mod layout;
mod over_table;
mod places;
mod remove;
mod rod;
mod row;
mod scan;
mod shave;
mod stance;
mod strip;
mod stripe;
mod surface;
mod thickness;
mod trace;
mod under_ball;
mod under_leaning_mill;
mod under_mill;
mod under_wheel;

pub use beside::Crests;
pub use dexels::Stock;
pub use layout::{Layout, Resolution};
pub use remove::Sweep;
pub use row::Cut;
pub use stance::Stance;
pub use thickness::Layer;

use crate::progress::Cancelled;

/// Why stock cannot be told.
#[derive(Debug, thiserror::Error)]
pub enum StockError {
    /// The spacing of dexels is no length.
    #[error("the resolution is {value} mm; it must be a number above 0")]
    Resolution {
        /// What was asked for.
        value: f64,
    },
    /// More dexels than memory should be asked for.
    #[error(
        "a resolution of {resolution} mm takes {dexels:.2e} dexels, more than {most:.0e}; \
         choose a coarser one"
    )]
    TooMany {
        /// The spacing asked for [mm].
        resolution: f64,
        /// How many dexels it takes.
        dexels: f64,
        /// How many there may be.
        most: f64,
    },
    /// There is no block.
    #[error("the stock has no extent; give a block that holds the part")]
    Empty,
    /// The part stands tilted against the rays.
    #[error(
        "the tool comes at the part {angle_deg:.3} degrees off the direction the stock is kept in; \
         moves that tilt the part are not simulated (that takes dexels in three directions): \
         simulate each tilt by itself"
    )]
    Tilted {
        /// By how much [deg].
        angle_deg: f64,
    },
    /// A move so long that it would take for ever.
    #[error(
        "one move takes {poses:.1e} places of the tool to follow, more than {most:.0e}: \
         it turns the part too far in one block; choose a coarser resolution"
    )]
    TooLong {
        /// How many places.
        poses: f64,
        /// How many there may be.
        most: f64,
    },
    /// The caller asked to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}
