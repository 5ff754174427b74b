//! Roughing and finishing in one go: one program or two, as the machine file says.

use crate::cam_command::{COARSE, Shop, refused, said, text};
use crate::command::horma;
use crate::jobs::{WHEEL, program_of, small_last};
use horma::cam::Block;
use horma::gcode::{BlockKind, Dialect, Program, read};
use horma::geom::{Aabb, Point3, Surface, TriMesh, shapes};
use horma::machine::{Machine, ToolChanges};
use horma::progress::Silent;
use horma::tool::{Tool, ToolLibrary};
use horma::workflow::cam::{CamError, CamOptions, Job, Plan, Work, rough_and_finish};
use horma::workflow::verify::{RawBlock, VerifyJob, VerifyOptions, asked, verify};
use serde_json::Value;

const ROUGHING: &str = "flat-12";
const FINISHING: &str = "ball-10";

fn tool(name: &str) -> Tool {
    ToolLibrary::builtin().find(name).unwrap()
}

fn coarse() -> CamOptions {
    CamOptions {
        pitch: Some(4.0),
        rough_pitch: Some(6.0),
        points_per_turn: Some(60),
        rough_with: Some(ROUGHING.into()),
        tool: Some(FINISHING.into()),
        ..CamOptions::default()
    }
}

/// The programs of `part` on `machine`, roughed with `tools[0]` and finished with `tools[1]`.
fn made(
    part: &TriMesh,
    machine: &Machine,
    tools: [&str; 2],
    options: &CamOptions,
) -> Result<Vec<Plan>, CamError> {
    in_dialect(part, machine, &Dialect::named(&machine.dialect).unwrap(), tools, options)
}

fn in_dialect(
    part: &TriMesh,
    machine: &Machine,
    dialect: &Dialect,
    tools: [&str; 2],
    options: &CamOptions,
) -> Result<Vec<Plan>, CamError> {
    let job = Job {
        name: "part".into(),
        surface: Surface::Mesh(part.clone()),
        notes: Vec::new(),
        machine,
        tool: tool(tools[1]),
        dialect,
        options,
        keep_scene: false,
    };
    rough_and_finish(job, tool(tools[0]), &Block::Box { margin: 4.0 }, &Silent)
}

/// The T words of a program, in order.
fn tools_of(program: &Program) -> Vec<u32> {
    let changes = program.blocks.iter().filter_map(|block| match block.kind {
        BlockKind::ToolChange(number) => Some(number),
        _ => None,
    });
    changes.collect()
}

/// A small block that stands on a table.
fn brick() -> TriMesh {
    shapes::cuboid(&Aabb {
        min: Point3::new(-15.0, -10.0, 0.0),
        max: Point3::new(15.0, 10.0, 12.0),
    })
}

#[test]
fn a_mill_that_changes_tools_roughs_and_finishes_in_one_program() {
    let machine = Machine::builtin("mill-rotary").unwrap();
    let part = small_last(150.0);
    let plans = made(&part, &machine, [ROUGHING, FINISHING], &coarse()).unwrap();
    let [plan] = &plans[..] else { panic!("{} programs", plans.len()) };
    let program = program_of(plan, &machine);
    assert_eq!(tools_of(&program), [tool(ROUGHING).number, tool(FINISHING).number]);
    let report = &plan.report;
    assert_eq!(report.work, Work::RoughAndFinish);
    assert_eq!(report.tool[0], FINISHING);
    assert_eq!(report.rough.as_ref().unwrap().tool[0], ROUGHING);
    assert_eq!(report.program.violations, []);
    let times = &report.program.operations;
    let tools: Vec<_> = times.iter().map(|operation| operation.tool).collect();
    assert_eq!(tools, [Some(tool(ROUGHING).number), Some(tool(FINISHING).number)]);
    let sum: f64 = times.iter().map(|operation| operation.planned.total()).sum();
    assert!((sum - report.program.planned.total()).abs() < 1e-6, "{sum}");
    assert!(times.iter().all(|operation| operation.planned.cutting > 10.0), "{times:?}");

    // Its header says how to verify it: the block, the tools, the part as it was set up.
    let head = asked(&program).unwrap();
    let options = head.options.unwrap();
    assert_eq!((options.rough_with.as_deref(), head.stock), (Some(ROUGHING), None));
    let verified = verify(
        VerifyJob {
            program_name: "both.ngc".into(),
            program: &program,
            part_name: "last".into(),
            surface: Surface::Mesh(part),
            notes: Vec::new(),
            machine: &machine,
            tools: vec![tool(ROUGHING), tool(FINISHING)],
            setup: &options,
            block: RawBlock::Body(options.block().parse().unwrap()),
            options: &VerifyOptions { resolution: Some(1.0), tolerance: Some(0.3) },
        },
        &Silent,
    );
    let report = verified.unwrap().report;
    assert!(report.faults.is_empty(), "{:?}", report.faults);
    // The corners of the box stood out by more than 20 mm; what no ball reaches is left.
    let stands = report.deviation.left.unwrap().value;
    assert!(stands < 5.0, "{stands} mm left of the box");
}

#[test]
fn a_lathe_that_does_not_change_tools_gets_two_programs() {
    let machine = Machine::builtin("last-lathe").unwrap();
    let options = CamOptions {
        tool: Some("wheel-r30-r5".into()),
        rough_with: Some("wheel-r60-r10".into()),
        pitch: Some(12.0),
        points_per_turn: Some(36),
        ..CamOptions::default()
    };
    let part = small_last(150.0);
    let plans = made(&part, &machine, ["wheel-r60-r10", "wheel-r30-r5"], &options).unwrap();
    let works: Vec<_> = plans.iter().map(|plan| plan.report.work).collect();
    assert_eq!(works, [Work::Rough, Work::Finish]);
    let programs: Vec<_> = plans.iter().map(|plan| program_of(plan, &machine)).collect();
    assert_eq!(tools_of(&programs[0]), [tool("wheel-r60-r10").number]);
    assert_eq!(tools_of(&programs[1]), [tool("wheel-r30-r5").number]);
    // Each header tells of its own program alone.
    let [rough, finish] = [0, 1].map(|i| asked(&programs[i]).unwrap());
    let (rough, assumed, finish) = (rough.options.unwrap(), finish.stock, finish.options.unwrap());
    assert_eq!(
        (rough.block(), rough.allowance, rough.rough_with.clone()),
        ("box:4", Some(1.0), None)
    );
    assert_eq!((finish.block, finish.allowance, assumed), (None, None, Some(5.0)));
}

#[test]
fn one_wheel_for_both_needs_no_change_and_one_program() {
    let machine = Machine::builtin("last-lathe").unwrap();
    let options =
        CamOptions { pitch: Some(12.0), points_per_turn: Some(36), ..CamOptions::default() };
    let plans = made(&small_last(150.0), &machine, [WHEEL, WHEEL], &options).unwrap();
    let [plan] = &plans[..] else { panic!("{} programs", plans.len()) };
    assert_eq!(tools_of(&program_of(plan, &machine)), [tool(WHEEL).number]);
    assert_eq!(plan.report.program.operations.len(), 2);
    assert!(plan.report.certificate.is_some(), "finishing is certified all the same");
}

#[test]
fn every_dialect_changes_the_tool_between_both() {
    for name in Dialect::names() {
        let dialect = Dialect::named(name).unwrap();
        // Standard GRBL turns nothing.
        let machine = Machine::builtin("mill-3axis").unwrap();
        let options = CamOptions { rough_pitch: Some(8.0), ..coarse() };
        let plans =
            in_dialect(&brick(), &machine, &dialect, [ROUGHING, FINISHING], &options).unwrap();
        let [plan] = &plans[..] else { panic!("{name}: {} programs", plans.len()) };
        let program = read(&mut plan.text.as_slice(), &machine, &dialect).unwrap();
        assert_eq!(tools_of(&program), [22, 12], "{name}");
        assert_eq!(plan.report.program.violations, [], "{name}");
    }
}

#[test]
fn two_tools_of_one_number_cannot_share_a_program() {
    let mill = Machine::builtin("mill-3axis").unwrap();
    let error = made(&brick(), &mill, ["flat:6", "ball:5"], &coarse()).unwrap_err().to_string();
    let expected = "the tools flat:6 and ball:5 are both T99: one program cannot change from one to the \
                    other; give them numbers of their own in a tool library";
    assert_eq!(error, expected);
    let mill = Machine { tool_changes: ToolChanges::BetweenPrograms, ..mill };
    assert_eq!(made(&brick(), &mill, ["flat:6", "ball:5"], &coarse()).unwrap().len(), 2);
}

#[test]
fn the_command_writes_one_file_or_two_and_verify_knows_the_block_and_the_tools() {
    let shop = Shop::new();
    let rough_with = |tool: &str| {
        let more = ["--rough-with", tool, "--rough-pitch", "12", "--block", "box:5", "--force"];
        let told = shop.cam(&[&more[..], &["--max-depth", "9", "--json"]].concat());
        assert_eq!(told.status.code(), Some(0), "{}", said(&told));
        serde_json::from_slice::<Value>(&told.stdout).unwrap()
    };
    let [out, rough] = ["out.ngc", "out.rough.ngc"].map(|name| shop.folder.path(name));
    let report = rough_with("wheel-r60-r10");
    assert_eq!(report["work"], "rough-and-finish");
    assert_eq!(report["rough"]["max-depth"], 9.0);
    assert!(!rough.exists(), "the wheel stays");
    let last = shop.folder.path("last.stl");
    let verify =
        ["verify", text(&out), text(&last), "-m", "last-lathe", "--resolution", "3", "--json"];
    let told = horma(&[&verify[..], &["--tolerance", "2"]].concat());
    assert_eq!(told.status.code(), Some(0), "{}", said(&told));
    let verified: Value = serde_json::from_slice(&told.stdout).unwrap();
    assert_eq!(verified["block"], "a box 5 mm larger all around");

    let reports = rough_with("wheel-r75-r12");
    assert_eq!((&reports[0]["work"], &reports[1]["work"]), (&"rough".into(), &"finish".into()));
    assert_eq!(reports[0]["tool"][0], "wheel-r75-r12");
    for name in ["out.rough.ngc", "out.rough.report.json", "out.rough.report.html"] {
        assert!(shop.folder.path(name).exists(), "{name}");
    }
    assert_eq!(horma(&["check", text(&rough), "-m", "last-lathe"]).status.code(), Some(0));
    let stream =
        ["cam", text(&last), "-m", "last-lathe", "-o", "-", "--rough-with", "wheel-r75-r12"];
    refused(
        &horma(&[&stream[..], &COARSE].concat()),
        2,
        &["two programs cannot go to standard output"],
    );
}

#[test]
fn a_job_file_can_ask_for_roughing_too() {
    let shop = Shop::new();
    let job = "part = \"last.stl\"\nmachine = \"mill-rotary\"\noutput = \"out.ngc\"\n[options]\n\
               pitch = 12\npoints-per-turn = 24\nrough-with = \"flat-12\"\nrough-pitch = 12\n\
               max-depth = 20\n";
    let job = shop.folder.put("job.toml", job);
    let told = horma(&["cam", "--job", text(&job), "--no-pictures"]);
    assert_eq!(told.status.code(), Some(0), "{}", said(&told));
    let told = String::from_utf8(told.stdout).unwrap();
    assert!(told.contains("T22 from line") && told.contains("T12 from line"), "{told}");
    let told = shop.cam(&["--force", "--max-depth", "3"]);
    refused(&told, 65, &["name its tool with --rough-with"]);
}
