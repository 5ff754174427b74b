//! Pictures and pages that tell people what was done.
mod png;
mod raster;
mod scene;
mod shade;
pub use png::encode_png;
pub use raster::{Raster, render};
pub use scene::{Camera, Path, Scene, Solid};
