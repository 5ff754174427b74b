//! How long each move takes: as fast as its feed, its axes and the control allow.
//!
//! The feed is that of the contact over the part, or a constant rotation of the part. What the axes
//! can hold of it, with their speeds and accelerations, the [planner](time_motion) tells, which looks
//! ahead as controls do; it works on plain arrays and times programs that were read just as well.

mod asked;
mod corner;
mod drive;
mod leg;
mod motion;
mod planner;
mod slowed;

use super::toolpath::{Move, Pace, Position, Toolpath};
use crate::machine::{AxisValues, Machine};
use crate::progress::{Cancelled, Progress};
use asked::Asked;
use serde::Serialize;

pub use drive::{Drive, drives};
pub use motion::{Limit, Motion, Timing};
pub use planner::time_motion;
pub use slowed::{Cause, Slow, Slowdowns, Slowed, Spot};

/// How fast a pass goes, and where it is out of the way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PassOptions {
    /// The attack word at which nothing can be touched [mm].
    pub clear: f64,
    /// Of the contact over the part [mm/s].
    pub cut: f64,
    /// Of the plunge into the material [mm/s].
    pub plunge: f64,
    /// Where the part turns it turns at this speed, however fast the contact then is [rad/s].
    pub rotation: Option<f64>,
}

/// A pass, and how it holds its feed.
#[derive(Debug, Clone, PartialEq)]
pub struct Pass {
    /// The moves.
    pub path: Toolpath,
    /// What became of the feed.
    pub feed: FeedReport,
}

/// What became of the feed that was asked for.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct FeedReport {
    /// How long the cut would take at this feed everywhere [s].
    pub asked: f64,
    /// How long it takes from rest to rest, as fast as the machine can [s].
    pub taken: f64,
    /// What stands in between, the costliest first.
    pub slowed: Vec<Slowed>,
}

impl FeedReport {
    /// Takes in what became of it in another cut.
    pub fn take(&mut self, other: &Self) {
        self.asked += other.asked;
        self.taken += other.taken;
        let mut slowed = Slowdowns::from(std::mem::take(&mut self.slowed));
        for one in &other.slowed {
            slowed.take_all(one);
        }
        self.slowed = slowed.finish();
    }
}

/// One pass: down from clear onto the first position, through all of them, and up again.
///
/// Where the tool touches nothing its own way counts. The duration of each cutting move is that at
/// the greatest speed the machine reaches in it.
pub fn pass(
    machine: &Machine,
    positions: impl IntoIterator<Item = Position, IntoIter: ExactSizeIterator>,
    options: PassOptions,
    progress: &dyn Progress,
) -> Result<Pass, Cancelled> {
    let PassOptions { clear, plunge, .. } = options;
    let mut positions = positions.into_iter();
    let n_positions = positions.len();
    let mut path = Toolpath { moves: Vec::with_capacity(n_positions + 2), clear };
    let mut asked = Asked::new(machine, options, n_positions);
    let Some(mut last) = positions.next() else {
        return Ok(Pass { path, feed: asked.report(&[], &[]) });
    };
    progress.start("scheduling", n_positions as u64);
    let lifted = |mut words: AxisValues| {
        words[machine.attack] = clear;
        words
    };
    path.moves.push(Move { to: lifted(last.words), pace: Pace::Rapid });
    path.moves.push(Move { to: last.words, pace: Pace::Feed(plunge) });
    let shortest = Pace::Duration(1.0 / machine.blocks_per_second);
    for (i, next) in (1..).zip(positions) {
        asked.take(&last, &next);
        path.moves.push(Move { to: next.words, pace: shortest });
        last = next;
        if i % 4096 == 0 {
            progress.advance(4096)?;
        }
    }
    asked.even_out();
    let timings = asked.timings();
    for (step, timing) in path.moves[2..].iter_mut().zip(&timings) {
        // A move that goes nowhere keeps the time of its block.
        if timing.pace > 0.0 {
            step.pace = Pace::Duration(timing.pace);
        }
    }
    let feed = asked.report(&timings, &path.moves[2..]);
    path.moves.push(Move { to: lifted(last.words), pace: Pace::Rapid });
    Ok(Pass { path, feed })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Point3;
    use crate::progress::Silent;

    /// A lathe whose axes are at any speed at once.
    fn nimble() -> Machine {
        let mut machine = Machine::builtin("last-lathe").unwrap();
        for axis in &mut machine.axes {
            axis.acceleration = 1e12;
        }
        machine
    }

    const OPTIONS: PassOptions =
        PassOptions { clear: 200.0, cut: 25.0, plunge: 5.0, rotation: None };

    fn durations(pass: &Pass) -> Vec<f64> {
        let durations = pass.path.moves.iter().filter_map(|step| match step.pace {
            Pace::Duration(seconds) => Some(seconds),
            _ => None,
        });
        durations.collect()
    }

    fn positions(
        n: usize,
        at: impl Fn(usize) -> (AxisValues, Option<Point3>),
    ) -> impl ExactSizeIterator<Item = Position> {
        (0..n).map(move |i| {
            let (words, touched) = at(i);
            Position { words, touched }
        })
    }

    #[test]
    fn a_move_is_as_slow_as_its_slowest_axis_and_its_contact_need() {
        let machine = nimble();
        let [vx, va] = [machine.axes[0].velocity, machine.axes[2].velocity];
        // Thirty times each: A alone, X half as far as it could in a second, the contact alone.
        let n = |i: usize, from: usize| i.saturating_sub(from).min(30) as f64;
        let at = |i: usize| {
            let (a, x, touched) = (n(i, 0) * va, n(i, 30) * vx / 2.0, n(i, 60));
            let words = [x, 80.0, a + 0.001 * touched, 0.0, 0.0, 0.0];
            (words, Some(Point3::new(50.0 * touched, 0.0, 0.0)))
        };
        let pass = pass(&machine, positions(91, at), OPTIONS, &Silent).unwrap();
        let paces: Vec<Pace> = pass.path.moves.iter().map(|step| step.pace).collect();
        assert_eq!(paces[..2], [Pace::Rapid, Pace::Feed(5.0)]);
        let durations = durations(&pass);
        for (i, expected) in [(15, 1.0), (45, 0.5), (75, 2.0)] {
            let seconds = durations[i];
            assert!((seconds - expected).abs() < 1e-9, "move {i}: {seconds} s, not {expected}");
        }
        assert_eq!(pass.path.moves[92].to[1], 200.0);
        // Only the contact's feed is held.
        let causes: Vec<_> = pass.feed.slowed.iter().map(|slowed| slowed.cause).collect();
        assert_eq!(causes[..2], [Cause::Velocity { axis: 'A' }, Cause::Velocity { axis: 'X' }]);
        assert!((pass.feed.asked - 60.0).abs() < 10.0 && pass.feed.asked < pass.feed.taken);
    }

    #[test]
    fn a_contact_that_leaps_from_edge_to_edge_gives_an_even_pace() {
        // Three moves of standing, one of 4 mm: 1 mm a move, 40 ms at 25 mm/s.
        let at = |i: usize| {
            let words = [0.0, 80.0, 0.01 * i as f64, 0.0, 0.0, 0.0];
            (words, Some(Point3::new(4.0 * (i / 4) as f64, 0.0, 0.0)))
        };
        let pass = pass(&nimble(), positions(200, at), OPTIONS, &Silent).unwrap();
        for seconds in &durations(&pass)[10..190] {
            // Nine moves have two leaps or three.
            assert!((8.0 / 9.0 * 0.04 - 1e-9..=12.0 / 9.0 * 0.04 + 1e-9).contains(seconds));
        }
        assert!((pass.feed.asked - 49.0 * 0.16).abs() < 0.2, "{}", pass.feed.asked);
    }

    #[test]
    fn a_constant_rotation_turns_at_its_speed_however_fast_the_contact_is() {
        let options = PassOptions { rotation: Some(2.0), ..OPTIONS };
        let at = |i: usize| {
            let words = [0.0, 80.0, 0.5 * i.min(2) as f64, 0.0, 0.0, 0.0];
            // Faster and faster over the part; in the end the part stands.
            (words, Some(Point3::new((i * i) as f64, 0.0, 0.0)))
        };
        let pass = pass(&nimble(), positions(4, at), options, &Silent).unwrap();
        let expected = [0.25, 0.25, 5.0 / 25.0];
        for (seconds, expected) in durations(&pass)[..2].iter().zip(expected) {
            assert!((seconds - expected).abs() < 1e-12, "{seconds} s, not {expected}");
        }
        assert!((pass.feed.asked - 0.7).abs() < 1e-12);
    }

    #[test]
    fn what_the_acceleration_of_an_axis_takes_is_told_by_its_name() {
        let machine = Machine::builtin("last-lathe").unwrap();
        let at = |i: usize| {
            let a = (i as f64).to_radians();
            let y = 100.0 + 12.0 * (2.0 * a).cos();
            ([i as f64 / 180.0, y, a, 0.0, 0.0, 0.0], None)
        };
        let options = PassOptions { rotation: Some(14.0), ..OPTIONS };
        let pass = pass(&machine, positions(3600, at), options, &Silent).unwrap();
        let most = &pass.feed.slowed[0];
        assert!(matches!(most.cause, Cause::Acceleration { axis: 'A' | 'Y' }), "{most}");
        assert!(most.is_worth_telling(pass.feed.taken));
        assert!(matches!(most.near, Spot::Word { axis: 'X', .. }));
        assert!(pass.feed.asked < 0.99 * pass.feed.taken);
    }
}
