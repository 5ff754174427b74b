//! How a pose graph is settled.

use clap::ValueEnum;
use serde::{Deserialize, Serialize};

/// How a pose graph is settled.
#[derive(Debug, Clone, PartialEq, clap::Args, Serialize, Deserialize)]
#[serde(default, rename_all = "kebab-case")]
pub struct GraphOptions {
    /// What becomes of loops that do not fit the others.
    #[arg(long, value_enum, default_value_t = Self::default().loop_kernel)]
    pub loop_kernel: LoopKernel,
    /// A loop that is off by more than this does not fit [standard deviations].
    #[arg(long, value_name = "SIGMAS", default_value_t = Self::default().loop_limit)]
    pub loop_limit: f64,
}

/// What becomes of loops that do not fit the others.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LoopKernel {
    /// They count as much as those that do.
    None,
    /// They count less, by the inverse square of what they are off.
    Cauchy,
    /// They are dropped: truncated least squares by graduated non-convexity. Yang et al. (2020).
    Truncated,
}

impl Default for GraphOptions {
    fn default() -> Self {
        // Of six numbers that err as they say, one in a thousand is off by more.
        Self { loop_kernel: LoopKernel::Truncated, loop_limit: 4.74 }
    }
}
