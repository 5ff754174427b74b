//! LinuxCNC's interpreter goes where the toolpath says, and takes as long.

use crate::rs274::{self, CanonicalMove};
use crate::small_machines::{lathe, mill, pair, random_path, values, wheel};
use horma::cam::{Move, Pace, Toolpath};
use horma::gcode::{Dialect, Header, PostWarning, Posted, Program, StepKind, check, post, restart};
use horma::io::{Overwrite, write_program};
use horma::machine::{AxisKind, Machine};

/// Half the last decimal of a word, and the noise of its binary form [mm or deg].
const HALF_A_DECIMAL: f64 = 0.5e-4 + 1e-9;

#[test]
fn a_last_is_turned_where_and_when_the_toolpath_says() {
    let steps = (0..=20 * 360).map(|i| {
        let turned = f64::from(i).to_radians();
        let seconds = (1.0 + 0.5 * (0.01 * f64::from(i)).sin()) / 360.0;
        let x = 2.0 * f64::from(i) / 360.0;
        (values([x, 60.0 + 12.0 * (2.0 * turned).cos(), -turned]), seconds)
    });
    takes_the_planned_time(&timed_path(steps));
}

#[test]
fn rings_and_pure_turns_take_their_time() {
    let rings = (0..12 * 90).map(|i| {
        let (ring, turned) = (f64::from(i / 90), f64::from(4 * i).to_radians());
        // Every other ring is a circle: only the spindle moves there.
        let bump = if i / 90 % 2 == 0 { 5.0 * (3.0 * turned).sin() } else { 0.0 };
        (values([3.0 * ring, 70.0 + bump, turned]), 0.02 + 0.01 * turned.sin())
    });
    takes_the_planned_time(&timed_path(rings));
}

#[test]
fn the_slowest_rate_of_the_control_is_told_and_counted() {
    // A degree in half a second with a hundredth of a millimetre or less beside it: below 0.1 mm/min the
    // interpreter goes no slower.
    let steps = (0..=200).map(|i| {
        let x = [0.0001, 0.0004, 0.002, 0.0][i % 4] + 0.01 * (i / 4) as f64;
        (values([x, 60.0, (i as f64).to_radians()]), 0.5)
    });
    let path = timed_path(steps);
    let posted = judged(&lathe(), &path);
    let [PostWarning::FeedRaised { n_blocks, seconds, min_rate, first_line }] = posted.warnings[..]
    else {
        panic!("one warning, not {:?}", posted.warnings)
    };
    assert!((50..=150).contains(&n_blocks), "{n_blocks}");
    assert_eq!(min_rate, 0.1);
    let programmed = check(&posted.program, &lathe()).feed_seconds;
    let planned = planned_seconds(&path);
    assert!((planned - seconds - programmed).abs() < 1e-3 * planned, "{planned} {programmed}");
    assert!(seconds > 1.0, "{seconds}");
    let first = &posted.program.blocks[first_line as usize - 1];
    assert_eq!(first.line, first_line);
}

#[test]
fn random_paths_on_every_machine_agree_with_the_interpreter() {
    for (machine, seed) in [(lathe(), 1), (pair(), 2), (mill(), 3)] {
        judged(&machine, &random_path(&machine, 2000, seed));
    }
}

#[test]
fn a_restarted_program_goes_the_rest_of_the_way() {
    if !rs274::is_here() {
        return;
    }
    let machine = lathe();
    let path = random_path(&machine, 300, 4);
    let whole = post(&path, &machine, &wheel(), &linuxcnc(), &Header::default()).unwrap().program;
    let whole_moves = interpreted(&whole);
    for line in [60, 120, 200] {
        let rest = interpreted(&restart(&whole, &machine, line, Some(300.0)).unwrap());
        let n_left = whole.steps(&machine).filter(|step| step.line >= line).count();
        let ends = |moves: &[CanonicalMove]| {
            moves[moves.len() - n_left..].iter().map(|step| step.to).collect::<Vec<_>>()
        };
        assert_eq!(ends(&rest), ends(&whole_moves), "from line {line}");
    }
}

/// A path down from Y = 150 and along `steps`, each a position and the time to it.
fn timed_path(steps: impl Iterator<Item = ([f64; 6], f64)>) -> Toolpath {
    let clear = 150.0;
    let mut moves = Vec::new();
    for (to, seconds) in steps {
        if moves.is_empty() {
            moves.push(Move { to: values([to[0], clear, to[2]]), pace: Pace::Rapid });
            moves.push(Move { to, pace: Pace::Feed(20.0) });
        } else {
            moves.push(Move { to, pace: Pace::Duration(seconds) });
        }
    }
    Toolpath { moves, clear }
}

/// Holds the program of `path` against rs274, and its time against that of the toolpath.
fn takes_the_planned_time(path: &Toolpath) {
    let posted = judged(&lathe(), path);
    assert_eq!(posted.warnings, []);
    let (planned, programmed) =
        (planned_seconds(path), check(&posted.program, &lathe()).feed_seconds);
    assert!((planned - programmed).abs() < 1e-3 * planned, "{programmed} s for {planned} s");
}

/// Posts `path` and holds what rs274 and our reader make of it against it.
fn judged(machine: &Machine, path: &Toolpath) -> Posted {
    let posted = post(path, machine, &wheel(), &linuxcnc(), &Header::default()).unwrap();
    if !rs274::is_here() {
        return posted;
    }
    let moves = interpreted(&posted.program);
    goes_along(machine, path, &moves);
    let judged: f64 = moves.iter().map(|step| step.seconds).sum();
    let steps = posted.program.steps(machine).filter(|step| step.kind != StepKind::Rapid);
    let programmed: f64 = steps.filter_map(|step| step.seconds).sum();
    assert!((judged - programmed).abs() < 1e-3 * programmed, "{judged} s for {programmed} s");
    let report = check(&posted.program, machine);
    assert_eq!(report.violations, []);
    posted
}

/// Fails unless `moves` approach `path`, go along it and retreat.
pub(crate) fn goes_along(machine: &Machine, path: &Toolpath, moves: &[CanonicalMove]) {
    let slot = |letter: char| "XYZABC".find(letter).unwrap();
    let near = |target: &[f64; 6], to: &[f64; 6]| {
        machine.axes.iter().zip(target).all(|(axis, &value)| {
            let word = if axis.kind == AxisKind::Rotary { value.to_degrees() } else { value };
            (word - to[slot(axis.letter)]).abs() <= HALF_A_DECIMAL
        })
    };
    let mut moves = moves.iter().filter(|step| step.rate != Some(0.0)).peekable();
    let mut at = [0.0; 6];
    for (i_move, step) in path.moves.iter().enumerate() {
        let target = machine.with_followers(&step.to);
        if i_move == 0 {
            // The approach: the attack axis twice, the others, the attack axis if the path begins lower.
            at = moves.by_ref().take(3).last().expect("a program has an approach").to;
            while !near(&target, &at) {
                at = moves.next().expect("the approach reaches the start").to;
            }
        } else if moves.peek().is_some_and(|next| near(&target, &next.to)) {
            at = moves.next().unwrap().to;
        }
        assert!(near(&target, &at), "move {i_move} ends at {at:?} instead of {target:?}");
    }
    // Nothing but the retreat is left.
    assert!(moves.count() <= 1);
}

fn interpreted(program: &Program) -> Vec<CanonicalMove> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("program.ngc");
    write_program(&path, Overwrite::Refuse, program, &linuxcnc()).unwrap();
    rs274::interpret(&path)
}

fn planned_seconds(path: &Toolpath) -> f64 {
    let seconds = path.moves.iter().map(|step| match step.pace {
        Pace::Duration(seconds) => seconds,
        _ => 0.0,
    });
    let lowest = path.moves[1].to[1];
    seconds.sum::<f64>() + (path.clear - lowest) / 20.0
}

fn linuxcnc() -> Dialect {
    Dialect::named("linuxcnc").unwrap()
}
