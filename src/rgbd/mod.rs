//! What depth cameras see: cameras, frames, the paths they took, sensors real and simulated.
//!
//! A [`Camera`] says where a point appears in the picture, an [`RgbdFrame`] is one exposure, and a
//! [`CameraTrajectory`] where the camera stood when. Camera axes are x right, y down, z forward;
//! pixel (0, 0) has its *centre* at (0, 0), as in the TUM benchmark and `OpenCV`. Depth is the z of a
//! point in its camera, in mm; **0 means that there is no reading** (not NaN: graphics kernels may
//! assume that NaN does not occur, and every file format of depth says 0).
//!
//! Sequences are iterators of `Result<RgbdFrame, SequenceError>`, so that none needs to fit in memory;
//! `io` opens them.

mod associate;
mod camera;
mod error;
mod exposure;
pub mod filter;
mod frame;
mod image;
mod normals;
mod organised;
mod pyramid;
mod sensor;
pub mod simulated;
mod trajectory;

pub use associate::associate;
pub use camera::{Camera, Distortion};
pub use error::{RgbdError, SequenceError};
pub use exposure::Exposure;
pub use frame::RgbdFrame;
pub use image::{Image, grey};
pub use normals::NormalOptions;
pub use organised::OrganisedCloud;
pub use pyramid::{halved_depth, halved_grey};
pub use sensor::{KinectDisparity, depth_from_numbers, numbers_from_depth};
pub use trajectory::{CameraTrajectory, StampedPose};
