//! How trajectories are compared.

use std::fmt;
use std::str::FromStr;

/// How trajectories are compared.
#[derive(Debug, Clone, PartialEq, clap::Args, serde::Serialize, serde::Deserialize)]
#[serde(default, rename_all = "kebab-case", deny_unknown_fields)]
pub struct OdometryErrorOptions {
    /// The step of the relative error: a number of poses, or of seconds as in 1s; several if repeated.
    #[arg(long = "delta", value_name = "N|Ns", default_values_t = Self::default().deltas)]
    pub deltas: Vec<Delta>,
    /// The truth at the stamp of an estimate: the nearest there is, or between two of them.
    #[arg(long, value_name = "HOW", value_enum, default_value_t = Self::default().truth_at)]
    pub truth_at: TruthAt,
    /// Farther from an estimate than this no truth is taken for it [s].
    #[arg(long, value_name = "S", default_value_t = Self::default().max_difference)]
    pub max_difference: f64,
}

/// The step of a relative error.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(into = "String", try_from = "String")]
pub enum Delta {
    /// So many poses on.
    Poses(usize),
    /// So many seconds on: the pose nearest to it. What would end at the last pose is left out, since
    /// every later step would too (`evaluate_rpe.py`).
    Seconds(f64),
}

/// What is taken for the truth at a stamp.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize, clap::ValueEnum,
)]
#[serde(rename_all = "kebab-case")]
pub enum TruthAt {
    /// The pose with the nearest stamp, as the TUM tools have it. It is off itself by what the camera
    /// moves in half a step of the truth.
    Nearest,
    /// What lies between the poses before and after.
    Interpolated,
}

impl Default for OdometryErrorOptions {
    fn default() -> Self {
        Self {
            deltas: vec![Delta::Poses(1), Delta::Seconds(1.0)],
            truth_at: TruthAt::Nearest,
            max_difference: 0.02,
        }
    }
}

impl fmt::Display for Delta {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Poses(n) => write!(f, "{n}"),
            Self::Seconds(seconds) => write!(f, "{seconds}s"),
        }
    }
}

impl FromStr for Delta {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let seconds = text.strip_suffix('s').map(|number| number.trim().parse::<f64>());
        match (seconds, text.parse::<usize>()) {
            (Some(Ok(seconds)), _) if seconds > 0.0 && seconds.is_finite() => {
                Ok(Self::Seconds(seconds))
            }
            (None, Ok(n)) if n > 0 => Ok(Self::Poses(n)),
            _ => {
                Err(format!("{text:?} is no step: give a number of poses (30) or of seconds (1s)"))
            }
        }
    }
}

impl From<Delta> for String {
    fn from(delta: Delta) -> Self {
        delta.to_string()
    }
}

impl TryFrom<String> for Delta {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        text.parse()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_is_poses_or_seconds() {
        assert_eq!("30".parse(), Ok(Delta::Poses(30)));
        assert_eq!("0.5s".parse(), Ok(Delta::Seconds(0.5)));
        for text in ["0", "-1", "1.5", "0s", "nans", "infs", "s", ""] {
            let told = text.parse::<Delta>().unwrap_err();
            assert!(told.contains("is no step"), "{told}");
        }
        assert_eq!(Delta::Seconds(1.0).to_string(), "1s");
    }
}
