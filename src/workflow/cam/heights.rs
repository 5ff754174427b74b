//! The attack words of all positions.

use super::OffPart;
use crate::cam::Contact;
use crate::geom::Point3;
use crate::machine::Machine;

/// A picture shows no more positions than this.
const MOST_SHOWN: usize = 20_000;

/// The attack words of all positions, missed ones by their rule.
pub(super) struct Heights<'a> {
    pub(super) contacts: &'a [Option<Contact>],
    pub(super) machine: &'a Machine,
    /// Missed positions with the heights they hold; none where they are clear.
    held: Option<Vec<(usize, f64)>>,
    clear: f64,
}

impl<'a> Heights<'a> {
    /// `None` if the tool meets nothing anywhere.
    pub(super) fn new(
        contacts: &'a [Option<Contact>],
        rule: OffPart,
        machine: &'a Machine,
        clear: f64,
    ) -> Option<Self> {
        let first = contacts.iter().flatten().next()?.height;
        let held = (rule == OffPart::Hold).then(|| {
            let mut held = Vec::new();
            let mut last = first;
            for (i, contact) in contacts.iter().enumerate() {
                match contact {
                    Some(contact) => last = contact.height,
                    None => held.push((i, last)),
                }
            }
            held
        });
        Some(Self { contacts, machine, held, clear })
    }

    pub(super) fn word(&self, i: usize) -> f64 {
        let height = match (&self.contacts[i], &self.held) {
            (Some(contact), _) => contact.height,
            (None, None) => return self.clear,
            (None, Some(held)) => held[held.partition_point(|(at, _)| *at < i)].1,
        };
        self.machine.axes[self.machine.attack].word(height)
    }

    pub(super) fn greatest_rise(&self) -> f64 {
        let rises = (1..self.contacts.len()).map(|i| (self.word(i) - self.word(i - 1)).abs());
        rises.fold(0.0, f64::max)
    }

    /// Positions at which the tool meets nothing.
    pub(super) fn n_missed(&self) -> usize {
        self.contacts.iter().filter(|contact| contact.is_none()).count()
    }

    /// Where the tool touches, position by position.
    pub(super) fn touched(&self) -> Vec<Point3> {
        self.contacts.iter().flatten().map(|contact| contact.point).collect()
    }

    /// Attack word over the position's number, for a picture.
    pub(super) fn thinned(&self) -> Vec<[f64; 2]> {
        let n = self.contacts.len();
        let stride = n.div_ceil(MOST_SHOWN).max(1);
        (0..n).step_by(stride).map(|i| [i as f64, self.word(i)]).collect()
    }
}
