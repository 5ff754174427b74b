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

/// On a mesh the contact leaps from edge to edge and stands in between; an axis that followed would
/// only jerk. Its way counts as the mean over so many moves before and after.
const MEAN_OVER: usize = 4;

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
        path.moves.push(Move { to: next, pace: Pace::Duration(1.0 / machine.blocks_per_second) });
        (words, touched) = (next, touches);
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
    path.moves.push(Move { to: lifted(words), pace: Pace::Rapid });
    Ok(Pass { path, feed })
}

/// The moves of a pass as the planner takes them.
struct Asked<'a> {
    machine: &'a Machine,
    options: PassOptions,
    /// How long the feed alone would take [s].
    fed: Vec<f64>,
    ways: Vec<f64>,
}

impl<'a> Asked<'a> {
    fn new(machine: &'a Machine, options: PassOptions) -> Self {
        Self { machine, options, fed: Vec::new(), ways: Vec::new() }
    }

    fn take(&mut self, words: [&AxisValues; 2], touched: [Option<Point3>; 2]) {
        self.fed.push(self.fed_time(words, touched));
        let [from, to] = words.map(|words| self.machine.with_followers(words));
        self.ways.extend((0..self.n_axes()).map(|i| to[i] - from[i]));
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

    /// Shares the times of neighbouring moves out between them, by how far the part is turned and
    /// the tool carried on in each.
    fn even_out(&mut self) {
        if self.options.rotation.is_some() {
            return;
        }
        let driven: Vec<f64> =
            self.ways.chunks_exact(self.n_axes()).map(|ways| self.driven(ways)).collect();
        let evened = (0..self.fed.len()).map(|i| {
            let around = i.saturating_sub(MEAN_OVER)..(i + MEAN_OVER + 1).min(self.fed.len());
            let [fed, whole] =
                [&self.fed, &driven].map(|all| all[around.clone()].iter().sum::<f64>());
            // Where only the attack axis moves the contact's own way is all there is.
            if whole > 0.0 && driven[i] > 0.0 { fed * driven[i] / whole } else { self.fed[i] }
        });
        self.fed = evened.collect();
    }

    /// How long the axes but the attack need for a move at their greatest speeds [s].
    fn driven(&self, ways: &[f64]) -> f64 {
        let axes = self.machine.axes.iter().zip(ways).enumerate();
        let driven = axes.filter(|(i, _)| *i != self.machine.attack);
        driven.map(|(_, (axis, way))| way.abs() / axis.velocity).fold(0.0, f64::max)
    }

    fn n_axes(&self) -> usize {
        self.machine.axes.len().min(MAX_AXES)
    }

    fn timings(&self) -> Vec<Timing> {
        let shortest = 1.0 / self.machine.blocks_per_second;
        let least: Vec<f64> = self.fed.iter().map(|fed| fed.max(shortest)).collect();
        time_motion(&Motion {
            drives: &drives(self.machine),
            ways: &self.ways,
            least: &least,
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
        let [vx, va] = [machine.axes[0].velocity, machine.axes[2].velocity];
        // Thirty times each: A alone, X half as far as it could in a second, the contact alone.
        let n = |i: usize, from: usize| i.saturating_sub(from).min(30) as f64;
        let at = |i: usize| {
            let (a, x, touched) = (n(i, 0) * va, n(i, 30) * vx / 2.0, n(i, 60));
            let words = [x, 80.0, a + 0.001 * touched, 0.0, 0.0, 0.0];
            (words, Some(Point3::new(50.0 * touched, 0.0, 0.0)))
        };
        let pass = pass(&machine, 91, at, OPTIONS, &Silent).unwrap();
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
        let pass = pass(&nimble(), 200, at, OPTIONS, &Silent).unwrap();
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
