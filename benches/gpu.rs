//! Kernels against the processor's own loops, and the tree against trying every triangle: in one
//! process, ratios printed. `cargo bench --bench gpu`; with `HORMA_DATA` set on the real foot, else on
//! a bumpy cylinder. `cargo bench --bench gpu -- memory` instead digitizes 1,000,000 positions on
//! 2,048,000 triangles and prints the memory that took.

#[path = "../examples/experiments/lathe.rs"]
mod lathe;
#[path = "../examples/experiments/scan.rs"]
mod scan;

use horma::cam::{Device, Digitizer, Method, Part};
use horma::compute::{Gpu, Precision};
use horma::geom::{Pose, shapes};
use horma::progress::Silent;
use horma::tool::Profile;
use lathe::{Lathe, RADII, Spiral};
use scan::{Scan, WideScan};
use std::time::Instant;

/// Runs of each contender; the best counts.
const RUNS: usize = 5;
/// Of the cloud, the finest of the thesis [points/mm2].
const SURFACE: f64 = 0.72;
/// Positions on the cloud.
const ON_POINTS: usize = 4096;
/// Positions that every triangle is tried at.
const ON_TRIANGLES: usize = 256;
/// Positions on the triangles by the tree.
const BY_TREE: usize = 16_384;

fn main() -> anyhow::Result<()> {
    let gpu = Gpu::open(None)?;
    let lathe = Lathe::new()?;
    println!("{lathe}; {}; all threads", gpu.name());
    if std::env::args().any(|word| word == "memory") {
        return memory(&lathe, &gpu);
    }
    points(&lathe, &gpu)?;
    triangles(&lathe, &gpu)
}

/// One thing to be timed: how it is called, and what it does.
struct Contender<'a> {
    name: &'a str,
    n_positions: usize,
    run: Box<dyn Fn() -> anyhow::Result<()> + 'a>,
}

/// Microseconds a position of each, the best of several runs. They take turns, so that a machine whose
/// pace drifts is fair to all.
fn race(contenders: &[Contender]) -> anyhow::Result<Vec<f64>> {
    let mut best = vec![f64::INFINITY; contenders.len()];
    // Once more than counted: kernels are compiled for their first run.
    for run in 0..=RUNS {
        for (contender, best) in contenders.iter().zip(&mut best) {
            let started = Instant::now();
            (contender.run)()?;
            if 0 < run {
                *best =
                    best.min(started.elapsed().as_secs_f64() * 1e6 / contender.n_positions as f64);
            }
        }
    }
    for (contender, micros) in contenders.iter().zip(&best) {
        println!("  {:<44} {micros:9.2} us a position", contender.name);
    }
    Ok(best)
}

fn digitizer(part: &Part, method: Method) -> Digitizer<'_> {
    let [major_radius, minor_radius] = RADII;
    let cutter = Profile::Wheel { major_radius, minor_radius }.cutter(0.0);
    Digitizer { part, cutter, method }
}

/// A stretch in the middle of a spiral of a step each 0.72 mm.
struct Stretch {
    spiral: Spiral,
    from: usize,
    n: usize,
}

impl Stretch {
    fn new(lathe: &Lathe, n: usize) -> Self {
        let spiral = lathe.spiral(1.0 / 0.72);
        Self { from: (spiral.n - n) / 2, spiral, n }
    }

    fn pose(&self, i: usize) -> Pose {
        self.spiral.pose(self.from + i)
    }

    fn contender<'a>(
        &'a self,
        name: &'a str,
        run: impl Fn() -> anyhow::Result<()> + 'a,
    ) -> Contender<'a> {
        Contender { name, n_positions: self.n, run: Box::new(run) }
    }

    fn on_cpu<'a>(&'a self, name: &'a str, digitizer: Digitizer<'a>) -> Contender<'a> {
        self.contender(name, move || {
            digitizer.run(self.n, |i| self.pose(i), &Silent)?;
            Ok(())
        })
    }

    fn on_device<'a>(
        &'a self,
        name: &'a str,
        digitizer: Digitizer<'a>,
        device: Device<'a>,
    ) -> Contender<'a> {
        self.contender(name, move || {
            digitizer.run_on_gpu(&device, self.n, |i| self.pose(i), &Silent)?;
            Ok(())
        })
    }
}

fn points(lathe: &Lathe, gpu: &Gpu) -> anyhow::Result<()> {
    let cloud = lathe.points(SURFACE);
    let points: Vec<[f64; 3]> = cloud.points.iter().map(|&point| point.into()).collect();
    let part = Part::points(&cloud);
    let [all, tree] = [Method::Exhaustive, Method::Indexed].map(|method| digitizer(&part, method));
    let stretch = Stretch::new(lathe, ON_POINTS);
    let steps: Vec<_> = (0..stretch.n).map(|i| stretch.spiral.step(stretch.from + i)).collect();
    let (plain, wide) = (Scan::<f32>::new(&points, RADII), WideScan::new(&points, RADII));
    let device = Device::new(gpu);
    println!("\n{} positions on {} points", stretch.n, points.len());
    let mut contenders = vec![
        stretch.contender("loop of the thesis, f32, rayon", || {
            std::hint::black_box(plain.heights(&steps));
            Ok(())
        }),
        stretch.contender("the same, vectorised", || {
            std::hint::black_box(wide.heights(&steps));
            Ok(())
        }),
        stretch.on_cpu("ours, f64, every point", all),
        stretch.on_cpu("ours, f64, by the tree", tree),
        stretch.on_device("kernel, f32, every point", all, device),
        stretch.on_device("kernel, f32, by the tree", tree, device),
    ];
    if gpu.has(Precision::Double) {
        let device = Device { precision: Precision::Double, ..device };
        contenders.push(stretch.on_device("kernel, f64, every point", all, device));
    }
    let micros = race(&contenders)?;
    println!(
        "  the kernel that tries every point takes {:.2} times the loop",
        micros[4] / micros[0]
    );
    Ok(())
}

fn triangles(lathe: &Lathe, gpu: &Gpu) -> anyhow::Result<()> {
    let part = Part::triangles(&lathe.mesh);
    let [all, tree] = [Method::Exhaustive, Method::Indexed].map(|method| digitizer(&part, method));
    let (some, many) = (Stretch::new(lathe, ON_TRIANGLES), Stretch::new(lathe, BY_TREE));
    println!(
        "\n{} triangles: all of them at {} positions, by the tree at {}",
        lathe.mesh.triangles.len(),
        some.n,
        many.n
    );
    let device = Device::new(gpu);
    let micros = race(&[
        some.on_cpu("ours, f64, every triangle", all),
        many.on_cpu("ours, f64, by the tree", tree),
        some.on_device("kernel, f32, every triangle", all, device),
        many.on_device("kernel, f32, by the tree", tree, device),
    ])?;
    println!("  by the tree the kernel is {:.0} times as fast", micros[2] / micros[3]);
    Ok(())
}

/// More than a device sees at once.
fn memory(lathe: &Lathe, gpu: &Gpu) -> anyhow::Result<()> {
    let mesh = shapes::subdivide(&shapes::subdivide(&lathe.mesh));
    let n_triangles = mesh.triangles.len();
    let part = Part::triangles(&mesh);
    drop(mesh);
    let n = 1_000_000;
    let spiral = lathe.spiral(n as f64 * lathe::PITCH / lathe.area);
    let started = Instant::now();
    let found = digitizer(&part, Method::Indexed).run_on_gpu(
        &Device::new(gpu),
        n,
        |i| spiral.pose(i),
        &Silent,
    )?;
    println!(
        "{} positions on {n_triangles} triangles: {:.0} s, {} of them decided by the processor alone, \
         peak memory {}",
        found.contacts.len(),
        started.elapsed().as_secs_f64(),
        found.n_undecided,
        peak_memory()
    );
    Ok(())
}

/// Of this process, what a device in software takes included.
fn peak_memory() -> String {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let peak = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    peak.map_or_else(|| "not told by this system".into(), |peak| peak.trim().to_owned())
}
