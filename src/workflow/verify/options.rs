//! How a program is verified.

use crate::workflow::cam::OptionsError;
use serde::{Deserialize, Serialize};

/// How a program is verified.
#[derive(Debug, Clone, Default, PartialEq, clap::Args, Serialize, Deserialize)]
#[serde(default, rename_all = "kebab-case", deny_unknown_fields)]
pub struct VerifyOptions {
    /// How far apart the stock is looked at [mm; default: 0.25].
    #[arg(long, value_name = "MM")]
    pub resolution: Option<f64>,
    /// How deep the program may cut into the part [mm; default: 0.05].
    #[arg(long, value_name = "MM")]
    pub tolerance: Option<f64>,
}

impl VerifyOptions {
    /// Refuses numbers that mean nothing.
    pub fn check(&self) -> Result<(), OptionsError> {
        let out_of_range =
            |option, value, must| Err(OptionsError::OutOfRange { option, value, must });
        let (resolution, tolerance) = (self.resolution(), self.tolerance());
        if !(resolution > 0.0 && resolution.is_finite()) {
            return out_of_range("--resolution", resolution, "a number above 0");
        }
        if !(tolerance >= 0.0 && tolerance.is_finite()) {
            return out_of_range("--tolerance", tolerance, "0 or more");
        }
        Ok(())
    }

    /// From ray to ray [mm].
    pub fn resolution(&self) -> f64 {
        self.resolution.unwrap_or(0.25)
    }

    /// Depth allowed into the part [mm].
    pub fn tolerance(&self) -> f64 {
        self.tolerance.unwrap_or(0.05)
    }
}
