//! How long each move takes: as fast as the feed at the contact and the axes allow.
//!
//! `t = max(way of the contact / feed, |dX| / vX, |dY| / vY, |dA| / vA, ...)`, no shorter than the
//! control can read a block. Accelerations are not looked at yet.

use super::toolpath::{Move, Pace, Toolpath};
use crate::geom::Point3;
use crate::machine::{AxisValues, Machine};
use crate::progress::{Cancelled, Progress};

/// How fast a pass goes, and where it is out of the way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PassOptions {
    /// The attack word at which nothing can be touched [mm].
    pub clear: f64,
    /// Of the contact over the part [mm/s].
    pub cut: f64,
    /// Of the plunge into the material [mm/s].
    pub plunge: f64,
}

/// One pass: down from clear onto the first position, through all of them, and up again.
///
/// `position(i)` gives the words of position `i`, attack axis included, and where the tool touches
/// the part there; where it touches nothing its own way counts.
pub fn pass(
    machine: &Machine,
    n_positions: usize,
    position: impl Fn(usize) -> (AxisValues, Option<Point3>),
    options: PassOptions,
    progress: &dyn Progress,
) -> Result<Toolpath, Cancelled> {
    let PassOptions { clear, cut, plunge } = options;
    let mut moves = Vec::with_capacity(n_positions + 2);
    if n_positions == 0 {
        return Ok(Toolpath { moves, clear });
    }
    progress.start("scheduling", n_positions as u64);
    let lifted = |mut words: AxisValues| {
        words[machine.attack] = clear;
        words
    };
    let (mut words, mut touched) = position(0);
    moves.push(Move { to: lifted(words), pace: Pace::Rapid });
    moves.push(Move { to: words, pace: Pace::Feed(plunge) });
    for i in 1..n_positions {
        let (next, touches) = position(i);
        let way = match (touched, touches) {
            (Some(from), Some(to)) => (to - from).norm(),
            _ => linear_way(machine, &words, &next),
        };
        let seconds =
            (way / cut).max(axis_time(machine, &words, &next)).max(1.0 / machine.blocks_per_second);
        moves.push(Move { to: next, pace: Pace::Duration(seconds) });
        (words, touched) = (next, touches);
        if i % 4096 == 0 {
            progress.advance(4096)?;
        }
    }
    moves.push(Move { to: lifted(words), pace: Pace::Rapid });
    Ok(Toolpath { moves, clear })
}

/// The least time in which every axis, followers included, can go from one position to the next.
fn axis_time(machine: &Machine, from: &AxisValues, to: &AxisValues) -> f64 {
    let (from, to) = (machine.with_followers(from), machine.with_followers(to));
    let times = machine.axes.iter().zip(from.iter().zip(&to));
    times.map(|(axis, (from, to))| (to - from).abs() / axis.velocity).fold(0.0, f64::max)
}

fn linear_way(machine: &Machine, from: &AxisValues, to: &AxisValues) -> f64 {
    (machine.tool_point(to) - machine.tool_point(from)).norm()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::progress::Silent;

    #[test]
    fn a_move_is_as_slow_as_its_slowest_axis_and_its_contact_need() {
        let machine = Machine::builtin("last-lathe").unwrap();
        let [x, a] = [machine.axes[0].velocity, machine.axes[2].velocity];
        let words =
            [[0.0, 80.0, 0.0], [0.0, 80.0, a], [x / 2.0, 80.0, a], [x / 2.0, 80.0, 1.001 * a]];
        let at = |i: usize| {
            let [x, y, a] = words[i];
            let touched = Point3::new(if i == 3 { 50.0 } else { 0.0 }, 0.0, 0.0);
            ([x, y, a, 0.0, 0.0, 0.0], Some(touched))
        };
        let options = PassOptions { clear: 200.0, cut: 25.0, plunge: 5.0 };
        let path = pass(&machine, 4, at, options, &Silent).unwrap();
        let paces: Vec<Pace> = path.moves.iter().map(|step| step.pace).collect();
        assert_eq!(paces[..2], [Pace::Rapid, Pace::Feed(5.0)]);
        for (pace, seconds) in paces[2..5].iter().zip([1.0, 0.5, 2.0]) {
            assert!(matches!(pace, Pace::Duration(t) if (t - seconds).abs() < 1e-12), "{pace:?}");
        }
        assert_eq!(path.moves[5].to[1], 200.0);
    }
}
