//! A verification in a dozen lines for the terminal.

use super::words::{bodies, exactness, fixtures, left, spot};
use crate::workflow::verify::VerifyReport;
use std::fmt::Write as _;

/// What `horma verify` tells people: names left, values right, faults last, where the eye is.
pub fn verify_summary(report: &VerifyReport) -> String {
    let (simulation, deviation) = (&report.simulation, &report.deviation);
    let mut text = String::new();
    // Writing to a String cannot fail.
    let mut line = |name: &str, value: String| {
        let _ = writeln!(text, "{name:<12}{value}");
    };
    line("program", format!("{}, {} moves", report.program, simulation.n_moves));
    line("block", report.block.clone());
    for tool in &report.tools {
        line("tool", tool.join(", "));
    }
    line(
        "removed",
        format!(
            "{:.2} cm3, {:.1} % of the feed time in air",
            simulation.removed / 1e3,
            100.0 * simulation.air_share
        ),
    );
    line("deepest cut", spot(simulation.thickest_cut.as_ref()));
    if let Some(depth) = &simulation.greatest_depth {
        line("", format!("along a ray up to {:.2} mm (line {})", depth.value, depth.line));
    }
    line("bodies", bodies(&simulation.bodies));
    line("fixtures", fixtures(&simulation.fixtures));
    line("gouge", spot(deviation.gouge.as_ref()));
    line("left", spot(deviation.left.as_ref()));
    line("", format!("too large a tool: {}", spot(deviation.left_by_tool.as_ref())));
    line("", format!("passed by: {}", spot(deviation.left_by_path.as_ref())));
    line("left > 0.05", left(report));
    line("rms", format!("{:.4} mm", deviation.rms));
    line("exactness", exactness(&simulation.resolution));
    for note in &report.notes {
        line("note", note.clone());
    }
    for fault in &report.faults {
        line("fault", fault.clone());
    }
    text
}
