//! What is proved of a path, and what it took.

use serde::Serialize;

/// What is proved of a path, and what it took. Lengths in millimetres, angles in degrees.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct Certificate {
    /// Nowhere on any move the tool is deeper in the part than this, along the attack axis.
    pub gouge: f64,
    /// How many moves that is said of: all there are between the path's positions.
    pub n_moves: usize,
    /// Steps put in.
    pub n_inserted: usize,
    /// The shortest of them.
    pub shortest_step: Option<ShortestStep>,
    /// Moves that no step would help, over which the attack axis was lifted and let down again on its
    /// own: shoulders, over which the height jumps.
    pub n_lifts: usize,
    /// The highest of them.
    pub greatest_lift: Option<Lift>,
    /// Between lifts that follow each other the tool stays up: no higher above the part than this,
    /// which is the material that leaves.
    pub left_by_lifts: f64,
    /// Steps left out.
    pub n_dropped: usize,
    /// No position left out is passed higher than this: the material that leaves.
    pub left_by_dropping: f64,
}

/// How far axes go in one step.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct ShortestStep {
    /// The farthest linear axis but the attack axis.
    pub mm: f64,
    /// The farthest rotary axis.
    pub deg: f64,
    /// The same in least steps, whichever is more.
    #[serde(skip)]
    pub(super) in_least_steps: f64,
}

/// A lift of the attack axis over a shoulder.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct Lift {
    /// From the lower end of the move.
    pub rise: f64,
    /// Where the tool touches the part there, if it does.
    pub at: Option<[f64; 3]>,
}

impl Certificate {
    pub(super) fn note_step(&mut self, step: ShortestStep) {
        self.n_inserted += 1;
        self.note_shortest(step);
    }

    fn note_shortest(&mut self, step: ShortestStep) {
        if self.shortest_step.is_none_or(|least| step.in_least_steps < least.in_least_steps) {
            self.shortest_step = Some(step);
        }
    }

    pub(super) fn note_lift(&mut self, lift: Lift) {
        self.n_lifts += 1;
        self.note_greatest(lift);
    }

    fn note_greatest(&mut self, lift: Lift) {
        if self.greatest_lift.is_none_or(|greatest| greatest.rise < lift.rise) {
            self.greatest_lift = Some(lift);
        }
    }

    /// Counts what was done on a stretch that follows.
    pub(super) fn add(&mut self, next: &Self) {
        self.n_inserted += next.n_inserted;
        self.n_lifts += next.n_lifts;
        self.n_dropped += next.n_dropped;
        self.left_by_lifts = self.left_by_lifts.max(next.left_by_lifts);
        self.left_by_dropping = self.left_by_dropping.max(next.left_by_dropping);
        next.shortest_step.into_iter().for_each(|step| self.note_shortest(step));
        next.greatest_lift.into_iter().for_each(|lift| self.note_greatest(lift));
    }
}
