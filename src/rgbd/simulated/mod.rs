//! A depth camera that looks at a mesh: frames with exact truth, and noise as sensors have it.
//!
//! The thesis used *Blensor* for this. Frames are drawn by filling triangles into a depth buffer, not by
//! casting rays: every pixel of a picture is asked for, so the triangles' order in space needs no tree,
//! and a triangle meets a pixel by the very test that a ray would make. The same scene, path and seed
//! give the same bytes, for any number of threads.

mod noise;
mod options;
mod path;
mod raster;
mod scene;
mod texture;

pub use noise::{Noise, NoiseKind};
pub use options::{Axis, PathKind, SimulatedError, SimulationOptions};
pub use path::Orbit;
pub use scene::{BuiltinScene, Scene};
pub use texture::{Texture, TextureKind};

use super::{Camera, CameraTrajectory, RgbdFrame, StampedPose};
use crate::geom::{Matrix3, Point3, Pose, Vector3};

/// A camera with its noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SimulatedSensor {
    /// Where points appear; its lens must be perfect.
    pub camera: Camera,
    /// What it adds to depth.
    pub noise: Noise,
}

impl SimulatedSensor {
    /// What the camera sees of `scene` from `pose`: depth without noise.
    ///
    /// The same for any number of threads.
    pub fn expose_exactly(&self, scene: &Scene, pose: &StampedPose) -> RgbdFrame {
        let seen = raster::look(&scene.mesh, &self.camera, &pose.world_from_camera.inverse());
        let color = scene.paint(&seen, &self.camera, &pose.world_from_camera);
        let depth = seen.map(|seen| seen.depth);
        RgbdFrame { stamp: pose.stamp, color: Some(color), depth, confidence: None }
    }

    /// The same with noise; `number` tells the draws of one frame from those of another.
    pub fn expose(&self, scene: &Scene, pose: &StampedPose, number: usize) -> RgbdFrame {
        let exact = self.expose_exactly(scene, pose);
        let depth = self.noise.added_to(&exact.depth, number);
        RgbdFrame { depth, ..exact }
    }

    /// One frame for each pose of `truth`, made when it is asked for.
    pub fn frames<'a>(
        &'a self,
        scene: &'a Scene,
        truth: &'a CameraTrajectory,
    ) -> impl ExactSizeIterator<Item = RgbdFrame> + 'a {
        let poses = truth.poses().iter().enumerate();
        poses.map(|(number, pose)| self.expose(scene, pose, number))
    }
}

/// The pose of a camera at `eye` that looks at `target`, with `up` up in the picture.
fn looking_at(eye: &Point3, target: &Point3, up: &Vector3) -> Pose {
    let forward = (target - eye).normalize();
    // Straight up or down there is no telling what is up; any direction will do.
    let right = forward.cross(up).try_normalize(1e-9).unwrap_or_else(|| {
        forward.cross(&Vector3::y()).try_normalize(1e-9).unwrap_or(Vector3::x())
    });
    let down = forward.cross(&right);
    let axes = Matrix3::from_columns(&[right, down, forward]);
    let rotation = nalgebra::Rotation3::from_matrix_unchecked(axes);
    Pose::from_parts(eye.coords.into(), nalgebra::UnitQuaternion::from_rotation_matrix(&rotation))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::{Aabb, TriMesh, shapes};
    use crate::rgbd::NormalOptions;

    fn camera() -> Camera {
        Camera::pinhole([160, 120], [131.0, 131.0], [79.5, 59.5])
    }

    fn sensor() -> SimulatedSensor {
        SimulatedSensor { camera: camera(), noise: Noise::default() }
    }

    fn from(eye: Point3, target: Point3) -> StampedPose {
        StampedPose { stamp: 0.0, world_from_camera: looking_at(&eye, &target, &Vector3::z()) }
    }

    #[test]
    fn a_camera_looks_at_its_target_with_up_up() {
        let eye = Point3::new(0.0, -500.0, 100.0);
        let pose = looking_at(&eye, &Point3::new(0.0, 0.0, 100.0), &Vector3::z());
        let seen = pose.inverse() * Point3::new(10.0, 0.0, 120.0);
        assert!((seen - Point3::new(10.0, -20.0, 500.0)).norm() < 1e-9, "{seen}");
        let above = looking_at(&Point3::new(0.0, 0.0, 500.0), &Point3::origin(), &Vector3::z());
        let seen = above.inverse() * Point3::origin();
        assert!((seen - Point3::new(0.0, 0.0, 500.0)).norm() < 1e-9);
    }

    #[test]
    fn a_slanting_plane_has_the_depth_of_its_equation() {
        // The plane through the origin with normal (0.2, -1, 0.3), as two large triangles.
        let normal = Vector3::new(0.2, -1.0, 0.3);
        let at = |x: f64, z: f64| Point3::new(x, 0.2 * x + 0.3 * z, z);
        let far = 4000.0;
        let points = vec![at(-far, -far), at(far, -far), at(far, far), at(-far, far)];
        let mesh = TriMesh::new(points, vec![[0, 1, 2], [0, 2, 3]]);
        let scene = Scene::new(mesh, Texture::default());
        let pose = from(Point3::new(100.0, -900.0, 50.0), Point3::origin());
        let frame = sensor().expose_exactly(&scene, &pose);
        let to_camera = pose.world_from_camera;
        for y in 0..120 {
            for x in 0..160 {
                let ray = to_camera * camera().unproject([x as f64, y as f64], 1.0).coords;
                let eye = to_camera.translation.vector;
                let expected = -normal.dot(&eye) / normal.dot(&ray);
                let depth = f64::from(frame.depth[(x, y)]);
                // f32 has 24 bits: 1e-4 mm at 1 m.
                assert!((depth - expected).abs() < 1.2e-4 * expected / 1000.0, "{x} {y}");
            }
        }
    }

    #[test]
    fn no_pixel_between_two_triangles_is_left_open() {
        let sphere = shapes::sphere(&Point3::origin(), 200.0, 90);
        let scene = Scene::new(sphere, Texture::default());
        let pose = from(Point3::new(30.0, -600.0, 200.0), Point3::origin());
        let frame = sensor().expose_exactly(&scene, &pose);
        let cloud = frame.cloud(&camera()).unwrap().moved(&pose.world_from_camera);
        assert!(cloud.n_points() > 4000, "{}", cloud.n_points());
        for y in 0..120 {
            // A convex body: the readings of a row are one run.
            let row = frame.depth.row(y);
            let n_borders = row.windows(2).filter(|w| (w[0] > 0.0) != (w[1] > 0.0)).count();
            assert!(n_borders == 0 || n_borders == 2, "row {y}: {n_borders}");
            for point in (0..160).filter_map(|x| cloud.point(x, y)) {
                // Chords of 90 rings lie up to 0.12 mm inside.
                assert!((199.85..200.001).contains(&point.coords.norm()));
            }
        }
        let eye = Point3::from(pose.world_from_camera.translation.vector);
        let cloud = cloud.with_normals(&eye, &NormalOptions::default());
        let (point, normal) = (cloud.point(80, 60).unwrap(), cloud.normal(80, 60).unwrap());
        assert!(normal.angle(&point.coords) < 0.05);
    }

    #[test]
    fn a_camera_inside_the_scene_sees_triangles_that_pass_behind_it() {
        let room = shapes::cuboid(&Aabb {
            min: Point3::new(-1000.0, -1000.0, -1000.0),
            max: Point3::new(1000.0, 1000.0, 1000.0),
        });
        let scene = Scene::new(room, Texture::default());
        let pose = from(Point3::origin(), Point3::new(0.0, 1.0, 0.0));
        let frame = sensor().expose_exactly(&scene, &pose);
        assert_eq!(frame.n_readings(), 160 * 120);
        assert!((frame.depth[(80, 60)] - 1000.0).abs() < 1e-3);
    }

    #[test]
    fn frames_are_the_same_for_any_number_of_threads_and_differ_by_seed() {
        let scene = BuiltinScene::TexturedStructured.build();
        let noise = Noise { kind: NoiseKind::Kinect, sigma: 1.0, seed: 5 };
        let sensor = SimulatedSensor { noise, ..sensor() };
        let pose = from(Point3::new(0.0, -1500.0, 0.0), Point3::origin());
        let frame = |n_threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads).build().unwrap();
            pool.install(|| sensor.expose(&scene, &pose, 3))
        };
        assert!(frame(1) == frame(3));
        assert_ne!(sensor.expose(&scene, &pose, 4).depth, frame(1).depth, "another frame");
        let other = SimulatedSensor { noise: Noise { seed: 6, ..noise }, ..sensor };
        assert_ne!(other.expose(&scene, &pose, 3).depth, frame(1).depth, "another seed");
    }
}
