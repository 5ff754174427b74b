//! A list that takes the survivors of sixteen lanes without looking how many there are.
//!
//! The search has one or two survivors at a time, never foreseeable which: a branch for each would
//! cost as much as the bounds themselves.

use crate::geom::WIDTH;

/// Lanes written without a look; more of them at once are rare.
const USUAL: u32 = 3;

/// What waits. Space beyond `len` is scratch, so that items can be written before they are counted.
#[derive(Debug, Default)]
pub(super) struct List<T> {
    items: Vec<T>,
    len: usize,
}

impl<T: Copy + Default> List<T> {
    /// What waits.
    #[inline(always)]
    pub(super) fn items(&self) -> &[T] {
        &self.items[..self.len]
    }

    #[inline(always)]
    pub(super) fn clear(&mut self) {
        self.len = 0;
    }

    /// Adds `item` if it `is_wanted`.
    #[inline(always)]
    pub(super) fn push_if(&mut self, is_wanted: bool, item: T) {
        self.make_room();
        self.items[self.len] = item;
        self.len += usize::from(is_wanted);
    }

    /// Adds the item of every lane whose bit is set in `lanes`.
    #[inline(always)]
    pub(super) fn push_lanes(&mut self, mut lanes: u64, item: impl Fn(usize) -> T) {
        self.make_room();
        let n_lanes = lanes.count_ones();
        let space = &mut self.items[self.len..self.len + WIDTH];
        for i in 0..n_lanes.max(USUAL) as usize {
            space[i % WIDTH] = item(lanes.trailing_zeros() as usize % WIDTH);
            lanes &= lanes.wrapping_sub(1);
        }
        self.len += n_lanes as usize;
    }

    /// All of them; none wait any longer.
    #[inline(always)]
    pub(super) fn drain(&mut self) -> &[T] {
        let len = std::mem::take(&mut self.len);
        &self.items[..len]
    }

    #[inline(always)]
    fn make_room(&mut self) {
        if self.items.len() < self.len + WIDTH {
            self.items.resize(2 * self.items.len() + WIDTH, T::default());
        }
    }
}

impl<T> List<(f32, T)> {
    /// Swaps the item of the greatest number to the front.
    #[inline(always)]
    pub(super) fn bring_highest_to_front(&mut self) {
        let mut top = 0;
        for i in 1..self.len {
            if self.items[top].0 < self.items[i].0 {
                top = i;
            }
        }
        if 0 < top {
            self.items.swap(0, top);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn takes_the_lanes_asked_for_in_their_order() {
        let mut list = List::default();
        list.push_lanes(0b1001, |lane| lane);
        list.push_lanes(0, |lane| lane);
        list.push_if(false, 77);
        list.push_if(true, 78);
        list.push_lanes(0xffff, |lane| 100 + lane);
        let expected: Vec<usize> = [0, 3, 78].into_iter().chain(100..116).collect();
        assert_eq!(list.drain(), expected);
        assert!(list.drain().is_empty());
    }

    #[test]
    fn brings_the_highest_to_the_front_and_keeps_the_rest() {
        let mut list = List::default();
        list.bring_highest_to_front();
        for item in [(1.0, 'a'), (3.0, 'b'), (2.0, 'c')] {
            list.push_if(true, item);
        }
        list.bring_highest_to_front();
        assert_eq!(list.drain(), [(3.0, 'b'), (1.0, 'a'), (2.0, 'c')]);
    }
}
