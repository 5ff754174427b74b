//! A stretch of the path, made to hold: steps put in where a move gouges, lifts where no step would
//! help, steps left out where nothing is lost.

use super::certificate::{Certificate, Lift};
use super::prove::{End, Prover, Verdict};
use super::{Certified, CertifyOptions};
use crate::cam::Contact;
use crate::cam::Position;
use crate::machine::{AxisKind, AxisValues, Machine};
use crate::tool::HeightFunction;
use fearless_simd::Simd;

/// No joined move turns the part farther: how fast the contact runs is told from its ends.
const MOST_TURN: f64 = 10.0 * std::f64::consts::PI / 180.0;

/// A move of so many least steps that stays open is lifted over rather than halved: where the tool's
/// side touches along a wall, no step would ever tell.
const FEW_STEPS: f64 = 50.0;

/// The path between two of its positions, in the making.
pub(super) struct Stretch<'a, H, S: Simd, const N: usize> {
    pub(super) prover: Prover<'a, H, S, N>,
    pub(super) options: &'a CertifyOptions,
    pub(super) made: Certified,
}

impl<'a, H: HeightFunction, S: Simd, const N: usize> Stretch<'a, H, S, N> {
    /// Follows `n` positions; the first belongs to the stretch before and is not repeated.
    #[inline(always)]
    pub(super) fn follow(
        &mut self,
        n: usize,
        position: impl Fn(usize) -> (AxisValues, Option<Contact>),
    ) {
        let at = |i: usize| {
            let (words, contact) = position(i);
            let exact = contact.map_or(f64::NEG_INFINITY, |contact| contact.height);
            End { words, exact, touched: contact.map(|contact| contact.point) }
        };
        let (mut i, mut from) = (0, at(0));
        while i + 1 < n {
            let mut to = at(i + 1);
            let mut n_joined = 1;
            match self.prover.judge(&from, &to) {
                Verdict::Holds if self.options.thin => {
                    n_joined = self.joined(i, n - 1, &at);
                    to = at(i + n_joined);
                }
                Verdict::Holds => {}
                verdict => self.refine(&from, &to, verdict),
            }
            self.push(&to);
            self.made.certificate.n_dropped += n_joined - 1;
            (i, from) = (i + n_joined, to);
        }
    }

    fn make_hold(&mut self, from: &End, to: &End) {
        let verdict = self.prover.judge(from, to);
        if verdict != Verdict::Holds {
            self.refine(from, to, verdict);
        }
    }

    /// Puts a step between two positions, and more until every move between them holds; or lifts the
    /// tool over a move that is too short, or that a step would help no more.
    fn refine(&mut self, from: &End, to: &End, verdict: Verdict) {
        let machine = self.machine();
        let length = self.options.step(machine, &from.words, &to.words).in_least_steps;
        let helps = verdict == Verdict::Gouges || FEW_STEPS < length;
        let middle = self.options.middle(machine, &from.words, &to.words).filter(|_| helps);
        let Some(words) = middle else { return self.lift(from, to) };
        let middle = self.step_at(words);
        let step = self.options.step(machine, &from.words, &middle.words);
        self.certificate().note_step(step);
        self.make_hold(from, &middle);
        self.push(&middle);
        self.make_hold(&middle, to);
    }

    /// An exact position. Where the tool meets nothing it stays on the line.
    fn step_at(&mut self, words: AxisValues) -> End {
        let mut step = self.prover.digitized(words);
        if step.touched.is_some() {
            let machine = self.machine();
            step.words[machine.attack] = machine.axes[machine.attack].word(step.exact);
        }
        step
    }

    /// Takes the attack axis up before a move that is too short for a step, and down again after it:
    /// above all that the move meets.
    fn lift(&mut self, from: &End, to: &End) {
        let machine = self.machine();
        let heights = [from, to].map(|end| end.height(machine));
        let highest = heights[0].max(heights[1]).max(from.exact).max(to.exact);
        let ceiling = self.prover.ceiling(from, to, highest);
        let word = machine.axes[machine.attack].word(ceiling);
        let lifted = [from, to].map(|end| {
            let mut lifted = *end;
            lifted.words[machine.attack] = word;
            lifted
        });
        let from_before = self.stay_up(from);
        if from_before.unwrap_or(heights[0]) < ceiling {
            self.push(&lifted[0]);
        }
        if heights[1] < ceiling {
            self.push(&lifted[1]);
        }
        let rise = ceiling - heights[0].min(heights[1]);
        let at = to.touched.or(from.touched).map(|point| [point.x, point.y, point.z]);
        self.certificate().note_lift(Lift { rise, at });
    }

    /// After a lift that came down on `end` to go up again at once: takes the coming down back. The
    /// height the tool stays at, if so.
    fn stay_up(&mut self, end: &End) -> Option<f64> {
        let machine = self.machine();
        let [.., above, down] = self.made.positions[..] else { return None };
        let is_still = self.options.step(machine, &above.words, &end.words).in_least_steps == 0.0;
        if !is_still || down.words != end.words {
            return None;
        }
        self.made.positions.pop();
        let height = machine.axes[machine.attack].motion(above.words[machine.attack]);
        let left = &mut self.made.certificate.left_by_lifts;
        *left = left.max(height - end.exact);
        Some(height)
    }

    /// How many moves from position `i` on can be made one: at least 1.
    #[inline(always)]
    fn joined(&mut self, i: usize, last: usize, at: &impl Fn(usize) -> End) -> usize {
        let (mut good, mut bad) = (1, 2);
        // Twice as many until it fails, then halfway between.
        while i + bad <= last && self.may_join(i, i + bad, at) {
            (good, bad) = (bad, 2 * bad);
        }
        bad = bad.min(last - i + 1);
        while good + 1 < bad {
            let middle = usize::midpoint(good, bad);
            if self.may_join(i, i + middle, at) {
                good = middle;
            } else {
                bad = middle;
            }
        }
        if 1 < good {
            let [from, to] = [at(i), at(i + good)];
            for k in i + 1..i + good {
                if let Some(left) = self.left_above(&from, &to, &at(k)) {
                    let left_most = &mut self.made.certificate.left_by_dropping;
                    *left_most = left_most.max(left);
                }
            }
        }
        good
    }

    /// Does one move do for all from position `i` to position `j`: along the same way, no deeper in
    /// the part than allowed, and leaving no more on it?
    #[inline(always)]
    fn may_join(&mut self, i: usize, j: usize, at: &impl Fn(usize) -> End) -> bool {
        let [from, to] = [at(i), at(j)];
        let is_on_part = from.touched.is_some() && to.touched.is_some();
        let is_short = self.turn(&from.words, &to.words) <= MOST_TURN;
        is_on_part
            && is_short
            && (i + 1..j).all(|k| {
                let left = self.left_above(&from, &to, &at(k));
                left.is_some_and(|left| left <= self.prover.gouge)
            })
            && self.prover.judge(&from, &to) == Verdict::Holds
    }

    /// How far above the part the move runs at a position it leaves out; nothing if it does not come
    /// by there [mm].
    fn left_above(&self, from: &End, to: &End, at: &End) -> Option<f64> {
        let (options, machine) = (self.options, self.machine());
        let way = options.in_steps(machine, &from.words, &to.words);
        let out = options.in_steps(machine, &from.words, &at.words);
        let length2: f64 = way.iter().map(|step| step * step).sum();
        let share = way.iter().zip(&out).map(|(way, out)| way * out).sum::<f64>() / length2;
        let is_near = way.iter().zip(&out).all(|(way, out)| (way * share - out).abs() <= 1.0);
        let line = from.height(machine) * (1.0 - share) + to.height(machine) * share;
        let is_between = 0.0 < share && share < 1.0;
        (at.touched.is_some() && is_near && is_between).then_some(line - at.exact)
    }

    fn turn(&self, from: &AxisValues, to: &AxisValues) -> f64 {
        let axes = self.machine().axes.iter().zip(from.iter().zip(to));
        let turns = axes.filter(|(axis, _)| axis.kind == AxisKind::Rotary);
        turns.map(|(_, (from, to))| (to - from).abs()).fold(0.0, f64::max)
    }

    fn push(&mut self, end: &End) {
        self.made.positions.push(Position { words: end.words, touched: end.touched });
    }

    fn certificate(&mut self) -> &mut Certificate {
        &mut self.made.certificate
    }

    fn machine(&self) -> &'a Machine {
        self.prover.lever.machine
    }
}
