//! What computes: the processor, or a graphics card through Vulkan.
//!
//! The only place that names wgpu. An algorithm with a kernel prepares plain slices, has them
//! [uploaded](Gpu::upload), [runs](Gpu::run) its [`Kernel`] over them and reads plain slices back;
//! what the kernel means is the algorithm's own. Nothing else of horma needs a device: without one,
//! or without a driver, all works but what asks for it by name.

mod adapter;
mod choice;
mod error;
mod gpu;
#[cfg(test)]
pub(crate) mod judge;
mod kernel;
mod memory;
mod pace;

pub use adapter::{Adapter, AdapterKind, AdapterLimits, adapters};
pub use choice::{Compute, ComputeChoice};
pub use error::GpuError;
pub use gpu::Gpu;
pub use kernel::{Kernel, Precision};
pub use memory::Buffer;
pub(crate) use pace::Pace;
#[cfg(test)]
pub(crate) use testing::device;

#[cfg(test)]
mod testing {
    use super::Gpu;

    /// A device; without one the test is skipped, and says so, unless `HORMA_REQUIRE_GPU` forbids that.
    pub(crate) fn device() -> Option<Gpu> {
        match Gpu::open(None) {
            Ok(gpu) => Some(gpu),
            Err(error) if std::env::var_os("HORMA_REQUIRE_GPU").is_some() => panic!("{error}"),
            Err(error) => {
                eprintln!("skipped: {error}");
                None
            }
        }
    }
}
