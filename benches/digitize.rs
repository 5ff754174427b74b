//! How much faster the search tree is than trying every primitive: both in one process, ratios
//! printed. `cargo bench --bench digitize`; with `HORMA_DATA` set on the real foot, else on a bumpy
//! cylinder.

use horma::cam::{Digitizer, Method, Part};
use horma::geom::{PointCloud, Pose, TriMesh, shapes};
use horma::progress::Silent;
use horma::tool::{Cutter, Profile};
use nalgebra::{Translation3, UnitQuaternion, Vector3};
use std::f64::consts::TAU;
use std::path::PathBuf;
use std::time::Instant;

/// Runs of each contender; the best counts.
const RUNS: usize = 5;
/// Positions the exhaustive search is given, spread evenly over the path.
const EXHAUSTIVE: usize = 100;
const PITCH: f64 = 2.0;
const PER_TURN: usize = 360;

fn main() {
    let foot = part("foot_mean_left.obj");
    println!("{} triangles, one thread unless said otherwise", foot.triangles.len());
    compare("wheel R60 r10", &foot, Profile::Wheel { major_radius: 60.0, minor_radius: 10.0 });
    compare("ball 5", &foot, Profile::Ball { radius: 5.0 });
    compare("flat 6", &foot, Profile::Flat { radius: 6.0 });
    compare("bull 6 r1", &foot, Profile::Bull { radius: 6.0, corner_radius: 1.0 });
    growth(&foot);
    points(&foot);
}

/// The part, lying along X from 0, its middle on the axis.
fn part(name: &str) -> TriMesh {
    let mesh = if let Some(data) = std::env::var_os("HORMA_DATA") {
        let path = PathBuf::from(data).join("lasts/find_foot").join(name);
        let reading = horma::io::read_surface(&path, None).expect("the foot can be read");
        reading.surface.into_mesh().expect("the foot is a mesh")
    } else {
        eprintln!("HORMA_DATA is not set: a bumpy cylinder stands in for {name}");
        shapes::bumpy_cylinder(if name.starts_with("foot_mean") { 128_000 } else { 2_000 })
    };
    let (aabb, middle) = (mesh.aabb(), mesh.aabb().center());
    mesh.moved(&Pose::translation(-aabb.min.x, -middle.y, -middle.z))
}

/// The helix over a part: how many positions, and the pose of each.
fn helix(length: f64) -> (usize, impl Fn(usize) -> Pose + Sync) {
    let n = (length / PITCH) as usize * PER_TURN;
    let pose = |i: usize| {
        let turns = i as f64 / PER_TURN as f64;
        let turn = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), turns.fract() * TAU);
        Pose::from_parts(Translation3::new(-turns * PITCH, 0.0, 0.0), turn)
    };
    (n, pose)
}

/// Microseconds per position, the best of several runs.
fn time(n: usize, threads: usize, run: impl Fn() + Sync) -> f64 {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
    let once = || {
        let start = Instant::now();
        pool.install(&run);
        start.elapsed().as_secs_f64() * 1e6 / n as f64
    };
    (0..RUNS).map(|_| once()).fold(f64::INFINITY, f64::min)
}

fn indexed(part: &Part, cutter: Cutter, length: f64, threads: usize) -> f64 {
    let (n, pose) = helix(length);
    let digitizer = Digitizer { part, cutter, method: Method::Indexed };
    time(n, threads, || drop(digitizer.run(n, &pose, &Silent)))
}

fn compare(name: &str, mesh: &TriMesh, profile: Profile) {
    let start = Instant::now();
    let part = Part::triangles(mesh);
    let built = start.elapsed().as_secs_f64() * 1e3;
    let (cutter, length) = (profile.cutter(0.0), mesh.aabb().size().x);
    let (n, pose) = helix(length);
    let [one, two] = [1, 2].map(|threads| indexed(&part, cutter, length, threads));
    let stride = n / EXHAUSTIVE;
    let digitizer = Digitizer { part: &part, cutter, method: Method::Exhaustive };
    let all = time(EXHAUSTIVE, 1, || {
        drop(digitizer.run(EXHAUSTIVE, |i| pose(i * stride), &Silent));
    });
    println!(
        "{name:<14} exhaustive {all:7.1} us, indexed {one:5.2} us ({:.0} positions/s): {:.0} times; \
         two threads {:.2} times one; tree built in {built:.0} ms",
        1e6 / one,
        all / one,
        one / two,
    );
}

fn growth(foot: &TriMesh) {
    let cutter = Profile::Wheel { major_radius: 60.0, minor_radius: 10.0 }.cutter(0.0);
    let small = shapes::subdivide(&part("foot_template_left_metres.obj"));
    let large = shapes::subdivide(&shapes::subdivide(foot));
    let [least, most] = [&small, &large].map(|mesh| {
        let per_position = indexed(&Part::triangles(mesh), cutter, mesh.aabb().size().x, 1);
        println!("{:>9} triangles: {per_position:.2} us", mesh.triangles.len());
        per_position
    });
    println!("growth {:.2} times", most / least);
}

/// The thesis' mode: as many points as positions, 50,000.
fn points(foot: &TriMesh) {
    let stride = (foot.points.len() / 50_000).max(1);
    let points = foot.points.iter().step_by(stride).copied().take(50_000).collect();
    let cloud = PointCloud { points, ..PointCloud::default() };
    let part = Part::points(&cloud);
    let cutter = Profile::Wheel { major_radius: 60.0, minor_radius: 10.0 }.cutter(0.0);
    let length = foot.aabb().size().x;
    let one = indexed(&part, cutter, length, 1);
    let (n, pose) = helix(length);
    let stride = n / EXHAUSTIVE;
    let digitizer = Digitizer { part: &part, cutter, method: Method::Exhaustive };
    let all = time(EXHAUSTIVE, 1, || {
        drop(digitizer.run(EXHAUSTIVE, |i| pose(i * stride), &Silent));
    });
    println!(
        "{} points: exhaustive {all:.1} us, indexed {one:.2} us: {:.0} times",
        part.n_primitives(),
        all / one
    );
}
