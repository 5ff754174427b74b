//! Runs of mills against closed forms: contour rings on a table, and around a part on a tilted one.

use crate::jobs::{cut, feed_words, try_cut};
use horma::cam::{Block, Strategy};
use horma::gcode::Dialect;
use horma::geom::{Point3, PointCloud, Surface, TriMesh, Vector3, shapes};
use horma::machine::Machine;
use horma::progress::Silent;
use horma::tool::ToolLibrary;
use horma::workflow::cam::{CamOptions, Job, Plan, rough};
use std::collections::HashMap;

const BALL: f64 = 5.0;
/// The facets of our round parts lie within this of the round ones [mm].
const FACETS: f64 = 0.04;

fn contour() -> CamOptions {
    CamOptions {
        tool: Some(format!("ball:{BALL}")),
        strategy: Some(Strategy::Contour),
        pitch: Some(2.0),
        step: Some(1.0),
        // Positions are looked at, and not what a proof puts between them.
        no_certify: true,
        ..Default::default()
    }
}

#[test]
fn contour_rings_run_over_a_ball_as_far_as_the_tool_touches_it() {
    let ball = shapes::sphere(&Point3::origin(), 20.0, 90);
    let words = feed_words(&cut(&ball, "mill-3axis", &contour()), "mill-3axis");
    let mut from_axis = Vec::new();
    for &[x, y, z, ..] in &words {
        let rho = x.hypot(y);
        from_axis.push(rho);
        // Beside the ball the height of the last touch is held.
        if rho < 24.0 {
            let tip = (25.0 * 25.0 - rho * rho).sqrt() + 20.0 - BALL;
            assert!((z - tip).abs() < 5.0 * FACETS, "{z} at {rho}, not {tip}");
        }
    }
    from_axis.sort_by(f64::total_cmp);
    assert!(from_axis[0] < 1.5 && from_axis.last().is_some_and(|rho| 24.5 < *rho));
    let gaps = from_axis.windows(2).map(|pair| pair[1] - pair[0]);
    assert!(gaps.fold(0.0, f64::max) < 2.3, "a ring is missing");
    let steps = words.windows(2).map(|w| (w[1][0] - w[0][0]).hypot(w[1][1] - w[0][1]));
    assert!(steps.fold(0.0, f64::max) < 1.0 + 2e-4);
}

#[test]
fn contour_says_what_it_cannot_do() {
    let ball = shapes::sphere(&Point3::origin(), 20.0, 8);
    let mesh = || Surface::Mesh(ball.clone());
    let scallop = CamOptions { pitch: None, scallop: Some(0.02), ..contour() };
    let error = try_cut(mesh(), "mill-3axis", &scallop).unwrap_err().to_string();
    assert_eq!(error, "--scallop cannot grade a contour's rings; give --pitch instead");
    let cloud = Surface::Points(PointCloud { points: ball.points.clone(), ..Default::default() });
    let error = try_cut(cloud, "mill-3axis", &contour()).unwrap_err().to_string();
    assert!(error.starts_with("strategy contour needs triangles"), "{error}");
    let wheel = CamOptions { tool: Some("wheel:60,10".into()), ..contour() };
    let error = try_cut(mesh(), "last-lathe", &wheel).unwrap_err().to_string();
    assert!(error.contains("no linear axis across X and the attack axis"), "{error}");
}

/// A column of radius 20 and height 40 that stands on the table.
fn column() -> TriMesh {
    let mut column = shapes::prism(120, 20.0, 40.0);
    for point in &mut column.points {
        *point = Point3::new(point.y, point.z, point.x);
    }
    column
}

/// How far a point lies outside a column of this radius between two heights.
fn outside(point: &Point3, radius: f64, [low, high]: [f64; 2]) -> f64 {
    let out = point.x.hypot(point.y) - radius;
    let above = (point.z - high).max(low - point.z);
    out.max(above).min(0.0) + out.max(0.0).hypot(above.max(0.0))
}

#[test]
fn a_tilted_table_turns_a_column_under_the_tool_and_keeps_the_tool_off_itself() {
    let machine = Machine::builtin("mill-5axis").unwrap();
    for (tilt, strategy) in [
        (90.0, Strategy::Helix),
        (60.0, Strategy::Helix),
        (60.0, Strategy::Lines),
        (35.0, Strategy::Rings),
    ] {
        let options = CamOptions {
            tool: Some(format!("ball:{BALL}")),
            strategy: Some(strategy),
            pitch: Some(4.0),
            points_per_turn: Some(60),
            hold: vec![format!("A={tilt}")],
            ..Default::default()
        };
        let plan = cut(&column(), "mill-5axis", &options);
        // It never goes down behind the part.
        assert!(plan.report.run.greatest_rise < 25.0, "{}", plan.report.run.greatest_rise);
        let (mut n_walls, mut n_top) = (0, 0);
        for words in feed_words(&plan, "mill-5axis") {
            let mut values = words;
            (values[3], values[4]) = (words[3].to_radians(), words[4].to_radians());
            assert!((words[3] - tilt).abs() < 1e-3);
            let tip = Point3::from(machine.tool_point(&values));
            let middle = tip + Vector3::new(0.0, 0.0, BALL);
            let seen = machine.machine_from_part(&values).inverse() * middle;
            let off = outside(&seen, 20.0, [0.0, 40.0]);
            assert!(BALL - 2e-3 - FACETS < off, "{tilt}: {off} mm off the column at {seen}");
            // The table's plate has radius 20 + 2 x 5 and lies 1 mm up.
            let off_table = outside(&seen, 30.0, [-1.0, 1.0]);
            assert!(BALL - 2e-3 < off_table, "{tilt}: {off_table} mm off the table at {seen}");
            let touches = off < BALL + 5e-3 + FACETS;
            n_walls += usize::from(touches && (8.0..39.0).contains(&seen.z));
            n_top += usize::from(touches && 44.0 < seen.z);
        }
        assert!(n_walls > 100, "{tilt} {strategy:?}: {n_walls} on the walls");
        // A tool held square to the part's axis does not come over its end.
        assert!(n_top > 20 || tilt == 90.0, "{tilt} {strategy:?}: {n_top} on the top");
        assert!(plan.report.warnings.iter().any(|warning| warning.contains("tilted table")));
    }
}

#[test]
fn roughing_on_a_tilted_table_stays_over_the_part_and_tells_of_the_table() {
    let machine = Machine::builtin("mill-5axis").unwrap();
    let options = CamOptions {
        strategy: Some(Strategy::Lines),
        allowance: Some(1.0),
        pitch: Some(4.0),
        points_per_turn: Some(60),
        overrun: Some(15.0),
        hold: vec!["A=20".into()],
        ..Default::default()
    };
    let finished = cut(&column(), "mill-5axis", &options);
    let job = Job {
        name: "column".into(),
        surface: Surface::Mesh(column()),
        notes: Vec::new(),
        machine: &machine,
        tool: ToolLibrary::builtin().find(&machine.default_tool).unwrap(),
        dialect: &Dialect::named(&machine.dialect).unwrap(),
        options: &options,
        keep_scene: false,
    };
    let roughed = rough(job, &Block::Cylinder { radius: Some(24.0) }, &Silent).unwrap();
    // Both run the same way; where it is, and how high.
    let heights = |plan: &Plan| {
        let words = feed_words(plan, "mill-5axis").into_iter();
        let place = |words: &[f64; 6]| {
            [words[0], words[1], words[4].rem_euclid(360.0)]
                .map(|word| (word * 100.0).round() as i64)
        };
        words.map(|words| (place(&words), words[2])).collect::<Vec<_>>()
    };
    let finished: HashMap<_, _> = heights(&finished).into_iter().collect();
    let mut n_found = 0;
    for (place, height) in heights(&roughed) {
        if let Some(finished) = finished.get(&place) {
            n_found += 1;
            assert!(finished - 1e-3 <= height, "down to {height} at {place:?}, not to {finished}");
        }
    }
    assert!(n_found > 1000, "{n_found}");
    assert!(roughed.report.warnings.iter().any(|warning| warning.contains("tilted table")));
}

#[test]
fn roughing_of_a_part_that_stands_tilted_spares_the_table_beside_it() {
    let machine = Machine::builtin("mill-5axis").unwrap();
    let options = CamOptions {
        pitch: Some(4.0),
        tool: Some(format!("ball:{BALL}")),
        hold: vec!["A=30".into()],
        ..Default::default()
    };
    let job = Job {
        name: "column".into(),
        surface: Surface::Mesh(column()),
        notes: Vec::new(),
        machine: &machine,
        tool: ToolLibrary::builtin().find(&format!("ball:{BALL}")).unwrap(),
        dialect: &Dialect::named(&machine.dialect).unwrap(),
        options: &options,
        keep_scene: false,
    };
    let roughed = rough(job, &Block::Box { margin: 8.0 }, &Silent).unwrap();
    for mut words in feed_words(&roughed, "mill-5axis") {
        (words[3], words[4]) = (words[3].to_radians(), words[4].to_radians());
        let middle = Point3::from(machine.tool_point(&words)) + Vector3::new(0.0, 0.0, BALL);
        let seen = machine.machine_from_part(&words).inverse() * middle;
        assert!(BALL - 1e-3 <= seen.z, "the ball's middle is {} mm over the table", seen.z);
    }
}

#[test]
fn a_level_table_is_told_to_tilt() {
    let options = CamOptions { strategy: Some(Strategy::Helix), ..Default::default() };
    let error = try_cut(Surface::Mesh(column()), "mill-5axis", &options).unwrap_err().to_string();
    assert!(error.starts_with("Helix runs around the part, and turning C shows"), "{error}");
    assert!(error.contains("as with --hold A=60"), "{error}");
    let error = try_cut(Surface::Mesh(column()), "mill-3axis", &options).unwrap_err().to_string();
    assert_eq!(
        error,
        "Helix runs around the part, and mill-3axis has no rotary axis that turns the part"
    );
}
