//! Many frames of a depth camera made one surface: a truncated signed distance field.
//!
//! A [`Volume`] keeps, for points of a lattice near what was seen, the mean distance from the surface;
//! only blocks of 8 x 8 x 8 lattice points that a frame touched exist, so a scene may be as large as
//! memory allows. With a [`Tracker`] it is `KinectFusion`: each frame is laid over a view of the model
//! ([`Volume::cast`]) and then fused with it ([`Volume::integrate`]). [`Volume::mesh`] is the surface.
//! A [`DeviceVolume`] is the same on a graphics card; a [`Model`] is either.
//!
//! Curless and Levoy (1996); Newcombe et al. (2011); Niessner et al. (2013); Morell (2014), section 2.2.4.

mod block;
mod cast;
mod cubes;
mod error;
mod frame;
mod gpu;
mod held;
mod integrate;
mod lattice;
mod lost;
mod model;
mod options;
mod readings;
mod step;
mod tiles;
mod touch;
mod track;
mod volume;

pub use block::{Block, SIDE};
pub use cast::{ModelView, Seen};
pub use error::TsdfError;
pub use gpu::DeviceVolume;
pub use integrate::Integrated;
pub use lost::{Lost, Unplaced};
pub use model::Model;
pub use options::{TrackOptions, TsdfOptions, TsdfWeight};
pub use readings::{Reading, Readings};
pub use track::{Tracked, Tracker};
pub use volume::Volume;

#[cfg(test)]
mod tests;
