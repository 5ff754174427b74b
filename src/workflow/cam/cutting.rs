//! The cuts of a roughing on their way to moves, with the links between them.

use crate::cam::{
    Contact, Cut, FeedReport, Move, Pace, Pass, PassOptions, Position, Roughing, Toolpath,
    Trajectory, pass,
};
use crate::geom::Point3;
use crate::progress::{Cancelled, Progress, Silent};
use std::f64::consts::TAU;

/// The cuts on their way to moves.
pub(super) struct Cutting<'a> {
    pub(super) way: &'a Trajectory<'a>,
    pub(super) roughing: &'a Roughing<'a>,
    pub(super) contacts: &'a [Option<Contact>],
    pub(super) pace: PassOptions,
    /// From the tool's programmed point to its lowest one [mm].
    pub(super) top: f64,
    /// The axis that turns the part without end.
    pub(super) turning: Option<usize>,
}

impl Cutting<'_> {
    /// All cuts with the links between them: straight up, across above all stock, straight down to
    /// it, and with the plunging feed into it. An axis that turns without end is never wound back.
    pub(super) fn toolpath(&self, progress: &dyn Progress) -> Result<Pass, Cancelled> {
        let clear = self.pace.clear;
        let cuts = &self.roughing.cuts;
        progress.start("scheduling", cuts.len() as u64);
        let mut all = Toolpath { moves: Vec::new(), clear };
        let mut feed = FeedReport::default();
        for (i, cut) in cuts.iter().enumerate() {
            let is_first = i == 0;
            let link = if is_first { clear } else { self.word(cut.link) };
            // The last move of the cut before leaves the stock straight up, now as far as this link.
            if let Some(leave) = all.moves.last_mut() {
                leave.to[self.way.machine().attack] = link;
            }
            let wound = self.whole_turns(all.moves.last(), cut.positions.start);
            let positions = cut.positions.clone().map(|i| {
                let mut position = self.position(cut, i);
                if let Some(axis) = self.turning {
                    position.words[axis] += wound;
                }
                position
            });
            let pace = PassOptions { clear: link, ..self.pace };
            let cut_pass = pass(self.way.machine(), positions, pace, &Silent)?;
            feed.take(&cut_pass.feed);
            let mut moves = cut_pass.path.moves.into_iter();
            if let Some(over) = moves.next() {
                let mut down = over.to;
                down[self.way.machine().attack] = self.word(cut.above);
                all.moves.extend([over, Move { to: down, pace: Pace::Rapid }]);
            }
            all.moves.extend(moves);
            progress.advance(1)?;
        }
        if let Some(leave) = all.moves.last_mut() {
            leave.to[self.way.machine().attack] = clear;
        }
        Ok(Pass { path: all, feed })
    }

    /// The whole turns that bring position `i` nearest to where the last move ended [rad].
    fn whole_turns(&self, last: Option<&Move>, i: usize) -> f64 {
        let (Some(axis), Some(last)) = (self.turning, last) else { return 0.0 };
        ((last.to[axis] - self.way.values(i)[axis]) / TAU).round() * TAU
    }

    /// The words of a position in a cut, and the point of the stock it is about.
    fn position(&self, cut: &Cut, i: usize) -> Position {
        let height = self.roughing.height(cut.layer, i);
        let mut words = self.way.values(i);
        words[self.way.machine().attack] = self.word(height);
        Position { words, touched: Some(self.touched(cut, i, height)) }
    }

    fn touched(&self, cut: &Cut, i: usize, height: f64) -> Point3 {
        match &self.contacts[i] {
            Some(contact) if self.roughing.is_on_part(cut.layer, i) => contact.point,
            _ => {
                let pose = self.way.machine().attack_from_part(&self.way.values(i));
                pose.inverse() * Point3::new(0.0, height - self.top, 0.0)
            }
        }
    }

    /// What is touched, cut by cut, for the picture.
    pub(super) fn path(&self) -> Vec<Point3> {
        let cuts = self.roughing.cuts.iter();
        let at = |cut: &Cut, i: usize| self.touched(cut, i, self.roughing.height(cut.layer, i));
        cuts.flat_map(|cut| cut.positions.clone().map(move |i| at(cut, i))).collect()
    }

    fn word(&self, height: f64) -> f64 {
        let machine = self.way.machine();
        machine.axes[machine.attack].word(height)
    }
}
