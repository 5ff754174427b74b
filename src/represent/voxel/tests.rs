use super::*;
use crate::geom::Vector3;
use crate::progress::Silent;

/// A wavy sheet with colours and normals.
fn sheet(n: u32) -> PointCloud {
    let uv = |i: u32| ((f64::from(i) * 0.618_034).fract(), (f64::from(i) * 0.754_878).fract());
    let at = |i: u32| {
        let (u, v) = uv(i);
        Point3::new(100.0 * u + 1e4, 60.0 * v, 5.0 * (9.0 * u).sin() * (7.0 * v).cos())
    };
    PointCloud {
        points: (0..n).map(at).collect(),
        normals: Some(vec![Vector3::z(); n as usize]),
        colors: Some((0..n).map(|i| [(200.0 * uv(i).0) as u8, 7, 255]).collect()),
    }
}

fn reduced(cloud: &PointCloud, size: CellSize, rule: Rule) -> VoxelCloud {
    voxel_grid(&mut &*cloud, size, rule, &Silent).unwrap()
}

#[test]
fn every_rule_gives_a_point_in_each_cell() {
    let cloud = sheet(20_000);
    for rule in [Rule::Centre, Rule::Centroid, Rule::Nearest, Rule::Median] {
        let VoxelCloud { cloud: few, cells, .. } = reduced(&cloud, CellSize::Side(3.0), rule);
        let mut keys: Vec<u64> = cloud.points.iter().map(|p| cells.key(p)).collect();
        keys.sort_unstable();
        keys.dedup();
        let found: Vec<u64> = few.points.iter().map(|p| cells.key(p)).collect();
        assert_eq!(found, keys, "{rule:?}");
        assert_eq!(few.normals.unwrap()[0], Vector3::z());
        assert_eq!(few.colors.unwrap()[0][1..], [7, 255]);
    }
}

#[test]
fn the_nearest_is_a_point_of_the_cloud_and_no_other_is_nearer_to_the_mean() {
    let cloud = sheet(3000);
    let side = CellSize::Side(7.0);
    let means = reduced(&cloud, side, Rule::Centroid).cloud.points;
    let nearest = reduced(&cloud, side, Rule::Nearest);
    for (mean, found) in means.iter().zip(&nearest.cloud.points) {
        let of_cell = |p: &&Point3| nearest.cells.key(p) == nearest.cells.key(found);
        let distances = cloud.points.iter().filter(of_cell).map(|p| (p - mean).norm());
        let least = distances.fold(f64::INFINITY, f64::min);
        assert!(((found - mean).norm() - least).abs() < 1e-12);
        assert!(cloud.points.contains(found));
    }
}

#[test]
fn a_count_is_met_within_half_a_percent() {
    let cloud = sheet(50_000);
    for count in [1000, 5000, 20_000] {
        let found = reduced(&cloud, CellSize::Count(count), Rule::Centroid);
        let reached = found.reached.unwrap();
        assert!(reached.is_near, "{reached:?}");
        assert_eq!(reached.count, found.cloud.points.len() as u64);
    }
}

#[test]
fn a_count_that_cannot_be_reached_is_told() {
    let mut cloud = sheet(3);
    cloud.points = vec![Point3::origin(); 3];
    let found = reduced(&cloud, CellSize::Count(2), Rule::Centroid);
    assert_eq!(found.reached.map(|r| (r.asked, r.count, r.is_near)), Some((2, 1, false)));
    assert_eq!(found.cloud.points, [Point3::origin()]);
    // Cells meet in the middle of the cloud: the fewest are the quarters around it.
    let found = reduced(&sheet(900), CellSize::Count(1), Rule::Centroid);
    assert_eq!(found.reached.map(|r| (r.count, r.is_near)), Some((8, false)));
}

#[test]
fn the_same_cells_for_any_number_of_threads() {
    let cloud = sheet(9000);
    let with = |n| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap();
        pool.install(|| reduced(&cloud, CellSize::Side(2.0), Rule::Centroid))
    };
    assert_eq!(with(1), with(3));
}

#[test]
fn what_cannot_be_reduced_is_refused() {
    let cloud = sheet(9);
    let refused = |cloud: &PointCloud, size| {
        voxel_grid(&mut &*cloud, size, Rule::Centre, &Silent).unwrap_err().to_string()
    };
    assert!(refused(&PointCloud::default(), CellSize::Side(1.0)).contains("no points"));
    assert!(refused(&cloud, CellSize::Count(0)).contains("at least 1"));
    assert!(refused(&cloud, CellSize::Count(10)).contains("has only 9"));
    assert!(refused(&cloud, CellSize::Side(-1.0)).contains("-1 mm"));
    let mut bad = cloud;
    bad.points[4].z = f64::NAN;
    assert!(refused(&bad, CellSize::Side(1.0)).starts_with("point 5"));
}
