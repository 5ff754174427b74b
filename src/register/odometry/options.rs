//! How a camera is followed.

use clap::ValueEnum;
use serde::{Deserialize, Serialize};

/// How a camera is followed.
#[derive(Debug, Clone, PartialEq, clap::Args, Serialize, Deserialize)]
#[serde(default, rename_all = "kebab-case", deny_unknown_fields)]
pub struct OdometryOptions {
    /// What the motion from frame to frame is found by.
    #[arg(long, value_enum, default_value_t = Self::default().method)]
    pub method: Method,
    /// Voxels in which surfaces are laid over each other [mm; default: 1/75 of the first frame's
    /// median depth].
    #[arg(long, value_name = "MM")]
    pub icp_voxel: Option<f64>,
    /// A frame that shows less than this share of what its key frame shows becomes the next key
    /// frame.
    #[arg(long, value_name = "SHARE", default_value_t = Self::default().key_overlap)]
    pub key_overlap: f64,
    /// A camera that is farther than this from where it was expected got lost [mm].
    #[arg(long, value_name = "MM", default_value_t = Self::default().most_moved)]
    pub most_moved: f64,
    /// A camera that is turned by more than this from how it was expected got lost [deg].
    #[arg(long, value_name = "DEG", default_value_t = Self::default().most_turned_deg)]
    pub most_turned_deg: f64,
    /// What is drawn is drawn from this seed.
    #[arg(long, value_name = "N", default_value_t = Self::default().seed)]
    pub seed: u64,
}

/// What the motion from frame to frame is found by.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// Features: corners found again, and what most of them agree on.
    Visual,
    /// Features, then surfaces where the pictures agree better for it.
    VisualIcp,
    /// Surfaces laid over each other.
    Icp,
}

/// Why a camera cannot be followed at all.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum OdometryError {
    /// A number that means nothing.
    #[error("{option} is {value}; it must be {must}")]
    Option {
        /// The flag.
        option: &'static str,
        /// What was given.
        value: f64,
        /// What would do.
        must: &'static str,
    },
    /// The caller asked to stop.
    #[error(transparent)]
    Cancelled(#[from] crate::progress::Cancelled),
}

impl Default for OdometryOptions {
    fn default() -> Self {
        Self {
            method: Method::Visual,
            icp_voxel: None,
            key_overlap: 0.85,
            most_moved: 400.0,
            most_turned_deg: 30.0,
            seed: 1,
        }
    }
}

impl OdometryOptions {
    /// Refuses numbers that mean nothing.
    pub fn check(&self) -> Result<(), OdometryError> {
        let positive = "a number above 0";
        let is_positive = |x: f64| x > 0.0 && x.is_finite();
        for (option, value, must, is_good) in [
            (
                "--icp-voxel",
                self.icp_voxel.unwrap_or(1.0),
                positive,
                is_positive as fn(f64) -> bool,
            ),
            ("--most-moved", self.most_moved, positive, is_positive),
            ("--most-turned-deg", self.most_turned_deg, positive, is_positive),
            ("--key-overlap", self.key_overlap, "from 0 to 1", |x| (0.0..=1.0).contains(&x)),
        ] {
            if !is_good(value) {
                return Err(OdometryError::Option { option, value, must });
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_that_mean_nothing_are_refused_by_flag() {
        let good = OdometryOptions::default();
        good.check().unwrap();
        for (bad, name) in [
            (OdometryOptions { icp_voxel: Some(0.0), ..good.clone() }, "--icp-voxel is 0"),
            (OdometryOptions { most_moved: f64::NAN, ..good.clone() }, "--most-moved is NaN"),
            (OdometryOptions { most_turned_deg: -1.0, ..good.clone() }, "--most-turned-deg is -1"),
            (OdometryOptions { key_overlap: 1.5, ..good.clone() }, "--key-overlap is 1.5"),
        ] {
            let error = bad.check().unwrap_err().to_string();
            assert!(error.starts_with(name), "{error}");
        }
    }
}
