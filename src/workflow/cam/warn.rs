//! What the user should know before pressing start.

use super::report::{CamReport, RoughReport, Work};
use crate::cam::{Certificate, TABLE_GAP};

/// More than this left by lifts is worth a warning [mm].
const MUCH_LEFT: f64 = 0.5;

impl CamReport {
    /// Adds what is different on a tilted table.
    pub(super) fn warn_of_table(&mut self) {
        // It runs off the part's top, and down to its table.
        self.run.overrun = [self.run.overrun[1]; 2];
        self.warnings.push(format!(
            "turned on the tilted table: the lowest {TABLE_GAP} mm above it are spared, and what the \
             tool cannot reach at this tilt is not mapped"
        ));
    }

    /// Adds what the user should know before pressing start.
    pub(super) fn warn(&mut self) {
        let mut say = |text: String| self.warnings.push(text);
        if self.work == Work::Finish {
            say(format!(
                "the program assumes at most {:.1} mm of stock on the part: rough it first",
                self.stock
            ));
        }
        if self.part.mode == "points" {
            say("digitized on points alone, as in the thesis: between points the tool may cut into \
                 the part, and what is proved is proved of the points; give triangles to be exact"
                .into());
        }
        if self.certificate.is_none() && self.work != Work::Rough {
            say("not certified: between positions the tool may cut into the part; leave out \
                 --no-certify, and how deep is proved"
                .into());
        }
        if let Some(left) = self.certificate.as_ref().and_then(left_by_lifts) {
            say(left);
        }
        for end in &self.setup.loose {
            say(format!(
                "most of the {end} stub misses the part and holds it badly: try --centre ends or \
                 another --axis"
            ));
        }
        let [overrun, whole] = self.run.overrun;
        if overrun < 0.98 * whole {
            say(format!(
                "the tool runs only {overrun:.1} mm beyond the part's ends, where {whole:.1} mm would \
                 cut them whole: clamp longer or take a narrower tool"
            ));
        }
        if let Some(reach) = &self.reach {
            let share = |area: f64| 100.0 * area / reach.area;
            if share(reach.undercut) >= 0.05 {
                say(format!(
                    "{:.0} mm2 ({:.1} %) of the part are undercut: turned away from the tool in every \
                     pose",
                    reach.undercut,
                    share(reach.undercut)
                ));
            }
            if share(reach.hollow) >= 0.05 {
                say(format!(
                    "{:.0} mm2 ({:.1} %) lie in hollows the tool cannot enter: it keeps up to {:.2} mm off",
                    reach.hollow,
                    share(reach.hollow),
                    reach.deepest
                ));
            }
        }
        if let (Work::RoughAndFinish, Some(RoughReport { held, .. })) = (self.work, &self.rough) {
            for slowed in held.slowed.iter().filter(|slowed| slowed.is_worth_telling(held.taken)) {
                say(format!("roughing: {slowed}"));
            }
        }
        let held = &self.run.held;
        for slowed in held.slowed.iter().filter(|slowed| slowed.is_worth_telling(held.taken)) {
            say(slowed.to_string());
        }
        if let Some(rate) = self.program.block_rate.filter(|rate| rate.highest > rate.limit) {
            say(format!(
                "line {}: {:.0} blocks a second, the control reads {:.0}: it will stutter",
                rate.line, rate.highest, rate.limit
            ));
        }
    }
}

/// What lifts that follow each other leave standing, if it is much.
fn left_by_lifts(certificate: &Certificate) -> Option<String> {
    let Certificate { n_lifts, greatest_lift, left_by_lifts, .. } = certificate;
    if *left_by_lifts <= MUCH_LEFT {
        return None;
    }
    let at = greatest_lift.and_then(|lift| lift.at);
    let at = at.map_or_else(String::new, |[x, y, z]| {
        format!(", the highest lift at {x:.1}, {y:.1}, {z:.1} of the part set up")
    });
    Some(format!(
        "up to {left_by_lifts:.2} mm are left where the tool stays lifted over shoulders ({n_lifts} \
         lifts{at}): take a tool with a smaller nose, more positions a turn or a smaller --min-step"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cam::Lift;

    #[test]
    fn material_left_by_lifts_is_warned_of_where_it_is_much() {
        let lift = Lift { rise: 2.0, at: Some([10.0, 2.0, 3.25]) };
        let certificate = Certificate {
            n_lifts: 4,
            greatest_lift: Some(lift),
            left_by_lifts: 0.8,
            ..Certificate::default()
        };
        let told = left_by_lifts(&certificate).unwrap();
        let expected = "up to 0.80 mm are left where the tool stays lifted over shoulders (4 lifts, the \
                        highest lift at 10.0, 2.0, 3.2 of the part set up): ";
        assert!(told.starts_with(expected) && told.contains("--min-step"), "{told}");
        let little = Certificate { left_by_lifts: 0.4, ..certificate };
        assert_eq!(left_by_lifts(&little), None);
    }
}
