//! Mistakes in machine files: each is refused, and shown at its line and column.

use horma::machine::{Dogs, Machine, Obstacles};
use horma::tool::ToolLibrary;

const LATHE: &str = "last-lathe";
const PAIR: &str = "last-lathe-pair";

/// What is wrong with the embedded machine `name` when the first `old` after `anchor` in its file is
/// `new` instead. `place` is the text where the error must point, with a `^` before the very
/// character.
fn problem(name: &str, anchor: &str, [old, new]: [&str; 2], place: &str) -> String {
    let text = Machine::builtin_text(name).unwrap();
    let start = text.find(anchor).unwrap_or_else(|| panic!("no {anchor:?} in {name}"));
    let at = start + text[start..].find(old).unwrap_or_else(|| panic!("no {old:?} in {name}"));
    let broken = format!("{}{new}{}", &text[..at], &text[at + old.len()..]);
    let message = Machine::parse(&broken, "my.toml").unwrap_err().to_string();
    let first = message.lines().next().unwrap();

    let (before, after) = place.split_once('^').unwrap();
    let matches: Vec<usize> =
        broken.match_indices(&format!("{before}{after}")).map(|(at, _)| at).collect();
    let [at] = matches[..] else { panic!("{place:?} stands {} times in it", matches.len()) };
    let (line, column) = line_and_column(&broken[..at + before.len()]);
    let told = first.strip_prefix(&format!("my.toml:{line}:{column}: "));
    told.unwrap_or_else(|| panic!("not at {line}:{column}: {first}")).to_owned()
}

fn line_and_column(before: &str) -> (usize, usize) {
    let last = before.rsplit('\n').next().unwrap();
    (before.matches('\n').count() + 1, last.chars().count() + 1)
}

#[test]
fn a_control_that_looks_ahead_sees_two_blocks_or_more() {
    let key = "blocks-per-second = 1_000";
    let with = |blocks: &str| format!("{key}\nlook-ahead-blocks = {blocks} # given");
    let text = |blocks: &str| Machine::builtin_text(LATHE).unwrap().replace(key, &with(blocks));
    let read = |blocks: &str| Machine::parse(&text(blocks), "my.toml").unwrap();
    assert_eq!(Machine::builtin(LATHE).unwrap().look_ahead_blocks, None);
    assert_eq!(read("16").look_ahead_blocks, Some(16));
    for blocks in ["1", "0", "-3"] {
        let place = format!("look-ahead-blocks = ^{blocks} # given");
        let told = problem(LATHE, key, [key, &with(blocks)], &place);
        assert_eq!(told, format!("look-ahead-blocks is {blocks}: it must be 2 or more"));
    }
}

#[test]
fn obstacles_have_sizes_and_stand_where_parts_are_held_like_that() {
    let key = "length = 25    # from the face of each dog to the part\n";
    let with = |obstacles: &str| format!("{key}[obstacles]\n{obstacles} # given\n");
    let text = Machine::builtin_text(LATHE).unwrap();
    let given = text.replace(key, &with("dogs = { radius = 22.5, length = 80 }"));
    let dogs = Machine::parse(&given, "my.toml").unwrap().obstacles.dogs;
    assert_eq!(dogs, Some(Dogs { radius: 22.5, length: 80.0 }));
    for name in Machine::builtin_names() {
        assert_eq!(Machine::builtin(name).unwrap().obstacles, Obstacles::default(), "{name}");
    }
    let refused = |obstacles: &str, place: &str| {
        problem(LATHE, key, [key, &with(obstacles)], &format!("{place} # given"))
    };
    let told = refused("dogs = { radius = 0, length = 81 }", "dogs = { radius = ^0, length = 81 }");
    assert_eq!(told, "radius is 0: it must be greater than 0");
    let told = refused("table-radius = 150.5", "table-radius = ^150.5");
    assert_eq!(
        told,
        "table-radius is for a machine that holds the part by clamping = \"table\", and this one does \
         not: leave it out"
    );
}

#[test]
fn a_direction_of_any_length_is_made_a_unit_vector() {
    for direction in ["[0, 5, 0]", "[0, 1e-200, 0]", "[0, 1e300, 0]"] {
        let text = Machine::builtin_text(LATHE).unwrap().replace("[0, 1, 0]", direction);
        let lathe = Machine::parse(&text, "my.toml").unwrap();
        assert_eq!(lathe.axes[lathe.attack].direction, horma::geom::Vector3::y());
    }
}

#[test]
fn an_error_shows_the_line_and_marks_the_place() {
    let text = Machine::builtin_text(LATHE).unwrap().replace("attack = \"Y\"", "attack = \"Q\"");
    let line = text.lines().position(|line| line.starts_with("attack")).unwrap() + 1;
    assert_eq!(
        Machine::parse(&text, "my.toml").unwrap_err().to_string(),
        format!(
            "my.toml:{line}:10: attack names the axis Q, but there is none; the axes are X, Y, A\n   \
             |\n{line} | attack = \"Q\"\n   |          ^^^"
        )
    );
}

#[test]
fn an_unknown_key_is_refused_by_name() {
    let told = problem(LATHE, "clearance = 20", ["clearance", "clearence"], "^clearence = 20");
    assert!(told.starts_with("unknown field `clearence`, expected one of `name`"), "{told}");
    let told = problem(LATHE, "\"A\"", ["velocity-deg-per-s", "speed"], "^speed = 900");
    assert!(told.starts_with("unknown field `speed`, expected one of `letter`"), "{told}");
    let told = problem(LATHE, "[clamping.nibs]", ["length = ", "gap = "], "^gap = 25");
    assert_eq!(told, "unexpected keys in table: gap, available keys: radius, length");
}

#[test]
fn a_missing_or_misspelt_value_is_refused() {
    let told = problem(LATHE, "mount =", ["\"across\"", "\"sideways\""], "^\"sideways\"");
    assert_eq!(told, "unknown variant `sideways`, expected `across` or `along`");
    let told = problem(LATHE, "letter = \"A\"", ["sign = -1", "sign = -1.0"], "^-1.0");
    assert_eq!(told, "invalid type: floating point `-1.0`, expected i64");
    let told = problem(LATHE, "", ["title = \"", "title = \"Two\\nlines: "], "^\"Two");
    assert_eq!(told, "the title has a control character in it; write one line of plain text");
    let told = problem(LATHE, "", ["name = \"last-lathe\"", "name = \"a/b\""], "^\"a/b\"");
    assert_eq!(
        told,
        "\"a/b\" cannot be a name: use letters, digits, - and _, beginning with a letter"
    );
    let told = problem(LATHE, "", ["zero-mm = 0", ""], "letter = ^\"X\"");
    assert_eq!(told, "axis X is linear and needs zero-mm");
    let told = problem(LATHE, "\"Y\"\nkind", ["limits-mm = [20, 300]", ""], "letter = ^\"Y\"");
    assert_eq!(told, "axis Y is linear and needs limits-mm");
    let told = problem(LATHE, "letter = \"A\"", ["point = [0, 0, 0]", ""], "letter = ^\"A\"");
    assert_eq!(told, "axis A is rotary and needs point");
}

#[test]
fn a_missing_axis_is_refused_wherever_it_is_named() {
    let told = problem(LATHE, "letter = \"Y\"", ["\"Y\"", "\"U\""], "attack = ^\"Y\"");
    assert_eq!(told, "attack names the axis Y, but there is none; the axes are X, U, A");
    let told = problem(LATHE, "", ["spindle = \"A\"", "spindle = \"B\""], "^\"B\"");
    assert_eq!(told, "spindle names the axis B, but there is none; the axes are X, Y, A");
    let told = problem(PAIR, "follows =", ["\"A\"", "\"C\""], "^\"C\"");
    assert_eq!(told, "follows names the axis C, but there is none; the axes are X, Y, A, B");
}

#[test]
fn axes_that_follow_each_other_in_a_circle_are_refused() {
    let told = problem(
        PAIR,
        "letter = \"A\"",
        ["sign = -1", "sign = -1\nfollows = { axis = \"B\", ratio = -1 }"],
        "axis = ^\"B\"",
    );
    assert_eq!(
        told,
        "no axis leads: A -> B -> A follow each other in a circle; let one of them go free"
    );
    let told = problem(PAIR, "follows =", ["\"A\"", "\"B\""], "axis = ^\"B\"");
    assert_eq!(
        told,
        "no axis leads: B -> B follow each other in a circle; let one of them go free"
    );
}

#[test]
fn an_axis_follows_only_a_driven_axis_of_its_own_kind() {
    let third = "follows = { axis = \"A\", ratio = -1 }\n\n[[axis]]\nletter = \"C\"\n\
                 kind = \"rotary\"\ncarries = \"part\"\ndirection = [1, 0, 0]\npoint = [0, 0, 0]\n\
                 sign = -1\nzero-deg = 0\nvelocity-deg-per-s = 1\nacceleration-deg-per-s2 = 1\n\
                 follows = { axis = \"B\", ratio = 1 }";
    let told =
        problem(PAIR, "", ["follows = { axis = \"A\", ratio = -1 }", third], "axis = ^\"B\"");
    assert_eq!(told, "axis C follows B, which follows A itself; let it follow A");
    let told = problem(PAIR, "follows =", ["\"A\"", "\"X\""], "axis = ^\"X\"");
    assert_eq!(told, "axis B is rotary and cannot follow X, which is not");
    let told = problem(PAIR, "follows =", ["ratio = -1", "ratio = 0"], "ratio = ^0");
    assert_eq!(told, "ratio is 0: it must be other than 0");
    let told = problem(PAIR, "", ["spindle = \"A\"", "spindle = \"B\""], "spindle = ^\"B\"");
    assert_eq!(told, "spindle must be driven on its own, and B follows another axis");
}

#[test]
fn the_attack_axis_slides_in_one_direction_square_to_x() {
    let told = problem(LATHE, "", ["attack = \"Y\"", "attack = \"A\""], "attack = ^\"A\"");
    assert_eq!(told, "the attack axis must be linear, and A is rotary");
    let told = problem(LATHE, "", ["attack = \"Y\"", "attack = \"X\""], "attack = ^\"X\"");
    assert_eq!(
        told,
        "the attack axis X must be square to X of the machine frame, along which the wheel's axis \
         lies; describe the machine in another frame, letters are free"
    );
    let told = problem("mill-rotary", "", ["attack = \"Z\"", "attack = \"X\""], "attack = ^\"X\"");
    assert_eq!(
        told,
        "the attack axis X must be square to X of the machine frame, along which the spindle lies; \
         describe the machine in another frame, letters are free"
    );
    let riding = "sign = -1\nzero-deg = 0\nvelocity-deg-per-s = 1\nacceleration-deg-per-s2 = 1\n\n\
                  [[axis]]\nletter = \"W\"\nkind = \"linear\"\ncarries = \"part\"\n\
                  direction = [0, 0, -1]\nzero-mm = 0\nlimits-mm = [0, 1]\n\
                  velocity-mm-per-s = 1\nacceleration-mm-per-s2 = 1\nsign = 1\n\n\
                  [[axis]]\nletter = \"B\"\nkind = \"rotary\"\ncarries = \"part\"\n\
                  direction = [0, 1, 0]\npoint = [0, 0, 0]\nsign = -1";
    let text = Machine::builtin_text("mill-rotary").unwrap();
    let (head, tail) = text.split_at(text.find("letter = \"A\"").unwrap());
    let text = format!("{head}{}", tail.replacen("sign = -1", riding, 1));
    let text = text.replace("attack = \"Z\"", "attack = \"W\"");
    let line = text.lines().position(|line| line.starts_with("attack")).unwrap() + 1;
    let message = Machine::parse(&text, "my.toml").unwrap_err().to_string();
    assert_eq!(
        message.lines().next().unwrap(),
        format!(
            "my.toml:{line}:10: the attack axis W rides on the rotary axis A, so its direction \
             changes; list it before A, or name another attack axis"
        )
    );
}

#[test]
fn the_spindle_turns_about_x() {
    let told = problem(LATHE, "", ["spindle = \"A\"", "spindle = \"X\""], "spindle = ^\"X\"");
    assert_eq!(told, "the spindle must be a rotary axis, and X is linear");
    let told = problem(
        LATHE,
        "letter = \"A\"",
        ["direction = [1, 0, 0]", "direction = [0, 0, 1]"],
        "spindle = ^\"A\"",
    );
    assert_eq!(
        told,
        "the spindle A must turn about X of the machine frame: X runs along the spindle; describe \
         the machine in such a frame, letters are free"
    );
}

#[test]
fn a_rotary_axis_under_the_tool_is_refused_by_name() {
    let told = problem(
        LATHE,
        "letter = \"A\"",
        ["carries = \"part\"", "carries = \"tool\" # head"],
        "carries = ^\"tool\" # head",
    );
    assert_eq!(
        told,
        "axis A is rotary and carries the tool: horma drives machines whose rotary axes carry the \
         part; a swivelling head must be described at one fixed angle"
    );
}

#[test]
fn letters_are_those_of_programs() {
    let letters = ": programs call linear axes X, Y, Z, U, V or W and rotary ones A, B or C";
    for (kind, old, new) in
        [("linear", "X", "Q"), ("linear", "X", "x"), ("linear", "X", "B"), ("rotary", "A", "Z")]
    {
        let [old, new_line] = [old, new].map(|letter| format!("letter = \"{letter}\""));
        let place = format!("letter = ^\"{new}\"");
        let told = problem(LATHE, "[[axis]]", [&old, &new_line], &place);
        assert_eq!(told, format!("'{new}' cannot be the letter of a {kind} axis{letters}"));
    }
    let told = problem(LATHE, "[[axis]]", ["\"X\"", "\"XY\""], "letter = ^\"XY\"");
    assert_eq!(told, "invalid value: string \"XY\", expected a character");
}

#[test]
fn two_axes_of_one_letter_are_refused_at_the_second() {
    let told = problem(PAIR, "[[axis]]", ["letter = \"B\"", "letter = \"A\" # B"], "^\"A\" # B");
    assert_eq!(told, "there are two axes A; give each its own letter");
}

#[test]
fn a_seventh_axis_is_refused() {
    let more: String = ["U", "V", "W"].map(extra_axis).concat();
    let text = format!("{}{more}", Machine::builtin_text("mill-3axis").unwrap());
    assert_eq!(Machine::parse(&text, "my.toml").unwrap().axes.len(), 6);
    let seven = format!("{text}{}", extra_axis("A").replace("linear", "rotary"));
    let line = seven.lines().position(|line| line == "letter = \"A\"").unwrap() + 1;
    let message = Machine::parse(&seven, "my.toml").unwrap_err().to_string();
    assert_eq!(
        message.lines().next().unwrap(),
        format!("my.toml:{line}:10: a machine can have at most 6 axes, and A is one more")
    );
}

fn extra_axis(letter: &str) -> String {
    format!(
        "\n[[axis]]\nletter = \"{letter}\"\nkind = \"linear\"\ncarries = \"tool\"\n\
         direction = [1, 0, 0]\nsign = 1\nzero-mm = 0\nlimits-mm = [0, 1]\n\
         velocity-mm-per-s = 1\nacceleration-mm-per-s2 = 1\n"
    )
}

#[test]
fn a_direction_that_points_nowhere_is_refused() {
    for (given, told_as) in [
        ("[0, 0, 0]", "[0.0, 0.0, 0.0]"),
        ("[nan, 0, 1]", "[NaN, 0.0, 1.0]"),
        ("[inf, 0, 0]", "[inf, 0.0, 0.0]"),
    ] {
        let told =
            problem(LATHE, "[[axis]]", ["[0, 1, 0]", given], &format!("direction = ^{given}"));
        assert_eq!(
            told,
            format!("axis Y: the direction {told_as} points nowhere; give a vector with a length")
        );
    }
}

#[test]
fn limits_that_leave_no_travel_are_refused() {
    for (given, told_as) in [
        ("[300, 20]", "[300.0, 20.0]"),
        ("[20, 20]", "[20.0, 20.0]"),
        ("[20, inf]", "[20.0, inf]"),
        ("[nan, 20]", "[NaN, 20.0]"),
    ] {
        let told =
            problem(LATHE, "[[axis]]", ["[20, 300]", given], &format!("limits-mm = ^{given}"));
        assert_eq!(
            told,
            format!("axis Y: the limits {told_as} leave no travel; write the least word first")
        );
    }
}

#[test]
fn numbers_out_of_range_are_refused_where_they_stand() {
    for (anchor, key, old, new, told_as) in [
        (
            "\"X\"",
            "velocity-mm-per-s",
            "150",
            "0",
            "velocity-mm-per-s is 0: it must be greater than 0",
        ),
        (
            "\"X\"",
            "velocity-mm-per-s",
            "150",
            "nan",
            "velocity-mm-per-s is NaN: it must be a finite number",
        ),
        (
            "\"A\"\nkind",
            "velocity-deg-per-s",
            "900",
            "-900",
            "velocity-deg-per-s is -900: it must be greater than 0",
        ),
        (
            "\"X\"",
            "acceleration-mm-per-s2",
            "1_500",
            "-1",
            "acceleration-mm-per-s2 is -1: it must be greater than 0",
        ),
        ("\"A\"\nkind", "zero-deg", "0", "inf", "zero-deg is inf: it must be a finite number"),
        ("\"A\"\nkind", "sign", "-1", "2", "sign is 2: it must be 1 or -1"),
        ("clearance =", "clearance", "20", "0", "clearance is 0: it must be greater than 0"),
        (
            "blocks",
            "blocks-per-second",
            "1_000",
            "-5",
            "blocks-per-second is -5: it must be greater than 0",
        ),
        ("[clamping", "radius", "12.5", "-12.5", "radius is -12.5: it must be greater than 0"),
    ] {
        let [old, new] = [old, new].map(|value| format!("{key} = {value}"));
        let new = format!("{new} # wrong");
        let place = new.replace("= ", "= ^");
        assert_eq!(problem(LATHE, anchor, [&old, &new], &place), told_as);
    }
    let told = problem(
        LATHE,
        "\"A\"\nkind",
        ["point = [0, 0, 0]", "point = [0, nan, 0]"],
        "point = ^[0, nan, 0]",
    );
    assert_eq!(told, "point is NaN: it must be a finite number");
}

#[test]
fn the_unit_of_a_key_is_that_of_the_axis() {
    let told = problem(
        LATHE,
        "letter = \"Y\"",
        ["velocity-mm-per-s", "velocity-deg-per-s"],
        "velocity-deg-per-s = ^500",
    );
    assert_eq!(
        told,
        "axis Y is linear: velocity-deg-per-s is for the other kind of axis; write velocity-mm-per-s"
    );
    let told = problem(
        LATHE,
        "letter = \"A\"",
        ["sign = -1", "limits-mm = [0, 9]\nsign = -1"],
        "limits-mm = ^[0, 9]",
    );
    assert_eq!(told, "axis A is rotary: limits-mm is for the other kind of axis; write limits-deg");
    let told = problem(
        LATHE,
        "letter = \"X\"",
        ["sign = 1", "point = [7, 0, 0]\nsign = 1"],
        "point = ^[7, 0, 0]",
    );
    assert_eq!(told, "axis X is linear: point is for the other kind of axis; leave it out");
}

#[test]
fn a_default_tool_that_does_not_fit_is_refused() {
    let told = problem(LATHE, "", ["\"wheel-r60-r10\"", "\"ball-6\""], "^\"ball-6\"");
    assert_eq!(
        told,
        "the tool ball-6 does not fit: the cutter sits across the attack axis, where only a wheel \
         cuts; choose a wheel"
    );
    let told = problem("mill-3axis", "", ["\"ball-10\"", "\"wheel:60,10\""], "^\"wheel:60,10\"");
    assert_eq!(
        told,
        "the tool wheel:60,10 does not fit: the cutter sits along the attack axis, where a wheel \
         cannot; choose an end mill"
    );
    let told = problem(LATHE, "", ["\"wheel-r60-r10\"", "\"wheel:60\""], "^\"wheel:60\"");
    assert!(told.starts_with("\"wheel:60\" is not a tool: a wheel has 2 dimension(s)"), "{told}");
}

#[test]
fn a_default_tool_of_another_library_is_left_to_that_library() {
    let text = Machine::builtin_text(LATHE).unwrap().replace("wheel-r60-r10", "our-finisher");
    let lathe = Machine::parse(&text, "my.toml").unwrap();
    assert_eq!(lathe.default_tool, "our-finisher");
    assert!(ToolLibrary::builtin().find(&lathe.default_tool).is_err());
}

#[test]
fn a_machine_file_cut_short_anywhere_is_an_error_and_no_panic() {
    let text = Machine::builtin_text(PAIR).unwrap();
    // The follower at the very end is optional, so is the line break after it.
    let whole = text.find("acceleration-deg-per-s2 = 2_880\nfollows").unwrap();
    for end in (0..whole).filter(|&end| text.is_char_boundary(end)).step_by(7) {
        let parsed = Machine::parse(&text[..end], "my.toml");
        let n_axes = text[..end].matches("[[axis]]").count();
        // Cut between two axes, what is left may be a lathe with one spindle.
        assert!(parsed.is_err() || parsed.unwrap().axes.len() == n_axes, "cut at {end}");
    }
}
