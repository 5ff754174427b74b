//! A finishing pass cut in simulation, against trying every triangle for the same path: both in one
//! process, the ratio printed. `cargo bench --bench simulate`; with `HORMA_DATA` set on the real
//! foot, else on a bumpy cylinder.

use horma::cam::{Digitizer, Method, Part, SetupOptions, set_up};
use horma::geom::{Aabb, Surface, TriMesh, Vector3, shapes};
use horma::machine::{AxisValues, Machine};
use horma::progress::Silent;
use horma::stock::{Layout, Resolution, Stock, Sweep};
use horma::tool::Profile;
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
const WHEEL: Profile = Profile::Wheel { major_radius: 60.0, minor_radius: 10.0 };
const BALL: Profile = Profile::Ball { radius: 6.0 };

fn main() {
    finish("last-lathe", WHEEL);
    finish("mill-rotary", BALL);
    finish("mill-3axis", BALL);
    if let Some(peak) = peak_memory_mb() {
        println!("peak memory of all this {peak:.0} MB");
    }
}

/// A finishing pass: a helix around the part, or a raster over it.
fn finish(machine: &str, profile: Profile) {
    let machine = Machine::builtin(machine).expect("it comes with horma");
    let setup = set_up(Surface::Mesh(part()), &machine, &SetupOptions::default()).expect("it fits");
    let Surface::Mesh(mesh) = &setup.surface else { unreachable!("a mesh stays a mesh") };
    let cutter = profile.cutter(0.0);
    let part = Part::triangles(mesh);
    let block = Aabb {
        min: setup.part.min - Vector3::repeat(STOCK),
        max: setup.part.max + Vector3::repeat(STOCK),
    };
    let values = |i: usize| {
        let share = i as f64 / N_MOVES as f64;
        let mut values = machine.at_rest();
        let along = |[from, to]: [f64; 2], share: f64| from + (to - from) * share;
        if let Some(spindle) = machine.spindle {
            values[0] = along([block.min.x, block.max.x], share);
            values[spindle] = -TAU * i as f64 / PER_TURN;
        } else {
            // Rows to and fro along X, a position every millimetre.
            let per_row = (block.max.x - block.min.x).ceil();
            let way = i as f64 / per_row;
            let in_row =
                if (way as usize).is_multiple_of(2) { way.fract() } else { 1.0 - way.fract() };
            values[0] = along([block.min.x, block.max.x], in_row);
            values[1] = along([block.min.y, block.max.y], way.floor() * per_row / N_MOVES as f64);
        }
        values
    };
    let pose = |i: usize| machine.attack_from_part(&values(i));
    let digitizer = Digitizer { part: &part, cutter, method: Method::Indexed };
    let contacts = digitizer.run(N_MOVES + 1, pose, &Silent).expect("never cancelled");
    let highest = contacts.iter().flatten().map(|c| c.height).fold(f64::NEG_INFINITY, f64::max);
    let place = |i: usize| -> AxisValues {
        let mut values = values(i);
        let height = contacts[i].map_or(highest, |contact| contact.height);
        values[machine.attack] = machine.axes[machine.attack].word(height);
        values
    };
    let sweeps: Vec<Sweep> =
        (0..N_MOVES).map(|i| Sweep { from: place(i), to: place(i + 1), engages: i == 0 }).collect();

    let resolution = Resolution::even(RESOLUTION);
    let round = Layout::round(&machine, setup.stretch, setup.swing + STOCK, resolution);
    let on_table = || Layout::new(&machine, &machine.at_rest(), &block, resolution);
    let layout = round.unwrap_or_else(on_table).expect("it fits");
    let n_dexels = layout.n_rows() * layout.n_columns();
    let stock = Stock::of_mesh(layout, mesh).grown(STOCK);
    println!(
        "{profile} on {}: {} triangles, {N_MOVES} moves, {n_dexels} dexels of {RESOLUTION} mm, \
         {STOCK} mm of stock",
        machine.name,
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
            "  {n_threads} threads: {best:.3} s ({removed:.0} mm3, sweep error {error:.4} mm); \
             exhaustive digitizing on one thread would take {exhaustive:.1} s: {:.0} times",
            exhaustive / best
        );
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
