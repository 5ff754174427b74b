//! How a scan is simulated, as flags and file keys.

use super::path::is_elevation;
use super::{Noise, NoiseKind, Orbit, Scene, Texture, TextureKind};
use crate::geom::{Aabb, Vector3};
use crate::rgbd::{CameraTrajectory, RgbdError};

/// How a simulated camera goes around a scene, and how well it measures.
#[derive(Debug, Clone, PartialEq, clap::Args, serde::Serialize, serde::Deserialize)]
#[serde(default, rename_all = "kebab-case", deny_unknown_fields)]
pub struct SimulationOptions {
    /// Where the camera goes [default: around a mesh on a turntable, in a hand before a scene].
    #[arg(long, value_name = "PATH")]
    pub path: Option<PathKind>,
    /// Views of one turn of the table, or of the whole arc.
    #[arg(long, value_name = "N", default_value_t = Self::default().views)]
    pub views: usize,
    /// Heights of the camera above the middle, one turn of the table for each [deg].
    #[arg(
        long,
        value_name = "DEG,DEG",
        value_delimiter = ',',
        allow_hyphen_values = true,
        default_values_t = Self::default().elevations
    )]
    pub elevations: Vec<f64>,
    /// From the camera to the middle [mm] [default: 800, before a scene 1500].
    #[arg(long, value_name = "MM")]
    pub distance: Option<f64>,
    /// How far the arc reaches [deg].
    #[arg(long, value_name = "DEG", default_value_t = Self::default().span)]
    pub span: f64,
    /// What the camera goes around.
    #[arg(long, value_name = "AXIS", value_enum, default_value_t = Self::default().axis)]
    pub axis: Axis,
    /// What the surface is painted with [default: the colours of a mesh's vertices, else patches; a
    /// scene's own].
    #[arg(long, value_name = "TEXTURE")]
    pub texture: Option<TextureKind>,
    /// Size of the patches [mm] [default: 10, on a scene 40].
    #[arg(long, value_name = "MM")]
    pub texture_size: Option<f64>,
    /// How depth is off.
    #[arg(long, value_name = "NOISE", value_enum, default_value_t = Self::default().noise)]
    pub noise: NoiseKind,
    /// Standard deviation of the noise at a depth of 0.8 m [mm].
    #[arg(long, value_name = "MM", default_value_t = Self::default().sigma)]
    pub sigma: f64,
    /// Another seed gives other noise, sway and patches.
    #[arg(long, value_name = "N", default_value_t = Self::default().seed)]
    pub seed: u64,
}

/// Where a simulated camera goes.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize, clap::ValueEnum,
)]
#[serde(rename_all = "kebab-case")]
pub enum PathKind {
    /// Around, once for each elevation.
    Turntable,
    /// In a hand, along an arc.
    Arc,
}

/// An axis of the world.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize, clap::ValueEnum,
)]
#[serde(rename_all = "kebab-case")]
pub enum Axis {
    /// Along a last.
    X,
    /// Across.
    Y,
    /// Up.
    Z,
}

/// Why a scan cannot be simulated.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SimulatedError {
    /// An option out of range.
    #[error("--{key} is {value}: it must be {rule}")]
    Option {
        /// The flag.
        key: &'static str,
        /// What was given.
        value: f64,
        /// What it must be.
        rule: &'static str,
    },
    /// Nothing to look at.
    #[error("there are no triangles to look at; give a mesh or one of the scenes")]
    NoTriangles,
    /// The camera would stand in the scene.
    #[error(
        "the part reaches {reach:.0} mm from its middle, but the camera goes around it at {distance} mm; \
         let it stand farther away (--distance)"
    )]
    TooClose {
        /// From the middle to the farthest corner [mm].
        reach: f64,
        /// The distance asked for [mm].
        distance: f64,
    },
    /// The camera's lens is not perfect.
    #[error(
        "a simulated camera has a perfect lens; leave [distortion] out of its description (the pictures \
         would be those of an undistorted sequence)"
    )]
    Distorted,
    /// The camera or the path cannot be.
    #[error(transparent)]
    Rgbd(#[from] RgbdError),
}

impl Default for SimulationOptions {
    fn default() -> Self {
        Self {
            path: None,
            views: 72,
            elevations: vec![35.0, -35.0],
            distance: None,
            span: 40.0,
            axis: Axis::Z,
            texture: None,
            texture_size: None,
            noise: NoiseKind::None,
            sigma: 1.0,
            seed: 1,
        }
    }
}

impl SimulationOptions {
    /// More frames are no scan.
    const MOST_FRAMES: usize = 100_000;

    /// Refuses options that are no scan.
    pub fn check(&self) -> Result<(), SimulatedError> {
        let refuse = |key, value, rule| Err(SimulatedError::Option { key, value, rule });
        if !(2..=Self::MOST_FRAMES).contains(&self.views) {
            return refuse("views", self.views as f64, "from 2 to 100000");
        }
        if !(1..=100).contains(&self.elevations.len()) {
            return refuse("elevations", self.elevations.len() as f64, "1 to 100 angles");
        }
        if let Some(&bad) = self.elevations.iter().find(|deg| !is_elevation(deg.to_radians())) {
            return refuse("elevations", bad, "between -90 and 90 degrees");
        }
        let rules = [
            ("distance", self.distance.unwrap_or(1.0), 1.0..=1e6, "from 1 mm to 1 km"),
            ("span", self.span, 0.0..=360.0, "from 0 to 360 degrees"),
            ("texture-size", self.texture_size.unwrap_or(1.0), 0.1..=1e5, "from 0.1 mm to 100 m"),
            ("sigma", self.sigma, 0.0..=1e3, "from 0 to 1000 mm"),
        ];
        for (key, value, range, rule) in rules {
            if !range.contains(&value) {
                return refuse(key, value, rule);
            }
        }
        Ok(())
    }

    /// The noise asked for.
    pub fn noise(&self) -> Noise {
        Noise { kind: self.noise, sigma: self.sigma, seed: self.seed }
    }

    /// `usual`, or the texture asked for instead.
    pub fn texture(&self, usual: Texture) -> Texture {
        Texture {
            kind: self.texture.unwrap_or(usual.kind),
            size: self.texture_size.unwrap_or(usual.size),
            seed: self.seed,
        }
    }

    /// The path of the camera around `scene`; the `usual` one at the usual distance [mm] unless others
    /// were asked for.
    pub fn trajectory(
        &self,
        scene: &Scene,
        usual: (PathKind, f64),
    ) -> Result<CameraTrajectory, SimulatedError> {
        self.check()?;
        let corners = scene.mesh.triangles.as_flattened().iter();
        let aabb = Aabb::around(corners.map(|&i| &scene.mesh.points[i as usize]));
        if aabb.is_empty() {
            return Err(SimulatedError::NoTriangles);
        }
        let (center, reach) = (aabb.center(), aabb.size().norm() / 2.0);
        let axis = match self.axis {
            Axis::X => Vector3::x(),
            Axis::Y => Vector3::y(),
            Axis::Z => Vector3::z(),
        };
        let path = self.path.unwrap_or(usual.0);
        let orbit = Orbit { center, axis, distance: self.distance.unwrap_or(usual.1) };
        let poses = match path {
            PathKind::Turntable => {
                if orbit.distance <= reach {
                    return Err(SimulatedError::TooClose { reach, distance: orbit.distance });
                }
                let elevations: Vec<f64> =
                    self.elevations.iter().map(|deg| deg.to_radians()).collect();
                orbit.turntable(self.views, &elevations)
            }
            PathKind::Arc => orbit.hand_held(self.views, self.span.to_radians(), self.seed),
        };
        Ok(CameraTrajectory::new(poses)?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::{Point3, TriMesh, shapes};

    const TABLE: (PathKind, f64) = (PathKind::Turntable, 800.0);
    const HAND: (PathKind, f64) = (PathKind::Arc, 1500.0);

    fn ball() -> Scene {
        Scene::new(shapes::sphere(&Point3::origin(), 100.0, 8), Texture::default())
    }

    #[test]
    fn options_that_are_no_scan_are_told_by_their_flag() {
        let good = SimulationOptions::default();
        good.check().unwrap();
        for (options, message) in [
            (SimulationOptions { views: 1, ..good.clone() }, "--views is 1: it must be from 2"),
            (SimulationOptions { distance: Some(f64::NAN), ..good.clone() }, "--distance is NaN"),
            (SimulationOptions { sigma: -1.0, ..good.clone() }, "--sigma is -1"),
            (SimulationOptions { elevations: vec![90.0], ..good.clone() }, "--elevations is 90"),
            (
                SimulationOptions { elevations: vec![], ..good.clone() },
                "--elevations is 0: it must be 1",
            ),
        ] {
            let error = options.check().unwrap_err().to_string();
            assert!(error.starts_with(message), "{error}");
        }
        let close = SimulationOptions { distance: Some(150.0), ..good.clone() };
        let error = close.trajectory(&ball(), TABLE).unwrap_err().to_string();
        assert!(error.starts_with("the part reaches 1"), "{error}");
        let nothing = Scene::new(TriMesh::default(), Texture::default());
        assert!(matches!(good.trajectory(&nothing, HAND), Err(SimulatedError::NoTriangles)));
    }

    #[test]
    fn a_path_that_is_not_asked_for_is_the_usual_one() {
        let options = SimulationOptions { views: 5, ..SimulationOptions::default() };
        let n = |options: &SimulationOptions, usual| {
            options.trajectory(&ball(), usual).unwrap().poses().len()
        };
        assert_eq!(n(&options, TABLE), 10);
        assert_eq!(n(&options, HAND), 5);
        let asked = SimulationOptions { path: Some(PathKind::Arc), ..options };
        assert_eq!(n(&asked, TABLE), 5);
    }
}
