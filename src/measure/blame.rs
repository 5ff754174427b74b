//! Which line of a program cut a place: the one ray it lies on is cut once more.

use super::simulate::{SimulateError, for_each_batch};
use crate::gcode::Program;
use crate::geom::Point3;
use crate::machine::Machine;
use crate::progress::Silent;
use crate::stock::{Stock, StockError, Sweep};
use crate::tool::{Cutter, Tool};

/// A ray this close to where it ended has been cut to its end [mm].
pub(super) const SAME: f64 = 1e-6;

/// The line of the move that cut `place` of `after`, the surface `program` left of `before`; `None` if
/// none did: it was so before.
pub fn blame(
    program: &Program,
    machine: &Machine,
    tools: &[Tool],
    [before, after]: [&Stock; 2],
    place: &Point3,
) -> Result<Option<u32>, SimulateError> {
    let Some([row, column]) = after.layout().ray_near(place) else { return Ok(None) };
    let end = after.end(row, column).map_or(f64::NEG_INFINITY, |end| end + SAME);
    let is_cut = |stock: &Stock| stock.end(0, column).is_none_or(|here| here <= end);
    let mut row = before.excerpt(row..row + 1);
    if is_cut(&row) {
        return Ok(None);
    }
    let mut found = None;
    for_each_batch(program, machine, tools, |batch| {
        if found.is_some() {
            return Ok(());
        }
        let cutter = batch.tool.profile.cutter(0.0);
        let i_sweep = first_to_cut(&mut row, machine, &cutter, &batch.sweeps, is_cut)
            .map_err(|problem| SimulateError::between(batch.lines(), problem))?;
        found = i_sweep.and_then(|i| batch.line(i));
        Ok(())
    })?;
    Ok(found)
}

/// The first of `sweeps` after which `stock` `is_cut`. Without one, all of them have cut it then.
pub(super) fn first_to_cut(
    stock: &mut Stock,
    machine: &Machine,
    cutter: &Cutter,
    sweeps: &[Sweep],
    is_cut: impl Fn(&Stock) -> bool,
) -> Result<Option<usize>, StockError> {
    // Halved as long as it takes: the first half is cut, and if that was not it, the second.
    let mut range = 0..sweeps.len();
    let mut step = range.len();
    while !range.is_empty() {
        let mut trial = stock.clone();
        trial.remove(machine, cutter, &sweeps[range.start..range.start + step], &Silent)?;
        if !is_cut(&trial) {
            range.start += step;
            *stock = trial;
        } else if step == 1 {
            return Ok(Some(range.start));
        } else {
            range.end = range.start + step;
        }
        step = range.len().div_ceil(2).min(range.len());
    }
    Ok(None)
}
