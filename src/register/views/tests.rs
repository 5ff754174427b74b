//! A body seen from all sides, each view in a frame of its own.

use super::*;
use crate::geom::{Aabb, Point3, TriMesh, Vector3, shapes};
use crate::progress::Silent;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// `n` points spread over a mesh at random.
fn scanned(mesh: &TriMesh, n: usize, seed: u64) -> Vec<Point3> {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let area = |i: usize| mesh.area_vector(i).norm();
    let mut sums: Vec<f64> = Vec::with_capacity(mesh.triangles.len());
    (0..mesh.triangles.len())
        .for_each(|i| sums.push(sums.last().copied().unwrap_or(0.0) + area(i)));
    let total = sums.last().copied().unwrap();
    let place = |_| {
        let at = random.random_range(0.0..total);
        let i = sums.partition_point(|sum| *sum < at).min(sums.len() - 1);
        let [a, b, c] = mesh.corners(i).map(|corner| corner.coords);
        let (u, v) = (random.random_range(0.0..1.0), random.random_range(0.0..1.0));
        let (u, v): (f64, f64) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
        Point3::from(a + (b - a) * u + (c - a) * v)
    };
    (0..n).map(place).collect()
}

fn pose(i: usize) -> Pose {
    let k = i as f64;
    let shift = Vector3::new(300.0 - 90.0 * k, 40.0 * k, -150.0 + 60.0 * k);
    Pose::new(shift, Vector3::new(0.9 * k, 1.3 - 0.5 * k, 0.4 + 0.3 * k))
}

/// What is seen of the body from four sides, each about three quarters of it, as view `i` has it.
fn view(i: usize) -> PointCloud {
    let all = scanned(&shapes::chiral(4000), 5000, i as u64 + 1);
    let size = Aabb::around(&all).size();
    let side = [Vector3::x(), Vector3::y(), -Vector3::x(), -Vector3::y()][i];
    let beyond = -0.2 * size.dot(&side.abs());
    let seen = all.iter().filter(|p| p.coords.dot(&side) > beyond);
    let points = seen.map(|p| pose(i).inverse() * p).collect();
    PointCloud { points, ..PointCloud::default() }
}

fn aligned(clouds: &[PointCloud]) -> Result<ViewsAligned, ViewsError> {
    let clouds: Vec<&PointCloud> = clouds.iter().collect();
    let options = (&CoarseOptions::default(), &IcpOptions::default(), &GraphOptions::default());
    align_all(&clouds, options, &Silent)
}

#[test]
fn views_from_all_sides_come_to_lie_where_they_belong_and_a_stranger_is_left_out() {
    let mut clouds: Vec<PointCloud> = (0..4).map(view).collect();
    let cube = Aabb { min: Point3::new(-60.0, -20.0, -9.0), max: Point3::new(60.0, 20.0, 9.0) };
    let stranger = scanned(&shapes::cuboid(&cube), 4000, 9);
    clouds.insert(1, PointCloud { points: stranger, ..PointCloud::default() });
    let found = aligned(&clouds).unwrap();
    let told: Vec<String> = found.pairs.iter().map(|pair| format!("{pair:?}")).collect();
    assert_eq!(found.stays, 4, "the last one stays: {told:#?}");
    assert!(found.stays_from_view[1].is_none(), "{told:#?}");
    assert_eq!(found.verdict(), Verdict::Doubtful);
    for (number, i) in [(0, 0), (2, 1), (3, 2), (4, 3)] {
        let known = pose(3).inverse() * pose(i);
        let pose = found.stays_from_view[number].unwrap();
        let off = |p: &Point3| (pose * p - known * p).norm();
        let off = clouds[number].points.iter().map(off).fold(0.0, f64::max);
        // Points drawn twice are a millimetre apart.
        assert!(off < 0.3, "view {number}: {off} mm");
    }
    // Pairs that are as good as these leave nothing to settle, but it must not get worse.
    let residual = found.residual;
    assert!(residual.refined < residual.chained * 1.02, "{residual:?}");
    assert!(found.converged && found.n_rounds > 0);
    let stranger = |pair: &&Pair| pair.source == 1 || pair.target == 1;
    for pair in found.pairs.iter().filter(stranger) {
        assert!(!pair.is_believed(), "{pair:?}");
    }
}

#[test]
fn views_that_cannot_be_are_refused_by_their_number() {
    let good = view(0);
    let error = aligned(std::slice::from_ref(&good)).unwrap_err().to_string();
    assert!(error.starts_with("1 views"), "{error}");
    let mut bad = good.clone();
    bad.points[3].x = f64::NAN;
    let error = aligned(&[good, bad]).unwrap_err().to_string();
    assert!(error.starts_with("view 2: point 4 of the source is not finite"), "{error}");
}
