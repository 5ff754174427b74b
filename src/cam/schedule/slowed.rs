//! Where a feed cannot be held, and what stands in its way.

use super::planner::Limit;
use serde::Serialize;
use std::fmt;

/// A move that is this much of its feed fast holds it: a feed is the most that a move reaches, and
/// one step of a ramp is slower on the mean.
const HELD: f64 = 0.9;
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
    /// The least share of its feed that one of them has.
    pub worst: f64,
    /// Where that is.
    pub near: Spot,
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
    /// Takes a move that was `asked` to take so long and has `taken` so long.
    pub fn take(&mut self, asked: f64, taken: f64, cause: Cause, near: impl FnOnce() -> Spot) {
        if asked >= HELD * taken {
            return;
        }
        let share = asked / taken;
        let Some(slowed) = self.causes.iter_mut().find(|slowed| slowed.cause == cause) else {
            let (worst, near) = (share, near());
            return self.causes.push(Slowed { cause, moves: 1, asked, taken, worst, near });
        };
        slowed.moves += 1;
        slowed.asked += asked;
        slowed.taken += taken;
        if share < slowed.worst {
            (slowed.worst, slowed.near) = (share, near());
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
            (slowed.worst, slowed.near) = (gathered.worst, gathered.near);
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
        let percent = |share: f64| 100.0 * share;
        let Self { cause, moves, asked, taken, worst, near } = self;
        match moves {
            1 => write!(f, "{cause} leaves {:.0} % of the feed on 1 move, ", percent(*worst))?,
            _ => write!(
                f,
                "{cause} leaves {:.0} % of the feed on {moves} moves, {:.0} % at the worst, ",
                percent(asked / taken),
                percent(*worst)
            )?,
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
        let at = |word| move || Spot::Word { axis: 'X', word };
        let [y, a] = [Cause::Acceleration { axis: 'Y' }, Cause::Velocity { axis: 'A' }];
        all.take(1.0, 1.1, y, at(1.0));
        all.take(1.0, 2.0, a, at(2.0));
        all.take(1.0, 4.0, y, at(3.0));
        all.take(3.0, 4.0, y, at(4.0));
        let told: Vec<_> = all.finish().iter().map(ToString::to_string).collect();
        assert_eq!(
            told,
            [
                "the acceleration of Y leaves 50 % of the feed on 2 moves, 25 % at the worst, near \
                 X 3.0: 4.0 s more",
                "the greatest speed of A leaves 50 % of the feed on 1 move, near X 2.0: 1.0 s more"
            ]
        );
    }

    #[test]
    fn only_what_costs_a_hundredth_of_the_time_is_worth_telling() {
        let mut all = Slowdowns::default();
        all.take(1.0, 2.0, Cause::LookAhead, || Spot::Line { line: 7 });
        let slowed = all.finish()[0];
        assert!(slowed.is_worth_telling(99.0) && !slowed.is_worth_telling(101.0));
    }
}
