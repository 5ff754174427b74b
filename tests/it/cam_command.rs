//! `horma cam`, `demo`, `check` and `restart` as a user calls them.

use crate::command::horma;
use crate::jobs::small_last;
use crate::parts::Folder;
use horma::gcode::{Dialect, Program, StepKind};
use horma::geom::{Surface, TriMesh, shapes};
use horma::io::{Overwrite, read_program, write_surface};
use horma::machine::Machine;
use serde_json::Value;
use std::path::Path;
use std::process::Output;

pub(crate) const LATHE: &str = "last-lathe";
/// Few positions, no pictures: each call takes a fraction of a second.
pub(crate) const COARSE: [&str; 5] = ["--pitch", "12", "--points-per-turn", "36", "--no-pictures"];
/// What a job of `out.ngc` writes.
pub(crate) const WRITTEN: [&str; 3] = ["out.ngc", "out.report.html", "out.report.json"];

#[test]
fn a_program_comes_with_a_report_for_people_and_one_for_programs() {
    let shop = Shop::new();
    let told = shop.cam(&[]);
    assert_eq!(told.status.code(), Some(0), "{}", said(&told));
    assert_eq!(shop.outputs(), WRITTEN);
    let report: Value = serde_json::from_slice(&shop.bytes("out.report.json")).unwrap();
    assert_eq!(report["part"]["name"], "last.stl");
    assert_eq!(report["part"]["mode"], "triangles");
    assert_eq!(report["machine"][0], LATHE);
    assert_eq!(report["run"]["strategy"], "helix");
    assert_eq!(report["run"]["per-turn"], 36);
    assert!(report["run"]["n-positions"].as_u64().unwrap() > 36 * 10);
    assert!(report["program"]["feed_seconds"].as_f64().unwrap() > 1.0);
    assert_eq!(report["program"]["violations"], Value::Array(Vec::new()));
    assert!(report["reach"]["area"].as_f64().unwrap() > 10_000.0);
    assert!(report["warnings"][0].as_str().unwrap().contains("10.0 mm of stock"));
    let page = String::from_utf8(shop.bytes("out.report.html")).unwrap();
    assert!(page.to_lowercase().starts_with("<!doctype html>"));
    for outside in ["http:", "https:", "src=\"/", "<link", "<script src", "@import", "url("] {
        // Nobody fetches the names of the languages a picture is written in, or what is inside.
        let inside = ["http://www.w3.org/", "url(data:", "url(#"];
        let mut found = page.match_indices(outside).map(|(at, _)| &page[at..]);
        let fetched = found.find(|text| !inside.iter().any(|inside| text.starts_with(inside)));
        let fetched = fetched.map(|text| text.chars().take(60).collect::<String>());
        assert_eq!(fetched, None, "the page is not self-contained");
    }
    let text = String::from_utf8(told.stdout).unwrap();
    assert!(text.contains("horma check") && text.contains("out.report.html"), "{text}");
}

#[test]
fn the_command_that_comes_next_names_machine_and_language_as_they_were_given() {
    let shop = Shop::new();
    let mine = shop.folder.put("mine.toml", Machine::builtin_text(LATHE).unwrap());
    let (last, out) = (shop.folder.path("last.stl"), shop.folder.path("out.nc"));
    let cam = ["cam", text(&last), "-m", text(&mine), "--dialect", "fanuc", "-o", text(&out)];
    let told = horma(&[&cam[..], &COARSE].concat());
    assert_eq!(told.status.code(), Some(0), "{}", said(&told));
    let answer = String::from_utf8(told.stdout).unwrap();
    let next = answer.lines().find_map(|line| line.strip_prefix("next  horma ")).unwrap();
    let next: Vec<&str> = next.split(' ').collect();
    assert_eq!(next, ["check", text(&out), "-m", text(&mine), "--dialect", "fanuc"]);
    assert_eq!(horma(&next).status.code(), Some(0));
}

#[test]
fn a_report_is_json_or_nothing_if_that_was_asked_for() {
    let shop = Shop::new();
    let told = shop.cam(&["--json"]);
    let report: Value = serde_json::from_slice(&told.stdout).unwrap();
    let written: Value = serde_json::from_slice(&shop.bytes("out.report.json")).unwrap();
    assert_eq!(report, written);
    assert!(told.stderr.is_empty(), "{}", said(&told));
    let told = shop.cam(&["-q", "--force"]);
    assert_eq!(told.status.code(), Some(0), "{}", said(&told));
    assert!(told.stdout.is_empty() && told.stderr.is_empty());
}

#[test]
fn a_program_on_standard_output_is_nothing_but_the_program() {
    let shop = Shop::new();
    let last = shop.folder.path("last.stl");
    let args = ["cam", text(&last), "-m", LATHE, "-o", "-"];
    let told = horma(&[&args[..], &COARSE].concat());
    assert_eq!(told.status.code(), Some(0), "{}", said(&told));
    assert_eq!(shop.outputs(), [""; 0]);
    shop.cam(&[]);
    assert!(told.stdout == shop.bytes("out.ngc"), "not what goes into a file");
}

#[test]
fn the_command_line_wins_over_the_job_file() {
    let shop = Shop::new();
    let job = "part = \"last.stl\"\nmachine = \"last-lathe\"\noutput = \"out.ngc\"\n[options]\n\
               pitch = 20\npoints-per-turn = 24\nstrategy = \"rings\"\n";
    let job = shop.folder.put("job.toml", job);
    let job = ["cam", "--job", text(&job), "--no-pictures"];
    let run = |more: &[&str]| {
        let told = horma(&[&job[..], more].concat());
        assert_eq!(told.status.code(), Some(0), "{}", said(&told));
        let report: Value = serde_json::from_slice(&shop.bytes("out.report.json")).unwrap();
        report["run"].clone()
    };
    let alone = run(&[]);
    assert_eq!(alone["strategy"], "rings");
    assert_eq!(alone["per-turn"], 24);
    let both = run(&["--force", "--points-per-turn", "12"]);
    assert_eq!(both["strategy"], "rings");
    assert_eq!(both["per-turn"], 12);
    assert_eq!(both["pitch"], alone["pitch"]);
}

#[test]
fn a_cloud_is_cut_in_the_mode_of_the_thesis_alone() {
    let shop = Shop::new();
    let points = shapes::chiral(4_000).points;
    let lines: Vec<_> = points.iter().map(|p| format!("{} {} {}\n", p.x, p.y, p.z)).collect();
    shop.folder.put("cloud.xyz", lines.concat());
    let told = shop.cam_of("cloud.xyz", &["--units", "mm", "--mode", "triangles"]);
    refused(&told, 65, &["the part has points alone; use --mode points"]);
    let told = shop.cam_of("cloud.xyz", &["--units", "mm", "--axis", "x"]);
    assert_eq!(told.status.code(), Some(0), "{}", said(&told));
    let report: Value = serde_json::from_slice(&shop.bytes("out.report.json")).unwrap();
    assert_eq!(report["part"]["mode"], "points");
    assert_eq!(report["reach"], Value::Null);
}

#[test]
fn the_demo_ends_well_and_its_program_can_be_checked_and_taken_up_again() {
    let shop = Shop::new();
    let (folder, program) = (shop.folder.path("demo"), shop.folder.path("demo/last.ngc"));
    let rest = shop.folder.path("demo/rest.ngc");
    let demo = ["demo", "--out", text(&folder), "--length", "150", "--resolution", "5"];
    let told = horma(&demo);
    assert_eq!(told.status.code(), Some(0), "{}", said(&told));
    let next = String::from_utf8(told.stdout).unwrap();
    assert!(next.contains("horma check") && next.contains("horma cam"), "{next}");
    let mut names = names_in(&folder);
    names.sort_unstable();
    let programs = ["last", "rough"].map(|name| {
        ["ngc", "report.html", "report.json"].map(|extension| format!("{name}.{extension}"))
    });
    let mut expected = programs.concat();
    expected.push("last.stl".into());
    expected.sort_unstable();
    assert_eq!(names, expected);
    refused(&horma(&demo), 73, &["exists already"]);
    let page = std::fs::read_to_string(folder.join("last.report.html")).unwrap();
    assert!(page.contains("Cut in simulation") && page.contains("Unrolled about the spindle."));

    let told = horma(&["check", text(&program), "-m", LATHE]);
    assert_eq!(told.status.code(), Some(0), "{}", said(&told));

    let machine = Machine::builtin(LATHE).unwrap();
    let linuxcnc = Dialect::named("linuxcnc").unwrap();
    let whole = read_program(&program, &machine, &linuxcnc).unwrap();
    let line = whole.blocks[whole.blocks.len() / 2].line.to_string();
    let restart = ["restart", text(&program), "-m", LATHE, "--line", &line, "-o", text(&rest)];
    let told = horma(&restart);
    assert_eq!(told.status.code(), Some(0), "{}", said(&told));
    assert_eq!(horma(&["check", text(&rest), "-m", LATHE]).status.code(), Some(0));
    let rest = ends(&read_program(&rest, &machine, &linuxcnc).unwrap(), &machine);
    let whole = ends(&whole, &machine);
    let from: u32 = line.parse().unwrap();
    let left = whole.iter().filter(|(at, _)| from <= *at).map(|(_, end)| *end).collect::<Vec<_>>();
    assert!(left.len() > 10_000, "{}", left.len());
    let taken_up: Vec<_> = rest[rest.len() - left.len()..].iter().map(|(_, end)| *end).collect();
    assert!(taken_up == left, "the rest goes another way");
    assert_eq!(
        horma(&["check", text(&shop.folder.path("demo/rest.ngc")), "-m", LATHE]).status.code(),
        Some(0)
    );
}

/// Line and end of every move.
fn ends(program: &Program, machine: &Machine) -> Vec<(u32, [f64; 6])> {
    let moves = program.steps(machine).filter(|step| step.kind != StepKind::Dwell);
    moves.filter_map(|step| Some((step.line, step.values(program)?))).collect()
}

/// A folder with a small last in it.
pub(crate) struct Shop {
    pub(crate) folder: Folder,
}

impl Shop {
    pub(crate) fn new() -> Self {
        let shop = Self { folder: Folder::new() };
        shop.part("last.stl", small_last(150.0), 1.0);
        shop
    }

    pub(crate) fn part(&self, name: &str, mesh: TriMesh, scale: f64) {
        let surface = Surface::Mesh(mesh).scaled(scale);
        write_surface(&self.folder.path(name), &surface, Overwrite::Refuse).unwrap();
    }

    /// Cuts the last into `out.ngc`, coarsely unless `more` says otherwise.
    pub(crate) fn cam(&self, more: &[&str]) -> Output {
        self.cam_of("last.stl", more)
    }

    pub(crate) fn cam_of(&self, part: &str, more: &[&str]) -> Output {
        let (part, out) = (self.folder.path(part), self.folder.path("out.ngc"));
        let args = ["cam", text(&part), "-m", LATHE, "-o", text(&out)];
        let asked = |flag: &str| more.contains(&flag);
        // A flag is said once.
        let coarse = if asked("--pitch") { &COARSE[2..] } else { &COARSE[..] };
        horma(&[&args[..], coarse, more].concat())
    }

    pub(crate) fn bytes(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.folder.path(name)).unwrap()
    }

    /// What is in the folder beside what the test put there: outputs, and anything half-written.
    pub(crate) fn outputs(&self) -> Vec<String> {
        let mut names = names_in(&self.folder.path(""));
        names.retain(|name| name.starts_with("out.") || name.starts_with('.'));
        names.sort_unstable();
        names
    }
}

fn names_in(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
}

/// The command ends with `code`, all of `expected` on stderr, and nothing on stdout.
#[track_caller]
pub(crate) fn refused(told: &Output, code: i32, expected: &[&str]) {
    let message = said(told);
    assert_eq!(told.status.code(), Some(code), "{message}");
    assert!(told.stdout.is_empty());
    for expected in expected {
        assert!(message.contains(expected), "no {expected:?} in: {message}");
    }
}

pub(crate) fn said(told: &Output) -> String {
    String::from_utf8_lossy(&told.stderr).into_owned()
}

pub(crate) fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}
