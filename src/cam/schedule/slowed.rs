//! Where a feed cannot be held, and what stands in its way.

use super::motion::Limit;
use serde::Serialize;
use std::fmt;

/// A move that is this much of its feed fast holds it: a feed is the most that a move reaches, and
/// one step of a ramp is slower on the mean.
const HELD: f64 = 0.9;
/// On a way shorter than this the tool stands [mm].
const STANDS: f64 = 0.01;
/// A cause that takes less than this share of the whole time is not worth a warning.
const WORTH_TELLING: f64 = 0.01;

/// What keeps the feed from being held, with all moves it slows down.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Slowed {
    /// What it is.
    #[serde(flatten)]
    pub cause: Cause,
    /// How many moves it slows down.
    pub moves: usize,
    /// How long these would take at their feed [s].
    pub asked: f64,
    /// How long they take [s].
    pub taken: f64,
    /// The least share of its feed that one of them has; 1 if the tool stands on the part in all.
    pub worst: f64,
    /// The feed that is, where feeds are lengths [mm/min].
    pub least_feed: Option<f64>,
    /// Where that is.
    pub near: Spot,
}

/// A move that may be slower than asked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slow {
    /// What keeps it from being faster.
    pub cause: Cause,
    /// How long it would take at its feed [s].
    pub asked: f64,
    /// How long it takes [s].
    pub taken: f64,
    /// The way its feed is of; `None` where the part is turned at a speed [mm].
    pub way: Option<f64>,
}

/// What keeps a feed from being held.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(tag = "cause", rename_all = "kebab-case")]
pub enum Cause {
    /// The greatest speed of an axis.
    Velocity {
        /// Its letter.
        axis: char,
    },
    /// The greatest acceleration of an axis.
    Acceleration {
        /// Its letter.
        axis: char,
    },
    /// The control reads no more blocks a second.
    BlockRate,
    /// The control sees too few blocks ahead.
    LookAhead,
}

/// A place in a path or in a program.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Spot {
    /// Where an axis has this word.
    Word {
        /// Its letter.
        axis: char,
        /// Its word, in the units of programs [mm or deg].
        word: f64,
    },
    /// In this line.
    Line {
        /// The line, counted from 1.
        line: u32,
    },
}

/// Gathers moves that do not hold their feed, cause by cause.
#[derive(Debug, Clone, Default)]
pub struct Slowdowns {
    causes: Vec<Slowed>,
}

impl Slowdowns {
    /// Takes a move.
    pub fn take(&mut self, slow: Slow, near: impl FnOnce() -> Spot) {
        let Slow { cause, asked, taken, way } = slow;
        if asked >= HELD * taken {
            return;
        }
        // Where the tool stands on the part while an axis moves there is no feed to be held.
        let stands = way.is_some_and(|way| way < STANDS);
        let worst = if stands { 1.0 } else { asked / taken };
        let least_feed = way.filter(|_| !stands).map(|way| 60.0 * way / taken);
        let found = self.causes.iter_mut().find(|slowed| slowed.cause == cause);
        let Some(slowed) = found else {
            let near = near();
            let first = Slowed { cause, moves: 1, asked, taken, worst, least_feed, near };
            return self.causes.push(first);
        };
        slowed.moves += 1;
        slowed.asked += asked;
        slowed.taken += taken;
        if worst < slowed.worst {
            (slowed.worst, slowed.least_feed, slowed.near) = (worst, least_feed, near());
        }
    }

    /// Takes moves gathered elsewhere.
    pub fn take_all(&mut self, gathered: &Slowed) {
        let Some(slowed) = self.causes.iter_mut().find(|slowed| slowed.cause == gathered.cause)
        else {
            return self.causes.push(*gathered);
        };
        slowed.moves += gathered.moves;
        slowed.asked += gathered.asked;
        slowed.taken += gathered.taken;
        if gathered.worst < slowed.worst {
            slowed.worst = gathered.worst;
            (slowed.least_feed, slowed.near) = (gathered.least_feed, gathered.near);
        }
    }

    /// All causes, the one that takes most time first.
    pub fn finish(mut self) -> Vec<Slowed> {
        self.causes.sort_by(|one, other| other.lost().total_cmp(&one.lost()));
        self.causes
    }
}

impl From<Vec<Slowed>> for Slowdowns {
    fn from(causes: Vec<Slowed>) -> Self {
        Self { causes }
    }
}

impl Slowed {
    /// The time it takes beyond what was asked [s].
    pub fn lost(&self) -> f64 {
        self.taken - self.asked
    }

    /// True if it matters in an operation that takes `seconds`.
    pub fn is_worth_telling(&self, seconds: f64) -> bool {
        self.lost() > WORTH_TELLING * seconds
    }
}

impl Limit {
    /// What it is on a machine whose axes have these `letters`; a least time is the feed's own, or
    /// that of the `BlockRate`.
    pub fn cause(self, letter: impl Fn(usize) -> char) -> Cause {
        match self {
            Self::Least => Cause::BlockRate,
            Self::Velocity(axis) => Cause::Velocity { axis: letter(axis) },
            Self::Acceleration(axis) => Cause::Acceleration { axis: letter(axis) },
            Self::LookAhead => Cause::LookAhead,
        }
    }
}

impl fmt::Display for Slowed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { cause, moves, asked, taken, worst, least_feed, near } = self;
        let mean = 100.0 * asked / taken;
        match moves {
            1 => write!(f, "{cause} leaves {mean:.0} % of the feed on 1 move")?,
            _ => write!(f, "{cause} leaves {mean:.0} % of the feed on {moves} moves")?,
        }
        match least_feed {
            Some(feed) => write!(f, ", down to {feed:.0} mm/min ")?,
            // A small share would read as none.
            None if *moves > 1 && *worst < 1.0 => {
                write!(f, ", down to {:.2} % ", 100.0 * worst)?;
            }
            None => write!(f, ", ")?,
        }
        write!(f, "{near}: {:.1} s more", self.lost())
    }
}

impl fmt::Display for Cause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Velocity { axis } => write!(f, "the greatest speed of {axis}"),
            Self::Acceleration { axis } => write!(f, "the acceleration of {axis}"),
            Self::BlockRate => write!(f, "the number of blocks the control reads a second"),
            Self::LookAhead => write!(f, "the number of blocks the control looks ahead"),
        }
    }
}

impl fmt::Display for Spot {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Word { axis, word } => write!(f, "near {axis} {word:.1}"),
            Self::Line { line } => write!(f, "in line {line}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moves_are_gathered_by_what_slows_them_down() {
        let mut all = Slowdowns::default();
        let mut take = |asked, taken, cause, way, word| {
            all.take(Slow { cause, asked, taken, way }, || Spot::Word { axis: 'X', word });
        };
        let [y, a] = [Cause::Acceleration { axis: 'Y' }, Cause::Velocity { axis: 'A' }];
        take(1.0, 1.1, y, Some(10.0), 1.0);
        take(1.0, 2.0, a, None, 2.0);
        take(1.0, 4.0, y, Some(10.0), 3.0);
        take(3.0, 4.0, y, Some(30.0), 4.0);
        take(0.0, 1.0, Cause::BlockRate, Some(0.0), 5.0);
        take(1.0, 200.0, Cause::LookAhead, None, 6.0);
        take(1.0, 2.0, Cause::LookAhead, None, 7.0);
        let told: Vec<_> = all.finish().iter().map(ToString::to_string).collect();
        assert_eq!(
            told,
            [
                "the number of blocks the control looks ahead leaves 1 % of the feed on 2 moves, down to \
                 0.50 % near X 6.0: 200.0 s more",
                "the acceleration of Y leaves 50 % of the feed on 2 moves, down to 150 mm/min near X \
                 3.0: 4.0 s more",
                "the greatest speed of A leaves 50 % of the feed on 1 move, near X 2.0: 1.0 s more",
                "the number of blocks the control reads a second leaves 0 % of the feed on 1 move, \
                 near X 5.0: 1.0 s more"
            ]
        );
    }

    #[test]
    fn only_what_costs_a_hundredth_of_the_time_is_worth_telling() {
        let mut all = Slowdowns::default();
        let slow = Slow { cause: Cause::LookAhead, asked: 1.0, taken: 2.0, way: None };
        all.take(slow, || Spot::Line { line: 7 });
        let slowed = all.finish()[0];
        assert!(slowed.is_worth_telling(99.0) && !slowed.is_worth_telling(101.0));
    }
}
