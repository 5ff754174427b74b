//! Programs for tilted tables cut in simulation: indexed, turned at a constant tilt, or refused.

use crate::jobs::{cut, program_of};
use crate::verify::{linuxcnc, verified_on};
use horma::cam::{Block, Strategy};
use horma::gcode::read;
use horma::geom::{Aabb, Point3, Surface, TriMesh, Vector3, shapes};
use horma::machine::Machine;
use horma::measure::CollisionKind;
use horma::progress::Silent;
use horma::tool::{Body, BodyPart, Tool, ToolLibrary};
use horma::workflow::cam::{CamOptions, Job, rough};
use horma::workflow::verify::{RawBlock, VerifyJob, VerifyOptions, verify};
use nalgebra::{Isometry3, Translation3, UnitQuaternion};
use std::f64::consts::{FRAC_PI_2, TAU};

#[test]
fn a_part_indexed_on_a_tilted_table_is_simulated_as_the_tool_sees_it() {
    let aabb = Aabb { min: Point3::new(-20.0, -15.0, 0.0), max: Point3::new(20.0, 15.0, 30.0) };
    let part = shapes::cuboid(&aabb);
    let options = CamOptions {
        tool: Some("ball-10".into()),
        pitch: Some(2.0),
        hold: vec!["A=30".into(), "C=45".into()],
        tolerance: Some(0.01),
        ..Default::default()
    };
    let plan = cut(&part, "mill-5axis", &options);
    let mill = Machine::builtin("mill-5axis").unwrap();
    let program = program_of(&plan, &mill);
    let ball = ToolLibrary::builtin().find("ball-10").unwrap();
    let found =
        verified_on(("mill-5axis", &ball), &part, &program, RawBlock::Grown(1.0), 0.5).report;
    assert!(found.is_clean(), "{:?}", found.faults);
    // Flat sides that lean are left with the ridges of a ball of 5 mm at 2 mm and a steep pitch.
    let left = found.deviation.left_by_path.unwrap().value;
    assert!(left < 0.5, "{left}");
    assert_eq!(found.simulation.n_collisions, 0);
}

/// A round column that stands on the table, 40 mm high.
fn column() -> TriMesh {
    let upright = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), -FRAC_PI_2);
    let lying = shapes::stub(180, 20.0, 0.0, 40.0);
    lying.moved(&Isometry3::from_parts(Translation3::identity(), upright))
}

#[test]
fn roughing_about_a_tilted_table_proves_its_rapids_and_watches_what_carries_the_tool() {
    let machine = Machine::builtin("mill-5axis").unwrap();
    let options = CamOptions {
        strategy: Some(Strategy::Helix),
        pitch: Some(4.0),
        points_per_turn: Some(60),
        max_depth: Some(4.0),
        hold: vec!["A=60".into()],
        ..Default::default()
    };
    let flat = ToolLibrary::builtin().find("flat-12").unwrap();
    let job = Job {
        name: "column".into(),
        surface: Surface::Mesh(column()),
        notes: Vec::new(),
        machine: &machine,
        tool: flat.clone(),
        dialect: &linuxcnc(),
        options: &options,
        keep_scene: false,
    };
    let plan = rough(job, &Block::Box { margin: 4.0 }, &Silent).unwrap();
    let roughed = plan.report.rough.as_ref().unwrap();
    assert!(roughed.links.n_rapids > 2 * roughed.n_cuts, "{roughed:?}");
    assert!(roughed.links.clearance > 0.8 * machine.clearance, "{roughed:?}");

    let program = program_of(&plan, &machine);
    let collisions = |stick_out: f64| {
        let body =
            Body { holder_diameter: Some(40.0), stick_out: Some(stick_out), ..Body::default() };
        let tool = Tool { body: Some(body), length: 150.0, ..flat.clone() };
        let block = RawBlock::Body(Block::Box { margin: 4.0 });
        let found = verified_on(("mill-5axis", &tool), &column(), &program, block, 1.0).report;
        let found = found.simulation;
        assert_eq!(found.bodies.checked[0].parts, [BodyPart::Holder]);
        let depth = found.greatest_depth.unwrap().value;
        assert!(found.thickest_cut.unwrap().value <= depth + 1e-9);
        found.collisions
    };
    assert_eq!(collisions(100.0), []);
    // Held short, it runs into the corners of the block.
    let short = collisions(9.0);
    assert!(
        short.iter().any(|hit| hit.kind == CollisionKind::Holder && hit.depth > 1.0),
        "{short:?}"
    );
}

#[test]
fn a_part_turned_on_a_tilted_table_is_simulated_about_the_table_s_axis() {
    let part = column();
    let options = CamOptions {
        tool: Some("ball-10".into()),
        strategy: Some(Strategy::Helix),
        pitch: Some(1.0),
        points_per_turn: Some(180),
        hold: vec!["A=60".into()],
        ..Default::default()
    };
    let plan = cut(&part, "mill-5axis", &options);
    let mill = Machine::builtin("mill-5axis").unwrap();
    let program = program_of(&plan, &mill);
    let ball = ToolLibrary::builtin().find("ball-10").unwrap();
    let found = verified_on(("mill-5axis", &ball), &part, &program, RawBlock::Grown(1.0), 0.5);
    assert!(found.stock.layout().is_on_turntable());
    let found = found.report;
    assert!(found.is_clean(), "{:?}", found.faults);
    assert!(found.deviation.gouge.is_none_or(|spot| spot.value < 0.01), "{:?}", found.deviation);
    // All around and on top, the ridges of a ball of 5 mm at a pitch of 1 mm: 0.025 mm. But the
    // table keeps the ball off the lowest 4 of 40 mm, and the report says so.
    let near = found.deviation.within.iter().find(|within| within.distance == 0.1).unwrap();
    assert!(near.share > 0.85, "{:?}", found.deviation);
    assert!(found.deviation.left_by_tool.unwrap().at[2] < 1.0, "{:?}", found.deviation);
    assert!(found.simulation.removed > 0.8 * TAU * 20.0 * 40.0);
}

#[test]
fn a_tilted_part_is_refused_by_name() {
    let mill = Machine::builtin("mill-5axis").unwrap();
    let text = "G21 G90 G94\nG0 Z90\nG0 X0 Y0 A0 C0\nG1 Z60 F100\nG1 A20\nM30\n";
    let program = read(&mut text.as_bytes(), &mill, &linuxcnc()).unwrap();
    let job = VerifyJob {
        program_name: "tilt".into(),
        program: &program,
        part_name: "cube".into(),
        surface: Surface::Mesh(shapes::cuboid(&Aabb {
            min: Point3::new(-10.0, -10.0, 0.0),
            max: Point3::new(10.0, 10.0, 20.0),
        })),
        notes: Vec::new(),
        machine: &mill,
        tools: vec![ToolLibrary::builtin().find("ball-10").unwrap()],
        setup: &CamOptions::default(),
        block: RawBlock::Body(Block::Box { margin: 1.0 }),
        options: &VerifyOptions { resolution: Some(1.0), tolerance: None },
    };
    let message = verify(job, &Silent).unwrap_err().to_string();
    assert!(message.contains("20.000 degrees off"), "{message}");
}
