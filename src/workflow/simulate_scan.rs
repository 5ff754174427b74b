//! From a mesh or a built-in scene to what a depth camera sees of it.

use crate::geom::TriMesh;
use crate::rgbd::simulated::{
    BuiltinScene, PathKind, Scene, SimulatedError, SimulatedSensor, SimulationOptions, Texture,
    TextureKind,
};
use crate::rgbd::{Camera, CameraTrajectory};

/// Where a camera stands before a part, and before a scene [mm].
const BEFORE_A_PART: f64 = 800.0;
const BEFORE_A_SCENE: f64 = 1500.0;
/// Patches on a part [mm]: a few across the foot of a last.
const PATCH_ON_A_PART: f64 = 10.0;

/// What is scanned.
#[derive(Debug, Clone, PartialEq)]
pub enum Subject {
    /// A mesh [mm].
    Mesh(TriMesh),
    /// A scene of our own.
    Scene(BuiltinScene),
}

/// What a simulated scan is made from.
#[derive(Debug)]
pub struct SimulateScanJob<'a> {
    /// What is scanned.
    pub subject: Subject,
    /// What scans it.
    pub camera: Camera,
    /// The way of the camera, if it is given.
    pub along: Option<CameraTrajectory>,
    /// How it is scanned.
    pub options: &'a SimulationOptions,
}

/// A scan about to be simulated: [`SimulatedScan::frames`] makes it, one frame after the other.
#[derive(Debug, Clone, PartialEq)]
pub struct SimulatedScan {
    /// What is seen.
    pub scene: Scene,
    /// What sees it.
    pub sensor: SimulatedSensor,
    /// From where.
    pub truth: CameraTrajectory,
}

/// Sets the scene and the way of the camera.
pub fn simulate_scan(job: SimulateScanJob) -> Result<SimulatedScan, SimulatedError> {
    let SimulateScanJob { subject, camera, along, options } = job;
    options.check()?;
    camera.check()?;
    if !camera.distortion.is_none() {
        return Err(SimulatedError::Distorted);
    }
    let (mut scene, usual) = match subject {
        Subject::Scene(scene) => (scene.build(), (PathKind::Arc, BEFORE_A_SCENE)),
        Subject::Mesh(mesh) => {
            let has_colors = mesh.colors.is_some();
            let kind = if has_colors { TextureKind::Vertices } else { TextureKind::Patches };
            let texture = Texture { kind, size: PATCH_ON_A_PART, seed: 0 };
            (Scene::new(mesh, texture), (PathKind::Turntable, BEFORE_A_PART))
        }
    };
    scene.texture = options.texture(scene.texture);
    let truth = match along {
        Some(along) if scene.mesh.triangles.is_empty() || along.poses().is_empty() => {
            return Err(SimulatedError::NoTriangles);
        }
        Some(along) => along,
        None => options.trajectory(&scene, usual)?,
    };
    let sensor = SimulatedSensor { camera, noise: options.noise() };
    Ok(SimulatedScan { scene, sensor, truth })
}

impl SimulatedScan {
    /// The frames, each made when it is asked for.
    pub fn frames(&self) -> impl ExactSizeIterator<Item = crate::rgbd::RgbdFrame> + '_ {
        self.sensor.frames(&self.scene, &self.truth)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::{Point3, shapes};

    fn job(subject: Subject, options: &SimulationOptions) -> SimulateScanJob<'_> {
        SimulateScanJob { subject, camera: Camera::KINECT, along: None, options }
    }

    #[test]
    fn a_part_stands_on_a_turntable_and_a_scene_is_walked_before() {
        let options = SimulationOptions { views: 10, ..SimulationOptions::default() };
        let ball = shapes::sphere(&Point3::origin(), 100.0, 9);
        let part = simulate_scan(job(Subject::Mesh(ball.clone()), &options)).unwrap();
        assert_eq!(part.truth.poses().len(), 20);
        assert_eq!(part.scene.texture.kind, TextureKind::Patches);
        assert_eq!(part.frames().len(), 20);
        let colored = TriMesh { colors: Some(vec![[9; 3]; ball.points.len()]), ..ball };
        let part = simulate_scan(job(Subject::Mesh(colored), &options)).unwrap();
        assert_eq!(part.scene.texture.kind, TextureKind::Vertices);
        let scene = Subject::Scene(BuiltinScene::PlainFlat);
        let scan = simulate_scan(job(scene.clone(), &options)).unwrap();
        assert_eq!((scan.truth.poses().len(), scan.scene.texture.kind), (10, TextureKind::Plain));
        let options = SimulationOptions { texture: Some(TextureKind::Patches), ..options };
        let scan = simulate_scan(job(scene, &options)).unwrap();
        assert_eq!(scan.scene.texture.kind, TextureKind::Patches);
    }

    #[test]
    fn a_given_way_is_gone_and_a_lens_that_distorts_is_refused() {
        let options = SimulationOptions::default();
        let scene = || Subject::Scene(BuiltinScene::TexturedFlat);
        let way = simulate_scan(job(scene(), &options)).unwrap().truth;
        let along = Some(CameraTrajectory::new(way.poses()[3..7].to_vec()).unwrap());
        let scan = simulate_scan(SimulateScanJob { along, ..job(scene(), &options) }).unwrap();
        assert_eq!(scan.truth.poses(), &way.poses()[3..7]);
        let camera = Camera::FREIBURG1;
        let distorted = simulate_scan(SimulateScanJob { camera, ..job(scene(), &options) });
        assert_eq!(distorted.unwrap_err(), SimulatedError::Distorted);
    }
}
