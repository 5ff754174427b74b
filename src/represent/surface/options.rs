//! What of a surface is closed.

use super::error::SurfaceError;
use serde::{Deserialize, Serialize};

/// Rims longer than this many mean distances of neurons are those of holes.
const LONGEST_RIM: f64 = 12.0;

/// What of a surface is closed.
#[derive(Debug, Clone, Default, PartialEq, clap::Args, Serialize, Deserialize)]
#[serde(default, rename_all = "kebab-case", deny_unknown_fields)]
pub struct SurfaceOptions {
    /// Close holes with rims no longer than this; a large number closes all, 0 none that could be one
    /// [default: 12 mean distances of neurons].
    #[arg(long, value_name = "MM")]
    pub close: Option<f64>,
}

impl SurfaceOptions {
    /// Refuses what is no length.
    pub fn check(&self) -> Result<(), SurfaceError> {
        let value = self.close.unwrap_or(0.0);
        if value >= 0.0 { Ok(()) } else { Err(SurfaceError::Close { value }) }
    }

    /// The longest rim that is closed [mm].
    pub(super) fn longest_rim(&self, spacing: f64) -> f64 {
        self.close.unwrap_or(LONGEST_RIM * spacing)
    }
}
