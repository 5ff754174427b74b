//! Programs are what their toolpaths say: written, read back, checked and taken up again.

use crate::small_machines::{lathe, mill, pair, random_path, values, wheel};
use horma::cam::{Move, Pace, Toolpath};
use horma::gcode::{
    BlockKind, CommentStyle, Dialect, Header, Numbering, PostError, Posted, Program, Step,
    StepKind, Tape, ViolationKind, check, post, read, restart, write,
};
use horma::machine::{AxisKind, Machine};
use std::fmt::Write;

#[test]
fn a_short_path_becomes_this_program() {
    let header = Header {
        lines: vec!["part: a last (left)".into()],
        stock: Some(12.5),
        ..Header::default()
    };
    let posted = post(&short_path(), &lathe(), &wheel(), &linuxcnc(), &header).unwrap();
    let expected = "\
(part: a last [left])
(X: 10.0000 to 12.0000 mm)
(Y: 70.0000 to 150.0000 mm)
(A: -720.0000 to 0.0000 deg)
(time: 0:00:07 h, accelerations included)
(moves: 8)
(assumes at most 12.50 mm of stock)
G21 G90 G94 G17 G40 G49 G80
G54
G64 P0.01
G0 Y150.0
T7 M6
S6000.0 M4
G0 Y150.0
G0 X10.0 A0.0
G1 Y70.0 F1200.0
G93
G1 X11.0 A-360.0 F60.0
G1 Y70.5 A-720.0 F40.0
G4 P0.25
G94
G1 X12.0 F600.0
G0 Y150.0
M5
M30
";
    assert_eq!(text(&posted.program, &linuxcnc()), expected);
    assert_eq!(posted.warnings, []);
}

#[test]
fn every_program_reads_back_as_it_was_posted() {
    let numbered = Dialect {
        block_numbers: Some(Numbering { step: 5, last: 1000 }),
        comment: CommentStyle::Semicolon,
        tape: Tape::Percent,
        ..linuxcnc()
    };
    for machine in [lathe(), pair(), mill()] {
        for seed in 0..20 {
            let path = random_path(&machine, 300, seed);
            for dialect in [linuxcnc(), numbered.clone()] {
                let posted = posted(&path, &machine, &dialect);
                let back = reread(&text(&posted.program, &dialect), &machine);
                for (back, posted) in back.blocks.iter().zip(&posted.program.blocks) {
                    assert_eq!(back, posted, "{} seed {seed}", machine.name);
                }
                assert_eq!(back.blocks.len(), posted.program.blocks.len());
            }
        }
    }
}

#[test]
fn every_program_goes_where_the_toolpath_goes_and_takes_as_long() {
    for machine in [lathe(), pair(), mill()] {
        for seed in 100..140 {
            let path = random_path(&machine, 300, seed);
            let program = posted(&path, &machine, &linuxcnc()).program;
            let program = reread(&text(&program, &linuxcnc()), &machine);
            goes_along(&machine, &path, &program);
            assert_eq!(check(&program, &machine).violations, []);
        }
    }
}

#[test]
fn durations_of_moves_too_small_to_write_are_not_lost() {
    // A hundredth of a decimal each, in ten microseconds.
    let step = |i: u32| Move {
        to: values([10.0 + 1e-6 * f64::from(i), 150.0, 0.0]),
        pace: if i == 0 { Pace::Rapid } else { Pace::Duration(1e-5) },
    };
    let path = Toolpath { moves: (0..=100_050).map(step).collect(), clear: 150.0 };
    let program = posted(&path, &lathe(), &linuxcnc()).program;
    let report = check(&program, &lathe());
    assert!((report.seconds - 1.0005).abs() < 1e-4, "{}", report.seconds);
    assert!(program.blocks.len() < 1050, "{}", program.blocks.len());
    let dwells = program.blocks.iter().filter(|block| matches!(block.kind, BlockKind::Dwell(_)));
    assert!(dwells.count() <= 1, "only what is left at the end is waited for");
}

#[test]
fn a_follower_has_words_of_its_own() {
    let program = posted(&short_path(), &pair(), &linuxcnc()).program;
    let text = text(&program, &linuxcnc());
    // A = -c and C = +c' with c' = -c: the second spindle turns the other way, its word the same.
    assert!(text.contains("G1 X11.0 A-360.0 C-360.0 F60.0"), "{text}");
    let step = program.steps(&pair()).last().unwrap();
    assert_eq!(step.values(&program).unwrap()[3], (-720_f64).to_radians());
}

#[test]
fn what_cannot_run_is_never_written() {
    let to = |x: f64, y: f64, a_deg: f64| values([x, y, a_deg.to_radians()]);
    let start = Move { to: to(0.0, 150.0, 0.0), pace: Pace::Rapid };
    let refusal = |moves: &[Move]| {
        let path = Toolpath { moves: moves.to_vec(), clear: 150.0 };
        let error = post(&path, &lathe(), &wheel(), &linuxcnc(), &Header::default());
        error.unwrap_err().to_string()
    };
    let second =
        |x: f64, y: f64, a_deg: f64, pace| refusal(&[start, Move { to: to(x, y, a_deg), pace }]);
    for (message, expected) in [
        (refusal(&[]), "the toolpath has no moves; there is nothing to write"),
        (
            refusal(&[Move { pace: Pace::Feed(1.0), ..start }]),
            "move 0 is not a rapid: the machine may stand anywhere; begin with one to the start",
        ),
        (
            second(400.001, 100.0, 0.0, Pace::Rapid),
            "move 1 sends X to 400.001 mm, outside its limits -50 to 400 mm; shift the part or \
             choose a larger machine",
        ),
        (second(f64::NAN, 100.0, 0.0, Pace::Rapid), "move 1 sends X to NaN, which is no position"),
        (
            second(0.0, 150.0, 90.0, Pace::Duration(0.099)),
            "move 1 asks A for 909.090909 deg/s, above its limit 900.000000; give the move more time",
        ),
        (
            second(0.0, 100.0, 0.0, Pace::Feed(501.0)),
            "move 1 asks Y for 501.000000 mm/s, above its limit 500.000000; give the move more time",
        ),
        (
            second(0.0, 100.0, 0.0, Pace::Feed(-3.0)),
            "move 1 has the feed -3; it must be a number greater than 0",
        ),
        (
            second(0.0, 100.0, 0.0, Pace::Duration(f64::INFINITY)),
            "move 1 has the duration inf; it must be a number greater than 0",
        ),
        (
            second(0.0, 150.0, 90.0, Pace::Feed(10.0)),
            "move 1 turns rotary axes only, but its feed is of linear ones; use a duration",
        ),
    ] {
        assert_eq!(message, expected);
    }
}

#[test]
fn the_clear_position_has_limits_too() {
    let path = Toolpath { clear: 251.0, ..short_path() };
    let error = post(&path, &lathe(), &wheel(), &linuxcnc(), &Header::default()).unwrap_err();
    assert!(matches!(error, PostError::Limit { axis: 'Y', word: 251.0, .. }), "{error}");
}

#[test]
fn a_control_without_inverse_time_gets_the_feed_of_the_length_it_measures() {
    let plain = Dialect { inverse_time: None, name: "plain".into(), ..linuxcnc() };
    let turned = text(&posted(&short_path(), &lathe(), &plain).program, &plain);
    // A millimetre beside the turn in a second, then half a one in a second and a half.
    assert!(turned.contains("G1 X11.0 A-360.0 F60.0\nG1 Y70.5 A-720.0 F20.0\n"), "{turned}");
    // Linear moves with a duration become a feed.
    let path = random_path(&mill(), 300, 5);
    let program = posted(&path, &mill(), &plain).program;
    assert!(!text(&program, &plain).contains("G93"));
    goes_along(&mill(), &path, &program);
}

#[test]
fn a_line_longer_than_the_control_reads_is_refused() {
    let narrow = Dialect { line_length: 40, name: "narrow".into(), ..linuxcnc() };
    let error = post(&short_path(), &pair(), &wheel(), &narrow, &Header::default()).unwrap_err();
    assert!(matches!(error, PostError::LineTooLong { limit: 40, .. }), "{error}");
}

#[test]
fn check_finds_every_violation_by_line() {
    let program = "\
(a program with everything wrong)
G21 G90 G94
G1 Y120 F600
G0 X500 A0
G0 X10 Y251
S100 M3
G93
G1 X20 A-10 F1000
G1 X30 A-20 F6
M5
G1 X40 F6
G1 X41 F6
";
    let report = check(&reread(program, &lathe()), &lathe());
    let found: Vec<_> = report
        .violations
        .iter()
        .map(|violation| format!("{}: {}", violation.line, violation.kind))
        .collect();
    let expected = [
        "3: a feed move before X was ever placed; begin with a rapid that does",
        "3: a feed move before Y was ever placed; begin with a rapid that does",
        "3: a feed move before A was ever placed; begin with a rapid that does",
        "3: feed moves begin here while the spindle stands",
        "4: X500 is outside the axis limits, -50 to 400 mm",
        "5: Y251 is outside the axis limits, 0 to 250 mm",
        "8: X would move at 166.667 mm/s; its limit is 100.000",
        "11: feed moves begin here while the spindle stands",
        "12: the program ends without M2 or M30",
    ];
    let slow = |mut machine: Machine| {
        machine.axes[0].velocity = 100.0;
        machine
    };
    let slow_report = check(&reread(program, &lathe()), &slow(lathe()));
    let slow_found: Vec<_> = slow_report
        .violations
        .iter()
        .map(|violation| format!("{}: {}", violation.line, violation.kind))
        .collect();
    assert_eq!(slow_found, expected);
    assert_eq!(found.len(), expected.len() - 1, "the fast machine can do line 8");
}

#[test]
fn check_tells_bounds_times_ways_and_lines() {
    let program = "G21\nG0 Y100\nG0 X0 A0\nS1 M3\nG1 Y70 F600\nG93\nG1 X10 A90 F30\nG4 P0.5\nG94\n\
                   G0 Y100\nM5\nM30\n";
    let report = check(&reread(program, &lathe()), &lathe());
    let bounds: Vec<_> = report
        .bounds
        .iter()
        .map(|axis| (axis.axis, axis.unit, axis.least, axis.greatest))
        .collect();
    assert_eq!(bounds, [('X', "mm", 0.0, 10.0), ('Y', "mm", 70.0, 100.0), ('A', "deg", 0.0, 90.0)]);
    assert_eq!((report.n_blocks, report.n_moves), (12, 5));
    assert_eq!((report.feed_seconds, report.feed_distance_mm), (5.0, 40.0));
    assert_eq!(report.rapid_distance_mm, 30.0);
    // A plunge of 3 s, a turn of 2, a pause of 0.5, and 30 mm up at 500 mm/s.
    assert!((report.seconds - 5.56).abs() < 1e-12, "{}", report.seconds);
    assert_eq!(report.block_rate, None, "too few moves to count blocks per second");
    let longest = report.longest_line.unwrap();
    assert_eq!((longest.line, longest.length), (7, 14));
    assert!(report.is_clean());
}

#[test]
fn check_measures_the_rate_of_blocks() {
    let mut program = "G21\nG0 X0 Y100 A0\nS1 M3\nG93\n".to_owned();
    for i in 1..=100 {
        // Line 4 + i; blocks 60 to 80 follow each other twice as fast as the control reads.
        let per_minute = if (60..80).contains(&i) { 120_000 } else { 30_000 };
        writeln!(program, "G1 A{} F{per_minute}", 0.1 * f64::from(i)).unwrap();
    }
    let rate = check(&reread(&(program + "M30"), &lathe()), &lathe()).block_rate.unwrap();
    assert!((rate.highest - 2000.0).abs() < 1e-6, "{}", rate.highest);
    assert!((79..=83).contains(&rate.line), "{}", rate.line);
    assert_eq!(rate.limit, 1000.0);
}

#[test]
fn a_program_without_feed_is_a_violation_however_it_was_made() {
    let mut program = reread("G0 X0 Y0 A0\nS1 M3\nG1 X1 F5\nM30", &lathe());
    program.blocks.retain(|block| !matches!(block.kind, BlockKind::Modes(_)));
    let modes = [horma::gcode::Mode::InverseTime].into_iter().collect();
    program.blocks.insert(2, horma::gcode::Block { line: 2, kind: BlockKind::Modes(modes) });
    let words = horma::gcode::MoveWords::new(horma::gcode::Motion::Feed).with_axis(0, 2.0);
    program.blocks.insert(3, horma::gcode::Block { line: 3, kind: BlockKind::Move(words) });
    let report = check(&program, &lathe());
    assert!(report.violations.iter().any(|v| v.line == 3 && v.kind == ViolationKind::NoFeed));
}

#[test]
fn a_program_taken_up_in_its_midst_approaches_safely() {
    let whole = posted(&short_path(), &lathe(), &linuxcnc()).program;
    let line = line_of(&whole, "G1 Y70.5");
    let rest = restart(&whole, &lathe(), line, None).unwrap();
    let expected = "\
(X: 10.0000 to 12.0000 mm)
(Y: 70.0000 to 150.0000 mm)
(A: -720.0000 to 0.0000 deg)
(time: 0:00:07 h, accelerations included)
(moves: 8)
(taken up at line 17; the figures above are of the whole program)
G21 G90 G94 G17 G40 G49 G80 G54
G64 P0.01
G0 Y150.0
T7 M6
S6000.0 M4
G0 Y150.0
G0 X11.0 A-360.0
G1 Y70.0 F1200.0
G93
G1 Y70.5 A-720.0 F40.0
G4 P0.25
G94
G1 X12.0 F600.0
G0 Y150.0
M5
M30
";
    assert_eq!(text(&rest, &linuxcnc()), expected);
    assert_eq!(check(&rest, &lathe()).violations, []);
}

#[test]
fn a_program_can_be_taken_up_at_every_line() {
    for machine in [lathe(), pair(), mill()] {
        let whole = posted(&random_path(&machine, 200, 9), &machine, &linuxcnc()).program;
        let steps: Vec<Step> = whole.steps(&machine).collect();
        let last = steps.iter().rfind(|step| step.kind == StepKind::Feed).unwrap().line;
        let placed = steps.iter().find(|step| step.values(&whole).is_some()).unwrap().line;
        for line in placed + 1..=last {
            let rest = restart(&whole, &machine, line, Some(600.0)).unwrap();
            let left: Vec<_> = steps.iter().filter(|step| step.line >= line).collect();
            let again: Vec<_> = rest.steps(&machine).collect();
            let again = &again[again.len() - left.len()..];
            for (before, after) in left.iter().zip(again) {
                assert_eq!((before.from, before.to), (after.from, after.to), "line {line}");
                assert_eq!((before.kind, before.seconds), (after.kind, after.seconds));
                assert!(after.spindle_on, "line {line}");
            }
            assert_eq!(check(&rest, &machine).violations, [], "line {line}");
        }
    }
}

#[test]
fn where_a_program_cannot_be_taken_up_the_reason_is_given() {
    let whole = posted(&short_path(), &lathe(), &linuxcnc()).program;
    let refusal = |line, feed| restart(&whole, &lathe(), line, feed).unwrap_err().to_string();
    assert_eq!(
        refusal(2, None),
        "line 2 stands before the program has placed X; run the program from its start"
    );
    assert_eq!(refusal(99, None), "nothing is cut from line 99 on; the last cut is in line 20");
    assert_eq!(refusal(16, Some(0.0)), "the plunge feed 0 mm/min must be a number greater than 0");
    let timed = reread("G0 Y150\nG0 X0 A0\nG93\nG1 X1 F6\nG1 X2 F6\nM30\n", &lathe());
    assert_eq!(
        restart(&timed, &lathe(), 5, None).unwrap_err().to_string(),
        "the program has no plunge feed (an F under G94); give one"
    );
}

#[test]
fn a_feed_at_the_limit_of_two_axes_stays_within_it_when_words_are_rounded() {
    // Both axes at their 500 mm/s, in steps that round to 9 or 10 units of the last decimal.
    let step = |i: u32| Move {
        to: values([
            100.000_08 + 0.000_96 * f64::from(i),
            100.000_04 + 0.000_96 * f64::from(i),
            0.0,
        ]),
        pace: if i == 0 { Pace::Rapid } else { Pace::Feed(500.0 * 2_f64.sqrt()) },
    };
    let path = Toolpath { moves: (0..100).map(step).collect(), clear: 60.0 };
    let program = posted(&path, &mill(), &linuxcnc()).program;
    assert_eq!(check(&program, &mill()).violations, []);
}

#[test]
fn away_from_the_part_is_down_where_the_attack_words_are_negative() {
    let mut machine = lathe();
    machine.axes[1].sign = -1.0;
    machine.axes[1].limits = Some([-250.0, 0.0]);
    let mut path = short_path();
    path.moves.iter_mut().for_each(|step| step.to[1] = -step.to[1]);
    path.clear = -path.clear;
    let whole = posted(&path, &machine, &linuxcnc()).program;
    let rest = restart(&whole, &machine, line_of(&whole, "G1 Y-70.5"), None).unwrap();
    let first = rest.steps(&machine).next().unwrap();
    assert_eq!((first.to[0], first.to[1], first.to[2]), (None, Some(-150.0), None));
}

#[test]
fn a_spindle_that_a_tool_change_stopped_is_not_started_again() {
    let text_before = "T1 M6\nS500 M3\nG0 Y100\nG0 X0 A0\nG1 Y70 F600\nG0 Y100\nT2 M6\n";
    let whole = reread(&format!("{text_before}G1 X1\nG1 X2\nM30\n"), &lathe());
    let rest = restart(&whole, &lathe(), 9, None).unwrap();
    let text = text(&rest, &linuxcnc());
    assert!(text.contains("T2 M6\nS500.0\n") && !text.contains("M3\n"), "{text}");
}

/// Down at 20 mm/s, a turn in a second, one in a second and a half, a pause, and on at 10 mm/s.
fn short_path() -> Toolpath {
    let step =
        |x: f64, y: f64, a_deg: f64, pace| Move { to: values([x, y, a_deg.to_radians()]), pace };
    let moves = vec![
        step(10.0, 150.0, 0.0, Pace::Rapid),
        step(10.0, 70.0, 0.0, Pace::Feed(20.0)),
        step(11.0, 70.0, -360.0, Pace::Duration(1.0)),
        step(11.0, 70.5, -720.0, Pace::Duration(1.5)),
        step(11.0, 70.5, -720.0, Pace::Duration(0.25)),
        step(12.0, 70.5, -720.0, Pace::Feed(10.0)),
    ];
    Toolpath { moves, clear: 150.0 }
}

fn posted(path: &Toolpath, machine: &Machine, dialect: &Dialect) -> Posted {
    post(path, machine, &wheel(), dialect, &Header::default()).unwrap()
}

fn text(program: &Program, dialect: &Dialect) -> String {
    let mut text = Vec::new();
    write(program, dialect, &mut text).unwrap();
    String::from_utf8(text).unwrap()
}

fn reread(text: &str, machine: &Machine) -> Program {
    read(&mut text.as_bytes(), machine, &linuxcnc()).unwrap()
}

fn line_of(program: &Program, start: &str) -> u32 {
    let text = text(program, &linuxcnc());
    let found = text.lines().position(|line| line.starts_with(start));
    found.expect("the line is there") as u32 + 1
}

/// Holds every position of `program`, and its time, against the toolpath it was made from.
/// Fails unless `program` goes along `path`, and takes as long.
pub(crate) fn goes_along(machine: &Machine, path: &Toolpath, program: &Program) {
    let half_a_decimal = |kind: AxisKind| match kind {
        AxisKind::Linear => 0.5e-4 + 1e-9,
        AxisKind::Rotary => (0.5e-4_f64 + 1e-9).to_radians(),
    };
    let near = |target: &[f64; 6], to: &[f64; 6]| {
        let mut axes = machine.axes.iter().enumerate();
        axes.all(|(i, axis)| (target[i] - to[i]).abs() <= half_a_decimal(axis.kind))
    };
    let steps: Vec<_> = program.steps(machine).collect();
    let mut ends = steps
        .iter()
        .filter(|step| step.kind != StepKind::Dwell)
        .filter_map(|step| step.values(program))
        .peekable();
    let mut at = ends.next().expect("a program has moves");
    for (i_move, step) in path.moves.iter().enumerate() {
        let target = machine.with_followers(&step.to);
        if ends.peek().is_some_and(|next| near(&target, next)) {
            at = ends.next().unwrap();
        }
        assert!(near(&target, &at), "move {i_move} ends at {at:?}, not {target:?}");
    }
    // Nothing but the retreat is left.
    assert!(ends.count() <= 1);
    let planned = planned_seconds(machine, path);
    let fed = steps.iter().filter(|step| step.kind != StepKind::Rapid);
    let programmed: f64 = fed.filter_map(|step| step.seconds).sum();
    assert!((planned - programmed).abs() < 1e-3 * planned + 1e-3, "{programmed} s for {planned} s");
}

/// Time of the moves that are not rapid.
fn planned_seconds(machine: &Machine, path: &Toolpath) -> f64 {
    let seconds = path.moves.windows(2).map(|pair| match pair[1].pace {
        Pace::Rapid => 0.0,
        Pace::Duration(seconds) => seconds,
        Pace::Feed(feed) => {
            let linear = |i: &usize| machine.axes[*i].kind == AxisKind::Linear;
            let way = |i: usize| (pair[1].to[i] - pair[0].to[i]).powi(2);
            (0..machine.axes.len()).filter(linear).map(way).sum::<f64>().sqrt() / feed
        }
    });
    seconds.sum()
}

fn linuxcnc() -> Dialect {
    Dialect::named("linuxcnc").unwrap()
}
