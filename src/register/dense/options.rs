//! How frames are laid over each other by all they show.

use super::DenseError;
use clap::ValueEnum;
use serde::{Deserialize, Serialize};

/// How frames are laid over each other by all they show.
#[derive(Debug, Clone, PartialEq, clap::Args, Serialize, Deserialize)]
#[serde(default, rename_all = "kebab-case", deny_unknown_fields)]
pub struct DenseOptions {
    /// What must agree.
    #[arg(long = "dense-residuals", value_enum, default_value_t = Self::default().residuals)]
    pub residuals: Residuals,
    /// Pictures from coarse to fine, each of half the size of the next.
    #[arg(long = "dense-levels", value_name = "N", default_value_t = Self::default().levels)]
    pub levels: usize,
    /// Pixels of a picture that are looked for in the other, at most about.
    #[arg(long = "dense-points", value_name = "N", default_value_t = Self::default().points)]
    pub points: usize,
    /// Steps at one size of picture, at most.
    #[arg(long = "dense-iterations", value_name = "N", default_value_t = Self::default().iterations)]
    pub iterations: u32,
    /// What is made of pictures of different brightness.
    #[arg(long = "dense-light", value_enum, default_value_t = Self::default().light)]
    pub light: Light,
    /// Standard deviation of a turn from what the motion before lets expect [deg; default: anything may
    /// come].
    #[arg(long = "dense-prior-turn", value_name = "DEG")]
    pub prior_turn_deg: Option<f64>,
    /// Standard deviation of a shift from what the motion before lets expect [mm; default: anything may
    /// come].
    #[arg(long = "dense-prior-shift", value_name = "MM")]
    pub prior_shift: Option<f64>,
    /// When turns of the camera are tried besides the start.
    #[arg(long = "dense-search", value_enum, default_value_t = Self::default().search)]
    pub search: Search,
}

/// What must agree.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Residuals {
    /// Brightness. Steinbruecker et al. (2011).
    Brightness,
    /// Brightness and depth. Kerl et al. (2013).
    BrightnessAndDepth,
}

/// What is made of pictures of different brightness.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Light {
    /// Nothing: exposure and light are constant.
    Constant,
    /// A factor and an offset are found with the motion.
    Corrected,
}

/// When turns of the camera are tried besides the start.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Search {
    /// Never.
    Never,
    /// When the start led to where the frames do not look alike.
    WhenLost,
}

impl Default for DenseOptions {
    fn default() -> Self {
        Self {
            residuals: Residuals::BrightnessAndDepth,
            levels: 4,
            points: 20_000,
            iterations: 20,
            light: Light::Corrected,
            prior_turn_deg: None,
            prior_shift: None,
            search: Search::WhenLost,
        }
    }
}

impl DenseOptions {
    /// Refuses numbers that mean nothing.
    pub fn check(&self) -> Result<(), DenseError> {
        let refuse =
            |option, value, must: &'static str| Err(DenseError::Option { option, value, must });
        if !(1..=8).contains(&self.levels) {
            return refuse("--dense-levels", self.levels as f64, "a whole number from 1 to 8");
        }
        if !(100..=1 << 28).contains(&self.points) {
            return refuse("--dense-points", self.points as f64, "100 or more");
        }
        if !(1..=10_000).contains(&self.iterations) {
            let value = f64::from(self.iterations);
            return refuse("--dense-iterations", value, "a whole number from 1 to 10000");
        }
        let priors = [
            ("--dense-prior-turn", self.prior_turn_deg),
            ("--dense-prior-shift", self.prior_shift),
        ];
        for (option, value) in priors {
            if let Some(value) = value.filter(|value| !(*value > 0.0 && value.is_finite())) {
                return refuse(option, value, "a number above 0");
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_that_mean_nothing_are_refused_by_name() {
        let good = DenseOptions::default();
        good.check().unwrap();
        for (bad, name) in [
            (DenseOptions { levels: 0, ..good.clone() }, "--dense-levels is 0"),
            (DenseOptions { points: 3, ..good.clone() }, "--dense-points is 3"),
            (DenseOptions { iterations: 0, ..good.clone() }, "--dense-iterations"),
            (DenseOptions { prior_turn_deg: Some(0.0), ..good.clone() }, "--dense-prior-turn"),
            (DenseOptions { prior_shift: Some(f64::NAN), ..good.clone() }, "--dense-prior-shift"),
        ] {
            let error = bad.check().unwrap_err().to_string();
            assert!(error.starts_with(name), "{error}");
        }
    }
}
