//! Why frames cannot be fused.

use crate::compute::GpuError;
use crate::rgbd::RgbdError;

/// Why frames cannot be fused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TsdfError {
    /// A number that means nothing.
    #[error("{option} is {value}; it must be {must}")]
    Option {
        /// The flag.
        option: &'static str,
        /// What was given.
        value: f64,
        /// What would do.
        must: &'static str,
    },
    /// The model would outgrow the memory it may take.
    #[error(
        "the model would take {needed} MB, but may take {allowed} MB (--memory): use greater voxels (--voxel), a \
         shorter --truncation, or look less far (--max-depth)"
    )]
    Memory {
        /// What it would take with the next frame [MB].
        needed: usize,
        /// What it may take [MB].
        allowed: usize,
    },
    /// A camera beyond what the lattice reaches.
    #[error(
        "the camera stands {distance:.3e} mm from the origin, where voxels of {voxel} mm cannot be counted any more: \
         is the trajectory in metres?"
    )]
    TooFar {
        /// How far [mm].
        distance: f64,
        /// The side of a voxel [mm].
        voxel: f64,
    },
    /// Rays that a device does not follow to their end.
    #[error(
        "voxels of {voxel} mm make rays of more steps than a device takes: use greater ones (--voxel), look less far \
         (--max-depth), or use --compute cpu"
    )]
    LongRays {
        /// The side of a voxel [mm].
        voxel: f64,
    },
    /// What a device gave back is no picture.
    #[error(transparent)]
    Picture(#[from] RgbdError),
    /// The device cannot.
    #[error(transparent)]
    Gpu(#[from] GpuError),
}
