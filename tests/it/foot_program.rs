//! The program of a real foot: every position where LinuxCNC's interpreter and our own reader go,
//! in the time the plan says.

use crate::jobs::{WHEEL, program_of, small_last, try_cut};
use crate::parts::real;
use crate::{linuxcnc, programs, rs274};
use horma::cam::{
    Digitizer, Method, Part, PassOptions, Position, SetupOptions, Spacing, Strategy, Toolpath,
    Trajectory, clear_word, pass, set_up,
};
use horma::geom::{LengthUnit, Surface};
use horma::io::read_surface;
use horma::machine::Machine;
use horma::progress::Silent;
use horma::tool::{Cutter, HeightFunction, ToolLibrary};
use horma::workflow::cam::{CamOptions, Plan};

const LATHE: &str = "last-lathe";
const PITCH: f64 = 2.0;

#[test]
fn the_program_of_a_foot_goes_and_takes_as_long_as_its_path() {
    let Some(path) = real("lasts/find_foot/foot_mean_left.obj") else { return };
    let foot = read_surface(&path, Some(LengthUnit::Millimetre)).unwrap().surface;
    goes_as_planned(foot, 360);
}

#[test]
fn the_program_of_a_last_goes_and_takes_as_long_as_its_path() {
    goes_as_planned(Surface::Mesh(small_last(240.0)), 120);
}

/// Holds the program of a helix around `surface` against the same path put together here, step by
/// step.
fn goes_as_planned(surface: Surface, per_turn: u32) {
    let options = CamOptions {
        tool: Some(WHEEL.into()),
        strategy: Some(Strategy::Helix),
        pitch: Some(PITCH),
        points_per_turn: Some(per_turn),
        // The path put together here is as digitized.
        no_certify: true,
        ..Default::default()
    };
    let machine = Machine::builtin(LATHE).unwrap();
    let plan = try_cut(surface.clone(), LATHE, &options).unwrap();
    let path = path_around(surface, &machine, per_turn, plan.report.run.along);
    assert_eq!(path.moves.len(), plan.report.run.n_positions + 2);
    assert_eq!(plan.report.program.violations, []);
    programs::goes_along(&machine, &path, &program_of(&plan, &machine));
    is_judged_alike(&plan, &machine, &path);
}

fn is_judged_alike(plan: &Plan, machine: &Machine, path: &Toolpath) {
    if !rs274::is_here() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("foot.ngc");
    std::fs::write(&file, &plan.text).unwrap();
    let moves = rs274::interpret(&file);
    linuxcnc::goes_along(machine, path, &moves);
    let judged: f64 = moves.iter().map(|step| step.seconds).sum();
    let programmed = plan.report.program.feed_seconds;
    assert!((judged - programmed).abs() < 1e-3 * programmed, "{judged} s for {programmed} s");
}

/// The path of a helix over X `along`, from the rooms of `cam` alone.
fn path_around(surface: Surface, machine: &Machine, per_turn: u32, along: [f64; 2]) -> Toolpath {
    let tool = ToolLibrary::builtin().find(WHEEL).unwrap();
    let cutter = tool.profile.cutter(0.0);
    let Cutter::Wheel(wheel) = cutter else { panic!("{WHEEL} is no wheel") };
    let setup = set_up(surface, machine, &SetupOptions::default()).unwrap();
    let rest = machine.at_rest();
    let clear = clear_word(&setup, machine, &rest, None, wheel.reach()).unwrap();
    let Surface::Mesh(mesh) = &setup.surface else { panic!("the part has no triangles") };
    let part = Part::triangles(mesh);
    let digitizer = Digitizer { part: &part, cutter, method: Method::Indexed };
    let stations = Spacing::even(along[0], along[1], PITCH).unwrap();
    let spacing = Spacing { per_turn, step: 1.0, stations };
    let way = Trajectory::new(machine, Strategy::Helix, along, spacing, &rest).unwrap();
    let pose = |i: usize| machine.attack_from_part(&way.values(i));
    let contacts = digitizer.run(way.n_positions(), pose, &Silent).unwrap();
    let position = |i: usize| {
        let contact = contacts[i].expect("the clamps leave no position without a contact");
        let mut words = way.values(i);
        words[machine.attack] = machine.axes[machine.attack].word(contact.height);
        Position { words, touched: Some(contact.point) }
    };
    let options = PassOptions { clear, cut: tool.feed, plunge: tool.plunge_feed, rotation: None };
    pass(machine, (0..way.n_positions()).map(position), options, &Silent).unwrap().path
}
