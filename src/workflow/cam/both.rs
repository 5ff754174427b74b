//! Roughing and finishing, one after the other.

use super::job::{CamError, Job, Plan};
use super::operation::program;
use super::plan::finishing;
use super::rough::roughing;
use crate::cam::Block;
use crate::machine::{Machine, ToolChanges};
use crate::progress::Progress;
use crate::tool::Tool;

/// Makes the program that brings `block` down to the part of `job` with `tool` and finishes it with
/// the job's own: one program with both operations where the machine changes tools within a program
/// or needs not change any, else one after the other.
pub fn rough_and_finish(
    job: Job,
    tool: Tool,
    block: &Block,
    progress: &dyn Progress,
) -> Result<Vec<Plan>, CamError> {
    let Job { machine, dialect, options, .. } = job;
    let in_one = is_one_program(machine, &tool, &job.tool);
    if in_one && tool.number == job.tool.number && !is_same(&tool, &job.tool) {
        let tools = [tool.name, job.tool.name];
        return Err(CamError::SameNumber { tools, number: tool.number });
    }
    let for_roughing = options.for_roughing();
    let before = Job { tool, options: &for_roughing, ..job.clone() };
    let roughing = roughing(before, block, progress)?;
    let finishing = finishing(job, progress)?;
    if in_one {
        return Ok(vec![program(vec![roughing, finishing], machine, dialect, options)?]);
    }
    let rough = program(vec![roughing], machine, dialect, &for_roughing)?;
    Ok(vec![rough, program(vec![finishing], machine, dialect, &options.for_finishing())?])
}

/// True if roughing with one tool and finishing with another goes into one program on `machine`.
pub fn is_one_program(machine: &Machine, roughing: &Tool, finishing: &Tool) -> bool {
    machine.tool_changes == ToolChanges::WithinPrograms || is_same(roughing, finishing)
}

fn is_same(one: &Tool, other: &Tool) -> bool {
    one.number == other.number && one.profile == other.profile
}
