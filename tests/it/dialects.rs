//! Every control gets its own words, and they read back as the path.
//!
//! `tests/golden/` holds a short program per dialect with every word it can write, and the same
//! taken up in its midst. `HORMA_WRITE_GOLDEN=1` writes these files anew; look at what changed.

use crate::rs274;
use crate::small_machines::{lathe, mill, random_path, values, wheel};
use horma::cam::{Move, Pace, Toolpath};
use horma::gcode::{
    BlockKind, Coolant, Dialect, Header, Operation, PostWarning, Posted, Program, Rotary,
    SplitError, StepKind, check, post, post_operations, read, restart, split, write,
};
use horma::machine::{AxisKind, AxisValues, Machine};
use horma::tool::{Tool, Turns};
use std::f64::consts::TAU;
use std::path::{Path, PathBuf};

#[test]
fn a_short_program_in_every_dialect_is_the_golden_one() {
    for dialect in dialects() {
        let machine = machine_for(&dialect);
        let whole = golden_program(&machine, &dialect).program;
        same_as_golden(&text(&whole, &dialect), &golden(&dialect, ""));
        let cuts = whole.steps(&machine).filter(|step| step.kind == StepKind::Feed);
        let line = cuts.map(|step| step.line).nth(3).unwrap();
        let rest = restart(&whole, &machine, line, None).unwrap();
        same_as_golden(&text(&rest, &dialect), &golden(&dialect, "-restart"));
    }
}

#[test]
fn golden_programs_read_back_along_their_path() {
    for dialect in dialects() {
        let machine = machine_for(&dialect);
        let bytes = std::fs::read(golden(&dialect, "")).unwrap();
        let program = read(&mut bytes.as_slice(), &machine, &dialect).unwrap();
        let (rough, fine) = (turning_path(&machine, 0.0), turning_path(&machine, 20.0));
        let ends = ends(&program, &machine);
        let ends = along(&machine, &dialect, &rough, &ends);
        along(&machine, &dialect, &fine, ends);
        assert_eq!(check(&program, &machine).violations, [], "{}", dialect.name);
        for kind in ["tool change", "coolant", "dwell", "comment", "end"] {
            assert!(program.blocks.iter().any(|block| is(kind, &block.kind)), "{kind}");
        }
    }
}

#[test]
fn golden_programs_of_linuxcnc_satisfy_its_interpreter() {
    if !rs274::is_here() {
        return;
    }
    let (machine, dialect) = (lathe(), named("linuxcnc"));
    for kind in ["", "-restart"] {
        let path = golden(&dialect, kind);
        let bytes = std::fs::read(&path).unwrap();
        let program = read(&mut bytes.as_slice(), &machine, &dialect).unwrap();
        let moves = rs274::interpret(&path);
        let mut judged = moves.iter().filter(|step| step.rate != Some(0.0));
        let last = judged.next_back().unwrap().to;
        let ours = ends(&program, &machine).last().copied().unwrap();
        for (judged, ours) in
            [(last[0], ours[0]), (last[1], ours[1]), (last[3], ours[2].to_degrees())]
        {
            assert!((judged - ours).abs() <= 1e-4, "{judged} {ours}");
        }
        let seconds: f64 = moves.iter().map(|step| step.seconds).sum();
        let fed = program.steps(&machine).filter(|step| step.kind != StepKind::Rapid);
        let programmed: f64 = fed.filter_map(|step| step.seconds).sum();
        assert!((seconds - programmed).abs() < 1e-3 * programmed, "{seconds} {programmed}");
    }
}

#[test]
fn any_path_reads_back_block_by_block_in_every_dialect() {
    for dialect in dialects() {
        let machine = machine_for(&dialect);
        for seed in 0..10 {
            let posted = posted(&random_path(&machine, 300, seed), &machine, &dialect);
            let back = reread(&text(&posted.program, &dialect), &machine, &dialect);
            for (back, posted) in back.blocks.iter().zip(&posted.program.blocks) {
                assert_eq!(back, posted, "{} seed {seed}", dialect.name);
            }
            assert_eq!(back.blocks.len(), posted.program.blocks.len(), "{}", dialect.name);
            assert_eq!(back.feeds, posted.program.feeds);
        }
    }
}

#[test]
fn a_spiral_goes_and_takes_as_long_as_its_path_in_every_dialect() {
    for dialect in dialects() {
        let machine = machine_for(&dialect);
        let path = spiral(&machine, 0.01);
        let posted = posted(&path, &machine, &dialect);
        let program = reread(&text(&posted.program, &dialect), &machine, &dialect);
        along(&machine, &dialect, &path, &ends(&program, &machine));
        let planned: f64 = path.moves.iter().map(|step| duration(step.pace)).sum();
        let timed = program.steps(&machine).filter(|step| step.kind == StepKind::Feed).skip(1);
        let programmed: f64 = timed.filter_map(|step| step.seconds).sum();
        // What an F word of the control cannot say is told.
        let told: f64 = posted.warnings.iter().map(told_seconds).sum();
        let off = (planned + told - programmed).abs();
        assert!(off <= 1e-3 * planned, "{}: {programmed} s for {planned} s", dialect.name);
        assert!(told.abs() <= 2e-3 * planned, "{} is off by {told} s", dialect.name);
    }
}

#[test]
fn blocks_faster_than_an_f_word_can_say_are_slower_and_told() {
    // 400 blocks a second are F24000; Haas takes 15400.
    let path = spiral(&lathe(), 0.0025);
    let posted = posted(&path, &lathe(), &named("haas"));
    let [PostWarning::FeedLowered { n_blocks, first_line, seconds }] = posted.warnings[..] else {
        panic!("one warning, not {:?}", posted.warnings)
    };
    let slower = 60.0 / 15_400.0 - 0.0025;
    assert!((seconds - n_blocks as f64 * slower).abs() < 1e-9, "{n_blocks} blocks, {seconds} s");
    let text = text(&posted.program, &named("haas"));
    let line = text.lines().nth(first_line as usize - 1).unwrap();
    assert!(line.ends_with(" F15400.0"), "{line}");
}

#[test]
fn seconds_are_written_as_such_and_never_too_few() {
    let path = spiral(&lathe(), 0.012_345_67);
    let written = text(&posted(&path, &lathe(), &named("beckhoff")).program, &named("beckhoff"));
    assert!(written.contains(" F0.012346\n"), "{written}");
}

#[test]
fn the_second_tool_goes_on_from_the_turns_of_the_first() {
    let machine = lathe();
    let program = golden_program(&machine, &named("linuxcnc")).program;
    let turned = program.steps(&machine).map(|step| (step.to[2], step.from[2]));
    let most = turned.filter_map(|(to, from)| Some((to? - from?).abs())).fold(0.0, f64::max);
    assert!(most < TAU, "no move turns back what the first tool has turned: {most}");
}

#[test]
fn parts_of_a_program_are_whole_programs_that_go_on_from_each_other() {
    for dialect in dialects() {
        let machine = machine_for(&dialect);
        let path = spiral(&machine, 0.01);
        let whole = posted(&path, &machine, &dialect).program;
        let limit = text(&whole, &dialect).len() / 4;
        let parts = split(&whole, &machine, &dialect, limit).unwrap();
        assert!((5..=8).contains(&parts.len()), "{}: {} parts", dialect.name, parts.len());
        let mut cuts = Vec::new();
        for (i_part, part) in parts.iter().enumerate() {
            let written = text(part, &dialect);
            assert!(written.len() <= limit, "{}: {} bytes", dialect.name, written.len());
            let part = reread(&written, &machine, &dialect);
            assert_eq!(check(&part, &machine).violations, [], "{}", dialect.name);
            assert!(written.contains(&format!("part {} of {}", i_part + 1, parts.len())));
            let mut numbers = part.blocks.iter().filter_map(|block| match block.kind {
                BlockKind::Number(number) => Some(number),
                _ => None,
            });
            assert!(numbers.next().is_none_or(|number| number == 1 + i_part as u32));
            // Behind the plunge to where the part before has ended.
            let feeds = part.steps(&machine).filter(|step| step.kind == StepKind::Feed).skip(1);
            cuts.extend(feeds.filter_map(|step| step.values(&part)));
        }
        let expected = whole.steps(&machine).filter(|step| step.kind == StepKind::Feed).skip(1);
        let expected: Vec<_> = expected.filter_map(|step| step.values(&whole)).collect();
        assert_eq!(cuts.len(), expected.len(), "{}", dialect.name);
        for (cut, expected) in cuts.iter().zip(&expected) {
            assert!(is_near(&machine, &dialect, cut, expected), "{}: {cut:?}", dialect.name);
        }
    }
}

#[test]
fn parts_too_small_for_a_cut_are_refused_with_what_they_need() {
    let dialect = named("fanuc");
    let whole = posted(&spiral(&lathe(), 0.01), &lathe(), &dialect).program;
    let refusal = split(&whole, &lathe(), &dialect, 300).unwrap_err();
    let SplitError::TooSmall { limit: 300, needed, .. } = refusal else { panic!("{refusal}") };
    assert!(split(&whole, &lathe(), &dialect, needed + 100).is_ok());
    let last = Header { number: Some(9999), ..Header::default() };
    let path = spiral(&lathe(), 0.01);
    let whole_last = post(&path, &lathe(), &wheel(), &dialect, &last).unwrap().program;
    let told = split(&whole_last, &lathe(), &dialect, 20_000).unwrap_err().to_string();
    assert!(told.starts_with("the parts would be numbered up to 10000"), "{told}");
    let fits = split(&whole, &lathe(), &dialect, 1 << 20).unwrap();
    assert_eq!(fits, [whole]);
}

#[test]
fn what_a_control_cannot_say_is_refused_by_name() {
    let refusal = |machine: &Machine, path: &Toolpath, dialect: &Dialect, header: &Header| {
        post(path, machine, &wheel(), dialect, header).unwrap_err().to_string()
    };
    let plain = Header::default();
    let turning = turning_path(&lathe(), 0.0);
    assert_eq!(
        refusal(&lathe(), &turning, &named("grbl"), &plain),
        "lathe turns A, but grbl has linear axes alone; choose a control with rotary axes, such as \
         linuxcnc or grblhal, with --dialect"
    );
    let mist = Header { coolant: Some(Coolant::Mist), ..plain.clone() };
    assert_eq!(
        refusal(&lathe(), &turning, &named("haas"), &mist),
        "haas has no word for Mist coolant; choose another one, or none"
    );
    let number = Header { number: Some(10_000), ..plain.clone() };
    let told = refusal(&lathe(), &turning, &named("fanuc"), &number);
    assert_eq!(told, "program number 10000 is not one of 1 to 9999");
    let nowhere = Header { tolerance: Some(f64::NAN), ..plain.clone() };
    let told = refusal(&lathe(), &turning, &named("linuxcnc"), &nowhere);
    assert_eq!(told, "the tolerance for corners is NaN mm; it must be a number, 0.0001 or more");
    let twice = Dialect { letters: vec![('A', 'X')], ..named("linuxcnc") };
    let told = refusal(&lathe(), &turning, &twice, &plain);
    assert_eq!(told, "linuxcnc calls two axes of lathe X; change its letters");
    let far = Toolpath {
        moves: vec![
            Move { to: values([10.0, 100.0, 0.0]), pace: Pace::Rapid },
            Move { to: values([10.0, 100.0, 3.2]), pace: Pace::Duration(1.0) },
        ],
        clear: 150.0,
    };
    let told = refusal(&lathe(), &far, &named("siemens-840d"), &plain);
    assert!(told.starts_with("move 1 turns A by 183.3465 degrees at once"), "{told}");
}

#[test]
fn an_axis_goes_by_the_letter_of_the_control() {
    let dialect = Dialect { letters: vec![('A', 'C')], ..named("linuxcnc") };
    let program = posted(&turning_path(&lathe(), 0.0), &lathe(), &dialect).program;
    let written = text(&program, &dialect);
    assert!(written.contains(" C100.0 ") && !written.contains(" A"), "{written}");
    assert_eq!(reread(&written, &lathe(), &dialect).blocks, program.blocks);
}

#[test]
fn the_tolerance_for_corners_is_what_was_asked_for() {
    let header = Header { tolerance: Some(0.05), ..Header::default() };
    for (name, line) in [
        ("linuxcnc", "\nG64 P0.05\n"),
        ("haas", "\nG187 P3 E0.05\n"),
        ("siemens-840d", " CYCLE832(0.05,_FINISH,1)\n"),
        ("heidenhain", " CYCL DEF 32.1 T0.05\n"),
    ] {
        let dialect = named(name);
        let path = turning_path(&lathe(), 0.0);
        let program = post(&path, &lathe(), &wheel(), &dialect, &header).unwrap().program;
        assert!(text(&program, &dialect).contains(line), "{name}");
    }
}

#[test]
fn every_coolant_of_a_control_is_opened_closed_and_read_back() {
    for dialect in dialects() {
        let machine = machine_for(&dialect);
        let path = turning_path(&machine, 0.0);
        for &coolant in &dialect.coolants {
            let header = Header { coolant: Some(coolant), ..Header::default() };
            let program = post(&path, &machine, &wheel(), &dialect, &header).unwrap().program;
            let back = reread(&text(&program, &dialect), &machine, &dialect);
            let turned = back.blocks.iter().filter_map(|block| match block.kind {
                BlockKind::Coolant(coolant) => Some(coolant),
                _ => None,
            });
            assert_eq!(turned.collect::<Vec<_>>(), [coolant, Coolant::Off], "{}", dialect.name);
        }
    }
}

/// Two tools, one after the other, and everything they can ask for.
fn golden_program(machine: &Machine, dialect: &Dialect) -> Posted {
    let paths = [turning_path(machine, 0.0), turning_path(machine, 20.0)];
    let tools = [wheel(), Tool { number: 8, turns: Turns::Clockwise, ..wheel() }];
    let operations: Vec<_> =
        paths.iter().zip(&tools).map(|(path, tool)| Operation { path, tool }).collect();
    let long = "a remark so long that no control would take it on a single line, not even in \
                brackets (as here), which is why it has to be broken where a blank allows it, \
                and on it goes for yet another while until the longest lines are too short, \
                which takes more than five hundred characters where Siemens is concerned, so \
                that the writer of this remark has to think of ever more to say about nothing, \
                and comes in the end to the weather, which is fair, and to the wood, which is \
                hornbeam, dried for two winters";
    let header = Header {
        lines: vec!["part: a last".into(), long.into()],
        stock: Some(12.5),
        number: Some(12),
        tolerance: Some(0.02),
        coolant: dialect.coolants.first().copied(),
    };
    let posted = post_operations(&operations, machine, dialect, &header).unwrap();
    assert_eq!(posted.warnings, [], "{}", dialect.name);
    posted
}

/// Down, more than a turn in five moves, a pause, on at a feed, a rapid and another cut; begins at
/// X = `from`. On a mill the third axis is Z, and goes up and down instead.
fn turning_path(machine: &Machine, from: f64) -> Toolpath {
    let turns = machine.axes[2].kind == AxisKind::Rotary;
    let third = |degrees: f64| if turns { degrees.to_radians() } else { 0.01 * degrees };
    let to = |x: f64, y: f64, degrees: f64| values([from + x, y, third(degrees)]);
    let mut moves = vec![
        Move { to: to(10.0, 100.0, 0.0), pace: Pace::Rapid },
        Move { to: to(10.0, 70.0, 0.0), pace: Pace::Feed(20.0) },
    ];
    for i in 1..=5 {
        let i = f64::from(i);
        let pace = Pace::Duration(0.25 + 0.05 * i);
        moves.push(Move { to: to(10.0 + 0.3 * i, 70.0 - 0.2 * i, 100.0 * i), pace });
    }
    let last = to(11.5, 69.0, 500.0);
    moves.push(Move { to: last, pace: Pace::Duration(0.25) });
    moves.push(Move { to: to(14.5, 69.0, 500.0), pace: Pace::Feed(10.0) });
    moves.push(Move { to: to(14.5, 80.0, 420.0), pace: Pace::Rapid });
    moves.push(Move { to: to(14.5, 70.0, 420.0), pace: Pace::Feed(20.0) });
    moves.push(Move { to: to(14.5, 70.0, 410.0), pace: Pace::Duration(0.5) });
    let clear = if machine.attack == 1 { 100.0 } else { 20.0 };
    Toolpath { moves, clear }
}

/// Three turns of a degree and `seconds` each, with a bump; on a mill a wave.
fn spiral(machine: &Machine, seconds: f64) -> Toolpath {
    let turns = machine.axes[2].kind == AxisKind::Rotary;
    let step = |i: u32| {
        let degrees = f64::from(i);
        let third = if turns { degrees.to_radians() } else { (0.05 * degrees).cos() };
        values([10.0 + 0.003 * degrees, 70.0 + 2.0 * (2.0 * degrees).to_radians().cos(), third])
    };
    let mut moves = vec![Move { to: step(0), pace: Pace::Rapid }];
    moves[0].to[machine.attack] = 90.0;
    moves.push(Move { to: step(0), pace: Pace::Feed(20.0) });
    moves.extend((1..=1080).map(|i| Move { to: step(i), pace: Pace::Duration(seconds) }));
    Toolpath { moves, clear: 90.0 }
}

/// Fails unless `ends` begin with an approach to `path` and go along it; gives what comes behind.
fn along<'a>(
    machine: &Machine,
    dialect: &Dialect,
    path: &Toolpath,
    ends: &'a [AxisValues],
) -> &'a [AxisValues] {
    let name = &dialect.name;
    let targets: Vec<_> = path.moves.iter().map(|step| machine.with_followers(&step.to)).collect();
    let start = ends.iter().position(|end| is_near(machine, dialect, end, &targets[0]));
    let mut i_end = start.expect("the path has a start");
    let turned = |i: usize| ends[i][2] - targets[0][2];
    let before = if machine.axes[2].kind == AxisKind::Rotary { turned(i_end) } else { 0.0 };
    let before = TAU * (before / TAU).round();
    for (i_move, target) in targets.iter().enumerate() {
        let mut target = *target;
        target[2] += before;
        let near = |end: &AxisValues| is_exactly_near(machine, dialect, end, &target);
        if ends.get(i_end + 1).is_some_and(near) {
            i_end += 1;
        }
        assert!(
            near(&ends[i_end]),
            "{name}: move {i_move} ends at {:?}, not {target:?}",
            ends[i_end]
        );
    }
    &ends[i_end + 1..]
}

/// Within half a decimal, whatever the turns an endless axis has made.
fn is_near(machine: &Machine, dialect: &Dialect, end: &AxisValues, target: &AxisValues) -> bool {
    let mut end = *end;
    for (i, axis) in machine.axes.iter().enumerate() {
        if axis.kind == AxisKind::Rotary {
            end[i] -= TAU * ((end[i] - target[i]) / TAU).round();
        }
    }
    is_exactly_near(machine, dialect, &end, target)
}

fn is_exactly_near(
    machine: &Machine,
    dialect: &Dialect,
    end: &AxisValues,
    target: &AxisValues,
) -> bool {
    let half = |decimals: u8| 0.5 * 10_f64.powi(-i32::from(decimals)) + 1e-9;
    machine.axes.iter().enumerate().all(|(i, axis)| {
        let allowed = match axis.kind {
            AxisKind::Linear => half(dialect.decimals.linear),
            AxisKind::Rotary => half(dialect.decimals.rotary).to_radians(),
        };
        (end[i] - target[i]).abs() <= allowed
    })
}

fn is(kind: &str, block: &BlockKind) -> bool {
    match block {
        BlockKind::ToolChange(_) => kind == "tool change",
        BlockKind::Coolant(_) => kind == "coolant",
        BlockKind::Dwell(_) => kind == "dwell",
        BlockKind::Comment(_) => kind == "comment",
        BlockKind::End => kind == "end",
        _ => false,
    }
}

fn duration(pace: Pace) -> f64 {
    match pace {
        Pace::Duration(seconds) => seconds,
        _ => 0.0,
    }
}

/// How much longer a program takes than planned, as its author is told.
fn told_seconds(warning: &PostWarning) -> f64 {
    match warning {
        PostWarning::FeedRaised { seconds, .. } => -seconds,
        PostWarning::FeedLowered { seconds, .. } => *seconds,
    }
}

/// Where the moves of a program end, once all axes are placed.
fn ends(program: &Program, machine: &Machine) -> Vec<AxisValues> {
    let moves = program.steps(machine).filter(|step| step.kind != StepKind::Dwell);
    moves.filter_map(|step| step.values(program)).collect()
}

fn same_as_golden(text: &str, path: &Path) {
    if std::env::var_os("HORMA_WRITE_GOLDEN").is_some_and(|value| value == "1") {
        std::fs::write(path, text).unwrap();
    }
    let golden = std::fs::read_to_string(path).unwrap();
    assert_eq!(text, golden, "{}", path.display());
}

fn golden(dialect: &Dialect, kind: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden");
    folder.join(format!("{}{kind}.{}", dialect.name, dialect.extension))
}

/// A lathe, or a mill for a control that turns nothing.
fn machine_for(dialect: &Dialect) -> Machine {
    if dialect.rotary == Rotary::None { mill() } else { lathe() }
}

/// All that are embedded; one that takes turns off does so after every one, so that it shows.
fn dialects() -> Vec<Dialect> {
    let mut dialects: Vec<_> = Dialect::names().map(named).collect();
    for dialect in &mut dialects {
        if let Rotary::Rezero { turns } = &mut dialect.rotary {
            *turns = 1;
        }
    }
    dialects
}

fn named(name: &str) -> Dialect {
    Dialect::named(name).unwrap()
}

fn posted(path: &Toolpath, machine: &Machine, dialect: &Dialect) -> Posted {
    post(path, machine, &wheel(), dialect, &Header::default()).unwrap()
}

fn text(program: &Program, dialect: &Dialect) -> String {
    let mut text = Vec::new();
    write(program, dialect, &mut text).unwrap();
    String::from_utf8(text).unwrap()
}

fn reread(text: &str, machine: &Machine, dialect: &Dialect) -> Program {
    read(&mut text.as_bytes(), machine, dialect)
        .unwrap_or_else(|error| panic!("{}: {error}\n{text}", dialect.name))
}
