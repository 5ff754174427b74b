//! Why a device cannot be used, and what to do then.

/// Why a device cannot be used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum GpuError {
    /// There is none.
    #[error(
        "no Vulkan adapter is there; install a driver (mesa-vulkan-drivers and libvulkan1 have one in \
         software) or use --compute cpu"
    )]
    NoAdapter,
    /// None is called so.
    #[error("no adapter is called \"{name}\"; there are: {}", .present.join(", "))]
    NoSuchAdapter {
        /// What was asked for.
        name: String,
        /// What there is.
        present: Vec<String>,
    },
    /// The adapter gives no device.
    #[error(
        "{adapter} cannot be opened: {why}; choose another with --adapter or use --compute cpu"
    )]
    Refused {
        /// Its name.
        adapter: String,
        /// What its driver says.
        why: String,
    },
    /// The adapter lacks what a kernel needs.
    #[error("{adapter} has no {what}; choose another with --adapter or use --compute cpu")]
    Lacks {
        /// Its name.
        adapter: String,
        /// What is needed.
        what: &'static str,
    },
    /// The device has no room.
    #[error(
        "{adapter} has no room for {n_bytes} bytes more; close what else uses it, or use --compute cpu"
    )]
    OutOfMemory {
        /// Its name.
        adapter: String,
        /// What did not fit.
        n_bytes: u64,
    },
    /// The device went away while it worked.
    #[error("{adapter} was lost: {why}; try again, or use --compute cpu")]
    Lost {
        /// Its name.
        adapter: String,
        /// What its driver says.
        why: String,
    },
    /// The driver refuses what we ask of it: our fault, or its own.
    #[error(
        "{adapter} refuses {what}: {why}; this is a bug in horma or in the driver; use --compute cpu"
    )]
    Refuses {
        /// Its name.
        adapter: String,
        /// What was asked.
        what: String,
        /// What it says.
        why: String,
    },
}
