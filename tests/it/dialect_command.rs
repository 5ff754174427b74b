//! `horma dialect`, and what other commands do with dialects, as a user calls them.

use crate::cam_command::{LATHE, Shop, refused, said, text};
use crate::command::horma;
use horma::gcode::Dialect;
use serde_json::Value;

#[test]
fn dialects_are_listed_shown_and_copied() {
    let told = horma(&["dialect", "list"]);
    let list = String::from_utf8(told.stdout).unwrap();
    for name in Dialect::names() {
        assert!(list.lines().any(|line| line.starts_with(name)), "{list}");
    }
    let told = horma(&["dialect", "show", "heidenhain"]);
    assert!(String::from_utf8(told.stdout).unwrap().contains("Klartext"));
    let told = horma(&["dialect", "show", "haas", "--toml"]);
    let copy = String::from_utf8(told.stdout).unwrap();
    assert_eq!(Dialect::parse(&copy, "copy").unwrap(), Dialect::named("haas").unwrap());
    refused(&horma(&["dialect", "show", "hass"]), 65, &["no dialect \"hass\"", "fanuc, haas"]);
}

#[test]
fn a_mistake_in_a_dialect_file_is_shown_with_line_and_column() {
    let shop = Shop::new();
    let mine = Dialect::text_named("fanuc").unwrap().replace("digits = 8", "digits = 2");
    let path = shop.folder.put("mine.toml", &mine);
    let place = format!("{}:", path.display());
    let told = horma(&["dialect", "check", text(&path)]);
    refused(&told, 65, &[&place, "feeds have 4 to 15 significant digits"]);
    let told = horma(&["dialect", "check", text(&path), "--json"]);
    let told: Value = serde_json::from_slice(&told.stdout).unwrap();
    let line = mine.lines().position(|line| line == "[feed]").unwrap() + 1;
    assert_eq!((&told["ok"], told["line"].as_u64()), (&Value::Bool(false), Some(line as u64)));
    assert_eq!(horma(&["dialect", "check", "fanuc"]).status.code(), Some(0));
}

#[test]
fn a_machine_with_a_dialect_that_is_none_is_refused() {
    let shop = Shop::new();
    let told = horma(&["machine", "show", LATHE, "--toml"]);
    let mine = String::from_utf8(told.stdout).unwrap().replace("\"linuxcnc\"", "\"linuxnc\"");
    let path = shop.folder.put("mine.toml", &mine);
    refused(&horma(&["machine", "check", text(&path)]), 65, &["there is no dialect \"linuxnc\""]);
}

#[test]
fn a_program_in_another_dialect_is_checked_and_taken_up_in_it() {
    let shop = Shop::new();
    let told = shop.cam(&["--dialect", "heidenhain", "--coolant", "flood"]);
    assert_eq!(told.status.code(), Some(0), "{}", said(&told));
    let out = shop.folder.path("out.ngc");
    let written = String::from_utf8(shop.bytes("out.ngc")).unwrap();
    assert!(written.starts_with("0 BEGIN PGM HORMA0001 MM\n"), "{written}");
    assert!(written.lines().any(|line| line.ends_with(" M8")), "the coolant is on");
    let check = ["check", text(&out), "-m", LATHE];
    refused(&horma(&check), 65, &["out.ngc: line 1, column 1: '0' begins no word"]);
    let told = horma(&[&check[..], &["--dialect", "heidenhain"]].concat());
    assert_eq!(told.status.code(), Some(0), "{}", said(&told));
    let rest = shop.folder.path("out.rest.h");
    let told = horma(&[
        "restart",
        text(&out),
        "-m",
        LATHE,
        "--dialect",
        "heidenhain",
        "--line",
        "100",
        "-o",
        text(&rest),
    ]);
    assert_eq!(told.status.code(), Some(0), "{}", said(&told));
}

#[test]
fn a_program_too_large_for_its_control_comes_in_numbered_parts() {
    let shop = Shop::new();
    let told =
        shop.cam(&["--dialect", "fanuc", "--split-bytes", "12000", "--program-number", "70"]);
    assert_eq!(told.status.code(), Some(0), "{}", said(&told));
    // The whole would not fit, so it is not written.
    assert_eq!(shop.outputs(), ["out.report.html", "out.report.json"]);
    for (name, number) in [("out-1.ngc", "O0070"), ("out-2.ngc", "O0071")] {
        let part = String::from_utf8(shop.bytes(name)).unwrap();
        assert_eq!(part.lines().nth(1), Some(number));
        assert!(part.len() <= 12_000, "{name} has {} bytes", part.len());
        let path = shop.folder.path(name);
        let told = horma(&["check", text(&path), "-m", LATHE, "--dialect", "fanuc"]);
        assert_eq!(told.status.code(), Some(0), "{}", said(&told));
    }
    let told =
        shop.cam(&["--dialect", "fanuc", "--split-bytes", "12000", "--program-number", "70"]);
    refused(&told, 73, &["exists already"]);
}

#[test]
fn a_lathe_program_for_plain_grbl_is_refused_with_what_to_choose() {
    let told = Shop::new().cam(&["--dialect", "grbl"]);
    refused(&told, 65, &["last-lathe turns A, but grbl has linear axes alone", "grblhal"]);
}
