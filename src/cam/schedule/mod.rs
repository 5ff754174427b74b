//! How long each move takes: as fast as its feed, its axes and the control allow.
//!
//! The feed is that of the contact over the part, or a constant rotation of the part. What the axes
//! can hold of it, with their speeds and accelerations, the [planner](time_motion) tells, which looks
//! ahead as controls do; it works on plain arrays and times programs that were read just as well.

mod corner;
mod drive;
mod leg;
mod planner;
mod slowed;

use super::toolpath::{Move, Pace, Toolpath};
use crate::geom::Point3;
use crate::machine::{Axis, AxisKind, AxisValues, MAX_AXES, Machine};
use crate::progress::{Cancelled, Progress};
use serde::Serialize;

pub use drive::{Drive, drives};
pub use planner::{Limit, Motion, Timing, time_motion};
pub use slowed::{Cause, Slowdowns, Slowed, Spot};

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
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct FeedReport {
    /// How long the cut would take at this feed everywhere [s].
    pub asked: f64,
    /// How long it takes from rest to rest, as fast as the machine can [s].
    pub taken: f64,
    /// What stands in between, the costliest first.
    pub slowed: Vec<Slowed>,
}

/// One pass: down from clear onto the first position, through all of them, and up again.
///
/// `position(i)` gives the words of position `i`, attack axis included, and where the tool touches
/// the part there; where it touches nothing its own way counts. The duration of each cutting move is
/// that at the greatest speed the machine reaches in it.
pub fn pass(
    machine: &Machine,
    n_positions: usize,
    position: impl Fn(usize) -> (AxisValues, Option<Point3>),
    options: PassOptions,
    progress: &dyn Progress,
) -> Result<Pass, Cancelled> {
    let PassOptions { clear, plunge, .. } = options;
    let mut path = Toolpath { moves: Vec::with_capacity(n_positions + 2), clear };
    let mut asked = Asked::new(machine, options);
    if n_positions == 0 {
        return Ok(Pass { path, feed: asked.report(&[], &[]) });
    }
    progress.start("scheduling", n_positions as u64);
    let lifted = |mut words: AxisValues| {
        words[machine.attack] = clear;
        words
    };
    let (mut words, mut touched) = position(0);
    path.moves.push(Move { to: lifted(words), pace: Pace::Rapid });
    path.moves.push(Move { to: words, pace: Pace::Feed(plunge) });
    for i in 1..n_positions {
        let (next, touches) = position(i);
        asked.take([&words, &next], [touched, touches]);
        path.moves.push(Move { to: next, pace: Pace::Duration(asked.least[i - 1]) });
        (words, touched) = (next, touches);
        if i % 4096 == 0 {
            progress.advance(4096)?;
        }
    }
    let timings = asked.timings();
    for (step, timing) in path.moves[2..].iter_mut().zip(&timings) {
        // A move that goes nowhere keeps the time of its block.
        if timing.pace > 0.0 {
            step.pace = Pace::Duration(timing.pace);
        }
    }
    let feed = asked.report(&timings, &path.moves[2..]);
    path.moves.push(Move { to: lifted(words), pace: Pace::Rapid });
    Ok(Pass { path, feed })
}

/// The moves of a pass as the planner takes them.
struct Asked<'a> {
    machine: &'a Machine,
    options: PassOptions,
    /// How long the feed alone would take [s].
    fed: Vec<f64>,
    /// And no shorter than the control can read a block [s].
    least: Vec<f64>,
    ways: Vec<f64>,
}

impl<'a> Asked<'a> {
    fn new(machine: &'a Machine, options: PassOptions) -> Self {
        Self { machine, options, fed: Vec::new(), least: Vec::new(), ways: Vec::new() }
    }

    fn take(&mut self, words: [&AxisValues; 2], touched: [Option<Point3>; 2]) {
        let fed = self.fed_time(words, touched);
        self.fed.push(fed);
        self.least.push(fed.max(1.0 / self.machine.blocks_per_second));
        let [from, to] = words.map(|words| self.machine.with_followers(words));
        let n_axes = self.machine.axes.len().min(MAX_AXES);
        self.ways.extend((0..n_axes).map(|i| to[i] - from[i]));
    }

    fn fed_time(&self, [from, to]: [&AxisValues; 2], touched: [Option<Point3>; 2]) -> f64 {
        let turn = self.machine.spindle.map_or(0.0, |spindle| (to[spindle] - from[spindle]).abs());
        if let Some(rotation) = self.options.rotation.filter(|_| turn > 0.0) {
            return turn / rotation;
        }
        let way = match touched {
            [Some(from), Some(to)] => (to - from).norm(),
            _ => (self.machine.tool_point(to) - self.machine.tool_point(from)).norm(),
        };
        way / self.options.cut
    }

    fn timings(&self) -> Vec<Timing> {
        time_motion(&Motion {
            drives: &drives(self.machine),
            ways: &self.ways,
            least: &self.least,
            look_ahead: self.machine.look_ahead_blocks,
        })
    }

    fn report(&self, timings: &[Timing], moves: &[Move]) -> FeedReport {
        let axes = &self.machine.axes;
        let along = self.along();
        let mut slowed = Slowdowns::default();
        for ((fed, timing), step) in self.fed.iter().zip(timings).zip(moves) {
            let cause = timing.limit.cause(|axis| axes[axis].letter);
            slowed.take(*fed, timing.seconds, cause, || spot(&axes[along], step.to[along]));
        }
        let taken = timings.iter().map(|timing| timing.seconds).sum();
        FeedReport { asked: self.fed.iter().sum(), taken, slowed: slowed.finish() }
    }

    /// The axis by whose word people find a place on the part: the first that is not the attack.
    fn along(&self) -> usize {
        let machine = self.machine;
        let mut axes = machine.axes.iter().enumerate().filter(|(i, _)| *i != machine.attack);
        let found = axes.find(|(_, axis)| axis.kind == AxisKind::Linear);
        found.map_or(machine.attack, |(i, _)| i)
    }
}

fn spot(axis: &Axis, value: f64) -> Spot {
    let word = if axis.kind == AxisKind::Rotary { value.to_degrees() } else { value };
    Spot::Word { axis: axis.letter, word }
}

#[cfg(test)]
mod tests {
    use super::*;
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

    #[test]
    fn a_move_is_as_slow_as_its_slowest_axis_and_its_contact_need() {
        let machine = nimble();
        let [x, a] = [machine.axes[0].velocity, machine.axes[2].velocity];
        let words =
            [[0.0, 80.0, 0.0], [0.0, 80.0, a], [x / 2.0, 80.0, a], [x / 2.0, 80.0, 1.001 * a]];
        let at = |i: usize| {
            let [x, y, a] = words[i];
            let touched = Point3::new(if i == 3 { 50.0 } else { 0.0 }, 0.0, 0.0);
            ([x, y, a, 0.0, 0.0, 0.0], Some(touched))
        };
        let pass = pass(&machine, 4, at, OPTIONS, &Silent).unwrap();
        let paces: Vec<Pace> = pass.path.moves.iter().map(|step| step.pace).collect();
        assert_eq!(paces[..2], [Pace::Rapid, Pace::Feed(5.0)]);
        for (seconds, expected) in durations(&pass).into_iter().zip([1.0, 0.5, 2.0]) {
            assert!((seconds - expected).abs() < 1e-12, "{seconds} s, not {expected}");
        }
        assert_eq!(pass.path.moves[5].to[1], 200.0);
        // Only the last holds its feed.
        let causes: Vec<_> = pass.feed.slowed.iter().map(|slowed| slowed.cause).collect();
        assert_eq!(causes, [Cause::Velocity { axis: 'A' }, Cause::Velocity { axis: 'X' }]);
        assert_eq!(pass.feed.asked, 2.0);
        assert!((pass.feed.taken - 3.5).abs() < 1e-3, "{}", pass.feed.taken);
    }

    #[test]
    fn a_constant_rotation_turns_at_its_speed_however_fast_the_contact_is() {
        let options = PassOptions { rotation: Some(2.0), ..OPTIONS };
        let at = |i: usize| {
            let words = [0.0, 80.0, 0.5 * i.min(2) as f64, 0.0, 0.0, 0.0];
            // Faster and faster over the part; in the end the part stands.
            (words, Some(Point3::new((i * i) as f64, 0.0, 0.0)))
        };
        let pass = pass(&nimble(), 4, at, options, &Silent).unwrap();
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
        let pass = pass(&machine, 3600, at, options, &Silent).unwrap();
        let most = &pass.feed.slowed[0];
        assert!(matches!(most.cause, Cause::Acceleration { axis: 'A' | 'Y' }), "{most}");
        assert!(most.is_worth_telling(pass.feed.taken));
        assert!(matches!(most.near, Spot::Word { axis: 'X', .. }));
        assert!(pass.feed.asked < 0.99 * pass.feed.taken);
    }
}
