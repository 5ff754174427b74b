//! What the page of a verification and its summary say alike.

use crate::measure::{BodiesReport, CheckedBody, Fixture, ResolutionReport, Spot};
use crate::workflow::verify::VerifyReport;

/// Less than this prints as nothing [mm].
const SHOWN: f64 = 0.0005;

/// A place and how far it is off, or that there is none.
pub(super) fn spot(spot: Option<&Spot>) -> String {
    match spot.filter(|spot| spot.value >= SHOWN) {
        None => "none".to_owned(),
        Some(Spot { value, at: [x, y, z], line }) => {
            let by = line.map_or_else(String::new, |line| format!(", by line {line}"));
            format!("{value:.3} mm at X {x:.1} Y {y:.1} Z {z:.1}{by}")
        }
    }
}

/// A share of the surface compared.
pub(super) fn percent(report: &VerifyReport, area: f64) -> f64 {
    100.0 * area / report.deviation.area.max(f64::MIN_POSITIVE)
}

/// How much is left where, and how much of that the tool cannot take.
pub(super) fn left(report: &VerifyReport) -> String {
    format!(
        "{:.2} % of the surface; {:.2} % where the tool cannot take it",
        percent(report, report.deviation.left_area),
        percent(report, report.deviation.left_area_by_tool)
    )
}

/// What of the tools does not cut: which parts kept clear, and of which tools nobody knows.
pub(super) fn bodies(bodies: &BodiesReport) -> String {
    let checked = bodies.checked.iter().map(|CheckedBody { tool, parts }| {
        let parts: Vec<_> = parts.iter().map(|part| part.word()).collect();
        format!("{} of {tool}", parts.join(", "))
    });
    let unknown = bodies
        .unknown
        .iter()
        .map(|tool| format!("nothing of {tool}: its library does not say what of it does not cut"));
    let stopped = bodies.stopped_at.map(|line| format!("after line {line} nobody looked any more"));
    checked.chain(unknown).chain(stopped).collect::<Vec<_>>().join("; ")
}

/// What stands around the part and was looked at.
pub(super) fn fixtures(fixtures: &[Fixture]) -> String {
    if fixtures.is_empty() {
        return "none: the machine file does not say how large they are".to_owned();
    }
    let words = fixtures.iter().map(|fixture| match fixture {
        Fixture::Dog => "dogs",
        Fixture::Table => "table",
    });
    words.collect::<Vec<_>>().join(", ")
}

/// How exact the simulation is, in one line.
pub(super) fn exactness(resolution: &ResolutionReport) -> String {
    let hollow = resolution.hollow.map_or("unknown".to_owned(), |error| format!("{error:.4}"));
    format!(
        "at a ray {:.4} mm; between rays hollows {hollow}, ridges {:.4} mm",
        resolution.sweep, resolution.ridge
    )
}
