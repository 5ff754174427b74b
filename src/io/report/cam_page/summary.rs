//! A cam report in a dozen lines for the terminal.

use super::words::{
    clear, clock, count, fine, pitch, proved, range, reached_percent, strategy, tool,
};
use crate::cam::{Certificate, ReachReport, Strategy};
use crate::gcode::AxisBounds;
use crate::workflow::cam::{CamReport, ComputeReport, RoughReport, RunReport};
use std::fmt::Write as _;

/// What `horma cam` tells people: names left, values right, warnings last, where the eye is.
pub fn cam_summary(report: &CamReport) -> String {
    let [x, y, z] = report.part.size;
    let (part, setup, program) = (&report.part, &report.setup, &report.program);
    let mut lines = Lines::default();
    let extent = format!("{x:.1} x {y:.1} x {z:.1} mm");
    lines.add(
        "part",
        format!("{}, {} {}, {extent}", part.name, count(part.n_primitives), part.mode),
    );
    lines.add("machine", format!("{}: {}", report.machine[0], report.machine[1]));
    lines.add("tool", tool(&report.tool));
    let spindle = if setup.swing > 0.0 {
        format!(", greatest radius {:.1} mm", setup.swing)
    } else {
        String::new()
    };
    let mirrored = if setup.mirrored { ", mirrored" } else { "" };
    lines.add("setup", format!("X {} mm{spindle}{mirrored}", range(setup.part_x)));
    lines.add("run", run(&report.run));
    if let Some(computed) = computed(&report.run.compute) {
        lines.add("computed", computed);
    }
    if let Some(rough) = &report.rough {
        lines.add("rough", self::rough(rough));
        lines.add("rapids", clear(&rough.links));
    }
    if let Some(certificate) = &report.certificate {
        lines.add("proof", proof(certificate));
    }
    if let Some(reach) = &report.reach {
        lines.add("reach", self::reach(reach));
    }
    if report.rough.is_none() {
        lines.add("stock", format!("at most {:.1} mm", report.stock));
    }
    for AxisBounds { axis, unit, least, greatest } in &program.bounds {
        lines.add(&axis.to_string(), format!("{least:.3} to {greatest:.3} {unit}"));
    }
    lines.add("program", format!("{} blocks", count(program.n_blocks)));
    let (total, cutting) = (clock(program.planned.total()), clock(program.planned.cutting));
    lines.add("time", format!("{total}, {cutting} of it cutting (h:mm:ss)"));
    for operation in program.several_operations() {
        let (total, cutting) = (clock(operation.planned.total()), clock(operation.planned.cutting));
        let tool = operation.tool.map_or("tool".to_owned(), |number| format!("T{number}"));
        let line = operation.line;
        lines.add("", format!("{tool} from line {line}: {total}, {cutting} of it cutting"));
    }
    for note in &part.notes {
        lines.add("note", note);
    }
    for warning in &report.warnings {
        lines.add("warning", warning);
    }
    if let Some(first) = program.violations.first() {
        let n = program.violations.len();
        lines.add("violations", format!("{n}, the first in line {}: {}", first.line, first.kind));
    }
    lines.0
}

fn rough(rough: &RoughReport) -> String {
    format!(
        "with {} from {}: {} layers of at most {} mm, {} cuts, {} positions",
        rough.tool[0],
        rough.block,
        rough.n_layers,
        fine(rough.max_depth),
        count(rough.n_cuts),
        count(rough.n_positions)
    )
}

fn run(run: &RunReport) -> String {
    let spacing = match run.strategy {
        Strategy::Helix | Strategy::Rings => {
            format!("pitch {} mm, {} a turn", pitch(run.pitch), run.per_turn)
        }
        Strategy::Lines => format!("{} lines, step {} mm", run.per_turn, fine(run.step)),
        Strategy::Raster | Strategy::Contour => {
            format!("pitch {} mm, step {} mm", pitch(run.pitch), fine(run.step))
        }
    };
    let mut text =
        format!("{}, {} positions, {spacing}", strategy(run.strategy), count(run.n_positions));
    if run.allowance > 0.0 {
        let _ = write!(text, ", {} mm left on", fine(run.allowance));
    }
    if let Some(scallop) = run.scallop {
        let _ = write!(text, ", ridges up to {scallop:.3} mm");
    }
    if run.n_missed > 0 {
        let _ = write!(text, ", {} positions meet nothing", count(run.n_missed));
    }
    text
}

/// Said only where the processor was not the one and only choice.
fn computed(compute: &ComputeReport) -> Option<String> {
    match &compute.why {
        Some(why) => Some(format!("on {}: {why}", compute.on)),
        None => (compute.on != "cpu").then(|| format!("on {}", compute.on)),
    }
}

fn proof(certificate: &Certificate) -> String {
    let mut text = proved(certificate);
    let taken = [
        (certificate.n_inserted, "steps put in"),
        (certificate.n_lifts, "lifts over shoulders"),
        (certificate.n_dropped, "steps left out"),
    ];
    for (n, what) in taken.into_iter().filter(|(n, _)| 0 < *n) {
        let _ = write!(text, ", {} {what}", count(n));
    }
    text
}

fn reach(reach: &ReachReport) -> String {
    let mut text = format!("{} % of {:.0} mm2", reached_percent(reach), reach.area);
    let missed = [
        (reach.clamped, "under clamps"),
        (reach.hollow, "in hollows"),
        (reach.undercut, "undercut"),
    ];
    for (area, what) in missed.into_iter().filter(|(area, _)| *area >= 0.5) {
        let _ = write!(text, ", {area:.0} {what}");
    }
    text
}

/// Names left, values right.
#[derive(Default)]
struct Lines(String);

impl Lines {
    fn add(&mut self, name: &str, value: impl AsRef<str>) {
        // Writing to a String cannot fail.
        let _ = writeln!(self.0, "{name:<12}{}", value.as_ref());
    }
}
