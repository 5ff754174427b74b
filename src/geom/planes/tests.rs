//! Boxes, stairs and sheets have their planes; what is round has none.

use super::*;
use crate::geom::{Aabb, normals, shapes};
use crate::progress::Silent;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// Root mean square of the noise that [`rough`] adds [mm].
const NOISE: f64 = 0.3;

fn options(tolerance: f64) -> PlaneOptions {
    let angle = 20_f64.to_radians();
    PlaneOptions { tolerance, angle, least_points: 60, most_planes: 40 }
}

/// A rectangle of points a millimetre apart, from a corner along both sides.
fn sheet(corner: [f64; 3], along: [f64; 3], up: [f64; 3]) -> Vec<Point3> {
    let [corner, along, up] = [corner, along, up].map(Vector3::from);
    let (n, m) = (along.norm() as usize, up.norm() as usize);
    let step = [along.normalize(), up.normalize()];
    (0..=n * m + n + m)
        .map(|i| ((i % (n + 1)) as f64, (i / (n + 1)) as f64))
        .map(|(u, v)| Point3::from(corner + step[0] * u + step[1] * v))
        .collect()
}

/// Noise along all axes, about normal.
fn rough(points: &mut [Point3], noise: f64, seed: u64) {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let mut normal = || (0..12).map(|_| random.random_range(0.0..1.0)).sum::<f64>() - 6.0;
    for point in points {
        *point += Vector3::from_fn(|_, _| noise * normal());
    }
}

fn found(points: &[Point3], options: &PlaneOptions) -> Vec<Plane> {
    let tree = KdTree::build(points);
    let tangents = normals(points, &tree, 20, &Silent).unwrap();
    let normals: Vec<Vector3> = tangents.iter().map(|tangent| tangent.normal).collect();
    planes((points, &normals), &tree, options, &Silent).unwrap()
}

/// About 60 x 40 x 30 mm, a point to a square millimetre, its faces' normals pointing anywhere.
fn noisy_box() -> Vec<Point3> {
    let ([x, y, z], o) = ([[60.0, 0.0, 0.0], [0.0, 40.0, 0.0], [0.0, 0.0, 30.0]], [0.0; 3]);
    let far = [60.0, 40.0, 30.0];
    let back = |side: [f64; 3]| side.map(|a| -a);
    let mut points = [
        sheet(o, x, y),
        sheet(o, y, z),
        sheet(o, z, x),
        sheet(far, back(x), back(y)),
        sheet(far, back(y), back(z)),
        sheet(far, back(z), back(x)),
    ]
    .concat();
    rough(&mut points, NOISE, 1);
    points
}

#[test]
fn a_noisy_box_has_six_faces_as_exact_as_its_noise_allows() {
    let points = noisy_box();
    let found = found(&points, &options(4.0 * NOISE));
    assert_eq!(found.len(), 6);
    let sizes =
        [[60.0, 40.0], [60.0, 40.0], [60.0, 30.0], [60.0, 30.0], [40.0, 30.0], [40.0, 30.0]];
    for (plane, [long, wide]) in found.iter().zip(sizes) {
        let n = plane.members.len() as f64;
        // All but the rim, where normals turn over to the next face.
        assert!(n > 0.75 * long * wide && n < 1.05 * (long + 1.0) * (wide + 1.0), "{n}");
        // A line through n places with noise and the spread w / sqrt(12) is tilted by noise over
        // the root of n times that; four of these are not exceeded.
        let tilt = 4.0 * NOISE * 12_f64.sqrt() / (n.sqrt() * wide);
        assert!(plane.normal.amax() > tilt.cos(), "{} {tilt}", plane.normal);
        let face = plane.normal.iamax();
        let side = plane.offset * plane.normal[face].signum();
        let nearest = [0.0, [60.0, 40.0, 30.0][face]].map(|at: f64| (side - at).abs());
        // The offset is at the origin, up to a diagonal away from the middle.
        let off = 4.0 * NOISE / n.sqrt() + tilt * 39.0;
        assert!(nearest[0].min(nearest[1]) < off, "{side} {off}");
        assert!((plane.roughness - NOISE).abs() < 0.15 * NOISE, "{}", plane.roughness);
        assert!(plane.members.is_sorted() && plane.distance(&plane.centroid) == 0.0);
    }
}

#[test]
fn a_stair_has_its_steps_and_not_one_slope() {
    let mut points = Vec::new();
    for i in 0..5 {
        let at = 18.0 * f64::from(i);
        points.extend(sheet([0.0, at, at], [60.0, 0.0, 0.0], [0.0, 18.0, 0.0]));
        points.extend(sheet([0.0, at + 18.0, at], [60.0, 0.0, 0.0], [0.0, 0.0, 18.0]));
    }
    rough(&mut points, 0.2, 3);
    // So tolerant that a slope through all edges would hold half of the points.
    let found = found(&points, &options(3.0));
    assert_eq!(found.len(), 10);
    for plane in &found {
        assert!(plane.normal.y.abs().max(plane.normal.z.abs()) > 0.999, "{}", plane.normal);
    }
}

#[test]
fn what_is_round_has_no_planes() {
    // A ball evenly covered along a spiral, a tube, and what is wavy all over.
    let ball: Vec<Point3> = (0..20_000)
        .map(|i| {
            let z = 1.0 - (2.0 * f64::from(i) + 1.0) / 20_000.0;
            let (r, a) = ((1.0 - z * z).sqrt(), 2.399_963 * f64::from(i));
            Point3::new(40.0 * r * a.cos(), 40.0 * r * a.sin(), 40.0 * z)
        })
        .collect();
    let tube = shapes::cylinder_points(20.0, 120.0, 120, 120).points;
    let bumps = shapes::bumpy_cylinder(20_000).points;
    for (name, points) in [("ball", ball), ("tube", tube), ("bumps", bumps)] {
        for tolerance in [0.1, 0.3, 1.0, 2.0] {
            let found = found(&points, &options(tolerance));
            let sizes: Vec<usize> = found.iter().map(|plane| plane.members.len()).collect();
            // The caps of the bumpy cylinder are flat.
            let most = if name == "bumps" { 2 } else { 0 };
            assert!(sizes.len() <= most, "{name} at {tolerance}: {sizes:?} of {}", points.len());
        }
    }
}

#[test]
fn sheets_three_tolerances_apart_stay_two_and_so_do_patches_that_do_not_touch() {
    let below = sheet([0.0; 3], [50.0, 0.0, 0.0], [0.0, 50.0, 0.0]);
    for apart in [[0.0, 0.0, 3.0], [70.0, 0.0, 0.0]] {
        let mut points = [below.clone(), below.iter().map(|p| p + Vector3::from(apart)).collect()];
        points.iter_mut().zip([5, 6]).for_each(|(points, seed)| rough(points, 0.2, seed));
        let found = found(&points.concat(), &options(1.0));
        let sizes: Vec<usize> = found.iter().map(|plane| plane.members.len()).collect();
        assert!(sizes.len() == 2 && sizes[1] > 2400, "{apart:?}: {sizes:?}");
    }
}

#[test]
fn a_wall_whose_middle_is_a_little_off_is_one() {
    // Noise that grows towards one side, and a dent: whatever pieces there are, they are one.
    let mut points = sheet([0.0; 3], [90.0, 0.0, 0.0], [0.0, 60.0, 0.0]);
    rough(&mut points, 0.4, 7);
    for point in &mut points {
        let dent = (-((point.x - 40.0).powi(2) + (point.y - 30.0).powi(2)) / 50.0).exp();
        point.z += 1.5 * dent;
    }
    let found = found(&points, &options(1.5));
    assert_eq!(found.len(), 1);
    assert!(found[0].members.len() > points.len() * 9 / 10, "{}", found[0].members.len());
}

#[test]
fn threads_units_and_a_place_far_away_change_nothing() {
    let points = noisy_box();
    let here = found(&points, &options(1.2));
    let on = |n: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap();
        pool.install(|| found(&points, &options(1.2)))
    };
    assert_eq!(on(1), on(3));
    let metres: Vec<Point3> = points.iter().map(|p| p / 1000.0).collect();
    let away = Vector3::new(1e6, -3e5, 7e5);
    let shifted: Vec<Point3> = points.iter().map(|p| p + away).collect();
    for (other, scale) in
        [(found(&metres, &options(0.0012)), 1000.0), (found(&shifted, &options(1.2)), 1.0)]
    {
        assert_eq!(other.len(), here.len());
        let all = |planes: &[Plane]| planes.iter().map(|p| p.members.len()).sum::<usize>();
        let differing = all(&here).abs_diff(all(&other));
        // The tree searches in f32: neighbours as near as each other may change places.
        assert!(differing < all(&here) / 500, "{differing}");
        for (a, b) in here.iter().zip(&other) {
            assert!(a.normal.dot(&b.normal).abs() > 1.0 - 1e-5);
            assert!((a.roughness - scale * b.roughness).abs() < 0.01);
        }
    }
}

#[test]
fn a_plane_looks_where_its_points_normals_look() {
    let points = sheet([0.0; 3], [30.0, 0.0, 0.0], [0.0, 30.0, 0.0]);
    let tree = KdTree::build(&points);
    for side in [Vector3::z(), -Vector3::z()] {
        let all = vec![side; points.len()];
        let found = planes((&points, &all), &tree, &options(0.5), &Silent).unwrap();
        assert!(found.len() == 1 && found[0].normal.dot(&side) > 1.0 - 1e-9);
    }
}

#[test]
fn few_points_have_no_planes_and_the_most_come_first() {
    assert_eq!(found(&[], &options(1.0)), []);
    assert_eq!(found(&[Point3::origin(); 3], &options(1.0)), []);
    let cube = shapes::cuboid(&Aabb { min: Point3::origin(), max: Point3::new(9.0, 9.0, 9.0) });
    assert_eq!(found(&cube.points, &options(1.0)), []);
    let two = [
        sheet([0.0; 3], [20.0, 0.0, 0.0], [0.0, 20.0, 0.0]),
        sheet([0.0, 0.0, 90.0], [40.0, 0.0, 0.0], [0.0, 20.0, 0.0]),
    ];
    let most = PlaneOptions { most_planes: 1, ..options(1.0) };
    let found = found(&two.concat(), &most);
    assert!(found.len() == 1 && (found[0].offset.abs() - 90.0).abs() < 1e-9);
}
