//! How long the planner needs for a path, and that it is linear in its length:
//! `cargo bench --bench schedule`.

use horma::cam::{Motion, drives, time_motion};
use horma::machine::Machine;
use std::f64::consts::TAU;
use std::time::Instant;

/// Runs of each length; the best counts.
const RUNS: usize = 5;

fn main() {
    let machine = Machine::builtin("last-lathe").expect("it comes with horma");
    let drives = drives(&machine);
    println!("look-ahead       moves          ms   us a move");
    for look_ahead in [None, Some(16), Some(200)] {
        for n_moves in [50_000, 1_000_000] {
            let (ways, least) = spiral(n_moves);
            let motion = Motion { drives: &drives, ways: &ways, least: &least, look_ahead };
            let seconds = (0..RUNS).map(|_| {
                let start = Instant::now();
                std::hint::black_box(time_motion(&motion));
                start.elapsed().as_secs_f64()
            });
            let best = seconds.fold(f64::INFINITY, f64::min);
            let seen = look_ahead.map_or("all".to_owned(), |seen: usize| seen.to_string());
            println!(
                "{seen:>10} {n_moves:>11} {:>11.1} {:>11.3}",
                best * 1e3,
                best * 1e6 / n_moves as f64
            );
        }
    }
}

/// Y = 60 + 12 cos 2A, 2 mm of X a turn, 360 steps, at 150 rpm; the infeed cannot follow.
fn spiral(n_moves: usize) -> (Vec<f64>, Vec<f64>) {
    let at = |i: usize| {
        let a = i as f64 * TAU / 360.0;
        [2.0 * a / TAU, 60.0 + 12.0 * (2.0 * a).cos(), a]
    };
    let way = |i: usize| [0, 1, 2].map(|axis| at(i + 1)[axis] - at(i)[axis]);
    ((0..n_moves).flat_map(way).collect(), vec![60.0 / 150.0 / 360.0; n_moves])
}
