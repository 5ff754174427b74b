//! Roughing programs against closed forms.

use crate::jobs::{WHEEL, program_of, small_last};
use horma::cam::{Block, Strategy};
use horma::gcode::{Dialect, StepKind};
use horma::geom::{Surface, TriMesh, shapes};
use horma::machine::Machine;
use horma::progress::Silent;
use horma::tool::ToolLibrary;
use horma::workflow::cam::{CamError, CamOptions, Job, Plan, rough};
use horma::workflow::verify::{RawBlock, VerifyJob, VerifyOptions, verify};

/// R + r of the wheel [mm].
const WHEEL_TOP: f64 = 70.0;
/// Of the column that is roughed, and of its bar [mm].
const RADII: [f64; 2] = [20.0, 40.0];
const DEPTH: f64 = 6.0;

fn roughed(
    part: &TriMesh,
    block: &Block,
    max_depth: f64,
    options: &CamOptions,
) -> Result<Plan, CamError> {
    let options = &CamOptions { max_depth: Some(max_depth), ..options.clone() };
    let machine = Machine::builtin("last-lathe").unwrap();
    let job = Job {
        name: "part".into(),
        surface: Surface::Mesh(part.clone()),
        notes: Vec::new(),
        machine: &machine,
        tool: ToolLibrary::builtin().find(WHEEL).unwrap(),
        dialect: &Dialect::named(&machine.dialect).unwrap(),
        options,
        keep_scene: false,
    };
    rough(job, block, &Silent)
}

fn column() -> TriMesh {
    shapes::prism(180, RADII[0], 100.0)
}

fn options() -> CamOptions {
    CamOptions {
        strategy: Some(Strategy::Helix),
        points_per_turn: Some(90),
        ..CamOptions::default()
    }
}

/// The words of all moves in order, with their kinds.
fn moves(plan: &Plan) -> Vec<(StepKind, [f64; 6])> {
    let machine = Machine::builtin("last-lathe").unwrap();
    let program = program_of(plan, &machine);
    let steps = program.steps(&machine);
    steps.filter_map(|step| Some((step.kind, step.values(&program)?))).collect()
}

#[test]
fn a_bar_comes_down_to_a_column_in_even_layers() {
    let bar = Block::Cylinder { radius: Some(RADII[1]) };
    let plan = roughed(&column(), &bar, DEPTH, &options()).unwrap();
    let report = plan.report.rough.clone().unwrap();
    // The lowest the wheel goes is onto the stubs of radius 12.5, with the allowance of 1.
    let fall = RADII[1] - 13.5;
    assert_eq!(report.n_layers, (fall / DEPTH).ceil() as usize);
    let step = fall / report.n_layers as f64;
    // Amid the column each turn runs at a level of its own until it meets the column.
    let amid = moves(&plan)
        .into_iter()
        .filter(|(kind, words)| *kind == StepKind::Feed && (40.0..110.0).contains(&words[0]));
    let mut levels: Vec<f64> = amid.map(|(_, words)| words[1] - WHEEL_TOP).collect();
    levels.sort_by(|a, b| b.total_cmp(a));
    levels.dedup_by(|a, b| (*a - *b).abs() < 0.02);
    let expected = [1, 2, 3, 4].map(|k| (RADII[1] - f64::from(k) * step).max(RADII[0] + 1.0));
    assert_eq!(levels.len(), expected.len(), "{levels:?}");
    for (level, expected) in levels.iter().zip(expected) {
        assert!((level - expected).abs() < 0.02, "{levels:?}, not {expected}");
    }
}

#[test]
fn rapids_stay_clear_of_the_bar_until_it_has_been_cut() {
    let bar = Block::Cylinder { radius: Some(RADII[1]) };
    let plan = roughed(&column(), &bar, DEPTH, &options()).unwrap();
    let moves = moves(&plan);
    // The deepest any feed has gone so far bounds how deep a rapid may be.
    let mut lowest = RADII[1] + WHEEL_TOP;
    for pair in moves.windows(2) {
        let [(_, from), (kind, to)] = [pair[0], pair[1]];
        if kind == StepKind::Feed {
            lowest = lowest.min(to[1]);
        } else if from[0] != to[0] || from[2] != to[2] {
            assert!(from[1] == to[1], "a rapid goes across and down at once: {from:?} to {to:?}");
            assert!(lowest + 1.0 < to[1], "a rapid at Y {} where {lowest} was cut", to[1]);
        }
    }
}

#[test]
fn the_part_is_never_wound_back() {
    let bar = Block::Cylinder { radius: Some(RADII[1]) };
    let plan = roughed(&column(), &bar, DEPTH, &options()).unwrap();
    let moves = moves(&plan);
    let backwards = moves.windows(2).map(|pair| pair[1].1[2] - pair[0].1[2]);
    // A = -c, and the part turns on: half a turn back at most, to the nearest start of a cut.
    assert!(backwards.fold(0.0, f64::max) <= std::f64::consts::PI + 1e-6);
}

#[test]
fn what_cannot_be_roughed_says_why() {
    let error = |block: &Block, depth, options: &CamOptions| {
        roughed(&column(), block, depth, options).unwrap_err().to_string()
    };
    let thin = Block::Cylinder { radius: Some(18.0) };
    let text = error(&thin, DEPTH, &options());
    assert!(
        text.starts_with("the part needs a block of radius 21.0 mm with the 1 mm left on"),
        "{text}"
    );
    let bar = Block::Cylinder { radius: Some(RADII[1]) };
    assert!(error(&bar, -1.0, &options()).starts_with("--max-depth is -1 mm"));
    let huge = Block::Cylinder { radius: Some(400.0) };
    let text = error(&huge, DEPTH, &options());
    assert!(text.contains("Y would have to go to"), "{text}");
}

#[test]
fn cut_in_simulation_no_cut_is_too_deep_and_hardly_one_is_in_air() {
    let last = small_last(150.0);
    let machine = Machine::builtin("last-lathe").unwrap();
    let blocks =
        [(Block::Cylinder { radius: Some(70.0) }, 0.10), (Block::Box { margin: 4.0 }, 0.25)];
    for (block, most_air) in blocks {
        let plan = roughed(&last, &block, DEPTH, &options()).unwrap();
        let rough = plan.report.rough.as_ref().unwrap();
        let links = rough.links;
        assert!(links.n_rapids > 2 * rough.n_cuts && links.clearance > 15.0, "{links:?}");
        let program = program_of(&plan, &machine);
        let setup = CamOptions { allowance: Some(1.0), ..options() };
        let verified = verify(
            VerifyJob {
                program_name: "rough.ngc".into(),
                program: &program,
                part_name: "last".into(),
                surface: Surface::Mesh(last.clone()),
                notes: Vec::new(),
                machine: &machine,
                tools: vec![ToolLibrary::builtin().find(WHEEL).unwrap()],
                setup: &setup,
                block: RawBlock::Body(block.clone()),
                options: &VerifyOptions { resolution: Some(1.0), ..VerifyOptions::default() },
            },
            &Silent,
        )
        .unwrap();
        let report = &verified.report;
        assert!(report.faults.is_empty(), "{:?}", report.faults);
        let cutting = &report.simulation;
        let depth = cutting.greatest_depth.map_or(0.0, |deepest| deepest.value);
        assert!(depth <= DEPTH + 0.05, "{depth} mm deep");
        assert!(cutting.air_share <= most_air, "{block}: {} of the feed time", cutting.air_share);
    }
}
