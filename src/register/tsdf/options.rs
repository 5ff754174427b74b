//! How frames are fused and placed, as flags and file keys.

use super::TsdfError;
use crate::rgbd::filter::BilateralOptions;

/// How a [`Volume`](super::Volume) is made.
#[derive(Debug, Clone, PartialEq, clap::Args, serde::Serialize, serde::Deserialize)]
#[serde(default, rename_all = "kebab-case", deny_unknown_fields)]
pub struct TsdfOptions {
    /// Side of a voxel [mm]; about what a pixel covers.
    #[arg(long, value_name = "MM", default_value_t = Self::default().voxel)]
    pub voxel: f64,
    /// Distances from the surface are kept up to this [mm; default: 4 voxels]. It must outreach the noise,
    /// and parts thinner than it come out wrong.
    #[arg(long, value_name = "MM")]
    pub truncation: Option<f64>,
    /// What a reading counts for, besides how squarely it was taken.
    #[arg(long, value_enum, default_value_t = Self::default().weight)]
    pub weight: TsdfWeight,
    /// Readings farther away are left out [mm].
    #[arg(long, value_name = "MM", default_value_t = Self::default().max_depth)]
    pub max_depth: f64,
    /// What the model may take [MB].
    #[arg(long, value_name = "MB", default_value_t = Self::default().memory)]
    pub memory: usize,
}

/// What a reading counts for.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize, clap::ValueEnum,
)]
#[serde(rename_all = "kebab-case")]
pub enum TsdfWeight {
    /// As much as any other.
    Constant,
    /// The less the farther, by 1/z^2: triangulating sensors are off by z^2.
    InverseSquare,
}

impl Default for TsdfOptions {
    fn default() -> Self {
        Self {
            voxel: 5.0,
            truncation: None,
            weight: TsdfWeight::InverseSquare,
            max_depth: 4000.0,
            memory: 2048,
        }
    }
}

impl TsdfOptions {
    /// Refuses numbers that mean nothing.
    pub fn check(&self) -> Result<(), TsdfError> {
        let lengths = [
            ("--voxel", self.voxel),
            ("--truncation", self.truncation()),
            ("--max-depth", self.max_depth),
        ];
        for (option, value) in lengths {
            require(option, value, value > 0.0 && value.is_finite(), "a length above 0")?;
        }
        let truncation = self.truncation();
        require(
            "--truncation",
            truncation,
            (2.0 * self.voxel..=64.0 * self.voxel).contains(&truncation),
            "from 2 to 64 voxels",
        )?;
        let is_size = (1..=1 << 20).contains(&self.memory);
        require("--memory", self.memory as f64, is_size, "from 1 to 1048576 MB")
    }

    /// Up to where distances are kept [mm].
    pub fn truncation(&self) -> f64 {
        self.truncation.unwrap_or(4.0 * self.voxel)
    }
}

/// How a [`Tracker`](super::Tracker) places frames.
#[derive(Debug, Clone, PartialEq, clap::Args, serde::Serialize, serde::Deserialize)]
#[serde(default, rename_all = "kebab-case", deny_unknown_fields)]
pub struct TrackOptions {
    /// Pictures of half the size, one after the other, that tracking goes through from coarse to fine.
    #[arg(long, value_name = "N", default_value_t = Self::default().levels)]
    pub levels: usize,
    /// Steps at each of them at most.
    #[arg(long, value_name = "N", default_value_t = Self::default().iterations)]
    pub iterations: usize,
    /// Points farther from the model are no pair at the coarsest level; half of it at the next [mm].
    #[arg(long, value_name = "MM", default_value_t = Self::default().max_distance)]
    pub max_distance: f64,
    /// Normals that enclose more are no pair [deg].
    #[arg(long, value_name = "DEG", default_value_t = Self::default().max_angle_deg)]
    pub max_angle_deg: f64,
    /// A frame of which a smaller share lies on the model is lost.
    #[arg(long, value_name = "SHARE", default_value_t = Self::default().least_overlap)]
    pub least_overlap: f64,
    /// From frame to frame a camera moves no farther [mm].
    #[arg(long, value_name = "MM", default_value_t = Self::default().most_moved)]
    pub most_moved: f64,
    /// From frame to frame a camera turns no farther [deg].
    #[arg(long, value_name = "DEG", default_value_t = Self::default().most_turned_deg)]
    pub most_turned_deg: f64,
    /// How depth is smoothed for tracking; what is fused is not.
    #[command(flatten)]
    pub smooth: BilateralOptions,
}

impl Default for TrackOptions {
    fn default() -> Self {
        Self {
            levels: 3,
            iterations: 10,
            max_distance: 100.0,
            max_angle_deg: 40.0,
            least_overlap: 0.3,
            most_moved: 150.0,
            most_turned_deg: 15.0,
            smooth: BilateralOptions::default(),
        }
    }
}

impl TrackOptions {
    /// Refuses numbers that mean nothing.
    pub fn check(&self) -> Result<(), TsdfError> {
        let levels = (1..=6).contains(&self.levels);
        require("--levels", self.levels as f64, levels, "from 1 to 6")?;
        let iterations = (1..=1000).contains(&self.iterations);
        require("--iterations", self.iterations as f64, iterations, "from 1 to 1000")?;
        let positive = [
            ("--max-distance", self.max_distance),
            ("--most-moved", self.most_moved),
            ("--most-turned-deg", self.most_turned_deg),
            ("--smooth-px", self.smooth.smooth_px),
            ("--smooth-depth", self.smooth.smooth_depth),
        ];
        for (option, value) in positive {
            require(option, value, value > 0.0 && value.is_finite(), "a number above 0")?;
        }
        let angle = self.max_angle_deg;
        require("--max-angle-deg", angle, angle > 0.0 && angle <= 90.0, "above 0, at most 90")?;
        let share = self.least_overlap;
        require("--least-overlap", share, (0.0..=1.0).contains(&share), "from 0 to 1")
    }
}

fn require(
    option: &'static str,
    value: f64,
    holds: bool,
    must: &'static str,
) -> Result<(), TsdfError> {
    if holds { Ok(()) } else { Err(TsdfError::Option { option, value, must }) }
}
