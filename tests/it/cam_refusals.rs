//! What `horma cam` refuses, with what message and exit code; and how it stops half-way.

use crate::cam_command::{COARSE, LATHE, Shop, WRITTEN, refused, text};
use crate::command::horma;
use crate::jobs::small_last;
use horma::geom::shapes;
use horma::machine::Machine;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

#[test]
fn an_unknown_key_of_a_job_file_is_refused_by_name_and_line() {
    let shop = Shop::new();
    let job = shop.folder.put("job.toml", "part = \"last.stl\"\n[options]\npich = 20\n");
    let told = horma(&["cam", "--job", text(&job)]);
    refused(&told, 65, &["job.toml", "line 3", "unknown field `pich`", "pitch"]);
}

#[test]
fn what_is_missing_is_asked_for() {
    let shop = Shop::new();
    let last = shop.folder.path("last.stl");
    for (args, expected) in [
        (&["cam"][..], "a part to cut is missing"),
        (&["cam", text(&last)], "a machine is missing; give it, as in: -m last-lathe"),
        (&["cam", text(&last), "-m", LATHE], "an output is missing; give it, as in: -o out.ngc"),
    ] {
        refused(&horma(args), 2, &[expected]);
    }
}

#[test]
fn a_part_larger_than_the_machine_is_refused_with_axis_need_and_limit() {
    let shop = Shop::new();
    shop.part("long.stl", small_last(240.0), 2.0);
    let told = shop.cam_of("long.stl", &[]);
    refused(
        &told,
        65,
        &["does not fit last-lathe: X would have to go to ", "its travel is -20.0 to 420.0 mm"],
    );
    shop.part("thick.stl", shapes::prism(24, 260.0, 200.0), 1.0);
    let told = shop.cam_of("thick.stl", &["--axis", "x"]);
    refused(&told, 65, &["Y would have to go to 35", "travel is 20.0 to 300.0 mm; take a smaller"]);
    assert_eq!(shop.outputs(), [""; 0]);
}

#[test]
fn a_wheel_that_cannot_pass_the_stubs_is_refused() {
    let told = Shop::new().cam(&["--tool", "wheel:60,26"]);
    refused(&told, 65, &["cannot pass the clamp at the heel: it is 52.0 mm wide", "narrower"]);
}

#[test]
fn bad_tools_machines_and_strategies_are_refused_by_name() {
    let shop = Shop::new();
    refused(&shop.cam(&["--tool", "wheel:60,-10"]), 65, &["-10", "wheel"]);
    refused(&shop.cam(&["--tool", "ball:3"]), 65, &["ball:3 does not fit", "choose a wheel"]);
    refused(&shop.cam(&["--tool", "wheel-r60-r11"]), 65, &["wheel-r60-r11", "wheel-r60-r10"]);
    refused(&shop.cam(&["--strategy", "spiral"]), 2, &["spiral", "helix, rings, lines, raster"]);
    refused(&shop.cam(&["--strategy", "raster"]), 65, &["cannot run Raster", "last-lathe"]);
    refused(&shop.cam(&["--pitch", "0"]), 65, &["--pitch is 0"]);
    refused(&shop.cam(&["--pitch", "nan"]), 65, &["--pitch is NaN"]);
    refused(&shop.cam(&["--verify=0"]), 65, &["--verify is 0; it must be a number above 0"]);
    refused(&shop.cam(&["--scallop", "0.1", "--pitch", "1"]), 2, &["--scallop", "--pitch"]);
    refused(&shop.cam(&["--axis", "0 0 0"]), 65, &["\"0 0 0\" is no direction"]);
    refused(&shop.cam(&["--hold", "Q=3"]), 65, &["\"Q=3\" is no axis"]);
    let last = shop.folder.path("last.stl");
    let out = shop.folder.path("out.ngc");
    let told = horma(&["cam", text(&last), "-m", "last-lath", "-o", text(&out)]);
    refused(&told, 65, &["last-lath", "last-lathe"]);
    assert_eq!(shop.outputs(), [""; 0]);
}

#[test]
fn a_part_without_triangles_is_refused() {
    let shop = Shop::new();
    shop.folder.put("empty.stl", "solid a\nendsolid a\n");
    refused(&shop.cam_of("empty.stl", &[]), 65, &["empty.stl", "there are no triangles in it"]);
}

#[test]
fn a_machine_file_that_hangs_in_itself_or_lacks_an_axis_is_refused() {
    let shop = Shop::new();
    let pair = Machine::builtin_text("last-lathe-pair").unwrap();
    let follows = "follows = { axis = \"A\"";
    for (from, to, expected) in [
        (follows, "follows = { axis = \"B\"", "B"),
        (follows, "follows = { axis = \"C\"", "C"),
        ("spindle = \"A\"", "spindle = \"C\"", "C"),
        ("attack = \"Y\"", "attack = \"Z\"", "Z"),
    ] {
        assert!(pair.contains(from));
        let mine = shop.folder.put("mine.toml", pair.replace(from, to));
        let line = pair.lines().position(|line| line.contains(from)).unwrap() + 1;
        let (last, out) = (shop.folder.path("last.stl"), shop.folder.path("out.ngc"));
        let told = horma(&["cam", text(&last), "-m", text(&mine), "-o", text(&out)]);
        refused(&told, 65, &[&format!("mine.toml:{line}:"), expected]);
    }
}

#[test]
fn a_spindle_axis_that_misses_the_part_is_refused() {
    let shop = Shop::new();
    let mut last = small_last(150.0);
    for point in &mut last.points {
        point.y += 200.0;
    }
    shop.part("aside.stl", last, 1.0);
    let told = shop.cam_of("aside.stl", &["--axis", "x", "--centre", "origin"]);
    refused(&told, 65, &["the heel stub finds no part on the spindle axis", "choose another"]);
}

#[test]
fn an_output_that_cannot_be_is_refused_before_the_work() {
    let shop = Shop::new();
    let last = shop.folder.path("last.stl");
    let nowhere = shop.folder.path("no-such-folder/out.ngc");
    let told = horma(&["cam", text(&last), "-m", LATHE, "-o", text(&nowhere)]);
    refused(&told, 73, &["no-such-folder", "does not exist; create it"]);
    // Any of the three counts.
    for name in WRITTEN {
        shop.folder.put(name, "theirs");
        refused(&shop.cam(&[]), 73, &[name, "exists already", "--force"]);
        assert_eq!(shop.bytes(name), b"theirs");
        assert_eq!(shop.outputs(), [name]);
        std::fs::remove_file(shop.folder.path(name)).unwrap();
    }
}

#[test]
fn a_part_where_the_demo_would_put_its_own_is_told_before_the_work() {
    let shop = Shop::new();
    let folder = shop.folder.path("");
    refused(&horma(&["demo", "--out", text(&folder)]), 73, &["last.stl", "exists already"]);
    assert_eq!(shop.outputs(), [""; 0]);
}

#[cfg(unix)]
#[test]
fn a_disk_that_fills_up_half_way_leaves_the_old_files_and_nothing_else() {
    let shop = Shop::new();
    for old in [false, true] {
        if old {
            for name in WRITTEN {
                shop.folder.put(name, "old");
            }
        }
        let (last, out) = (shop.folder.path("last.stl"), shop.folder.path("out.ngc"));
        // No file may grow beyond a few KiB; past that the write fails as on a full disk.
        let told = Command::new("sh")
            .args(["-c", "trap '' XFSZ; ulimit -f 8; exec \"$0\" \"$@\""])
            .args([env!("CARGO_BIN_EXE_horma"), "cam", text(&last), "-m", LATHE])
            .args(["-o", text(&out), "--force"])
            .args(COARSE)
            .output()
            .unwrap();
        refused(&told, 73, &["cannot write", "out.ngc", "make room or write somewhere else"]);
        assert_eq!(shop.outputs(), if old { &WRITTEN[..] } else { &[] });
        assert!(!old || WRITTEN.iter().all(|name| shop.bytes(name) == b"old"));
    }
}

#[cfg(target_os = "linux")]
#[test]
fn ctrl_c_in_the_midst_ends_within_a_second_and_leaves_nothing() {
    let shop = Shop::new();
    shop.part("fine.stl", shapes::chiral(200_000), 1.0);
    let (part, out) = (shop.folder.path("fine.stl"), shop.folder.path("out.ngc"));
    let mut child = Command::new(env!("CARGO_BIN_EXE_horma"))
        .args(["cam", text(&part), "-m", LATHE, "-o", text(&out), "--method", "exhaustive"])
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    wait_until_busy(&mut child);
    let asked = Instant::now();
    assert!(interrupt(&child).success());
    let told = child.wait_with_output().unwrap();
    let took = asked.elapsed();
    refused(&told, 75, &["stopping", "stopped on request; nothing was written"]);
    assert_eq!(shop.outputs(), [""; 0]);
    assert!(took < Duration::from_secs(1), "{took:?}");
}

/// Waits until `child` has worked for a while, however busy the machine is: it digitizes then.
#[cfg(target_os = "linux")]
fn wait_until_busy(child: &mut Child) {
    let stat = format!("/proc/{}/stat", child.id());
    let ticks = || -> u64 {
        let stat = std::fs::read_to_string(&stat).unwrap();
        let (_, fields) = stat.rsplit_once(") ").unwrap();
        // User and system time are the 14th and 15th field; the first two are cut off.
        fields.split(' ').skip(11).take(2).map(|field| field.parse::<u64>().unwrap()).sum()
    };
    while ticks() < 200 {
        assert!(child.try_wait().unwrap().is_none(), "the job ends before it is stopped");
        std::thread::sleep(Duration::from_millis(20));
    }
}

#[cfg(target_os = "linux")]
fn interrupt(child: &Child) -> std::process::ExitStatus {
    Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap()
}
