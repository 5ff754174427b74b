//! Does a move keep within the allowed gouge all along?
//!
//! Where the sweep of the whole move cannot tell, its middle is digitized exactly. Is the gouge too
//! deep there, the answer is no; else both halves are asked in the same way. What neither gouges nor
//! can be told from it on a quarter of the move, under a blunt tool a sixty-fourth, stays open. Where a move as long could not be
//! told lately, the middle comes first: mostly it gouges, and the sweep is spared.

use super::motion::{Lever, Motion};
use super::sweep::{Limits, Sweep, Waiting};
use crate::cam::digitize::{Found, Memory, Part, View, drop_indexed};
use crate::geom::{PatchTree, Point3};
use crate::machine::{AxisValues, Machine};
use crate::tool::HeightFunction;
use fearless_simd::Simd;

/// Moves are halved so often before they are given up: by their bend only short ones are proved, and
/// only a blunt tool is proved by its bend.
const MOST_HALVINGS_IF_BLUNT: u32 = 6;
/// Under other tools planes go along with the whole move, and a part of it is hardly ever told
/// better; but each look costs a sweep.
const MOST_HALVINGS: u32 = 2;

/// A tool that bends less along its way [1/mm], as a wheel does along its rim, is close to the part
/// over many triangles: halving until they run smoothly is cheaper than cutting them.
const BLUNT: f64 = 1.0 / 30.0;

/// Moves that differ by rounding are as long as each other.
const NEARLY: f64 = 0.999;

/// What it takes to digitize and to sweep a part.
pub(super) struct Prover<'a, H, S: Simd, const N: usize> {
    pub(super) simd: S,
    pub(super) part: &'a Part,
    pub(super) tree: &'a PatchTree<N>,
    pub(super) tool: &'a H,
    pub(super) lever: Lever<'a>,
    /// What is allowed [mm].
    pub(super) gouge: f64,
    pub(super) memory: Memory,
    pub(super) waiting: Waiting<N>,
    /// The square of how long a move may be before its middle is digitized first.
    pub(super) doubtful: f64,
}

/// What is known of a move.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Verdict {
    /// Nowhere on it the tool is deeper in the part than allowed.
    Holds,
    /// Somewhere it is.
    Gouges,
    /// It could not be told.
    Open,
}

/// An end of a move.
#[derive(Debug, Clone, Copy)]
pub(super) struct End {
    /// The attack word is the one the tool runs through, whatever the part needs.
    pub(super) words: AxisValues,
    /// The exact height of the part here, as a motion of the attack axis; minus infinity if the tool
    /// meets nothing [mm].
    pub(super) exact: f64,
    /// Where the tool touches.
    pub(super) touched: Option<Point3>,
}

impl End {
    /// The height the tool runs through.
    pub(super) fn height(&self, machine: &Machine) -> f64 {
        machine.axes[machine.attack].motion(self.words[machine.attack])
    }
}

impl<H: HeightFunction, S: Simd, const N: usize> Prover<'_, H, S, N> {
    /// Is the tool anywhere on the move deeper in the part than allowed?
    pub(super) fn judge(&mut self, from: &End, to: &End) -> Verdict {
        let n_halvings = if self.is_blunt() { MOST_HALVINGS_IF_BLUNT } else { MOST_HALVINGS };
        self.judge_halves(from, to, n_halvings)
    }

    fn judge_halves(&mut self, from: &End, to: &End, n_halvings: u32) -> Verdict {
        let machine = self.lever.machine;
        let line = [from.height(machine), to.height(machine)];
        let deepest = (from.exact - line[0]).max(to.exact - line[1]).max(0.0);
        if self.gouge < deepest {
            return Verdict::Gouges;
        }
        let halfway = std::array::from_fn(|i| f64::midpoint(from.words[i], to.words[i]));
        let length2 = self.length2(from, to);
        let is_doubtful = self.doubtful <= length2;
        let middle = is_doubtful.then(|| self.digitized(halfway));
        if middle.is_some_and(|middle| self.gouge < middle.exact - middle.height(machine)) {
            return Verdict::Gouges;
        }
        let bend = 8.0 * (self.gouge - deepest);
        let limits = Limits { gouge: self.gouge, deepest, bend, is_verdict: true };
        let motion = Motion::new(&self.lever, &from.words, &to.words);
        if !self.is_too_coarse(from, to, &motion, bend)
            && self.harm(&motion, line, limits) == f32::NEG_INFINITY
        {
            if is_doubtful {
                // Longer ones are in doubt until one of them holds.
                self.doubtful = length2 / NEARLY;
            }
            return Verdict::Holds;
        }
        self.doubtful = self.doubtful.min(length2 * NEARLY);
        if n_halvings == 0 {
            return Verdict::Open;
        }
        let middle = middle.unwrap_or_else(|| self.digitized(halfway));
        match self.judge_halves(from, &middle, n_halvings - 1) {
            Verdict::Holds => self.judge_halves(&middle, to, n_halvings - 1),
            other => other,
        }
    }

    /// How far all axes but the attack axis go together, squared.
    fn length2(&self, from: &End, to: &End) -> f64 {
        let machine = self.lever.machine;
        let others = (0..machine.axes.len()).filter(|&i| i != machine.attack);
        others.map(|i| (to.words[i] - from.words[i]).powi(2)).sum()
    }

    /// A height that nothing on the move from one to the other holds the tool above; both ends are
    /// known to lie no higher than `least`.
    pub(super) fn ceiling(&mut self, from: &End, to: &End, least: f64) -> f64 {
        let bend = 8.0 * self.gouge;
        let limits = Limits { gouge: self.gouge, deepest: 0.0, bend, is_verdict: false };
        let motion = Motion::new(&self.lever, &from.words, &to.words);
        let above = self.harm(&motion, [least; 2], limits);
        least + f64::from(above).max(0.0)
    }

    /// Do the very points that a blunt tool touches at the ends bend down by more than `bend`? Then a
    /// sweep could hardly tell either.
    fn is_too_coarse(&self, from: &End, to: &End, motion: &Motion, bend: f64) -> bool {
        self.is_blunt()
            && [from, to].into_iter().filter_map(|end| end.touched).any(|point| {
                let at = motion.place.of(&point);
                let way = motion.velocity.of(&point);
                let turned = motion.acceleration.of(&point);
                let is_inside = self.tool.height(at.x, at.z).is_some();
                let slope = |x: f64, z: f64| self.tool.along(at.x, at.z, x, z);
                is_inside && {
                    let with_part = turned.y + slope(turned.x, turned.z).slope;
                    bend < -(with_part + slope(way.x, way.z).bend)
                }
            })
    }

    fn is_blunt(&self) -> bool {
        let [_, least_bend] = self.tool.least_bend();
        0.0 < least_bend && least_bend < BLUNT
    }

    fn harm(&mut self, motion: &Motion, line: [f64; 2], limits: Limits) -> f32 {
        let sweep = Sweep::new(self.simd, self.tool, self.tree, motion, line);
        sweep.harm(limits, &mut self.waiting)
    }

    /// The part digitized at `words`, whose attack word is left as it is.
    pub(super) fn digitized(&mut self, words: AxisValues) -> End {
        let view = View::new(&self.lever.machine.attack_from_part(&words));
        let found: Option<Found> =
            drop_indexed(self.simd, self.part, self.tool, &view, &mut self.memory);
        match found {
            Some(found) => {
                let contact = found.contact(self.part, self.tool, &view);
                End { words, exact: contact.height, touched: Some(contact.point) }
            }
            None => End { words, exact: f64::NEG_INFINITY, touched: None },
        }
    }
}
