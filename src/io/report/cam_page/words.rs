//! Numbers of a cam report as people read them, on the page and on the terminal alike.

use crate::cam::{Certificate, ReachReport, Strategy};
use crate::gcode::{AxisBounds, CheckReport};
use crate::workflow::cam::LinkReport;
use std::fmt::Write as _;

/// Hours, minutes and seconds, the seconds rounded up: `0:09:30`.
pub(super) fn clock(seconds: f64) -> String {
    let seconds = seconds.max(0.0).ceil() as u64;
    format!("{}:{:02}:{:02}", seconds / 3600, seconds / 60 % 60, seconds % 60)
}

/// A whole number with its thousands apart: `51,481`.
pub(super) fn count(number: usize) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// What is proved of the path: `gouge <= 0.0100 mm on all 50,399 moves (proved)`.
pub(super) fn proved(certificate: &Certificate) -> String {
    format!(
        "gouge <= {:.4} mm on all {} moves (proved)",
        certificate.gouge,
        count(certificate.n_moves)
    )
}

/// What is proved of rapids: `all 1,094 clear of the stock ... by 18 mm`.
pub(super) fn clear(links: &LinkReport) -> String {
    format!(
        "all {} clear of the stock as it then is by {} mm or more (looked at every {} mm)",
        count(links.n_rapids),
        fine(links.clearance),
        fine(links.resolution)
    )
}

/// What that took, as names and values.
pub(super) fn proof(certificate: &Certificate) -> Vec<(&'static str, String)> {
    let mut facts = Vec::new();
    let mut steps = count(certificate.n_inserted);
    if let Some(step) = &certificate.shortest_step {
        let _ = write!(steps, ", the shortest {:.4} mm and {:.4}°", step.mm, step.deg);
    }
    facts.push(("Steps put in", steps));
    if let Some(lift) = &certificate.greatest_lift {
        let mut text = format!("{}, the highest {:.3} mm", count(certificate.n_lifts), lift.rise);
        if let Some([x, y, z]) = lift.at {
            let _ = write!(text, " at {x:.1}, {y:.1}, {z:.1}");
        }
        let _ = write!(text, "; they leave up to {:.3} mm", certificate.left_by_lifts);
        facts.push(("Lifts over shoulders", text));
    }
    if 0 < certificate.n_dropped {
        let left = format!(
            "{}; what they would have cut stands up to {:.4} mm high",
            count(certificate.n_dropped),
            certificate.left_by_dropping
        );
        facts.push(("Steps left out", left));
    }
    facts
}

/// As the command line spells it.
pub(super) fn strategy(strategy: Strategy) -> &'static str {
    match strategy {
        Strategy::Helix => "helix",
        Strategy::Rings => "rings",
        Strategy::Lines => "lines",
        Strategy::Raster => "raster",
        Strategy::Contour => "contour",
    }
}

/// A tool by its name and its shape; one named by its shape alone is said once.
pub(super) fn tool([name, shape]: &[String; 2]) -> String {
    if name == shape { name.clone() } else { format!("{name}, {shape}") }
}

/// What the tool touches [mm2].
pub(super) fn reached(reach: &ReachReport) -> f64 {
    (reach.area - reach.undercut - reach.hollow - reach.clamped).max(0.0)
}

/// The same in percent, rounded down: only what is reached whole reads 100.0.
pub(super) fn reached_percent(reach: &ReachReport) -> String {
    let share = if reach.area > 0.0 { reached(reach) / reach.area } else { 0.0 };
    // Sums of areas are not exact to the last bit.
    format!("{:.1}", ((share + 1e-9) * 1000.0).floor() / 10.0)
}

/// How far the attack axis goes: Z where the program has one, as on mills, else Y, as on lathes.
pub(super) fn attack_travel(program: &CheckReport) -> Option<&AxisBounds> {
    let of = |letter| program.bounds.iter().find(move |bounds| bounds.axis == letter);
    of('Z').or_else(|| of('Y'))
}

/// `from` to `to`, to a tenth of a millimetre; one number if they are the same.
pub(super) fn range([from, to]: [f64; 2]) -> String {
    let [from, to] = [from, to].map(|end| format!("{end:.1}"));
    if from == to { from } else { format!("{from} to {to}") }
}

/// A pitch or step: three decimals, but no zeros at their end.
pub(super) fn fine(value: f64) -> String {
    ((value * 1e3).round() / 1e3).to_string()
}

/// The least and the greatest pitch, or the one pitch there is.
pub(super) fn pitch([least, greatest]: [f64; 2]) -> String {
    let [least, greatest] = [least, greatest].map(fine);
    if least == greatest { least } else { format!("{least} to {greatest}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clock_rounds_up_and_carries() {
        assert_eq!(clock(0.0), "0:00:00");
        assert_eq!(clock(59.2), "0:01:00");
        assert_eq!(clock(36_000.0 + 61.0), "10:01:01");
        assert_eq!(clock(f64::NAN), "0:00:00");
    }

    #[test]
    fn thousands_stand_apart() {
        for (number, text) in [(0, "0"), (999, "999"), (1000, "1,000"), (1_234_567, "1,234,567")] {
            assert_eq!(count(number), text);
        }
    }

    #[test]
    fn only_what_is_reached_whole_reads_100_percent() {
        let reach = |undercut| ReachReport {
            area: 60_000.0,
            undercut,
            hollow: 0.0,
            clamped: 0.0,
            deepest: 0.0,
            places: vec![],
        };
        assert_eq!(reached_percent(&reach(0.0)), "100.0");
        assert_eq!(reached_percent(&reach(1.0)), "99.9");
        assert_eq!(reached_percent(&reach(60_000.0)), "0.0");
        assert_eq!(reached_percent(&ReachReport { area: 0.0, ..reach(0.0) }), "0.0");
    }

    #[test]
    fn ranges_of_one_value_are_one_number() {
        assert_eq!(range([1.0, 1.04]), "1.0");
        assert_eq!(range([-1.0, 2.25]), "-1.0 to 2.2");
        assert_eq!(pitch([2.0, 2.0]), "2");
        assert_eq!(pitch([0.123_456, 2.0]), "0.123 to 2");
    }
}
