//! The clouds that growing neural gas is measured on.

use horma::geom::{Point3, PointCloud, Pose, Surface, TriMesh, Vector3};
use horma::io::read_surface;
use horma::io::rgbd::{DepthCamera, open_sequence};
use rand::{Rng, RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::path::{Path, PathBuf};

/// Points on the bunny.
const BUNNY_POINTS: usize = 300_000;
/// Its diagonal [mm], and the noise of the points.
const BUNNY_DIAGONAL: f64 = 250.0;
const BUNNY_SIGMA: f64 = 0.05;
/// Every such frame of the sequence goes into the map.
const MAP_STEP: usize = 5;

/// Both, by name; none, with a word about it, where `HORMA_DATA` is not set.
pub(crate) fn all() -> Vec<(&'static str, PointCloud)> {
    let Some(data) = std::env::var_os("HORMA_DATA").map(PathBuf::from) else {
        eprintln!("HORMA_DATA is not set: there are no clouds");
        return Vec::new();
    };
    vec![("bunny", bunny(&data)), ("map", map(&data))]
}

/// Points drawn evenly from the reconstructed bunny, with noise.
pub(crate) fn bunny(data: &Path) -> PointCloud {
    let path = data.join("scans/stanford_bunny/bun_zipper_res2.ply");
    let Surface::Mesh(mesh) = read_surface(&path, None).expect("the bunny").surface else {
        panic!("{} is no mesh", path.display())
    };
    let scale = BUNNY_DIAGONAL / mesh.aabb().size().norm();
    let points: Vec<Point3> = mesh.points.iter().map(|p| p * scale).collect();
    sampled(&TriMesh::new(points, mesh.triangles), BUNNY_POINTS, BUNNY_SIGMA)
}

/// `n` points drawn evenly from a surface, moved by `sigma` along each axis.
pub(crate) fn sampled(mesh: &TriMesh, n: usize, sigma: f64) -> PointCloud {
    let mut draws = Pcg64Mcg::seed_from_u64(1);
    let mut sum = 0.0;
    let sums: Vec<f64> = (0..mesh.triangles.len())
        .map(|i| {
            sum += mesh.area_vector(i).norm();
            sum
        })
        .collect();
    let point = |_| {
        let at = draws.random::<f64>() * sum;
        let [a, b, c] = mesh.corners(sums.partition_point(|x| *x < at).min(sums.len() - 1));
        let (mut u, mut v) = (draws.random::<f64>(), draws.random::<f64>());
        if 1.0 < u + v {
            (u, v) = (1.0 - u, 1.0 - v);
        }
        let noise = Vector3::from_fn(|_, _| normal(&mut draws) * sigma);
        a + (b - a) * u + (c - a) * v + noise
    };
    PointCloud { points: (0..n).map(point).collect(), ..PointCloud::default() }
}

/// Frames of a sequence merged by their true poses.
pub(crate) fn map(data: &Path) -> PointCloud {
    let folder = data.join("rgbd/tum_fr1_rpy_cut");
    let sequence = open_sequence(&folder, Some(DepthCamera::FREIBURG1)).expect("a sequence");
    let truth = sequence.truth.as_ref().expect("a truth");
    let mut points = Vec::new();
    for files in sequence.files.iter().step_by(MAP_STEP) {
        let frame = sequence.read(files).expect("a frame");
        let pose: Pose = truth.at(files.depth_stamp).expect("a pose");
        let cloud = frame.cloud(&sequence.camera.camera).expect("a cloud").moved(&pose).to_cloud();
        points.extend(cloud.points);
    }
    PointCloud { points, ..PointCloud::default() }
}

/// Points of the cloud drawn at random, from `origin`, without end.
pub(crate) fn signals<'a>(
    cloud: &'a PointCloud,
    origin: &'a Point3,
) -> impl Iterator<Item = [f32; 3]> + 'a {
    let mut draws = Pcg64Mcg::seed_from_u64(1);
    std::iter::repeat_with(move || {
        let out = cloud.points[draws.random_range(0..cloud.points.len())] - origin;
        [out.x as f32, out.y as f32, out.z as f32]
    })
}

/// A draw from the normal distribution, by the sum of twelve even ones.
fn normal(draws: &mut impl Rng) -> f64 {
    (0..12).map(|_| draws.random::<f64>()).sum::<f64>() - 6.0
}
