//! Which neurons are joined, and how long ago each edge was confirmed.

/// The edges of all neurons, each kept at both its ends.
///
/// A neuron has a row of slots in one long list; rows are widened together when one of them is full, so that a
/// row is one or two cache lines and never a list of its own.
///
/// An edge grows older by one whenever one of its ends wins. Nobody counts that: an edge keeps how often both
/// ends had won when it was confirmed, and its age is how often they have won since.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Links {
    width: usize,
    n_slots: Vec<u32>,
    slots: Vec<Slot>,
}

/// One end of an edge. `Slot` of `kernels/gng_learn.wgsl` and `kernels/gng_insert.wgsl`.
#[derive(Debug, Clone, Copy, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub(super) struct Slot {
    /// The neuron at the other end.
    pub(super) to: u32,
    /// How often both ends had won when the edge was confirmed, together (it may go round).
    pub(super) confirmed: u32,
}

impl Slot {
    /// How often the ends have won since the edge was confirmed, their `wins` being what they are.
    pub(super) fn age(self, wins: [u32; 2]) -> u32 {
        wins[0].wrapping_add(wins[1]).wrapping_sub(self.confirmed)
    }
}

/// Slots a row begins with; in a settled network hardly a neuron has more.
const WIDTH: usize = 16;

impl Links {
    pub(super) fn new() -> Self {
        Self { width: WIDTH, n_slots: Vec::new(), slots: Vec::new() }
    }

    /// Slots in a row.
    pub(super) fn width(&self) -> usize {
        self.width
    }

    /// How many slots of each row hold an edge, and all rows one after the other.
    pub(super) fn rows(&self) -> (&[u32], &[Slot]) {
        (&self.n_slots, &self.slots)
    }

    /// Edges in rows of `width` slots.
    pub(super) fn of_rows(width: usize, n_slots: Vec<u32>, slots: Vec<Slot>) -> Self {
        Self { width, n_slots, slots }
    }

    /// A neuron without edges more.
    pub(super) fn add(&mut self) {
        self.n_slots.push(0);
        self.slots.resize(self.slots.len() + self.width, Slot::default());
    }

    /// The edges of the neuron `i`.
    pub(super) fn of(&self, i: u32) -> &[Slot] {
        let begin = i as usize * self.width;
        &self.slots[begin..begin + self.n_slots[i as usize] as usize]
    }

    fn of_mut(&mut self, i: u32) -> &mut [Slot] {
        let begin = i as usize * self.width;
        &mut self.slots[begin..begin + self.n_slots[i as usize] as usize]
    }

    /// Joins `a` and `b`, or confirms that they are.
    pub(super) fn confirm(&mut self, a: u32, b: u32, confirmed: u32) {
        for (from, to) in [(a, b), (b, a)] {
            match self.of_mut(from).iter_mut().find(|slot| slot.to == to) {
                Some(slot) => slot.confirmed = confirmed,
                None => self.push(from, Slot { to, confirmed }),
            }
        }
    }

    /// Cuts the edge between `a` and `b`.
    pub(super) fn cut(&mut self, a: u32, b: u32) {
        for (from, to) in [(a, b), (b, a)] {
            let row = self.of_mut(from);
            if let Some(found) = row.iter().position(|slot| slot.to == to) {
                row[found] = row[row.len() - 1];
                self.n_slots[from as usize] -= 1;
            }
        }
    }

    /// Takes out the neuron `i`, which has no edges; the last one gets its number.
    pub(super) fn swap_remove(&mut self, i: u32) {
        let last = self.n_slots.len() as u32 - 1;
        if i != last {
            for k in 0..self.n_slots[last as usize] as usize {
                let moved = self.of(last)[k];
                for slot in self.of_mut(moved.to) {
                    if slot.to == last {
                        slot.to = i;
                    }
                }
                self.slots[i as usize * self.width + k] = moved;
            }
        }
        self.n_slots.swap_remove(i as usize);
        self.slots.truncate(self.n_slots.len() * self.width);
    }

    fn push(&mut self, i: u32, slot: Slot) {
        let n = self.n_slots[i as usize] as usize;
        if n == self.width {
            self.widen();
        }
        self.slots[i as usize * self.width + n] = slot;
        self.n_slots[i as usize] += 1;
    }

    /// Twice the room for the edges of each neuron.
    pub(super) fn widen(&mut self) {
        let mut wider = vec![Slot::default(); 2 * self.slots.len()];
        for (new, old) in wider.chunks_mut(2 * self.width).zip(self.slots.chunks(self.width)) {
            new[..self.width].copy_from_slice(old);
        }
        self.slots = wider;
        self.width *= 2;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ends(links: &Links, i: u32) -> Vec<u32> {
        links.of(i).iter().map(|slot| slot.to).collect()
    }

    fn star(n: u32) -> Links {
        let mut links = Links::new();
        (0..=n).for_each(|_| links.add());
        (1..=n).for_each(|i| links.confirm(0, i, i));
        links
    }

    #[test]
    fn a_row_that_is_full_is_widened_and_keeps_its_edges() {
        let links = star(40);
        assert_eq!(ends(&links, 0), (1..=40).collect::<Vec<_>>());
        assert!((1..=40).all(|i| links.of(i) == [Slot { to: 0, confirmed: i }]));
    }

    #[test]
    fn an_edge_is_cut_and_confirmed_at_both_its_ends() {
        let mut links = star(3);
        links.confirm(2, 0, 9);
        links.cut(3, 0);
        assert_eq!(ends(&links, 0), [1, 2]);
        assert_eq!(links.of(0)[1].confirmed, 9);
        assert_eq!(links.of(2), [Slot { to: 0, confirmed: 9 }]);
        assert!(links.of(3).is_empty());
    }

    #[test]
    fn the_last_neuron_takes_the_number_of_the_one_taken_out() {
        let mut links = star(3);
        links.cut(1, 0);
        links.swap_remove(1);
        assert_eq!(ends(&links, 0), [3, 2].map(|i| if i == 3 { 1 } else { i }));
        assert_eq!(ends(&links, 1), [0]);
        links.cut(2, 0);
        links.swap_remove(2);
        assert_eq!((ends(&links, 0), ends(&links, 1)), (vec![1], vec![0]));
    }

    #[test]
    fn the_age_of_an_edge_is_how_often_its_ends_have_won_since() {
        let slot = Slot { to: 1, confirmed: u32::MAX };
        assert_eq!(slot.age([2, 5]), 8, "the counters may go round");
    }
}
