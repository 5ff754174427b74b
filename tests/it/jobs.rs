//! Whole jobs in memory: a part, a machine's name, options, and the plan that comes of them.

use horma::gcode::{Dialect, Program, StepKind, read};
use horma::geom::shapes::{LastParameters, last};
use horma::geom::{Surface, TriMesh};
use horma::machine::{AxisKind, Machine};
use horma::progress::Silent;
use horma::tool::ToolLibrary;
use horma::workflow::cam::{CamError, CamOptions, Job, Plan, plan};

/// The wheel of the jobs here.
pub(crate) const WHEEL: &str = "wheel:60,10";

/// The plan of `part` on the embedded machine `machine`, which must come off.
#[track_caller]
pub(crate) fn cut(part: &TriMesh, machine: &str, options: &CamOptions) -> Plan {
    try_cut(Surface::Mesh(part.clone()), machine, options).unwrap()
}

/// The plan of `surface`, if it comes off.
pub(crate) fn try_cut(
    surface: Surface,
    machine: &str,
    options: &CamOptions,
) -> Result<Plan, CamError> {
    let machine = Machine::builtin(machine).unwrap();
    let name = options.tool.as_deref().unwrap_or(&machine.default_tool);
    let job = Job {
        name: "part".into(),
        surface,
        notes: Vec::new(),
        machine: &machine,
        tool: ToolLibrary::builtin().find(name).unwrap(),
        dialect: &Dialect::named(&machine.dialect).unwrap(),
        options,
        keep_scene: false,
    };
    plan(job, &Silent)
}

/// The program of a plan, read by our reader.
pub(crate) fn program_of(plan: &Plan, machine: &Machine) -> Program {
    let dialect = Dialect::named(&machine.dialect).unwrap();
    read(&mut plan.text.as_slice(), machine, &dialect).unwrap()
}

/// Where each feed move of the plan's program ends, words in millimetres and degrees; the first is
/// the plunge onto the first position.
pub(crate) fn feed_words(plan: &Plan, machine: &str) -> Vec<[f64; 6]> {
    let machine = Machine::builtin(machine).unwrap();
    let program = program_of(plan, &machine);
    let feeds = program.steps(&machine).filter(|step| step.kind == StepKind::Feed);
    let ends = feeds.filter_map(|step| step.values(&program)).map(|mut words| {
        for (word, axis) in words.iter_mut().zip(&machine.axes) {
            if axis.kind == AxisKind::Rotary {
                *word = word.to_degrees();
            }
        }
        words
    });
    ends.collect()
}

/// A last of `length` mm, of few triangles.
pub(crate) fn small_last(length: f64) -> TriMesh {
    last(&LastParameters { length, resolution: Some(6.0), ..Default::default() }).unwrap()
}
