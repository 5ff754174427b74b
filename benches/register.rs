//! Fine registration on real pairs: how far off it ends, how long it takes, and what it says of
//! itself. `HORMA_DATA=... cargo bench --bench register [-- WORDS]`; with words, only pairs and
//! methods whose names hold one of them. Thinning, normals and alignment are timed, reading is not.
//! On two threads; the best of three. Then coarse registration: five bunny pairs, the source turned
//! three ways, once each; and frames of a depth camera and a pair of laser scans in the same manner.

use horma::geom::{Point3, PointCloud, Pose};
use horma::progress::Silent;
use horma::register::coarse::{self, Coarse, CoarseOptions};
use horma::register::icp::{Alignment, IcpOptions, Kernel, Metric, Verdict, align};
use rand::{RngExt, SeedableRng};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::time::Instant;

const RUNS: usize = 3;
/// Intrinsics of freiburg1: focal lengths and centre [px].
const CAMERA: [f64; 4] = [517.3, 516.5, 318.6, 255.3];
/// Depth units to a millimetre.
const DEPTH_PER_MM: f64 = 5.0;

struct Case {
    name: String,
    init: Pose,
    truth: Pose,
    ok_below: f64,
}

/// How far a pose may be off in the list of gaps.
const GAP_SHIFT: f64 = 20.0;
const GAP_TURN_DEG: f64 = 1.0;

fn main() {
    let Some(data) = std::env::var_os("HORMA_DATA").map(PathBuf::from) else {
        eprintln!("HORMA_DATA is not set: there is nothing to register");
        return;
    };
    let words: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().expect("a pool");
    let mut clouds = HashMap::new();
    let mut all = cases(&data.join("pairs/icp.csv"));
    all.extend(gaps(&data));
    for case in all {
        let [source, target] = sides(&data, &case.name)
            .map(|path| clouds.entry(path.clone()).or_insert_with(|| read(&path)).clone());
        for (method, options) in methods(&case.name) {
            let name = format!("{} {method}", case.name);
            if !words.is_empty() && !words.iter().any(|word| name.contains(word.as_str())) {
                continue;
            }
            let (alignment, ms) = pool.install(|| timed(&source, &target, &case.init, &options));
            let back = pool.install(|| {
                align(&target, &source, &case.init.inverse(), &options, &Silent).expect("it runs")
            });
            report(&name, &case, &source, (alignment, back, ms));
        }
    }
    pool.install(|| turned_pairs(&data, &words));
    pool.install(|| turned_rooms(&data, &words));
}

/// Frames of a room and two laser scans whose source was turned at random, from nothing, by their
/// shape alone.
fn turned_rooms(data: &Path, words: &[String]) {
    let mut cases = gaps(data);
    cases.extend(
        self::cases(&data.join("pairs/icp.csv"))
            .into_iter()
            .filter(|case| case.name == "lidar-pair"),
    );
    for method in [Coarse::Planes, Coarse::FpfhRansac, Coarse::FpfhGnc, Coarse::Auto] {
        // Right, near enough for a fine stage to make it right, and wrong; ok and not.
        let (mut counts, mut slowest, mut sum) = ([[0; 2]; 3], 0.0_f64, 0.0);
        for case in &cases {
            let [source, target] = sides(data, &case.name).map(|path| read(&path).points);
            for seed in 1..=3 {
                let name = format!("rooms {method:?} {} turn {seed}", case.name);
                if !words.is_empty() && !words.iter().any(|word| name.contains(word.as_str())) {
                    continue;
                }
                let turn = any_turn(seed);
                let source = source.iter().map(|point| turn * point).collect();
                let [source, target] = [source, target.clone()]
                    .map(|points| PointCloud { points, ..PointCloud::default() });
                let options = CoarseOptions { coarse: Some(method), ..CoarseOptions::default() };
                let (_, fine) = methods(&case.name).swap_remove(0);
                let start = Instant::now();
                let found = coarse::align(&source, &target, None, (&options, &fine), &Silent);
                let ms = start.elapsed().as_secs_f64() * 1e3;
                let found = found.expect("it runs");
                let truth = case.truth * turn.inverse();
                let pose = found.alignment.target_from_source;
                let is_right = is_right(case, &pose, &truth, &source.points);
                let is_ok = found.alignment.verdict == Verdict::Ok;
                let off = off(&pose, &truth, &source.points);
                let is_near = off < fine.max_distance.unwrap_or(0.0);
                let place = [(is_right, "right"), (is_near, "near"), (true, "WRONG")];
                let i = place.iter().position(|(is, _)| *is).expect("the last is");
                counts[i][usize::from(!is_ok)] += 1;
                slowest = slowest.max(ms);
                sum += ms;
                let reasons: Vec<String> =
                    found.alignment.reasons.iter().map(ToString::to_string).collect();
                println!(
                    "{name:44} {:5} {off:8.1} mm {ms:7.1} ms {} from {}, fit {:.3}, {:?} {:?} {}",
                    place[i].1,
                    found.alignment.verdict,
                    found.started_from,
                    found.fit,
                    found.planes,
                    found.support,
                    reasons.join("; "),
                );
            }
        }
        let n = counts.iter().flatten().sum::<u32>().max(1);
        println!(
            "rooms {method:?}: of {n}, [ok, not ok] right {:?}, near {:?}, wrong {:?}; {:.0} ms on the \
             mean, {slowest:.0} at most",
            counts[0],
            counts[1],
            counts[2],
            sum / f64::from(n)
        );
    }
}

/// Within what the case calls right.
fn is_right(case: &Case, pose: &Pose, truth: &Pose, source: &[Point3]) -> bool {
    if !case.name.starts_with("gap") {
        return off(pose, truth, source) < case.ok_below;
    }
    let error = truth.inverse() * pose;
    error.translation.vector.norm() < GAP_SHIFT
        && error.rotation.angle().to_degrees() < GAP_TURN_DEG
}

/// Pairs of bunny scans whose source was turned at random, from nothing.
fn turned_pairs(data: &Path, words: &[String]) {
    let known = cases(&data.join("pairs/icp.csv"));
    let truth = |name: &str| {
        let case = known.iter().find(|case| case.name.starts_with(name));
        case.expect("the pair is in the list").truth
    };
    let across = truth("bun315-bun000").inverse() * truth("bun045-bun000");
    let mut all: Vec<(&str, Pose)> =
        ["bun045-bun000", "bun315-bun000", "bun090-bun045", "chin-bun315"]
            .iter()
            .map(|name| (*name, truth(name)))
            .collect();
    all.push(("bun045-bun315", across));
    for method in [Coarse::Auto, Coarse::FpfhRansac, Coarse::FpfhGnc] {
        let (mut n_right, mut n_all, mut slowest) = (0, 0, 0.0_f64);
        for (pair, truth) in &all {
            for seed in 1..=3 {
                let name = format!("coarse {method:?} {pair} turn {seed}");
                if !words.is_empty() && !words.iter().any(|word| name.contains(word.as_str())) {
                    continue;
                }
                let [source, target] = sides(data, pair).map(|path| read(&path));
                let turn = any_turn(seed);
                let source = PointCloud {
                    points: source.points.iter().map(|point| turn * point).collect(),
                    ..PointCloud::default()
                };
                let options = CoarseOptions { coarse: Some(method), ..CoarseOptions::default() };
                let fine = IcpOptions { voxel: Some(1.0), ..IcpOptions::default() };
                let start = Instant::now();
                let found = coarse::align(&source, &target, None, (&options, &fine), &Silent);
                let ms = start.elapsed().as_secs_f64() * 1e3;
                let found = found.expect("it runs");
                let pose = found.alignment.target_from_source;
                let off = off(&pose, &(truth * turn.inverse()), &source.points);
                n_all += 1;
                n_right += u32::from(off < 1.0);
                slowest = slowest.max(ms);
                println!(
                    "{name:44} {off:8.3} mm {ms:7.1} ms {} from {}, fit {:.3}, {:?}",
                    found.alignment.verdict, found.started_from, found.fit, found.support
                );
            }
        }
        println!(
            "coarse {method:?}: {n_right} of {n_all} below 1 mm, the slowest in {slowest:.0} ms"
        );
    }
}

/// A turn of all, each as likely.
fn any_turn(seed: u64) -> Pose {
    let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(seed);
    let mut normal = || (0..12).map(|_| random.random_range(0.0..1.0)).sum::<f64>() - 6.0;
    let turn = nalgebra::Quaternion::new(normal(), normal(), normal(), normal());
    Pose::from_parts(
        nalgebra::Translation3::identity(),
        nalgebra::UnitQuaternion::from_quaternion(turn),
    )
}

fn report(
    name: &str,
    case: &Case,
    source: &PointCloud,
    (to, back, ms): (Alignment, Alignment, f64),
) {
    let off = off(&to.target_from_source, &case.truth, &source.points);
    let is_right = is_right(case, &to.target_from_source, &case.truth, &source.points);
    let swapped = back.target_from_source.inverse();
    let loop_off = self::off(&swapped, &to.target_from_source, &source.points);
    let turn = swapped.rotation.angle_to(&to.target_from_source.rotation).to_degrees();
    let reasons: Vec<String> = to.reasons.iter().map(ToString::to_string).collect();
    println!(
        "{name:44} {:5} {off:8.3} mm {ms:7.1} ms {:3} steps, swapped {loop_off:7.4} mm {turn:.4} deg {}, {} \
         [held {:.4} overlap {:.2} {:.2} plane {:.3} rough {:.3} rms {:.3} moved {:.1}] {}",
        if is_right { "right" } else { "WRONG" },
        to.n_iterations,
        back.verdict,
        to.verdict,
        to.least_held,
        to.overlap[0],
        to.overlap[1],
        to.plane_distance,
        to.roughness,
        to.rms,
        to.moved,
        reasons.join("; "),
    );
}

fn timed(
    source: &PointCloud,
    target: &PointCloud,
    init: &Pose,
    options: &IcpOptions,
) -> (Alignment, f64) {
    let mut best = f64::INFINITY;
    let mut found = None;
    for _ in 0..RUNS {
        let start = Instant::now();
        found = Some(align(source, target, init, options, &Silent).expect("it runs"));
        best = best.min(start.elapsed().as_secs_f64() * 1e3);
    }
    (found.expect("it ran"), best)
}

fn methods(name: &str) -> Vec<(&'static str, IcpOptions)> {
    let with = |voxel: f64, far: f64, fine: Metric, kernel: Kernel| IcpOptions {
        voxel: Some(voxel),
        max_distance: Some(far),
        fine: Some(fine),
        kernel,
        ..IcpOptions::default()
    };
    if name.contains("bun") {
        vec![
            ("gicp", with(1.0, 20.0, Metric::Generalised, Kernel::None)),
            ("plane-tukey", with(1.0, 20.0, Metric::PointToPlane, Kernel::Tukey)),
        ]
    } else if name.starts_with("tum") || name.starts_with("gap") {
        vec![
            ("gicp", with(20.0, 150.0, Metric::Generalised, Kernel::None)),
            ("coloured", with(20.0, 150.0, Metric::Coloured, Kernel::None)),
        ]
    } else {
        vec![("gicp", with(250.0, 1000.0, Metric::Generalised, Kernel::None))]
    }
}

/// Root mean square displacement of `points` between two poses [mm].
fn off(a: &Pose, b: &Pose, points: &[Point3]) -> f64 {
    let sum: f64 = points.iter().map(|p| (a * p - b * p).norm_squared()).sum();
    (sum / points.len() as f64).sqrt()
}

fn cases(path: &Path) -> Vec<Case> {
    let text = std::fs::read_to_string(path).expect("the list of pairs");
    let case = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        let numbers: Vec<f64> =
            cells[1..26].iter().map(|cell| cell.trim().parse().expect("a number")).collect();
        Case {
            name: cells[0].to_owned(),
            init: pose(&numbers[..12]),
            truth: pose(&numbers[12..24]),
            ok_below: numbers[24],
        }
    };
    text.lines().skip(1).map(case).collect()
}

/// The frame pairs of the list of gaps, from where they are; truth between the two nearest stamps.
fn gaps(data: &Path) -> Vec<Case> {
    let folder = data.join("rgbd/tum_fr1_rpy_cut");
    let depth = stamps(&folder.join("depth.txt"));
    let truth: Vec<Vec<f64>> = std::fs::read_to_string(folder.join("groundtruth.txt"))
        .expect("the truth")
        .lines()
        .filter(|line| !line.starts_with('#'))
        .map(|line| line.split_whitespace().map(|x| x.parse().expect("a number")).collect())
        .collect();
    let at = |row: &[f64]| {
        let turn = nalgebra::Quaternion::new(row[7], row[4], row[5], row[6]);
        let shift = nalgebra::Vector3::new(row[1], row[2], row[3]) * 1e3;
        Pose::from_parts(shift.into(), nalgebra::UnitQuaternion::from_quaternion(turn))
    };
    let world = |stamp: f64| {
        let next = truth.partition_point(|row| row[0] < stamp).clamp(1, truth.len() - 1);
        let (a, b) = (&truth[next - 1], &truth[next]);
        at(a).lerp_slerp(&at(b), (stamp - a[0]) / (b[0] - a[0]))
    };
    let list = std::fs::read_to_string(data.join("pairs/gaps_tum_fr1_rpy_cut.csv"));
    let pair = |line: &str| {
        let mut cells = line.split(',').map(str::parse::<usize>);
        let mut next = || cells.next().expect("a cell").expect("a frame");
        let (i, j) = (next(), next());
        Case {
            name: format!("gap-f{i}+{}", j - i),
            init: Pose::identity(),
            truth: world(depth[i].0).inverse() * world(depth[j].0),
            ok_below: 0.0,
        }
    };
    list.expect("the list of gaps").lines().skip(1).map(pair).collect()
}

/// Three rows of a matrix, in metres.
fn pose(rows: &[f64]) -> Pose {
    let rotation = nalgebra::Matrix3::from_fn(|a, b| rows[4 * a + b]);
    let rotation = nalgebra::UnitQuaternion::from_matrix(&rotation);
    let shift = nalgebra::Vector3::from_fn(|a, _| rows[4 * a + 3] * 1e3);
    Pose::from_parts(shift.into(), rotation)
}

/// Source and target of a pair: a scan, or a depth image.
fn sides(data: &Path, name: &str) -> [PathBuf; 2] {
    let scans = data.join("scans");
    if name == "lidar-pair" {
        return ["source.ply", "target.ply"].map(|file| scans.join("small_gicp_pair").join(file));
    }
    let frames = name.strip_prefix("tum_fr1_rpy_cut-f").or(name.strip_prefix("gap-f"));
    if let Some(frames) = frames {
        let (target, gap) = frames.split_once('+').expect("frame and gap");
        let [target, gap] = [target, gap].map(|n| n.parse::<usize>().expect("a number"));
        let folder = data.join("rgbd/tum_fr1_rpy_cut");
        let list = stamps(&folder.join("depth.txt"));
        return [target + gap, target].map(|i| folder.join(&list[i].1));
    }
    let mut names = name.split('-');
    let mut next = || scans.join("stanford_bunny").join(format!("{}.ply", names.next().unwrap()));
    [next(), next()]
}

fn stamps(list: &Path) -> Vec<(f64, String)> {
    let text = std::fs::read_to_string(list).expect("a list of frames");
    let lines = text.lines().filter(|line| !line.starts_with('#'));
    lines
        .filter_map(|line| {
            let (stamp, file) = line.split_once(' ')?;
            Some((stamp.parse().ok()?, file.trim().to_owned()))
        })
        .collect()
}

fn read(path: &Path) -> PointCloud {
    if path.extension().is_some_and(|extension| extension == "png") {
        return read_depth(path);
    }
    let unit = Some(horma::geom::LengthUnit::Metre);
    horma::io::read_surface(path, unit).expect("a scan").surface.into_points()
}

/// Every second pixel of a depth image as a point, coloured by the image nearest in time.
fn read_depth(path: &Path) -> PointCloud {
    let folder = path.parent().and_then(Path::parent).expect("a sequence");
    let stamp: f64 = path.file_stem().and_then(|s| s.to_str()?.parse().ok()).expect("a stamp");
    let images = stamps(&folder.join("rgb.txt"));
    let nearest = |a: &&(f64, String), b: &&(f64, String)| {
        (a.0 - stamp).abs().total_cmp(&(b.0 - stamp).abs())
    };
    let image = &images.iter().min_by(nearest).expect("an image").1;
    let (width, depth) = pixels(path);
    let (_, color) = pixels(&folder.join(image));
    let mut cloud = PointCloud { colors: Some(Vec::new()), ..PointCloud::default() };
    for v in (0..depth.len() / 2 / width).step_by(2) {
        for u in (0..width).step_by(2) {
            let i = v * width + u;
            let z = f64::from(u16::from_be_bytes([depth[2 * i], depth[2 * i + 1]])) / DEPTH_PER_MM;
            if z > 0.0 {
                let [fx, fy, cx, cy] = CAMERA;
                let (x, y) = ((u as f64 - cx) / fx, (v as f64 - cy) / fy);
                cloud.points.push(Point3::new(x * z, y * z, z));
                let seen = [color[3 * i], color[3 * i + 1], color[3 * i + 2]];
                cloud.colors.as_mut().expect("colours").push(seen);
            }
        }
    }
    cloud
}

/// Width and bytes of a PNG.
fn pixels(path: &Path) -> (usize, Vec<u8>) {
    let file = std::io::BufReader::new(std::fs::File::open(path).expect("a picture"));
    let mut reader = png::Decoder::new(file).read_info().expect("a PNG");
    let mut bytes = vec![0; reader.output_buffer_size().expect("it fits")];
    let info = reader.next_frame(&mut bytes).expect("a frame");
    bytes.truncate(info.buffer_size());
    (info.width as usize, bytes)
}
