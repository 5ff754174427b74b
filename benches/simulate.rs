//! A finishing pass cut in simulation, against trying every triangle for the same path: both in one
//! process, the ratio printed. `cargo bench --bench simulate`; with `HORMA_DATA` set on the real
//! foot, else on a bumpy cylinder.

use horma::cam::{Digitizer, Method, Part, SetupOptions, set_up};
use horma::geom::{Surface, TriMesh, shapes};
use horma::machine::{AxisValues, Machine};
use horma::progress::Silent;
use horma::stock::{Layout, Resolution, Stock, Sweep};
use horma::tool::{HeightFunction, Profile, Wheel};
use std::f64::consts::TAU;
use std::path::PathBuf;
use std::time::Instant;

/// Runs of the simulation; the best counts.
const RUNS: usize = 3;
const N_MOVES: usize = 50_000;
const PER_TURN: f64 = 200.0;
const RESOLUTION: f64 = 0.25;
const STOCK: f64 = 1.0;
/// Positions the exhaustive search is given, spread over the path.
const SOME: usize = 200;
const MAJOR: f64 = 60.0;
const MINOR: f64 = 10.0;

fn main() {
    let machine = Machine::builtin("last-lathe").expect("it comes with horma");
    let setup = set_up(Surface::Mesh(part()), &machine, &SetupOptions::default()).expect("it fits");
    let Surface::Mesh(mesh) = &setup.surface else { unreachable!("a mesh stays a mesh") };
    let cutter = Profile::Wheel { major_radius: MAJOR, minor_radius: MINOR }.cutter(0.0);
    let part = Part::triangles(mesh);
    let [from, to] = setup.stretch.map(|x| x.clamp(setup.part.min.x - 8.0, setup.part.max.x + 8.0));
    let values = |i: usize| {
        let share = i as f64 / N_MOVES as f64;
        [from + (to - from) * share, 0.0, -TAU * i as f64 / PER_TURN, 0.0, 0.0, 0.0]
    };
    let pose = |i: usize| machine.attack_from_part(&values(i));
    let digitizer = Digitizer { part: &part, cutter, method: Method::Indexed };
    let contacts = digitizer.run(N_MOVES + 1, pose, &Silent).expect("never cancelled");
    let clear = setup.swing + Wheel { major: MAJOR, minor: MINOR }.reach().top;
    let place = |i: usize| -> AxisValues {
        let mut values = values(i);
        values[machine.attack] = contacts[i].map_or(clear, |contact| contact.height);
        values
    };
    let sweeps: Vec<Sweep> =
        (0..N_MOVES).map(|i| Sweep { from: place(i), to: place(i + 1), engages: i == 0 }).collect();

    let resolution = Resolution::even(RESOLUTION);
    let layout = Layout::round(&machine, setup.stretch, setup.swing + STOCK, resolution);
    let layout = layout.expect("a lathe has a spindle").expect("it fits");
    let n_dexels = layout.n_rows() * layout.n_columns();
    let stock = Stock::of_mesh(layout, mesh).grown(STOCK);
    println!(
        "{} triangles, {N_MOVES} moves, {n_dexels} dexels of {RESOLUTION} mm, {STOCK} mm of stock",
        mesh.triangles.len()
    );

    let exhaustive = Digitizer { method: Method::Exhaustive, ..digitizer };
    let stride = N_MOVES / SOME;
    let start = Instant::now();
    on(1, || drop(exhaustive.run(SOME, |i| pose(i * stride), &Silent)));
    let exhaustive = start.elapsed().as_secs_f64() / SOME as f64 * N_MOVES as f64;
    for n_threads in [1, 2] {
        let mut best = f64::INFINITY;
        let mut removed = 0.0;
        let mut error = 0.0;
        for _ in 0..RUNS {
            let mut stock = stock.clone();
            let start = Instant::now();
            let cuts = on(n_threads, || stock.remove(&machine, &cutter, &sweeps, &Silent));
            best = best.min(start.elapsed().as_secs_f64());
            removed = cuts.expect("nothing tilts").iter().map(|cut| cut.removed).sum();
            error = stock.sweep_error();
        }
        println!(
            "{n_threads} threads: {best:.3} s ({removed:.0} mm3, sweep error {error:.4} mm); \
             exhaustive digitizing on one thread would take {exhaustive:.1} s: {:.0} times",
            exhaustive / best
        );
    }
    if let Some(peak) = peak_memory_mb() {
        println!("peak memory of all this {peak:.0} MB");
    }
}

/// The part, as its file has it.
fn part() -> TriMesh {
    let Some(data) = std::env::var_os("HORMA_DATA") else {
        eprintln!("HORMA_DATA is not set: a bumpy cylinder stands in for the foot");
        return shapes::bumpy_cylinder(128_000);
    };
    let path = PathBuf::from(data).join("lasts/find_foot/foot_mean_left.obj");
    let reading = horma::io::read_surface(&path, None).expect("the foot can be read");
    reading.surface.into_mesh().expect("the foot is a mesh")
}

fn on<T: Send>(n_threads: usize, work: impl FnOnce() -> T + Send) -> T {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads).build();
    pool.expect("a pool").install(work)
}

/// As the system counts it, where it does.
fn peak_memory_mb() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    line.trim().strip_suffix(" kB")?.trim().parse::<f64>().ok().map(|kb| kb / 1e3)
}
