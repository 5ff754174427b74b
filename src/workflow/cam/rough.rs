//! The roughing program: from a block down to what finishing leaves for itself.

use super::cutting::Cutting;
use super::ground::Ground;
use super::job::{CamError, Job, Plan};
use super::links::prove_links;
use super::operation::{Made, Operation, program};
use super::report::{RoughReport, RunReport};
use crate::cam::{Block, Contact, Digitizer, Part, Pass, RoughOptions, Roughing, Setup, within};
use crate::geom::{Surface, TriMesh};
use crate::machine::Clamping;
use crate::progress::Progress;

/// Makes the program that brings `block` down to the part of `job` and its allowance, in layers.
pub fn rough(job: Job, block: &Block, progress: &dyn Progress) -> Result<Plan, CamError> {
    let Job { machine, dialect, .. } = job;
    let options = &job.options.for_rough()?;
    let operation = roughing(Job { options, ..job }, block, progress)?;
    program(vec![operation], machine, dialect, options)
}

/// From `block` down to the part and its allowance, where stock is.
pub(super) fn roughing(
    job: Job,
    block: &Block,
    progress: &dyn Progress,
) -> Result<Operation, CamError> {
    let ground = Ground::new(job)?;
    let (machine, options) = (ground.machine(), ground.options);
    let allowance = options.allowance.unwrap_or(0.0);
    let bare = ground.tool.profile.cutter(0.0);
    let way = ground.way(progress)?;
    let pose = |i: usize| machine.attack_from_part(&way.values(i));
    let contacts = ground.contacts(way.n_positions(), pose, progress)?;
    let block = block.sized(&ground.setup, machine, allowance)?;
    let raw = with_clamps(block.around(&ground.setup, machine, allowance)?, &ground.setup);
    let on_block = Digitizer { part: &Part::triangles(&raw), cutter: bare, ..ground.digitizer() };
    let [on_part, on_block] =
        [&contacts, &on_block.run(way.n_positions(), pose, progress)?].map(|found| heights(found));

    let max_depth = options.max_depth.unwrap_or_else(|| ground.depth_of_cut());
    let is_on_table = machine.clamping == Clamping::Table && ground.run.line.is_none();
    let rough_options = RoughOptions {
        max_depth,
        clearance: machine.clearance,
        // A table that turns the part is a part of what the tool spares.
        floor: if is_on_table { 0.0 } else { f64::NEG_INFINITY },
    };
    let layers = Roughing::new(&on_part, &on_block, way.per_row() as usize, &rough_options)?;
    let clear = clear_of(&ground, &on_block)?;
    let cutting = Cutting {
        way: &way,
        roughing: &layers,
        contacts: &contacts,
        pace: ground.pace(clear),
        top: bare.reach().top,
        turning: endless_axis(&ground),
    };
    let Pass { path, feed } = cutting.toolpath(progress)?;
    let links = prove_links(&ground, &raw, &path, progress)?;
    let held_heights = ground.heights(&contacts, clear)?;
    let mut run = RunReport::new(&ground, &way, &held_heights);
    run.held = feed.clone();
    let shown = ground.keep_scene.then(|| (cutting.path(), held_heights.thinned()));
    let rough = RoughReport {
        block: block.to_string(),
        shape: block.shorthand(),
        tool: [ground.tool.name.clone(), ground.tool.profile.to_string()],
        max_depth,
        allowance,
        n_layers: layers.levels.len(),
        n_cuts: layers.cuts.len(),
        n_positions: layers.cuts.iter().map(|cut| cut.positions.len()).sum(),
        held: feed,
        links,
    };
    Ok(ground.operation(Made {
        path,
        run,
        rough: Some(rough),
        certificate: None,
        reach: None,
        stock: max_depth,
        shown,
    }))
}

fn heights(contacts: &[Option<Contact>]) -> Vec<Option<f64>> {
    contacts.iter().map(|contact| contact.map(|contact| contact.height)).collect()
}

/// The raw block, and what holds it: no link may go through a clamp that stands out of it.
fn with_clamps(mut block: TriMesh, setup: &Setup) -> TriMesh {
    if let Surface::Mesh(part) = &setup.surface {
        let clamps = part.triangles[setup.n_own..].to_vec();
        block.append(TriMesh::new(part.points.clone(), clamps));
    }
    block
}

/// The attack word at which the tool is clear of the part and of its block.
fn clear_of(ground: &Ground, on_block: &[Option<f64>]) -> Result<f64, CamError> {
    let machine = ground.machine();
    let attack = &machine.axes[machine.attack];
    let over_block = on_block.iter().flatten().copied().fold(f64::NEG_INFINITY, f64::max);
    let clear = attack.motion(ground.clear).max(over_block + machine.clearance);
    let clear = attack.word(clear);
    within(machine, attack, clear, "take a smaller block or a larger machine")?;
    Ok(clear)
}

/// The axis that turns the part, if it does so without end.
fn endless_axis(ground: &Ground) -> Option<usize> {
    let machine = ground.machine();
    let turning = machine.spindle.or(ground.run.line.map(|line| line.axis));
    turning.filter(|&axis| machine.axes[axis].limits.is_none())
}
