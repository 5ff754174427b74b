//! Which line of a program cut a place: the one ray it lies on is cut once more.

use super::simulate::{SimulateError, for_each_batch};
use crate::gcode::Program;
use crate::geom::Point3;
use crate::machine::Machine;
use crate::progress::Silent;
use crate::stock::Stock;
use crate::tool::Tool;

/// A ray this close to where it ended has been cut to its end [mm].
const SAME: f64 = 1e-6;

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
        // Halved as long as it takes: the first half is cut, and if that was not it, the second.
        let mut range = 0..batch.sweeps.len();
        let mut step = range.len();
        while !range.is_empty() {
            let mut trial = row.clone();
            let sweeps = &batch.sweeps[range.start..range.start + step];
            trial
                .remove(machine, &cutter, sweeps, &Silent)
                .map_err(|problem| SimulateError::between(batch.lines(), problem))?;
            if !is_cut(&trial) {
                range.start += step;
                row = trial;
            } else if step == 1 {
                found = batch.line(range.start);
                break;
            } else {
                range.end = range.start + step;
            }
            step = range.len().div_ceil(2).min(range.len());
        }
        Ok(())
    })?;
    Ok(found)
}
