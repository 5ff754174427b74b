//! How much faster the search tree is than trying every primitive: both in one process, ratios
//! printed. `cargo bench --bench digitize`; with `HORMA_DATA` set on the real foot, else on a bumpy
//! cylinder.

use fearless_simd::{Level, dispatch, f64x8, prelude::*};
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
/// Positions that what takes long is given, spread evenly over the path.
const SOME: usize = 100;
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

/// One thing to be timed: so many positions on so many threads.
struct Contender<'a> {
    n: usize,
    n_threads: usize,
    run: Box<dyn Fn() + Sync + 'a>,
}

/// Microseconds per position of each, the best of several runs. They take turns, so that a machine
/// whose pace drifts is fair to all.
fn time<const N: usize>(contenders: &[Contender<'_>; N]) -> [f64; N] {
    let pools = contenders.each_ref().map(|contender| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(contender.n_threads).build();
        pool.expect("a pool")
    });
    let mut best = [f64::INFINITY; N];
    for _ in 0..RUNS {
        for ((contender, pool), best) in contenders.iter().zip(&pools).zip(&mut best) {
            let start = Instant::now();
            pool.install(&contender.run);
            *best = best.min(start.elapsed().as_secs_f64() * 1e6 / contender.n as f64);
        }
    }
    best
}

/// The whole helix by the tree.
fn indexed(part: &Part, cutter: Cutter, length: f64, n_threads: usize) -> Contender<'_> {
    let (n, pose) = helix(length);
    let digitizer = Digitizer { part, cutter, method: Method::Indexed };
    let run = Box::new(move || drop(digitizer.run(n, &pose, &Silent)));
    Contender { n, n_threads, run }
}

/// Far enough apart for [`SOME`] positions spread over the path; odd, so that they come at many
/// angles.
fn stride(n: usize) -> usize {
    (n / SOME) | 1
}

fn compare(name: &str, mesh: &TriMesh, profile: Profile) {
    let start = Instant::now();
    let part = Part::triangles(mesh);
    let built = start.elapsed().as_secs_f64() * 1e3;
    let (cutter, length) = (profile.cutter(0.0), mesh.aabb().size().x);
    let (n, pose) = helix(length);
    let digitizer = Digitizer { part: &part, cutter, method: Method::Exhaustive };
    let n_some = n / stride(n);
    let exhaustive = Contender {
        n: n_some,
        n_threads: 1,
        run: Box::new(|| drop(digitizer.run(n_some, |i| pose(i * stride(n)), &Silent))),
    };
    let [all, one, two] =
        time(&[exhaustive, indexed(&part, cutter, length, 1), indexed(&part, cutter, length, 2)]);
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
    let parts = [&small, &large].map(Part::triangles);
    let [least, most] = time(&[
        indexed(&parts[0], cutter, small.aabb().size().x, 1),
        indexed(&parts[1], cutter, large.aabb().size().x, 1),
    ]);
    println!("{:>9} triangles: {least:.2} us", small.triangles.len());
    println!("{:>9} triangles: {most:.2} us", large.triangles.len());
    println!("growth {:.2} times", most / least);
}

/// The wheel of the points rows.
const RADII: [f64; 2] = [60.0, 10.0];

/// The thesis' mode: as many points as positions, 50,000.
fn points(foot: &TriMesh) {
    let every = (foot.points.len() / 50_000).max(1);
    let mut points: Vec<_> = foot.points.iter().step_by(every).copied().take(50_000).collect();
    points.sort_by(|a, b| a.x.total_cmp(&b.x));
    let columns = [0, 1, 2].map(|axis| points.iter().map(|p| p[axis]).collect::<Vec<f64>>());
    let part = Part::points(&PointCloud { points, ..PointCloud::default() });
    let profile = Profile::Wheel { major_radius: RADII[0], minor_radius: RADII[1] };
    let (cutter, length) = (profile.cutter(0.0), foot.aabb().size().x);
    let (n, pose) = helix(length);
    let (stride, n_some) = (stride(n), n / stride(n));
    let n_points = columns[0].len();
    let scan = &|i: usize, window: bool| {
        let x = (i * stride) as f64 / PER_TURN as f64 * PITCH;
        let turn = (i * stride % PER_TURN) as f64 / PER_TURN as f64 * TAU;
        let range = if window {
            let at = |limit: f64| columns[0].partition_point(|&p| p < limit);
            at(x - RADII[1])..at(x + RADII[1])
        } else {
            0..n_points
        };
        let columns = [0, 1, 2].map(|axis| &columns[axis][range.clone()]);
        dispatch!(Level::new(), simd => highest(simd, columns, x, turn))
    };
    let scans = |window| Contender {
        n: n_some,
        n_threads: 1,
        run: Box::new(move || {
            for i in 0..n_some {
                std::hint::black_box(scan(i, window));
            }
        }),
    };
    let [all, window, one] = time(&[scans(false), scans(true), indexed(&part, cutter, length, 1)]);
    let digitizer = Digitizer { part: &part, cutter, method: Method::Indexed };
    let found = digitizer.run(n_some, |i| pose(i * stride), &Silent).expect("never cancelled");
    let off = found.iter().enumerate().map(|(i, contact)| {
        let height = contact.map_or(f64::NEG_INFINITY, |contact| contact.height);
        if height == scan(i, false) { 0.0 } else { (height - scan(i, false)).abs() }
    });
    println!(
        "{n_points} points: all of them, vectorised {all:.1} us; window of sorted x {window:.1} us; \
         indexed {one:.2} us: {:.0} times; answers differ by {:.1e} mm at most",
        all / one,
        off.fold(0.0, f64::max)
    );
}

/// Morell (2014), algorithm 3 with eq. 4.7, over all points given, eight side by side.
#[inline(always)]
fn highest<S: Simd>(simd: S, [x, y, z]: [&[f64]; 3], at: f64, turn: f64) -> f64 {
    let [major, minor] = RADII;
    let (sin, cos) = turn.sin_cos();
    let splat = |value: f64| f64x8::splat(simd, value);
    let never = splat(f64::NEG_INFINITY);
    let mut best = never;
    let whole = x.len() / 8 * 8;
    for i in (0..whole).step_by(8) {
        let load = |column: &[f64]| f64x8::from_slice(simd, &column[i..i + 8]);
        let (dx, y, z) = (load(x) - splat(at), load(y), load(z));
        let nose = splat(minor * minor) - dx * dx;
        let radius = nose.max(splat(0.0)).sqrt() + splat(major);
        let across = y * splat(sin) + z * splat(cos);
        let reach = radius * radius - across * across;
        let height = y * splat(cos) - z * splat(sin) + reach.max(splat(0.0)).sqrt();
        let touches = nose.simd_ge(splat(0.0)) & reach.simd_ge(splat(0.0));
        best = best.max(touches.select(height, never));
    }
    let rest = (whole..x.len()).map(|i| {
        let nose = minor * minor - (x[i] - at).powi(2);
        let radius = major + nose.max(0.0).sqrt();
        let reach = radius * radius - (y[i] * sin + z[i] * cos).powi(2);
        let height = y[i] * cos - z[i] * sin + reach.max(0.0).sqrt();
        if nose >= 0.0 && reach >= 0.0 { height } else { f64::NEG_INFINITY }
    });
    best.as_slice().iter().copied().chain(rest).fold(f64::NEG_INFINITY, f64::max)
}
