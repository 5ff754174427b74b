//! A cube of the lattice, and where it lies.

use std::hash::{BuildHasherDefault, Hasher};

/// Lattice points along the side of a block.
pub const SIDE: usize = 8;
/// Lattice points of a block.
pub(super) const N: usize = SIDE * SIDE * SIDE;

/// What is known about `SIDE`^3 points of the lattice, x fastest, then y.
///
/// Plain arrays of four and eight bytes a point: a kernel can have them as they are.
#[repr(C)]
#[derive(Debug, Clone, PartialEq)]
pub struct Block {
    /// Mean distance from the surface, positive before it; 1 is the truncation.
    pub distance: [f32; N],
    /// Sum of the weights of the readings; 0 where there was none.
    pub weight: [f32; N],
    /// Mean red, green and blue in steps of 1/256, and of how many readings it is (255 at most).
    pub color: [[u16; 4]; N],
}

impl Block {
    /// A block about which nothing is known.
    pub(super) fn unknown() -> Box<Self> {
        Box::new(Self { distance: [0.0; N], weight: [0.0; N], color: [[0; 4]; N] })
    }

    /// The distance at a point that a reading has told something about.
    pub(super) fn known(&self, i: usize) -> Option<f32> {
        (self.weight[i] > 0.0).then(|| self.distance[i])
    }
}

/// Which block: its first lattice point over `SIDE`.
pub(super) type Key = [i32; 3];

/// The block of a lattice point, and the point's place in it.
pub(super) fn place_of([x, y, z]: [i32; 3]) -> (Key, usize) {
    // Arithmetic shift and mask round down, below zero too.
    let within = [x, y, z].map(|c| (c & 7) as usize);
    ([x >> 3, y >> 3, z >> 3], index_of(within))
}

/// The place of a point in its block.
pub(super) fn index_of([x, y, z]: [usize; 3]) -> usize {
    x + SIDE * (y + SIDE * z)
}

/// The point of the lattice `by` steps on.
pub(super) fn step(point: [i32; 3], by: [usize; 3]) -> [i32; 3] {
    // Steps stay within a block and its neighbour.
    [0, 1, 2].map(|k| point[k] + i32::from(by[k] as u8))
}

/// Where a place lies in its block.
pub(super) fn coords_of(i: usize) -> [usize; 3] {
    [i % SIDE, i / SIDE % SIDE, i / (SIDE * SIDE)]
}

/// Hashes the three numbers of a [`Key`]: looked up millions of times a frame, and nobody who attacks
/// chooses them.
#[derive(Default)]
pub(super) struct KeyHasher(u64);

/// For maps by [`Key`].
pub(super) type ByKey = BuildHasherDefault<KeyHasher>;

impl Hasher for KeyHasher {
    fn finish(&self) -> u64 {
        // The table takes the upper bits and the lowest ones.
        self.0 ^ (self.0 >> 29)
    }

    fn write(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.write_u32(u32::from(*byte));
        }
    }

    fn write_u32(&mut self, number: u32) {
        self.0 = (self.0.rotate_left(21) ^ u64::from(number)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    }

    fn write_i32(&mut self, number: i32) {
        self.write_u32(number as u32);
    }

    // The length of the array is the same for all.
    fn write_usize(&mut self, _number: usize) {}
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_below_zero_have_their_block_too() {
        assert_eq!(place_of([0, 7, 8]), ([0, 0, 1], index_of([0, 7, 0])));
        assert_eq!(place_of([-1, -8, -9]), ([-1, -1, -2], index_of([7, 0, 7])));
        assert_eq!(coords_of(index_of([3, 5, 6])), [3, 5, 6]);
    }

    #[test]
    fn neighbouring_keys_hash_apart() {
        use std::hash::BuildHasher;
        let hashes = (0..8_000).map(|i| [i % 20 - 10, i / 20 % 20 - 10, i / 400 - 10]);
        let mut hashes: Vec<u64> =
            hashes.map(|key: Key| ByKey::default().hash_one(key) & 0xffff).collect();
        hashes.sort_unstable();
        hashes.dedup();
        // 8000 draws from 65536 leave about 7530 different ones.
        assert!(hashes.len() > 7000, "{}", hashes.len());
    }
}
