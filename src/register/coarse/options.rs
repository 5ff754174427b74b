//! Where a registration begins when nobody knows.

use crate::register::icp::IcpError;
use clap::ValueEnum;
use serde::{Deserialize, Serialize};

/// How the start of a registration is found.
#[derive(Debug, Clone, PartialEq, clap::Args, Serialize, Deserialize)]
#[serde(default, rename_all = "kebab-case", deny_unknown_fields)]
pub struct CoarseOptions {
    /// How a start is found [default: none with --init, else auto].
    #[arg(long, value_name = "METHOD")]
    pub coarse: Option<Coarse>,
    /// Side of the cells that are described [mm; default: 1/60 of the smaller cloud's diagonal].
    #[arg(long, value_name = "MM")]
    pub feature_voxel: Option<f64>,
    /// How far a description looks [mm; default: 5 of its voxels].
    #[arg(long, value_name = "MM")]
    pub feature_radius: Option<f64>,
    /// Starts that are tried out on the surfaces, of each method.
    #[arg(long, value_name = "N", default_value_t = Self::default().hypotheses)]
    pub hypotheses: usize,
    /// Triangles that `fpfh-ransac` draws at most.
    #[arg(long, value_name = "N", default_value_t = Self::default().draws)]
    pub draws: u64,
}

/// How the start of a registration is found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Coarse {
    /// Not at all: it begins where --init or the files say.
    None,
    /// Surroundings that look alike, and three of them drawn. Rusu et al. (2009).
    FpfhRansac,
    /// Surroundings that look alike, consistent groups of them, and graduated non-convexity. Yang et
    /// al. (2020).
    FpfhGnc,
    /// Planes laid on planes: for rooms, fixtures and boxes. After Pathak et al. (2010).
    Planes,
    /// The principal axes: for scans that show the body all around.
    Axes,
    /// From where the files have it, and by all others; what lies best on each other wins.
    Auto,
}

impl Default for CoarseOptions {
    fn default() -> Self {
        Self {
            coarse: None,
            feature_voxel: None,
            feature_radius: None,
            hypotheses: 8,
            draws: 100_000,
        }
    }
}

impl CoarseOptions {
    /// The method, given whether somebody says where to begin.
    pub fn method(&self, has_start: bool) -> Coarse {
        self.coarse.unwrap_or(if has_start { Coarse::None } else { Coarse::Auto })
    }

    /// Refuses numbers that mean nothing.
    pub fn check(&self) -> Result<(), IcpError> {
        let lengths =
            [("--feature-voxel", self.feature_voxel), ("--feature-radius", self.feature_radius)];
        for (option, value) in lengths {
            if let Some(value) = value.filter(|x| !(*x > 0.0 && x.is_finite())) {
                return Err(IcpError::Option {
                    option,
                    value,
                    must: "a number above 0".to_owned(),
                });
            }
        }
        let counts = [
            ("--hypotheses", self.hypotheses as f64, 1.0, 100.0),
            ("--draws", self.draws as f64, 1.0, 1e9),
        ];
        for (option, value, least, most) in counts {
            if !(least..=most).contains(&value) {
                let must = format!("a whole number from {least} to {most}");
                return Err(IcpError::Option { option, value, must });
            }
        }
        Ok(())
    }
}

impl Coarse {
    /// True if points are described for it.
    pub(super) fn needs_features(self) -> bool {
        matches!(self, Self::FpfhRansac | Self::FpfhGnc | Self::Auto)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_given_start_is_believed_and_else_one_is_looked_for() {
        let mut options = CoarseOptions::default();
        assert_eq!([true, false].map(|is| options.method(is)), [Coarse::None, Coarse::Auto]);
        options.coarse = Some(Coarse::Axes);
        assert_eq!([true, false].map(|is| options.method(is)), [Coarse::Axes; 2]);
    }

    #[test]
    fn numbers_that_mean_nothing_are_refused_by_name() {
        let good = CoarseOptions::default();
        assert!(good.check().is_ok());
        for (bad, name) in [
            (CoarseOptions { feature_voxel: Some(0.0), ..good.clone() }, "--feature-voxel"),
            (CoarseOptions { feature_radius: Some(f64::NAN), ..good.clone() }, "--feature-radius"),
            (CoarseOptions { hypotheses: 0, ..good.clone() }, "--hypotheses"),
            (CoarseOptions { draws: 0, ..good.clone() }, "--draws"),
        ] {
            let error = bad.check().unwrap_err().to_string();
            assert!(error.starts_with(name), "{error}");
        }
    }
}
