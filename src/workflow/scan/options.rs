//! How a scan is made.

use crate::geom::{OutlierFilter, VoxelError};
use crate::register::loops::LoopOptions;
use crate::register::odometry::{OdometryError, OdometryOptions};
use serde::{Deserialize, Serialize};

/// How a scan is made.
#[derive(Debug, Clone, Default, PartialEq, clap::Args, Serialize, Deserialize)]
#[serde(default, rename_all = "kebab-case")]
pub struct ScanOptions {
    /// Side of the cells of the cloud that become one point each [mm; default: 1/200 of the first
    /// frame's median depth].
    #[arg(long, value_name = "MM")]
    pub voxel: Option<f64>,
    /// How the camera is followed.
    #[command(flatten)]
    #[serde(flatten)]
    pub odometry: OdometryOptions,
    /// What of the cloud is left out.
    #[command(flatten)]
    #[serde(flatten)]
    pub filter: OutlierFilter,
    /// How loops are closed.
    #[command(flatten)]
    pub loops: LoopOptions,
}

impl ScanOptions {
    /// Voxels from the camera to what it sees in the median.
    pub(super) const VOXELS_DEEP: f64 = 200.0;

    /// Refuses numbers that mean nothing.
    pub fn check(&self) -> Result<(), OdometryError> {
        self.odometry.check()?;
        let is_positive = |value: &f64| *value > 0.0 && value.is_finite();
        let must = "a number above 0";
        for (option, value) in [
            ("--voxel", self.voxel),
            ("--outlier-sigma", Some(self.filter.outlier_sigma)),
            ("--outlier-radius", self.filter.outlier_radius),
        ] {
            if let Some(value) = value.filter(|value| !is_positive(value)) {
                return Err(OdometryError::Option { option, value, must });
            }
        }
        let n = self.filter.outlier_neighbours;
        if !(1..=1000).contains(&n) {
            let (option, value) = ("--outlier-neighbours", n as f64);
            let must = "a whole number from 1 to 1000";
            return Err(OdometryError::Option { option, value, must });
        }
        Ok(())
    }

    /// The side of a voxel, or why it is none.
    pub(super) fn side(voxel: f64) -> Result<f64, VoxelError> {
        let is_length = voxel > 0.0 && voxel.is_finite();
        if is_length { Ok(voxel) } else { Err(VoxelError::Side { side: voxel }) }
    }
}
