//! Models on a device: the same as on the processor.
//!
//! Without an adapter these tests say that they are skipped; `HORMA_REQUIRE_GPU=1` forbids that.

use horma::compute::Gpu;
use horma::geom::{Point3, Pose, TriMesh, Vector3, distances_from_mesh, shapes, topology};
use horma::register::tsdf::{DeviceVolume, Readings, TsdfError, TsdfOptions, Volume};
use horma::rgbd::simulated::{
    Noise, NoiseKind, Orbit, Scene, SimulatedSensor, Texture, TextureKind,
};
use horma::rgbd::{Camera, StampedPose};
use std::sync::Arc;

/// The device, or word that the test is skipped.
fn device() -> Option<Arc<Gpu>> {
    match Gpu::open(None) {
        Ok(gpu) => Some(Arc::new(gpu)),
        Err(error) if std::env::var_os("HORMA_REQUIRE_GPU").is_some() => panic!("{error}"),
        Err(error) => {
            eprintln!("skipped: {error}");
            None
        }
    }
}

fn camera() -> Camera {
    Camera::pinhole([160, 120], [131.0, 131.0], [79.5, 59.5])
}

/// A ball in colours, far from the origin, and frames of it.
fn frames(options: &TsdfOptions) -> Vec<(Readings, Pose)> {
    let center = Point3::new(3005.0, -2003.0, 1008.0);
    let scene = Scene::new(
        shapes::sphere(&center, 100.0, 90),
        Texture { kind: TextureKind::Patches, size: 20.0, seed: 0 },
    );
    let noise = Noise { kind: NoiseKind::Gaussian, sigma: 1.0, seed: 1 };
    let sensor = SimulatedSensor { camera: camera(), noise };
    let orbit = Orbit { center, axis: Vector3::z(), distance: 500.0 };
    let taken = |(number, pose): (usize, &StampedPose)| {
        let frame = sensor.expose(&scene, pose, number);
        (Readings::new(&frame, &camera(), options).unwrap(), pose.world_from_camera)
    };
    orbit.turntable(6, &[0.7, -0.7]).iter().enumerate().map(taken).collect()
}

fn options(voxel: f64) -> TsdfOptions {
    TsdfOptions { voxel, ..TsdfOptions::default() }
}

/// The same frames fused on both.
fn both(voxel: f64) -> Option<(Volume, DeviceVolume)> {
    let gpu = device()?;
    let options = options(voxel);
    let mut on_cpu = Volume::new(&options).unwrap();
    let mut on_gpu = DeviceVolume::new(&options, gpu).unwrap();
    for (readings, pose) in &frames(&options) {
        let done = on_cpu.integrate(readings, pose).unwrap();
        assert_eq!(on_gpu.integrate(readings, pose).unwrap(), done);
    }
    assert_eq!((on_gpu.n_blocks(), on_gpu.memory()), (on_cpu.n_blocks(), on_cpu.memory()));
    Some((on_cpu, on_gpu))
}

fn assert_same(a: &TriMesh, b: &TriMesh) {
    assert_eq!(topology(b).is_closed(), topology(a).is_closed());
    assert!(a.points.len().abs_diff(b.points.len()) * 500 < a.points.len());
    let mut off = distances_from_mesh(a, &b.points);
    off.sort_by(f64::total_cmp);
    // Rounding; but a lattice point on the border of two pixels may take the other's reading.
    let (median, most) = (off[off.len() / 2], off[off.len() * 99 / 100]);
    assert!(median < 1e-3 && most < 0.05, "{median} mm, 99 % within {most} mm");
}

#[test]
fn gpu_and_cpu_fuse_frames_to_the_same_model() {
    let Some((on_cpu, on_gpu)) = both(5.0) else { return };
    let (a, b) = (on_cpu.mesh().unwrap(), on_gpu.download().unwrap().mesh().unwrap());
    assert_same(&a, &b);
    assert!(topology(&b).is_closed());
    let mean = |mesh: &TriMesh| -> [f64; 3] {
        let colors = mesh.colors.as_ref().unwrap();
        [0, 1, 2].map(|k| colors.iter().map(|c| f64::from(c[k])).sum::<f64>() / colors.len() as f64)
    };
    let (a, b) = (mean(&a), mean(&b));
    assert!((0..3).all(|k| (a[k] - b[k]).abs() < 0.2 && a[k] > 20.0), "{a:?} {b:?}");
}

#[test]
fn a_model_that_outgrows_its_room_keeps_what_it_knows() {
    let Some((on_cpu, on_gpu)) = both(1.0) else { return };
    assert!(on_gpu.n_blocks() > 2048, "{} blocks", on_gpu.n_blocks());
    assert_same(&on_cpu.mesh().unwrap(), &on_gpu.download().unwrap().mesh().unwrap());
}

#[test]
fn gpu_and_cpu_see_the_same_of_a_model() {
    let Some((_, mut on_gpu)) = both(5.0) else { return };
    // One model for both.
    let on_cpu = on_gpu.download().unwrap();
    let frames = frames(&options(5.0));
    for (_, pose) in [&frames[0], &frames[7]] {
        let aside = pose * Pose::new(Vector3::new(9.0, -4.0, 30.0), Vector3::new(0.02, 0.1, 0.3));
        let (a, b) = (on_cpu.cast(&camera(), &aside), on_gpu.cast(&camera(), &aside).unwrap());
        assert_eq!((a.camera, a.world_from_camera), (b.camera, b.world_from_camera));
        let (mut n_seen, mut n_off) = (0, 0);
        for (a, b) in a.pixels.pixels().iter().zip(b.pixels.pixels()) {
            n_seen += usize::from(a.point[2] > 0.0);
            let point = (0..3).all(|k| (a.point[k] - b.point[k]).abs() < 0.05);
            let normal = (0..3).all(|k| (a.normal[k] - b.normal[k]).abs() < 0.01);
            n_off += usize::from(!(point && normal));
        }
        // Steps end elsewhere by a rounding, and a ray along the rim may pass the surface by.
        assert!(n_seen > 1500 && n_off * 200 < n_seen, "{n_off} of {n_seen}");
    }
}

#[test]
fn an_empty_model_shows_nothing_and_one_too_large_stays_as_it_was() {
    let Some(gpu) = device() else { return };
    let mut model = DeviceVolume::new(&options(5.0), gpu.clone()).unwrap();
    let view = model.cast(&camera(), &Pose::identity()).unwrap();
    assert!(view.pixels.pixels().iter().all(|seen| seen.point[2] == 0.0));
    let little = TsdfOptions { memory: 9, ..options(1.0) };
    let (readings, pose) = frames(&little).remove(0);
    let mut model = DeviceVolume::new(&little, gpu).unwrap();
    let error = model.integrate(&readings, &pose).unwrap_err();
    assert!(matches!(error, TsdfError::Memory { allowed: 9, .. }), "{error}");
    assert_eq!(model.n_blocks(), 0);
}
