//! What computes: as the user has it, and as it is then.

use super::{Gpu, GpuError};
use std::sync::Arc;

/// What computes.
#[derive(Debug, Clone, Default)]
pub enum Compute {
    /// All threads of the processor.
    #[default]
    Cpu,
    /// A device.
    Gpu(Arc<Gpu>),
}

/// What the user would have compute.
#[derive(
    Debug,
    Clone,
    Copy,
    Default,
    PartialEq,
    Eq,
    serde::Serialize,
    serde::Deserialize,
    clap::ValueEnum,
)]
#[serde(rename_all = "kebab-case")]
pub enum ComputeChoice {
    /// The processor.
    #[default]
    Cpu,
    /// A graphics card, or what stands for one.
    Gpu,
    /// Whichever a small batch shows to be faster.
    Auto,
}

impl Compute {
    /// A device: the one whose name has `adapter` in it, or the one of the fastest kind.
    pub fn gpu(adapter: Option<&str>) -> Result<Self, GpuError> {
        Ok(Self::Gpu(Arc::new(Gpu::open(adapter)?)))
    }

    /// Its name, for reports.
    pub fn name(&self) -> &str {
        match self {
            Self::Cpu => "cpu",
            Self::Gpu(gpu) => gpu.name(),
        }
    }
}
