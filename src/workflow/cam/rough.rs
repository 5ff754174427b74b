//! The roughing program: from a block down to what finishing leaves for itself.

use super::cutting::Cutting;
use super::ground::Ground;
use super::job::{CamError, Job, Plan};
use super::links::prove_links;
use super::operation::{Made, Operation, program};
use super::report::{RoughReport, RunReport};
use crate::cam::{Block, Contact, Digitizer, Part, Pass, RoughOptions, Roughing, Setup, within};
use crate::geom::{Aabb, Point3, Surface, TriMesh, Vector3};
use crate::machine::Clamping;
use crate::progress::Progress;

/// A table whose cosine to the attack axis is off 1 by no more lies level.
const LEVEL: f64 = 1e-9;
/// Half the side of what stands for a table: no machine has a larger one [mm].
const WIDE: f64 = 2000.0;

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
    let (contacts, computed) = ground.contacts(way.n_positions(), pose, progress)?;
    let block = block.sized(&ground.setup, machine, allowance)?;
    let raw = with_clamps(block.around(&ground.setup, machine, allowance)?, &ground.setup);
    let on_block = Digitizer { part: &Part::triangles(&raw), cutter: bare, ..ground.digitizer() };
    let [mut on_part, on_block] =
        [&contacts, &on_block.run(way.n_positions(), pose, progress)?].map(|found| heights(found));
    let table = tilted_table(&ground);
    if let Some(table) = &table {
        let on_table = Digitizer { part: &Part::triangles(table), ..ground.digitizer() };
        let on_table = on_table.run(way.n_positions(), pose, progress)?;
        for (spared, table) in on_part.iter_mut().zip(heights(&on_table)) {
            *spared = [*spared, table].into_iter().flatten().reduce(f64::max);
        }
    }

    let max_depth = options.max_depth.unwrap_or_else(|| ground.depth_of_cut());
    // A table that is among what the tool spares is no floor.
    let is_spared = table.is_some() || ground.run.line.is_some();
    let has_floor = machine.clamping == Clamping::Table && !is_spared;
    let rough_options = RoughOptions {
        max_depth,
        clearance: machine.clearance,
        floor: if has_floor { 0.0 } else { f64::NEG_INFINITY },
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
    run.compute = computed;
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

/// The top of the table under a part that stands tilted but is not turned there. Beside the part the
/// tool would go down to the lowest layer, and the table rises above that; of one that lies level it is
/// enough to know the height, and one that turns the part is among what the tool spares.
fn tilted_table(ground: &Ground) -> Option<TriMesh> {
    let (machine, rest) = (ground.machine(), &ground.run.stand.rest);
    let up = machine.attack_from_part(rest).rotation * Vector3::z();
    let is_level = up.y > 1.0 - LEVEL;
    if machine.clamping != Clamping::Table || ground.run.line.is_some() || is_level {
        return None;
    }
    let Aabb { min, .. } = ground.setup.part;
    let middle = ground.setup.part.center();
    let corner = |x: f64, y: f64| Point3::new(middle.x + x * WIDE, middle.y + y * WIDE, min.z);
    let corners = vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
    Some(TriMesh::new(corners, vec![[0, 1, 2], [0, 2, 3]]))
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
