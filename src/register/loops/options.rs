//! How loops of a walk are looked for.

use crate::register::pose_graph::{GraphError, GraphOptions};
use serde::{Deserialize, Serialize};

/// How loops of a walk are looked for, and what they do to it.
#[derive(Debug, Clone, PartialEq, clap::Args, Serialize, Deserialize)]
#[serde(default, rename_all = "kebab-case")]
pub struct LoopOptions {
    /// Do not look for places that the camera comes back to.
    #[arg(long)]
    pub no_loops: bool,
    /// Key frames that must lie between two that close a loop.
    #[arg(long, value_name = "N", default_value_t = Self::default().loop_gap)]
    pub loop_gap: usize,
    /// How loops are weighed against the walk.
    #[command(flatten)]
    #[serde(flatten)]
    pub graph: GraphOptions,
}

impl Default for LoopOptions {
    fn default() -> Self {
        Self { no_loops: false, loop_gap: 5, graph: GraphOptions::default() }
    }
}

impl LoopOptions {
    /// Refuses numbers that mean nothing.
    pub fn check(&self) -> Result<(), GraphError> {
        self.graph.check()
    }
}
