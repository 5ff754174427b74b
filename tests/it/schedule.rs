//! The planner against a search of the whole phase plane, and the times of whole programs.

use crate::jobs::{cut, program_of, try_cut};
use crate::parts::real;
use horma::cam::{Drive, Motion, Strategy, drives, time_motion};
use horma::gcode::{Dialect, check, read};
use horma::geom::{LengthUnit, shapes};
use horma::io::read_surface;
use horma::machine::Machine;
use horma::workflow::cam::CamOptions;
use std::f64::consts::TAU;
use std::fmt::Write as _;

const LATHE: &str = "last-lathe";

/// The spiral: Y = 60 + 12 cos 2A, 2 mm of X a turn, 360 steps.
const PER_TURN: usize = 360;

/// X, Y and A, of which Y alone is a limit: 40 rad/s are 382 rpm.
fn strong_but_for_y(acceleration: f64) -> [Drive; 3] {
    let free = Drive { velocity: 40.0, acceleration: 1e7, rounding: 0.01 };
    [free, Drive { velocity: 500.0, acceleration, rounding: 0.01 }, free]
}

/// The ways of so many turns, and the least time of each step at `rpm`.
fn spiral(turns: usize, rpm: f64) -> (Vec<f64>, Vec<f64>) {
    let n = turns * PER_TURN;
    let at = |i: usize| {
        let a = TAU * i as f64 / PER_TURN as f64;
        [2.0 * a / TAU, 60.0 + 12.0 * (2.0 * a).cos(), a]
    };
    let way = |i: usize| [0, 1, 2].map(|axis| at(i + 1)[axis] - at(i)[axis]);
    let ways = (0..n).flat_map(way).collect();
    (ways, vec![60.0 / rpm / PER_TURN as f64; n])
}

fn seconds(drives: &[Drive], ways: &[f64], least: &[f64]) -> f64 {
    let timings = time_motion(&Motion { drives, ways, least, look_ahead: None });
    timings.iter().map(|timing| timing.seconds).sum()
}

#[track_caller]
fn assert_within_2_percent(planned: f64, expected: f64) {
    let off = 100.0 * (planned / expected - 1.0);
    eprintln!("planned {planned:.3} s, reference {expected:.3} s: {off:+.2} %");
    assert!(off.abs() < 2.0, "planned {planned:.3} s, reference {expected:.3} s");
}

#[test]
fn the_reference_spiral_takes_the_time_its_infeed_allows() {
    for (rpm, expected) in [(60.0, 140.0), (150.0, 56.0), (300.0, 33.0)] {
        let (ways, least) = spiral(140, rpm);
        assert_within_2_percent(seconds(&strong_but_for_y(60_000.0), &ways, &least), expected);
    }
}

#[test]
fn a_weak_infeed_is_time_optimal_on_the_spiral() {
    // With the spindle's real acceleration and without; from rest to rest.
    let lathe = drives(&Machine::builtin(LATHE).unwrap());
    for (drives, rpm) in [
        (&strong_but_for_y(5_000.0)[..], 150.0),
        (&strong_but_for_y(5_000.0)[..], 300.0),
        (&lathe[..], 150.0),
    ] {
        let turns = 2;
        let (ways, least) = spiral(turns, rpm);
        let [_, y, a] = [drives[0], drives[1], drives[2]];
        // Along A itself, from the formula and not from steps.
        let length = TAU / 180.0;
        let top = (rpm * TAU / 60.0).min(a.velocity);
        let piece = |i: usize| {
            let s = (i as f64 + 0.5) * length;
            let first = vec![-24.0 * (2.0 * s).sin(), 1.0];
            Piece { length, first, second: vec![-48.0 * (2.0 * s).cos(), 0.0], top }
        };
        let pieces: Vec<Piece> = (0..180 * turns).map(piece).collect();
        let expected = optimal_seconds(&[y, a], &pieces);
        assert_within_2_percent(seconds(drives, &ways, &least), expected);
    }
}

#[test]
fn a_weak_infeed_is_time_optimal_on_a_foot() {
    let Some(path) = real("lasts/find_foot/foot_mean_left.obj") else { return };
    let foot = read_surface(&path, Some(LengthUnit::Millimetre)).unwrap().surface;
    let options = CamOptions { pitch: Some(20.0), ..Default::default() };
    let plan = try_cut(foot, LATHE, &options).unwrap();
    let machine = Machine::builtin(LATHE).unwrap();
    let program = program_of(&plan, &machine);
    let ends: Vec<_> = program.steps(&machine).filter_map(|step| step.values(&program)).collect();
    // A turn from where it is well on the foot.
    let from = ends.len() / 3;
    let positions = &ends[from..=from + PER_TURN];
    let way = |i: usize| [0, 1, 2].map(|axis| positions[i + 1][axis] - positions[i][axis]);
    let ways: Vec<[f64; 3]> = (0..PER_TURN).map(way).collect();
    let lathe = drives(&machine);
    let least = 60.0 / RPM / PER_TURN as f64;
    let planned = seconds(&lathe, ways.as_flattened(), &[least; PER_TURN]);
    let expected = optimal_seconds(&lathe, &rounded(&ways, &lathe, 1.0 / least));
    assert_within_2_percent(planned, expected);
}

/// The foot cannot be turned so fast: the infeed limits nearly everywhere.
const RPM: f64 = 80.0;

/// The path of equal steps with its corners rounded by parabolas, counted in steps: straight pieces
/// and, from as far before a corner to as far behind it, pieces whose slope goes evenly from one
/// step's way to the next one's. A parabola passes its corner at a quarter of the change of way.
fn rounded(ways: &[[f64; 3]], drives: &[Drive], top: f64) -> Vec<Piece> {
    let change = |i: usize| [0, 1, 2].map(|axis| ways[i + 1][axis] - ways[i][axis]);
    let half = |i: usize| {
        let allowed =
            change(i).into_iter().zip(drives).map(|(d, drive)| 4.0 * drive.rounding / d.abs());
        allowed.fold(0.5, f64::min)
    };
    let piece = |length: f64, first: [f64; 3], second: [f64; 3]| {
        let speeds = first.iter().zip(drives).map(|(slope, drive)| drive.velocity / slope.abs());
        let top = speeds.fold(top, f64::min);
        Piece { length, first: first.to_vec(), second: second.to_vec(), top }
    };
    let mut pieces = Vec::new();
    let mut behind = 0.0;
    for (i, way) in ways.iter().enumerate() {
        let ahead = if i + 1 < ways.len() { half(i) } else { 0.0 };
        if behind + ahead < 1.0 {
            pieces.push(piece(1.0 - behind - ahead, *way, [0.0; 3]));
        }
        if ahead > 0.0 {
            let bend = change(i).map(|d| d / (2.0 * ahead));
            for at in [0.5, 1.5] {
                let first = [0, 1, 2].map(|axis| way[axis] + at * ahead * bend[axis]);
                pieces.push(piece(ahead, first, bend));
            }
        }
        behind = ahead;
    }
    pieces
}

/// A piece of a path by some parameter: its length, first and second derivative of every axis in
/// its middle, and the greatest speed on it.
struct Piece {
    length: f64,
    first: Vec<f64>,
    second: Vec<f64>,
    top: f64,
}

/// So many levels of the square of the speed from rest to the greatest there is.
const LEVELS: usize = 3000;

/// The time-optimal motion by brute force: every station of the path times every level of the
/// square of the speed, the least time to the end from each, from the end backwards (Bellman). It
/// shares no step with the planner.
fn optimal_seconds(drives: &[Drive], pieces: &[Piece]) -> f64 {
    let top = pieces.iter().map(|piece| piece.top).fold(0.0, f64::max);
    let level = top * top / LEVELS as f64;
    let speeds: Vec<f64> = (0..=LEVELS).map(|i| (level * i as f64).sqrt()).collect();
    let mut to_end = vec![f64::INFINITY; LEVELS + 1];
    to_end[0] = 0.0;
    for piece in pieces.iter().rev() {
        let top = (piece.top.powi(2) / level + 1e-9) as usize;
        let time_from = |from: usize| {
            if from > top {
                return f64::INFINITY;
            }
            let [least, most] = reachable(piece, drives, from as f64 * level);
            let least = (least / level).ceil() as usize;
            // One beyond the last.
            let most = ((most / level).floor() + 1.0).clamp(0.0, top as f64 + 1.0) as usize;
            let times = (least..most)
                .map(|to| to_end[to] + 2.0 * piece.length / (speeds[from] + speeds[to]));
            times.fold(f64::INFINITY, f64::min)
        };
        to_end = (0..=LEVELS).map(time_from).collect();
    }
    to_end[0]
}

/// Squares of speed that all axes can have at the end of a piece that begins with `x`:
/// `|q' (y - x) / 2h + q'' (x + y) / 2| <= a`.
fn reachable(piece: &Piece, drives: &[Drive], x: f64) -> [f64; 2] {
    let mut range = [0.0, f64::INFINITY];
    for ((first, second), drive) in piece.first.iter().zip(&piece.second).zip(drives) {
        let (ramp, bend) = (first / (2.0 * piece.length), second / 2.0);
        let (rise, rest, a) = (ramp + bend, (bend - ramp) * x, drive.acceleration);
        if rise == 0.0 {
            if rest.abs() > a {
                return [f64::INFINITY, 0.0];
            }
            continue;
        }
        let (one, other) = ((a - rest) / rise, (-a - rest) / rise);
        range = [range[0].max(one.min(other)), range[1].min(one.max(other))];
    }
    range
}

#[test]
fn a_program_takes_the_time_of_its_ramps_too() {
    // Y: 30 mm down at 10 mm/s, v / a = 2 ms; up at 500 mm/s, which 30 mm do not suffice for.
    let text = "G21 G90 G94\nG0 Y100\nG0 X0 A0\nS1 M3\nG1 Y70 F600\nG4 P0.5\nG0 Y100\nM5\nM30\n";
    let machine = Machine::builtin(LATHE).unwrap();
    let report = check(&read(&mut text.as_bytes(), &machine, &linuxcnc()).unwrap(), &machine);
    let planned = report.planned;
    assert!((planned.cutting - 3.002).abs() < 1e-9, "{planned}");
    assert!((planned.retreat - 2.0 * (30.0_f64 / 5_000.0).sqrt()).abs() < 1e-9, "{planned}");
    assert_eq!((planned.approach, planned.links, planned.pauses), (0.0, 0.0, 0.5));
    assert_eq!(planned.total(), planned.cutting + planned.retreat + 0.5);
    assert!(report.seconds < planned.total());
}

#[test]
fn rapids_between_cuts_are_links_and_stand_at_both_ends() {
    // Down 10 mm and up again, twice, 30 mm of X apart.
    let text = "G21 G90 G94\nG0 Y100\nG0 X0 A0\nS1 M3\nG1 Y90 F600\nG1 Y100\nG0 X15\nG0 X30\n\
                G1 Y90\nG1 Y100\nM5\nM30\n";
    let machine = Machine::builtin(LATHE).unwrap();
    let planned =
        check(&read(&mut text.as_bytes(), &machine, &linuxcnc()).unwrap(), &machine).planned;
    // It cruises at 150 mm/s from 7.5 mm on.
    let link = 30.0 / 150.0 + 150.0 / 1_500.0;
    assert!((planned.links - link).abs() < 1e-9, "{planned}, not {link}");
    assert_eq!((planned.approach, planned.retreat), (0.0, 0.0));
    // Four times 10 mm at 10 mm/s, and a ramp of 2 ms at either end; it turns about at the bottom.
    assert!((4.0..4.01).contains(&planned.cutting), "{planned}");
}

#[test]
fn a_program_that_asks_too_much_is_told_by_how_much_and_why() {
    // The spiral at 150 rpm as a program of one time a block, heedless of acceleration.
    let machine = Machine::builtin(LATHE).unwrap();
    let mut text = "G21 G90 G94\nG0 Y200\nG0 X0 A0\nS1 M3\nG1 Y72 F600\nG93\n".to_owned();
    let feed = 150.0 * PER_TURN as f64;
    for i in 1..=6 * PER_TURN {
        let a = TAU * i as f64 / PER_TURN as f64;
        let [x, y] = [2.0 * a / TAU, 60.0 + 12.0 * (2.0 * a).cos()];
        writeln!(text, "G1 X{x:.4} Y{y:.4} A{:.4} F{feed}", a.to_degrees()).unwrap();
    }
    text += "G94\nM5\nM30\n";
    let report = check(&read(&mut text.as_bytes(), &machine, &linuxcnc()).unwrap(), &machine);
    let most = report.slowed[0];
    assert!(most.is_worth_telling(report.planned.total()), "{most}");
    let (programmed, planned) = (report.feed_seconds, report.planned.cutting);
    assert!(programmed + 0.3 < planned, "programmed {programmed} s, planned {planned} s");
    let told = report.to_string();
    let because = told.lines().find(|line| line.starts_with("the acceleration of")).unwrap();
    assert!(because.contains("of the feed on") && because.contains("in line"), "{because}");
}

#[test]
fn the_time_of_a_job_is_that_of_its_program() {
    let part = shapes::prism(90, 30.0, 60.0);
    let options = CamOptions {
        axis: Some("x".into()),
        strategy: Some(Strategy::Helix),
        pitch: Some(6.0),
        rpm: Some(140.0),
        ..Default::default()
    };
    let report = cut(&part, LATHE, &options).report;
    let (held, planned) = (&report.run.held, report.program.planned);
    // The plunge is the program's alone; it ends nearly at rest.
    let plunge = report.program.feed_seconds - held.taken;
    assert!(plunge > 0.0 && planned.cutting > held.taken, "{held:?}");
    assert!((planned.cutting - report.program.feed_seconds).abs() < 0.02 * planned.cutting);
    // 360 moves a turn at 140 rpm are 840 blocks a second.
    assert!(report.program.block_rate.unwrap().highest < 850.0);
    let told = report.warnings.join("\n");
    assert!(told.contains("the acceleration of A leaves"), "{told}");
}

#[test]
fn a_rotation_is_for_strategies_that_turn_the_part() {
    let options =
        CamOptions { rpm: Some(60.0), strategy: Some(Strategy::Lines), ..Default::default() };
    let part = horma::geom::Surface::Mesh(shapes::chiral(500));
    let told = try_cut(part, LATHE, &options).unwrap_err().to_string();
    assert!(told.contains("Lines does not turn it while cutting; use --feed"), "{told}");
}

fn linuxcnc() -> Dialect {
    Dialect::named("linuxcnc").unwrap()
}
