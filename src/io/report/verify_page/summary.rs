//! A verification in a dozen lines for the terminal.

use crate::measure::Spot;
use crate::workflow::verify::VerifyReport;
use std::fmt::Write as _;

/// What `horma verify` tells people: names left, values right, faults last, where the eye is.
pub fn verify_summary(report: &VerifyReport) -> String {
    let (simulation, deviation) = (&report.simulation, &report.deviation);
    let resolution = &simulation.resolution;
    let spot = |spot: &Option<Spot>| match spot {
        None => "none".to_owned(),
        Some(Spot { value, at: [x, y, z] }) => {
            format!("{value:.3} mm at X {x:.1} Y {y:.1} Z {z:.1}")
        }
    };
    let percent = |area: f64| 100.0 * area / deviation.area.max(f64::MIN_POSITIVE);
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
    if let Some(depth) = &simulation.greatest_depth {
        line("depth", format!("up to {:.2} mm (line {})", depth.value, depth.line));
    }
    line("gouge", spot(&deviation.gouge));
    line("left", spot(&deviation.left));
    line("", format!("too large a tool: {}", spot(&deviation.left_by_tool)));
    line("", format!("passed by: {}", spot(&deviation.left_by_path)));
    line(
        "left > 0.05",
        format!(
            "{:.2} % of the surface; {:.2} % where the tool cannot take it",
            percent(deviation.left_area),
            percent(deviation.left_area_by_tool)
        ),
    );
    line("rms", format!("{:.4} mm", deviation.rms));
    let hollow = resolution.hollow.map_or("unknown".to_owned(), |error| format!("{error:.4}"));
    line(
        "exactness",
        format!(
            "at a ray {:.4} mm; between rays hollows {hollow}, ridges {:.4} mm",
            resolution.sweep, resolution.ridge
        ),
    );
    for note in &report.notes {
        line("note", note.clone());
    }
    for fault in &report.faults {
        line("fault", fault.clone());
    }
    text
}
