//! How a camera is followed.

use crate::register::dense::{DenseError, DenseOptions};
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
    /// Another key frame is taken when less than this share of what the last one shows is seen.
    #[arg(long, value_name = "SHARE", default_value_t = Self::default().key_overlap)]
    pub key_overlap: f64,
    /// Another key frame is taken when a pose is known less well than the first one after the key
    /// frame by this factor, on the mean over its six directions [default: 1.3 with dvo and rgbd-icp,
    /// else 4].
    #[arg(long, value_name = "FACTOR")]
    pub key_factor: Option<f64>,
    /// A camera that is farther than this from where it was expected got lost [mm].
    #[arg(long, value_name = "MM", default_value_t = Self::default().most_moved)]
    pub most_moved: f64,
    /// A camera that is turned by more than this from how it was expected got lost [deg].
    #[arg(long, value_name = "DEG", default_value_t = Self::default().most_turned_deg)]
    pub most_turned_deg: f64,
    /// What is drawn is drawn from this seed.
    #[arg(long, value_name = "N", default_value_t = Self::default().seed)]
    pub seed: u64,
    /// How pictures are laid over each other by all they show.
    #[command(flatten)]
    pub dense: DenseOptions,
}

/// What the motion from frame to frame is found by.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// All that pictures show: brightness and depth of every surface.
    Dvo,
    /// Features: corners found again, and what most of them agree on.
    Visual,
    /// Features, then surfaces where the pictures agree better for it.
    VisualIcp,
    /// Features and surfaces, made small at once (RGBD-ICP).
    RgbdIcp,
    /// Surfaces laid over each other.
    Icp,
    /// Surfaces laid over a model of all before, which becomes a mesh (Kinect Fusion).
    Kinfu,
}

/// Why a camera cannot be followed at all.
#[derive(Debug, thiserror::Error)]
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
    /// Pictures cannot be laid over each other like that.
    #[error(transparent)]
    Dense(#[from] DenseError),
    /// What places frames over a model lays none over another.
    #[error(
        "kinfu lays frames over a model of all before, and not over each other: use `workflow::fuse`"
    )]
    Model,
    /// The caller asked to stop.
    #[error(transparent)]
    Cancelled(#[from] crate::progress::Cancelled),
}

impl Default for OdometryOptions {
    fn default() -> Self {
        Self {
            method: Method::Dvo,
            icp_voxel: None,
            key_overlap: 0.6,
            key_factor: None,
            most_moved: 400.0,
            most_turned_deg: 30.0,
            seed: 1,
            dense: DenseOptions::default(),
        }
    }
}

impl OdometryOptions {
    /// By what a pose is known less well when another key frame is taken.
    ///
    /// How many features agree changes from frame to frame, and what is known with it; what all pixels
    /// know, or features and surfaces together, wears off steadily.
    pub fn key_factor(&self) -> f64 {
        let is_steady = matches!(self.method, Method::Dvo | Method::RgbdIcp);
        self.key_factor.unwrap_or(if is_steady { 1.3 } else { 4.0 })
    }

    /// Refuses numbers that mean nothing.
    pub fn check(&self) -> Result<(), OdometryError> {
        if self.method == Method::Kinfu {
            return Err(OdometryError::Model);
        }
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
            ("--key-factor", self.key_factor(), "a number above 1", |x| x > 1.0 && x.is_finite()),
            ("--key-overlap", self.key_overlap, "from 0 to 1", |x| (0.0..=1.0).contains(&x)),
        ] {
            if !is_good(value) {
                return Err(OdometryError::Option { option, value, must });
            }
        }
        Ok(self.dense.check()?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_that_mean_nothing_are_refused_by_flag() {
        let good = OdometryOptions::default();
        good.check().unwrap();
        let model = OdometryOptions { method: Method::Kinfu, ..good.clone() };
        assert!(matches!(model.check(), Err(OdometryError::Model)));
        for (bad, name) in [
            (OdometryOptions { icp_voxel: Some(0.0), ..good.clone() }, "--icp-voxel is 0"),
            (OdometryOptions { most_moved: f64::NAN, ..good.clone() }, "--most-moved is NaN"),
            (OdometryOptions { most_turned_deg: -1.0, ..good.clone() }, "--most-turned-deg is -1"),
            (OdometryOptions { key_overlap: 1.5, ..good.clone() }, "--key-overlap is 1.5"),
            (OdometryOptions { key_factor: Some(1.0), ..good.clone() }, "--key-factor is 1"),
            (
                OdometryOptions {
                    dense: DenseOptions { levels: 0, ..DenseOptions::default() },
                    ..good.clone()
                },
                "--dense-levels is 0",
            ),
        ] {
            let error = bad.check().unwrap_err().to_string();
            assert!(error.starts_with(name), "{error}");
        }
    }
}
