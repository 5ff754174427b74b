//! Programs cut in simulation, as read back, and compared with the part they are for.

use crate::command::horma;
use crate::jobs::{WHEEL, cut, program_of, small_last};
use crate::parts::{Folder, real};
use horma::cam::Block;
use horma::cam::{SetupOptions, Strategy, set_up};
use horma::gcode::{Dialect, Program, read};
use horma::geom::{Aabb, LengthUnit, Point3, Surface, TriMesh, shapes};
use horma::io::{Overwrite, read_surface, write_surface};
use horma::machine::{Dogs, Machine, Obstacles};
use horma::measure::{CollisionKind, Fixture, simulate};
use horma::progress::Silent;
use horma::stock::{Layout, Resolution, Stock};
use horma::tool::{Body, BodyPart, Side, Tool, ToolLibrary};
use horma::workflow::cam::CamOptions;
use horma::workflow::verify::{RawBlock, Verified, VerifyJob, VerifyOptions, asked, verify};
use serde_json::Value;
use std::fmt::Write;
use std::process::Output;

fn lathe() -> Machine {
    Machine::builtin("last-lathe").unwrap()
}

fn wheel() -> Tool {
    ToolLibrary::builtin().find(WHEEL).unwrap()
}

/// What `program` makes of a block around `part`.
fn verified(part: &TriMesh, program: &Program, block: RawBlock, resolution: f64) -> Verified {
    verified_on(("last-lathe", &wheel()), part, program, block, resolution)
}

/// The same on any machine with any tool.
pub(crate) fn verified_on(
    (machine, tool): (&str, &Tool),
    part: &TriMesh,
    program: &Program,
    block: RawBlock,
    resolution: f64,
) -> Verified {
    let machine = Machine::builtin(machine).unwrap();
    let head = asked(program).unwrap();
    let options = VerifyOptions { resolution: Some(resolution), tolerance: None };
    let job = VerifyJob {
        program_name: "program".into(),
        program,
        part_name: "part".into(),
        surface: Surface::Mesh(part.clone()),
        notes: Vec::new(),
        machine: &machine,
        tools: vec![tool.clone()],
        setup: &head.options.unwrap_or_default(),
        block,
        options: &options,
    };
    verify(job, &Silent).unwrap()
}

/// A round bar of radius 30, 100 mm long: it comes to stand at X 25 to 125.
fn round_bar() -> TriMesh {
    shapes::prism(720, 30.0, 100.0)
}

/// Rings around that bar at `pitch`, as deep as `depth(x)` says, in moves of 10 degrees.
fn rings(pitch: f64, depth: impl Fn(f64) -> f64) -> Program {
    let mut text = String::from("G21 G90 G94\nG0 Y140\nG0 X0 A0\nS6000 M4\n");
    let n_rings = (150.0 / pitch) as usize;
    for i in 0..=n_rings {
        let x = pitch * i as f64;
        let y = 100.0 - depth(x);
        let _ = writeln!(text, "G1 X{x:.3} Y{y:.4} F1000");
        for turn in 1..=36 {
            let _ = writeln!(text, "G1 A{}", 360 * i + 10 * turn);
        }
    }
    text.push_str("G0 Y140\nM30\n");
    read(&mut text.as_bytes(), &lathe(), &linuxcnc()).unwrap()
}

#[test]
fn a_bar_turned_right_is_right_within_the_stated_error() {
    let program = rings(1.0, |_| 0.0);
    let found = verified(&round_bar(), &program, RawBlock::Grown(1.0), 0.5).report;
    assert!(found.is_clean(), "{:?}", found.faults);
    let resolution = found.simulation.resolution;
    assert!(resolution.sweep > 0.0 && resolution.sweep <= 0.011, "{resolution:?}");
    assert!(resolution.hollow.is_some_and(|error| error < 0.01), "{resolution:?}");
    let cusp = 10.0 - (100.0_f64 - 0.25).sqrt();
    let left = found.deviation.left.unwrap().value;
    assert!(left < cusp + resolution.sweep + 1e-3, "{left}");
    // The stubs are thinner than the bar, and the wheel stays at its radius: air.
    assert!(found.deviation.gouge.is_none_or(|spot| spot.value < 1e-3));
    assert!((found.simulation.greatest_depth.unwrap().value - 1.0).abs() < 0.02);
    let thickest = found.simulation.thickest_cut.unwrap();
    assert!((thickest.value - 1.0).abs() < 0.02 && thickest.line.is_some(), "{thickest:?}");
    let histogram: f64 = found.deviation.histogram.iter().map(|bin| bin.area).sum();
    assert!((histogram / found.deviation.area - 1.0).abs() < 1e-3);
}

#[test]
fn a_gouge_is_caught_to_a_hundredth_where_it_is() {
    let program = rings(1.0, |x| if x == 73.0 { 0.37 } else { 0.0 });
    let found = verified(&round_bar(), &program, RawBlock::Grown(1.0), 0.5).report;
    let gouge = found.deviation.gouge.unwrap();
    assert!((gouge.value - 0.37).abs() < 0.01, "{gouge:?}");
    assert!((gouge.at[0] - 73.0).abs() <= 0.25, "{gouge:?}");
    // Four lines, then 37 to a ring.
    let ring = 5 + 37 * 73;
    assert!((ring..=ring + 37).contains(&gouge.line.unwrap()), "{gouge:?}");
    assert!(found.faults[0].contains(&format!(", by line {}", gouge.line.unwrap())));
    // The groove of a nose of radius 10, 0.37 deep, is 5.4 mm wide.
    assert!(
        (found.deviation.gouged_area / 942.0 - 1.0).abs() < 0.15,
        "{}",
        found.deviation.gouged_area
    );
    assert!(!found.is_clean() && found.faults[0].starts_with("the part is cut 0.3"));
}

#[test]
fn a_rapid_through_material_is_a_collision_with_its_line() {
    let text = "G21 G90 G94\nG0 Y140\nG0 X60 A0\nG0 Y98.5\nG0 Y140\nG1 X61 F100\nM30\n";
    let program = read(&mut text.as_bytes(), &lathe(), &linuxcnc()).unwrap();
    let found = verified(&round_bar(), &program, RawBlock::Grown(0.5), 0.5).report;
    let [collision] = found.simulation.collisions[..] else { panic!("{:?}", found.faults) };
    assert_eq!((collision.line, collision.kind), (4, CollisionKind::Rapid));
    assert!((collision.depth - 2.0).abs() < 0.02, "{collision:?}");
}

#[test]
fn a_stub_cut_through_is_a_collision_and_a_free_end_faced_is_none() {
    // Past the bar's end the wheel sinks below the axis, and the bar turns once.
    let faced = |machine: &str, x: f64| {
        let text = format!(
            "G21 G90 G94\nG0 Y140\nG0 X{x} A0\nS6000 M4\nG1 Y69 F1000\nG1 A360\nG0 Y140\nM2\n"
        );
        let on = Machine::builtin(machine).unwrap();
        let program = read(&mut text.as_bytes(), &on, &linuxcnc()).unwrap();
        let block = RawBlock::Grown(3.0);
        verified_on((machine, &wheel()), &round_bar(), &program, block, 0.5).report
    };
    let held = faced("last-lathe", 14.0);
    let across = |kind| kind == CollisionKind::AcrossAxis;
    let collision = held.simulation.collisions.iter().find(|c| across(c.kind)).unwrap();
    assert_eq!(collision.line, 6);
    assert!(collision.in_words().contains("in two"));
    // On the cone lathe the bar begins at X 20: its end is free, and the stock past it is faced.
    let free = faced("last-lathe-cone", 8.0);
    assert!(free.simulation.removed > 1000.0, "{}", free.simulation.removed);
    assert_eq!(free.simulation.collisions, []);
}

#[test]
fn a_spindle_too_thick_for_its_wheel_collides_as_deep_as_the_stock_stands_then() {
    let program = rings(2.0, |_| 0.0);
    let with = |side| {
        // The wheel's centre keeps 100 mm from the axis: a spindle of radius 75 reaches to 25 mm.
        let body = Body {
            spindle_side: Some(side),
            spindle_diameter: Some(150.0),
            arbor_diameter: Some(60.0),
            nut_length: Some(30.0),
            ..Body::default()
        };
        let tool = Tool { body: Some(body), length: 45.0, ..wheel() };
        let block = RawBlock::Grown(1.0);
        verified_on(("last-lathe", &tool), &round_bar(), &program, block, 1.0).report
    };
    // Towards the toe it runs ahead of the wheel, over what is not cut yet; the other way behind it.
    for (side, depth) in [(Side::Toe, 6.0), (Side::Heel, 5.0)] {
        let found = with(side).simulation;
        let deepest = found.collisions.iter().map(|hit| hit.depth).fold(0.0, f64::max);
        assert!((deepest - depth).abs() < 0.1, "{side:?}: {deepest}");
        assert!(found.collisions.iter().all(|hit| hit.kind == CollisionKind::Spindle));
        assert_eq!(found.n_collisions, 100);
        assert_eq!(found.bodies.stopped_at, Some(found.collisions[99].line));
        assert_eq!(found.bodies.checked[0].parts, [BodyPart::Arbor, BodyPart::Spindle]);
    }
    let found = with(Side::Toe);
    assert!(found.faults[0].contains("the spindle runs "), "{:?}", found.faults);
    // Without a word on its body nothing is looked at, and the report says of what.
    let found = verified(&round_bar(), &program, RawBlock::Grown(1.0), 1.0).report.simulation;
    assert_eq!((found.n_collisions, found.bodies.unknown), (0, vec![wheel().name]));
}

#[test]
fn a_dog_in_the_way_is_named_with_its_line_and_depth_where_its_size_is_known() {
    // Past the toe end of the stub, at X 150, to 8 mm below the face of a dog of radius 20.
    let text = "G21 G90 G94\nG0 Y140\nG0 X155 A0\nG1 Y82 F500\nG0 Y140\nM30\n";
    let program = read(&mut text.as_bytes(), &lathe(), &linuxcnc()).unwrap();
    let found = |obstacles: Obstacles| {
        let machine = Machine { obstacles, ..lathe() };
        let job = VerifyJob {
            program_name: "program".into(),
            program: &program,
            part_name: "part".into(),
            surface: Surface::Mesh(round_bar()),
            notes: Vec::new(),
            machine: &machine,
            tools: vec![wheel()],
            setup: &CamOptions::default(),
            block: RawBlock::Grown(1.0),
            options: &VerifyOptions { resolution: Some(1.0), tolerance: None },
        };
        verify(job, &Silent).unwrap().report
    };
    let report = found(Obstacles::default());
    assert_eq!((report.simulation.n_collisions, report.simulation.fixtures), (0, vec![]));
    let dogs = Dogs { radius: 20.0, length: 60.0 };
    let report = found(Obstacles { dogs: Some(dogs), ..Obstacles::default() });
    assert_eq!(report.simulation.fixtures, [Fixture::Dog]);
    let [hit, out] = report.simulation.collisions[..] else { panic!("{:?}", report.faults) };
    assert_eq!((hit.line, hit.kind, hit.by), (4, CollisionKind::Dog, None));
    assert!((hit.depth - 8.0).abs() < 0.06, "{hit:?}");
    assert_eq!(out.line, 5, "and the way out goes through it again");
    assert!(report.faults[0].contains("runs 8.0") && report.faults[0].contains("into a dog"));
}

#[test]
fn a_pass_that_was_made_before_cuts_air() {
    let lines = "G1 X60 Y99 F1000\nG1 X80\nG1 X60\nG1 X80\n";
    let text = format!("G21 G90 G94\nG0 Y140\nG0 X40 A0\n{lines}G1 Y130\nG0 Y140\nM30\n");
    let program = read(&mut text.as_bytes(), &lathe(), &linuxcnc()).unwrap();
    let found = verified(&round_bar(), &program, RawBlock::Grown(0.5), 0.5).report.simulation;
    // Three lines of 20 mm are neither first nor last nor plunge; the first cuts.
    assert!((found.air_share - 2.0 / 3.0).abs() < 0.01, "{found:?}");
}

#[test]
fn a_prism_cut_by_its_program_has_its_own_volume() {
    let prism = shapes::prism(6, 25.0, 100.0);
    let options = CamOptions {
        tool: Some(WHEEL.into()),
        strategy: Some(Strategy::Helix),
        pitch: Some(0.5),
        ..Default::default()
    };
    let machine = lathe();
    let plan = cut(&prism, "last-lathe", &options);
    let program = program_of(&plan, &machine);
    let setup = set_up(Surface::Mesh(prism), &machine, &SetupOptions::default()).unwrap();
    let [from, to] = [setup.part.min.x + 35.0, setup.part.max.x - 35.0];
    let inside = Aabb { min: Point3::new(from, -26.0, -26.0), max: Point3::new(to, 26.0, 26.0) };
    let resolution = Resolution::even(0.4);
    let layout = Layout::new(&machine, &machine.at_rest(), &inside, resolution).unwrap();
    let stock = Stock::cylinder(layout, 26.0);
    let done = simulate(&program, &machine, &[wheel()], stock.into(), &Silent).unwrap();
    let expected = 3.0 * 625.0 * (std::f64::consts::TAU / 6.0).sin() * (to - from);
    let volume = done.report.end_volume;
    assert!((volume / expected - 1.0).abs() < 1e-3, "{volume} for {expected}");
    assert_eq!(done.report.n_collisions, 0);
    let balance = done.report.start_volume - volume - done.report.removed;
    assert!(balance.abs() < 1e-6 * expected, "{balance}");
}

#[test]
fn what_a_wheel_is_too_large_for_is_told_from_what_it_passed_by() {
    // A bar with a groove no wheel of 10 mm can enter, turned with rings that leave out a stretch.
    let mut part = shapes::stub(180, 30.0, 0.0, 40.0);
    part.append(shapes::stub(180, 27.0, 40.0, 43.0));
    part.append(shapes::stub(180, 30.0, 43.0, 100.0));
    let program = rings(1.0, |x| if (95.0..105.0).contains(&x) { -0.4 } else { 0.0 });
    let found =
        verified(&part, &program, RawBlock::Body(Block::Cylinder { radius: Some(31.0) }), 0.5)
            .report
            .deviation;
    let (by_tool, by_path) = (found.left_by_tool.unwrap(), found.left_by_path.unwrap());
    // 3 mm wide, 3 mm deep: the nose dips in by 10 - sqrt(100 - 1.5^2) = 0.113 mm.
    assert!(
        (by_tool.value - 1.5).abs() < 0.1,
        "half the groove's width from its walls: {by_tool:?}"
    );
    assert!((by_tool.at[0] - 66.5).abs() < 2.0, "{by_tool:?}");
    assert!((by_path.value - 0.4).abs() < 0.05, "{by_path:?}");
    assert!((95.0..105.0).contains(&by_path.at[0]), "{by_path:?}");
}

#[test]
fn the_command_sets_the_part_up_as_the_header_says_and_its_exit_code_judges() {
    let shop = Folder::new();
    let last = Surface::Mesh(small_last(240.0));
    write_surface(&shop.path("last.stl"), &last, Overwrite::Refuse).unwrap();
    let [part, program, map] = ["last.stl", "out.ngc", "map.ply"].map(|name| shop.path(name));
    let [part, program, map] = [&part, &program, &map].map(|path| path.to_str().unwrap());
    let coarse = ["--pitch", "8", "--points-per-turn", "90", "--no-pictures", "--mirror", "--flip"];
    let told = horma(&[&["cam", part, "-m", "last-lathe", "-o", program][..], &coarse].concat());
    assert_eq!(told.status.code(), Some(0), "{}", said(&told));

    let base = ["verify", program, part, "-m", "last-lathe", "--resolution", "1.5", "--force"];
    let told = horma(&[&base[..], &["--tolerance", "1", "--map", map, "--json"]].concat());
    assert_eq!(told.status.code(), Some(0), "{}", said(&told));
    let report: Value = serde_json::from_slice(&told.stdout).unwrap();
    let written = std::fs::read(shop.path("out.verify.json")).unwrap();
    assert_eq!(serde_json::from_slice::<Value>(&written).unwrap(), report);
    assert!(report["deviation"]["gouge"]["value"].as_f64().unwrap() < 1.0);
    assert_eq!(report["faults"], Value::Array(Vec::new()));
    let page = std::fs::read_to_string(shop.path("out.verify.html")).unwrap();
    assert!(page.contains("Deepest gouge") && page.contains("data:image/png"));
    let Surface::Mesh(map) = read_surface(map.as_ref(), None).unwrap().surface else { panic!() };
    assert!(map.colors.is_some_and(|colors| colors.len() == map.points.len()));

    // A map that cannot be written is refused before the work, and nothing else is written.
    let untouched = std::fs::read(shop.path("out.verify.json")).unwrap();
    for (name, expected) in [("map.foo", "extension"), ("map.xyz", "cannot hold a mesh")] {
        let told = horma(&[&base[..], &["--map", shop.path(name).to_str().unwrap()]].concat());
        assert_eq!(told.status.code(), Some(73), "{}", said(&told));
        assert!(said(&told).contains(expected), "{}", said(&told));
    }
    assert_eq!(std::fs::read(shop.path("out.verify.json")).unwrap(), untouched);

    // Set up without what the header says, the program is for another foot.
    let told = horma(&[&base[..], &["--tolerance", "1", "--no-header"]].concat());
    assert_eq!(told.status.code(), Some(65), "{}", said(&told));
    assert!(said(&told).contains("the part is cut "), "{}", said(&told));
    let told = horma(&[&base[..], &["--block", "cylinder:5"]].concat());
    assert_eq!(told.status.code(), Some(65));
    assert!(said(&told).contains("the part needs a block of radius"));
}

#[test]
fn a_job_shows_in_its_own_report_what_its_program_leaves() {
    let shop = Folder::new();
    let bar = Surface::Mesh(round_bar());
    write_surface(&shop.path("bar.stl"), &bar, Overwrite::Refuse).unwrap();
    std::fs::write(shop.path("cloud.xyz"), "0 0 0\n90 0 9\n0 9 0\n").unwrap();
    let [part, cloud, program] = ["bar.stl", "cloud.xyz", "out.ngc"].map(|name| shop.path(name));
    let [part, cloud, program] = [&part, &cloud, &program].map(|path| path.to_str().unwrap());
    let coarse = ["-m", "last-lathe", "--pitch", "4", "--points-per-turn", "60", "--no-pictures"];
    let cam = [&coarse[..], &["--stock", "1", "--verify=1", "--json", "-o", program]].concat();
    let told = horma(&[&["cam", part][..], &cam].concat());
    assert_eq!(told.status.code(), Some(0), "{}", said(&told));
    let report: Value = serde_json::from_slice(&told.stdout).unwrap();
    let verified = &report["verified"];
    assert_eq!(verified["block"], "the part with 1 mm more all over");
    assert_eq!(verified["simulation"]["n-collisions"], 0);
    let depth = verified["simulation"]["greatest-depth"]["value"].as_f64().unwrap();
    // The wheel shaves the ends of the block as well, where they are deep along a ray. But the layer
    // it takes is nowhere thicker than the stock: between rays 1 mm apart by one of them at most.
    assert!((1.5..6.0).contains(&depth), "{depth}");
    let thickest = &verified["simulation"]["thickest-cut"];
    let thickness = thickest["value"].as_f64().unwrap();
    assert!((0.95..1.5).contains(&thickness) && thickest["line"].is_u64(), "{thickest}");
    let page = std::fs::read_to_string(shop.path("out.report.html")).unwrap();
    assert!(page.contains("Cut in simulation") && page.contains("Unrolled about the spindle."));
    // Roughing is cut from the block it was made for.
    let rough = ["--force", "--block", "box:3", "--max-depth", "8"];
    let told = horma(&[&["rough", part][..], &cam, &rough].concat());
    assert_eq!(told.status.code(), Some(0), "{}", said(&told));
    let report: Value = serde_json::from_slice(&told.stdout).unwrap();
    assert_eq!(report["verified"]["block"], "a box 3 mm larger all around");
    // What cannot be simulated is written all the same; its report and the exit code say why.
    let fine = ["--verify=0.001", "--force"];
    let told = horma(&[&["cam", part][..], &coarse, &["--json", "-o", program], &fine].concat());
    assert_eq!(told.status.code(), Some(65), "{}", said(&told));
    let why = "not cut in simulation: a resolution of 0.001 mm takes ";
    assert!(said(&told).contains(why), "{}", said(&told));
    let report: Value = serde_json::from_slice(&told.stdout).unwrap();
    assert!(report["not-verified"].as_str().unwrap().starts_with("a resolution of 0.001 mm"));
    assert!(report.get("verified").is_none() && report["program"]["n-blocks"] != 0);
    let page = std::fs::read_to_string(shop.path("out.report.html")).unwrap();
    assert!(page.contains(why));
    let check = horma(&["check", program, "-m", "last-lathe"]);
    assert_eq!(check.status.code(), Some(0), "{}", said(&check));
    // Points have no surface, and standard output has no report: told before the work begins.
    let told = horma(&[&["cam", cloud, "--units", "mm", "--force"][..], &cam].concat());
    assert_eq!(told.status.code(), Some(65), "{}", said(&told));
    assert!(said(&told).contains("no surface to compare with"), "{}", said(&told));
    let told = horma(&[&["cam", part][..], &coarse, &["--verify", "-o", "-"]].concat());
    assert_eq!(told.status.code(), Some(2), "{}", said(&told));
    assert!(said(&told).contains("give -o FILE"), "{}", said(&told));
}

#[test]
fn a_program_goes_on_with_what_the_one_before_it_left() {
    let program = |depth: f64| rings(2.0, |_| depth);
    let bar = RawBlock::Body(Block::Cylinder { radius: Some(34.0) });
    let rough = verified(&round_bar(), &program(-1.5), bar, 1.0);
    let left = RawBlock::Left(Box::new(rough.stock));
    let found = verified(&round_bar(), &program(0.0), left, 1.0).report;
    assert_eq!(found.block, "what the program before it left");
    assert_eq!(found.simulation.start_volume, rough.report.simulation.end_volume);
    // 4 mm of stock less the 2.5 mm roughing took, and the ridges between its rings.
    let ridge = 10.0 - (100.0_f64 - 1.0).sqrt();
    let depth = found.simulation.greatest_depth.unwrap().value;
    assert!((1.5..1.5 + ridge + 0.05).contains(&depth), "{depth}");
}

fn said(told: &Output) -> String {
    String::from_utf8_lossy(&told.stderr).into_owned()
}

#[test]
fn what_is_left_of_a_foot_is_explained() {
    let Some(path) = real("lasts/find_foot/foot_mean_left.obj") else { return };
    let foot = read_surface(&path, Some(LengthUnit::Millimetre)).unwrap().surface;
    let foot = foot.into_mesh().unwrap();
    let options =
        CamOptions { tool: Some(WHEEL.into()), pitch: Some(1.0), ..CamOptions::default() };
    let plan = cut(&foot, "last-lathe", &options);
    let program = program_of(&plan, &lathe());
    let found = verified(&foot, &program, RawBlock::Grown(1.0), 0.5).report;
    eprintln!("{:#?}\n{:#?}", found.simulation, found.deviation);
    assert_eq!(found.simulation.n_collisions, 0);
    let deviation = &found.deviation;
    // Nothing is promised between positions yet; a degree a step keeps it to hundredths.
    assert!(deviation.gouge.is_none_or(|spot| spot.value < 0.2), "{:?}", deviation.gouge);
    // Nearly all of what is left, the tool is too large for.
    assert!(deviation.left_area_by_tool > 0.5 * deviation.left_area, "{deviation:?}");
    assert!(deviation.left_by_tool.unwrap().value > 0.9 * deviation.left.unwrap().value);
}

pub(crate) fn linuxcnc() -> Dialect {
    Dialect::named("linuxcnc").unwrap()
}
