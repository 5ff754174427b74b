//! The finishing program, step by step.

use super::certified::{self, Proof};
use super::ground::Ground;
use super::job::{CamError, Job, Plan};
use super::operation::{Made, Operation, program};
use super::report::RunReport;
use crate::cam::{Pass, pass};
use crate::progress::Progress;

/// Makes the program that finishes the part of `job`, and all there is to tell about it.
pub fn plan(job: Job, progress: &dyn Progress) -> Result<Plan, CamError> {
    let Job { machine, dialect, options, .. } = job;
    options.check_finishing()?;
    program(vec![finishing(job, progress)?], machine, dialect, options)
}

/// Down to the part, along the whole of its surface.
pub(super) fn finishing(job: Job, progress: &dyn Progress) -> Result<Operation, CamError> {
    let dialect = job.dialect;
    let ground = Ground::new(job)?;
    let (machine, options) = (ground.machine(), ground.options);
    let way = ground.way(progress)?;
    let proof = Proof::asked(options, machine, dialect)?;
    let words = |i: usize| certified::words(proof.as_ref(), machine, &way, i);
    let pose = |i: usize| machine.attack_from_part(&words(i));
    let (contacts, computed) = ground.contacts(way.n_positions(), pose, progress)?;
    let heights = ground.heights(&contacts, ground.clear)?;
    let (positions, certificate) =
        certified::positions(proof.as_ref(), &ground.digitizer(), &heights, words, progress)?;
    let mut run = RunReport::new(&ground, &way, &heights);
    run.compute = computed;
    let shown = ground.keep_scene.then(|| (heights.touched(), heights.thinned()));
    // A million positions are 70 MB: gone before the program is made.
    drop(contacts);
    let Pass { path, feed } = pass(machine, positions, ground.pace(ground.clear), progress)?;
    run.held = feed;
    let reach = ground.reach(progress)?;
    let stock = options.stock.unwrap_or_else(|| ground.depth_of_cut());
    Ok(ground.operation(Made { path, run, rough: None, certificate, reach, stock, shown }))
}
