//! The machines and tools that come with horma fit together, and the commands that show and check
//! them.

use horma::machine::{AxisKind, Clamping, Machine, Mount};
use horma::tool::{Shape, ToolLibrary};

const LATHE: &str = "last-lathe";

#[test]
fn every_embedded_machine_is_called_what_its_file_is_and_says_its_dialect() {
    for name in Machine::builtin_names() {
        let machine = Machine::builtin(name).unwrap();
        assert_eq!(machine.name, name);
        assert_eq!(machine.dialect, "linuxcnc");
    }
}

#[test]
fn the_default_tool_of_every_embedded_machine_is_in_the_library_and_fits() {
    let library = ToolLibrary::builtin();
    for name in Machine::builtin_names() {
        let machine = Machine::builtin(name).unwrap();
        let tool = library.by_name(&machine.default_tool).unwrap();
        assert_eq!(machine.check_tool(tool), Ok(()));
        assert!(machine.mount.takes(&tool.profile));
    }
}

#[test]
fn lathes_take_wheels_and_mills_take_the_rest() {
    for tool in ToolLibrary::builtin().tools {
        let is_wheel = tool.profile.shape() == Shape::Wheel;
        assert_eq!(Mount::Across.takes(&tool.profile), is_wheel, "{}", tool.name);
        assert_eq!(Mount::Along.takes(&tool.profile), !is_wheel, "{}", tool.name);
    }
}

#[test]
fn every_last_lathe_has_room_for_a_large_last_under_its_largest_wheel() {
    for name in ["last-lathe", "last-lathe-cone", "last-lathe-pair"] {
        let lathe = Machine::builtin(name).unwrap();
        let [x, y] =
            ['X', 'Y'].map(|letter| lathe.axes[lathe.axis_index(letter).unwrap()].limits.unwrap());
        let held = match lathe.clamping {
            Clamping::Nibs { length, .. } => 2.0 * length,
            Clamping::Cone { gap, .. } => gap,
            Clamping::Table => panic!("{name} is no mill"),
        };
        assert!(held + 330.0 <= x[1] && x[0] <= 0.0, "{name}");
        // Part, wheel R75 r12, clearance.
        assert!(130.0 + 87.0 + lathe.clearance <= y[1], "{name}");
    }
}

#[test]
fn degrees_in_a_file_are_radians_inside() {
    let mill = Machine::builtin("mill-5axis").unwrap();
    let cradle = &mill.axes[mill.axis_index('A').unwrap()];
    assert_eq!(cradle.kind, AxisKind::Rotary);
    assert_eq!(cradle.limits, Some([-30.0_f64.to_radians(), 120.0_f64.to_radians()]));
    assert_eq!(cradle.velocity, std::f64::consts::PI);
    assert_eq!(cradle.acceleration, 900.0_f64.to_radians());
    assert_eq!(mill.axes[mill.axis_index('C').unwrap()].limits, None);
}

#[test]
fn machine_check_says_ok_or_points_at_the_mistake_and_fails() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mine.toml");
    let text = Machine::builtin_text(LATHE).unwrap();

    std::fs::write(&path, text).unwrap();
    let told = horma(&["machine", "check", path.to_str().unwrap()]);
    assert_eq!(told.status.code(), Some(0));
    assert!(String::from_utf8(told.stdout).unwrap().starts_with("ok: "));

    std::fs::write(&path, text.replace("attack = \"Y\"", "attack = \"A\"")).unwrap();
    let line = text.lines().position(|line| line.starts_with("attack")).unwrap() + 1;
    let told = horma(&["machine", "check", path.to_str().unwrap(), "--json"]);
    assert_eq!(told.status.code(), Some(65));
    let stderr = String::from_utf8(told.stderr).unwrap();
    let place = format!("{}:{line}:10: the attack axis must be linear", path.display());
    assert!(stderr.contains(&place), "{stderr}");
    assert_eq!(stderr.matches("must be linear").count(), 1, "told twice: {stderr}");
    let json: serde_json::Value = serde_json::from_slice(&told.stdout).unwrap();
    assert_eq!(
        json,
        serde_json::json!({
            "ok": false,
            "file": path,
            "line": line,
            "column": 10,
            "problem": "the attack axis must be linear, and A is rotary",
        })
    );
}

#[test]
fn machine_check_looks_the_default_tool_up_in_the_library_given() {
    let folder = tempfile::tempdir().unwrap();
    let [machine, tools] = ["mine.toml", "shop.toml"].map(|name| folder.path().join(name));
    let text = Machine::builtin_text(LATHE).unwrap().replace("wheel-r60-r10", "our-finisher");
    std::fs::write(&machine, text).unwrap();
    let [machine, shop] = [&machine, &tools].map(|path| path.to_str().unwrap());

    let told = horma(&["machine", "check", machine]);
    assert_eq!(told.status.code(), Some(65));
    let stderr = String::from_utf8(told.stderr).unwrap();
    assert!(stderr.contains("no tool is called \"our-finisher\""), "{stderr}");

    let ours = ToolLibrary::BUILTIN.replace("\"wheel-r60-r10\"", "\"our-finisher\"");
    std::fs::write(&tools, ours).unwrap();
    assert_eq!(horma(&["machine", "check", machine, "--tools", shop]).status.code(), Some(0));

    let ball = ToolLibrary::BUILTIN.replace("\"ball-6\"", "\"our-finisher\"");
    std::fs::write(&tools, ball).unwrap();
    let told = horma(&["machine", "check", machine, "--tools", shop]);
    assert_eq!(told.status.code(), Some(65));
    let stderr = String::from_utf8(told.stderr).unwrap();
    assert!(stderr.contains("the tool our-finisher does not fit"), "{stderr}");
}

#[test]
fn the_machine_file_shown_can_be_used_as_it_is() {
    let told = horma(&["machine", "show", "mill-rotary", "--toml"]);
    let text = String::from_utf8(told.stdout).unwrap();
    assert_eq!(Machine::parse(&text, "copy.toml"), Machine::builtin("mill-rotary"));
    let told = horma(&["tool", "list", "--toml"]);
    let text = String::from_utf8(told.stdout).unwrap();
    assert_eq!(ToolLibrary::parse(&text, "copy.toml"), Ok(ToolLibrary::builtin()));
}

#[test]
fn every_embedded_machine_and_tool_is_listed() {
    let told = horma(&["machine", "list"]);
    let list = String::from_utf8(told.stdout).unwrap();
    for name in Machine::builtin_names() {
        assert!(list.lines().any(|line| line.split_whitespace().next() == Some(name)), "{list}");
    }
    let told = horma(&["tool", "list", "--json"]);
    let list: Vec<serde_json::Value> = serde_json::from_slice(&told.stdout).unwrap();
    let names: Vec<&str> = list.iter().map(|tool| tool["name"].as_str().unwrap()).collect();
    assert_eq!(names, ToolLibrary::builtin().names().collect::<Vec<_>>());
}

#[test]
fn tool_check_points_at_a_negative_radius() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("shop.toml");
    std::fs::write(&path, ToolLibrary::BUILTIN.replacen("\nradius = 3", "\nradius = -3", 1))
        .unwrap();
    let line = ToolLibrary::BUILTIN.lines().position(|line| line == "radius = 3").unwrap() + 1;
    let told = horma(&["tool", "check", path.to_str().unwrap()]);
    assert_eq!(told.status.code(), Some(65));
    let stderr = String::from_utf8(told.stderr).unwrap();
    let place = format!("shop.toml:{line}:10: a ball cannot have a radius of -3");
    assert!(stderr.contains(&place), "{stderr}");
}

fn horma(args: &[&str]) -> std::process::Output {
    std::process::Command::new(env!("CARGO_BIN_EXE_horma")).args(args).output().unwrap()
}
