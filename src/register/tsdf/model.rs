//! A model wherever it lives.

use super::gpu::DeviceVolume;
use super::{Integrated, ModelView, Readings, TsdfError, TsdfOptions, Volume};
use crate::compute::Compute;
use crate::geom::{Pose, TriMesh};
use crate::rgbd::Camera;

/// A model wherever it lives.
#[derive(Debug)]
pub enum Model {
    /// In memory.
    Cpu(Volume),
    /// On a device.
    Gpu(Box<DeviceVolume>),
}

impl Model {
    /// A model of nothing yet on `compute`.
    pub fn new(options: &TsdfOptions, compute: &Compute) -> Result<Self, TsdfError> {
        Ok(match compute {
            Compute::Cpu => Self::Cpu(Volume::new(options)?),
            Compute::Gpu(gpu) => Self::Gpu(Box::new(DeviceVolume::new(options, gpu.clone())?)),
        })
    }

    /// How it is made.
    pub fn options(&self) -> &TsdfOptions {
        match self {
            Self::Cpu(volume) => volume.options(),
            Self::Gpu(volume) => volume.options(),
        }
    }

    /// Blocks that exist.
    pub fn n_blocks(&self) -> usize {
        match self {
            Self::Cpu(volume) => volume.n_blocks(),
            Self::Gpu(volume) => volume.n_blocks(),
        }
    }

    /// What it takes [bytes].
    pub fn memory(&self) -> usize {
        match self {
            Self::Cpu(volume) => volume.memory(),
            Self::Gpu(volume) => volume.memory(),
        }
    }

    /// Fuses what `readings` say, taken from `world_from_camera`. An error leaves the model as it was,
    /// unless the device is lost.
    pub fn integrate(
        &mut self,
        readings: &Readings,
        world_from_camera: &Pose,
    ) -> Result<Integrated, TsdfError> {
        match self {
            Self::Cpu(volume) => volume.integrate(readings, world_from_camera),
            Self::Gpu(volume) => volume.integrate(readings, world_from_camera),
        }
    }

    /// The model as `camera` (its distortion undone) would see it from `world_from_camera`.
    pub fn cast(
        &mut self,
        camera: &Camera,
        world_from_camera: &Pose,
    ) -> Result<ModelView, TsdfError> {
        match self {
            Self::Cpu(volume) => Ok(volume.cast(camera, world_from_camera)),
            Self::Gpu(volume) => volume.cast(camera, world_from_camera),
        }
    }

    /// The surface, counter-clockwise seen from outside, with colours if there were any.
    pub fn mesh(&self) -> Result<TriMesh, TsdfError> {
        match self {
            Self::Cpu(volume) => volume.mesh(),
            Self::Gpu(volume) => volume.download()?.mesh(),
        }
    }
}
