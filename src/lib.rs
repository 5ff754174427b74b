//! horma: from a scanned part to a lathe program.
//!
//! The walk of the data, and the modules in the order they may name each other (each knows only
//! those before it):
//!
//! 1. [`progress`]: how long work reports and is stopped.
//! 2. [`geom`]: poses, boxes, clouds, meshes, normals, the search trees.
//! 3. [`compute`]: the processor, or a graphics card.
//! 4. [`rgbd`]: what depth cameras see: cameras, frames, sensors real and simulated.
//! 5. [`register`]: what moves one view onto another, and how far off it is.
//! 6. [`represent`]: fewer points that say the same.
//! 7. [`tool`]: what cuts: profiles of revolution and their height functions.
//! 8. [`machine`]: what moves: axes, limits and clamping as data, and the kinematics they make.
//! 9. [`stock`]: what is left of the raw block, and whole moves of a tool through it.
//! 10. [`cam`]: trajectories, virtual digitizing, the toolpath with its feeds.
//! 11. [`gcode`]: the toolpath as a program of blocks, and back.
//! 12. [`measure`]: a program replayed on its block, and what is left compared with the part.
//! 13. [`workflow`]: one pure function per job.
//! 14. [`io`]: files in and out.
//!
//! Inside, lengths are millimetres and angles radians, all `f64`; metres, degrees and seconds per
//! minute live only in files, flags and reports.

pub mod cam;
pub mod compute;
pub mod gcode;
pub mod geom;
pub mod io;
pub mod machine;
pub mod measure;
pub mod progress;
pub mod register;
pub mod represent;
pub mod rgbd;
pub mod stock;
pub mod tool;
pub mod workflow;
