//! The stages of a registration, by the names the literature has for them.

use super::IcpError;
use clap::ValueEnum;
use serde::{Deserialize, Serialize};

/// How two clouds are laid over each other.
#[derive(Debug, Clone, PartialEq, clap::Args, Serialize, Deserialize)]
#[serde(default, rename_all = "kebab-case", deny_unknown_fields)]
pub struct IcpOptions {
    /// What is made small [default: coloured where both clouds have colours, else generalised].
    #[arg(long, value_name = "METRIC")]
    pub fine: Option<Metric>,
    /// Side of the cells that become one point each [mm; default: 1/200 of the smaller cloud's
    /// diagonal].
    #[arg(long, value_name = "MM")]
    pub voxel: Option<f64>,
    /// Points farther apart than this are no pair at the start [mm; default: 10 voxels].
    #[arg(long, value_name = "MM")]
    pub max_distance: Option<f64>,
    /// Points farther apart than this are no pair at the end [mm; default: 3 voxels].
    #[arg(long, value_name = "MM")]
    pub final_distance: Option<f64>,
    /// Steps from the first distance to the last; each takes four times the points of the one before.
    #[arg(long, value_name = "N", default_value_t = Self::default().levels)]
    pub levels: u32,
    /// Neighbours a normal is taken from.
    #[arg(long, value_name = "N", default_value_t = Self::default().neighbours)]
    pub neighbours: usize,
    /// Which points of the source look for a partner.
    #[arg(long, value_enum, default_value_t = Self::default().sampling)]
    pub sampling: Sampling,
    /// How many points `--sampling` takes, but for `all`.
    #[arg(long, value_name = "N", default_value_t = Self::default().samples)]
    pub samples: usize,
    /// How the partner is found.
    #[arg(long, value_enum, default_value_t = Self::default().pairing)]
    pub pairing: Pairing,
    /// Whose points look for a partner.
    #[arg(long, value_enum, default_value_t = Self::default().directions)]
    pub directions: Directions,
    /// Drop pairs longer than the mean by this many standard deviations (Masuda).
    #[arg(long, value_name = "K")]
    pub reject_sigma: Option<f64>,
    /// Drop this share of the pairs, the longest ones (Pulli) [percent].
    #[arg(long, value_name = "PERCENT")]
    pub reject_worst: Option<f64>,
    /// Drop pairs whose normals enclose more than this [deg].
    #[arg(long, value_name = "DEG")]
    pub reject_angle: Option<f64>,
    /// Let each target point have one partner, the nearest (Zhang).
    #[arg(long)]
    pub bi_unique: bool,
    /// Drop pairs whose target point lies on a border.
    #[arg(long)]
    pub reject_borders: bool,
    /// What a pair counts for.
    #[arg(long, value_enum, default_value_t = Self::default().weighting)]
    pub weighting: Weighting,
    /// How pairs that do not fit lose weight; its scale is the median absolute residual.
    #[arg(long, value_enum, default_value_t = Self::default().kernel)]
    pub kernel: Kernel,
    /// Iterations of a level at most.
    #[arg(long, value_name = "N", default_value_t = Self::default().iterations)]
    pub iterations: u32,
    /// Stop when a step turns less than this [deg].
    #[arg(long, value_name = "DEG", default_value_t = Self::default().rotation_eps_deg)]
    pub rotation_eps_deg: f64,
    /// Stop when a step also moves less than this [mm; default: a thousandth of a voxel].
    #[arg(long, value_name = "MM")]
    pub translation_eps: Option<f64>,
    /// What is drawn is drawn from this seed.
    #[arg(long, value_name = "N", default_value_t = Self::default().seed)]
    pub seed: u64,
}

/// What is made small.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Metric {
    /// From point to point. Besl and McKay (1992).
    PointToPoint,
    /// From point to tangent plane. Chen and Medioni (1991).
    PointToPlane,
    /// Along the mean of both normals. Rusinkiewicz (2019).
    Symmetric,
    /// From plane to plane, with a little of point to point. Segal et al. (2009).
    Generalised,
    /// Generalised, and the colour of the surface. After Park et al. (2017).
    Coloured,
}

/// Which points of the source look for a partner.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Sampling {
    /// All of them.
    All,
    /// Every n-th along a path that fills the cloud. Turk and Levoy (1994).
    Uniform,
    /// Drawn at random. Masuda et al. (1996).
    Random,
    /// As many of every direction of the normal. Rusinkiewicz and Levoy (2001).
    NormalSpace,
}

/// How the partner of a point is found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Pairing {
    /// The nearest point, by a kd-tree.
    KdTree,
    /// The nearest point in the cells around: no farther off than three voxels.
    VoxelMap,
    /// The nearest of what the other cloud's camera saw around the same pixel. Files of points have no
    /// camera: this is for frames.
    #[value(skip)]
    Projective,
}

/// Whose points look for a partner.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Directions {
    /// The source's.
    Source,
    /// Those of both: source and target may be swapped without another result.
    Both,
}

/// What a pair counts for, before the kernel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Weighting {
    /// All the same.
    Even,
    /// 1 at no distance, 0 at the greatest. Godin et al. (1994).
    Distance,
    /// The cosine between the normals.
    Normals,
    /// As sure as a depth camera in the source's origin is: noise grows with the square of the depth.
    SensorNoise,
}

/// How residuals that are too large lose weight.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kernel {
    /// Not at all.
    None,
    /// By their inverse.
    Huber,
    /// To nothing.
    Tukey,
    /// By their inverse square.
    Cauchy,
    /// By the fourth power of their inverse.
    GemanMcclure,
}

impl Default for IcpOptions {
    fn default() -> Self {
        Self {
            fine: None,
            voxel: None,
            max_distance: None,
            final_distance: None,
            levels: 3,
            neighbours: 20,
            sampling: Sampling::All,
            samples: 5000,
            pairing: Pairing::KdTree,
            directions: Directions::Both,
            reject_sigma: None,
            reject_worst: None,
            reject_angle: None,
            bi_unique: false,
            reject_borders: false,
            weighting: Weighting::Even,
            kernel: Kernel::None,
            iterations: 60,
            rotation_eps_deg: 0.005,
            translation_eps: None,
            seed: 1,
        }
    }
}

impl IcpOptions {
    /// Refuses numbers that mean nothing.
    pub fn check(&self) -> Result<(), IcpError> {
        let is_length = |x: f64| x > 0.0 && x.is_finite();
        let positive = [
            ("--voxel", self.voxel),
            ("--max-distance", self.max_distance),
            ("--final-distance", self.final_distance),
            ("--reject-sigma", self.reject_sigma),
            ("--translation-eps", self.translation_eps),
            ("--rotation-eps-deg", Some(self.rotation_eps_deg)),
        ];
        for (option, value) in positive {
            require(option, value, "a number above 0", is_length)?;
        }
        require("--reject-worst", self.reject_worst, "0 or more, and below 100", |x| {
            (0.0..100.0).contains(&x)
        })?;
        require("--reject-angle", self.reject_angle, "above 0, and at most 180", |x| {
            x > 0.0 && x <= 180.0
        })?;
        let counts = [
            ("--levels", f64::from(self.levels), 1.0, 10.0),
            ("--neighbours", self.neighbours as f64, 3.0, 1000.0),
            ("--samples", self.samples as f64, 6.0, f64::from(u32::MAX)),
            ("--iterations", f64::from(self.iterations), 1.0, 1e6),
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

fn require(
    option: &'static str,
    value: Option<f64>,
    must: &str,
    is_good: impl Fn(f64) -> bool,
) -> Result<(), IcpError> {
    match value {
        Some(value) if !is_good(value) => {
            Err(IcpError::Option { option, value, must: must.to_owned() })
        }
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_that_mean_nothing_are_refused_by_name() {
        let good = IcpOptions::default();
        assert!(good.check().is_ok());
        for (bad, name) in [
            (IcpOptions { voxel: Some(0.0), ..good.clone() }, "--voxel"),
            (IcpOptions { max_distance: Some(f64::NAN), ..good.clone() }, "--max-distance"),
            (IcpOptions { final_distance: Some(-1.0), ..good.clone() }, "--final-distance"),
            (IcpOptions { reject_worst: Some(100.0), ..good.clone() }, "--reject-worst"),
            (IcpOptions { reject_angle: Some(0.0), ..good.clone() }, "--reject-angle"),
            (IcpOptions { reject_sigma: Some(0.0), ..good.clone() }, "--reject-sigma"),
            (IcpOptions { levels: 0, ..good.clone() }, "--levels"),
            (IcpOptions { neighbours: 2, ..good.clone() }, "--neighbours"),
            (IcpOptions { samples: 5, ..good.clone() }, "--samples"),
            (IcpOptions { iterations: 0, ..good.clone() }, "--iterations"),
            (IcpOptions { rotation_eps_deg: 0.0, ..good.clone() }, "--rotation-eps-deg"),
        ] {
            let error = bad.check().unwrap_err().to_string();
            assert!(error.starts_with(name), "{error}");
        }
    }
}
