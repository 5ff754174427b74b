//! The most a tool could take off: what would be left if its path went everywhere.

use super::deviation::Target;
use crate::cam::{Digitizer, Method};
use crate::progress::Progress;
use crate::stock::{Stance, Stock, StockError};
use crate::tool::Cutter;
use std::f64::consts::TAU;

/// Between two places of the tool this share of the resolution may stay.
const LEFT_SHARE: f64 = 0.04;
/// A tool with a sharp edge leaves no known ridge: its places are this many rays apart.
const SHARP_RAYS: f64 = 2.0;
/// More places than this are not tried; they lie farther apart instead.
const MOST_PLACES: f64 = 2e6;

/// What `stock` would still lose if `cutter` came down everywhere, in steps so small that nothing
/// of note stays in between: what is then left over the part the tool cannot take.
pub fn limit(
    stock: &Stock,
    target: &Target,
    cutter: &Cutter,
    progress: &dyn Progress,
) -> Result<Stock, StockError> {
    let digitizer = Digitizer { part: target.part, cutter: *cutter, method: Method::Indexed };
    let layout = stock.layout();
    let reach = cutter.reach();
    let [x, across] = layout.extent();
    // A tool that leans stands over the axis before or behind where it touches.
    let lead = layout.lead();
    let x = [x[0] - reach.x - lead.max(0.0), x[1] + reach.x - lead.min(0.0)];
    let [mut step, mut turn] = steps(stock, cutter);
    let many = (x[1] - x[0]) / step * ((across[1] - across[0]) / turn) / MOST_PLACES;
    if many > 1.0 {
        (step, turn) = (step * many.sqrt(), turn * many.sqrt());
    }
    let n_x = ((x[1] - x[0]) / step).ceil().max(1.0) as usize + 1;
    let n_across = ((across[1] - across[0]) / turn).ceil().max(1.0) as usize;
    let place = |i: usize| {
        let share = |i: usize, n: usize| i as f64 / n as f64;
        [
            x[0] + (x[1] - x[0]) * share(i / n_across, n_x - 1),
            across[0] + (across[1] - across[0]) * share(i % n_across, n_across),
        ]
    };
    let pose = |i: usize| {
        let [x, across] = place(i);
        layout.attack_from_part(x, across)
    };
    let contacts = digitizer.run(n_x * n_across, pose, progress)?;
    let stances: Vec<Stance> = contacts
        .iter()
        .enumerate()
        .filter_map(|(i, contact)| {
            let [x, across] = place(i);
            contact.map(|contact| layout.stance(x, across, contact.height))
        })
        .collect();
    let mut limit = stock.clone();
    progress.start("looking what the tool could reach", stances.len() as u64);
    limit.remove_at(cutter, &stances, progress)?;
    Ok(limit)
}

/// From place to place along X [mm], and around or across [rad or mm].
fn steps(stock: &Stock, cutter: &Cutter) -> [f64; 2] {
    let layout = stock.layout();
    let real = layout.resolution();
    let left = LEFT_SHARE * real.along.min(real.across);
    let scallop = |radius: f64| (8.0 * radius * left).sqrt();
    let [along, mut across] = match cutter {
        Cutter::Wheel(wheel) => {
            let rim = wheel.major + wheel.minor;
            // Around a part of radius p a wheel of radius A leaves p (p + A) / A da^2 / 8.
            let bend = (layout.reach() + rim) / (rim * layout.reach());
            [scallop(wheel.minor), scallop(1.0 / bend)]
        }
        Cutter::Mill(mill) => match mill.ball_radius() {
            Some(radius) if radius > 0.0 => [scallop(radius); 2],
            _ => [SHARP_RAYS * real.along, SHARP_RAYS * real.across],
        },
    };
    if layout.is_turned() {
        across = (across / layout.reach()).min(TAU / 8.0);
    }
    [along, across]
}
