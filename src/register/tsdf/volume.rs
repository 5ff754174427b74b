//! The blocks that exist, and how they are looked at.

use super::block::{Block, Key, SIDE, place_of, step};
use super::lattice::Lattice;
use super::{TsdfError, TsdfOptions};

/// A truncated signed distance field over the blocks that frames have touched.
///
/// Its lattice has a point at the origin of the world and one every voxel along each axis.
#[derive(Debug, Clone)]
pub struct Volume {
    pub(super) lattice: Lattice,
    /// As the lattice's keys. Each in a place of its own, so that growing moves none and needs no room
    /// twice.
    pub(super) blocks: Vec<Box<Block>>,
}

impl Volume {
    /// A model of nothing yet.
    pub fn new(options: &TsdfOptions) -> Result<Self, TsdfError> {
        Ok(Self { lattice: Lattice::new(options)?, blocks: Vec::new() })
    }

    /// How it is made.
    pub fn options(&self) -> &TsdfOptions {
        &self.lattice.options
    }

    /// Blocks that exist.
    pub fn n_blocks(&self) -> usize {
        self.lattice.n_blocks()
    }

    /// What it takes [bytes].
    pub fn memory(&self) -> usize {
        self.lattice.memory()
    }

    /// Makes the blocks of `keys` that are not there yet, all of them or none; how many those were.
    pub(super) fn make(&mut self, keys: &[Key]) -> Result<usize, TsdfError> {
        let n_new = self.lattice.make(keys)?;
        self.blocks.resize_with(self.lattice.n_blocks(), Block::unknown);
        Ok(n_new)
    }

    /// A view that remembers the block it looked at last.
    pub(super) fn look(&self) -> Look<'_> {
        Look { volume: self, last: None }
    }
}

/// Reads distances; the block of the last one is at hand.
pub(super) struct Look<'a> {
    volume: &'a Volume,
    last: Option<(Key, Option<&'a Block>)>,
}

impl<'a> Look<'a> {
    fn block(&mut self, key: Key) -> Option<&'a Block> {
        match self.last {
            Some((last, block)) if last == key => block,
            _ => {
                let block = self.volume.lattice.find(&key).map(|i| &*self.volume.blocks[i]);
                self.last = Some((key, block));
                block
            }
        }
    }

    /// Block and place of a point of the lattice, where the block exists.
    pub(super) fn place(&mut self, point: [i32; 3]) -> Option<(&'a Block, usize)> {
        let (key, i) = place_of(point);
        Some((self.block(key)?, i))
    }

    /// The distance at a point of the lattice.
    pub(super) fn known(&mut self, point: [i32; 3]) -> Option<f32> {
        self.place(point).and_then(|(block, i)| block.known(i))
    }

    /// The distance at the point of the lattice nearest to `at`, counted in voxels.
    pub(super) fn nearest(&mut self, at: [f64; 3]) -> Option<f32> {
        self.known(at.map(|c| (c + 0.5).floor() as i32))
    }

    /// The distance between the points of the lattice around `at`, counted in voxels; linear along each
    /// axis. `None` where one of them is not known.
    pub(super) fn between(&mut self, at: [f64; 3]) -> Option<f32> {
        let floor = at.map(f64::floor);
        let [x, y, z] = floor.map(|c| c as i32);
        let [u, v, w] = [0, 1, 2].map(|k| (at[k] - floor[k]) as f32);
        let (key, i) = place_of([x, y, z]);
        let is_inside = [x, y, z].iter().all(|c| c & 7 != 7);
        let corners: [Option<f32>; 8] = if is_inside {
            let block = self.block(key)?;
            CORNERS.map(|[x, y, z]| block.known(i + x + SIDE * (y + SIDE * z)))
        } else {
            CORNERS.map(|corner| self.known(step([x, y, z], corner)))
        };
        let mut d = [0.0; 8];
        for (d, corner) in d.iter_mut().zip(corners) {
            *d = corner?;
        }
        let mix = |a: f32, b: f32, share: f32| a + (b - a) * share;
        let along = [0, 2, 4, 6].map(|i| mix(d[i], d[i + 1], u));
        Some(mix(mix(along[0], along[1], v), mix(along[2], along[3], v), w))
    }
}

/// The corners of a cell: bit 0 is x, bit 1 y, bit 2 z.
pub(super) const CORNERS: [[usize; 3]; 8] =
    [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0], [0, 0, 1], [1, 0, 1], [0, 1, 1], [1, 1, 1]];

#[cfg(test)]
mod tests {
    use super::super::block::{N, coords_of};
    use super::*;

    #[test]
    fn a_linear_field_is_read_exactly_across_blocks() {
        let mut volume = Volume::new(&TsdfOptions::default()).unwrap();
        let keys: Vec<Key> = CORNERS.map(|corner| step([-1; 3], corner)).to_vec();
        assert_eq!(volume.make(&keys).unwrap(), 8);
        assert_eq!(volume.make(&keys).unwrap(), 0, "they are there");
        for (key, block) in keys.iter().zip(&mut volume.blocks) {
            for i in 0..N {
                let at = step(key.map(|c| 8 * c), coords_of(i)).map(|c| c as f32);
                block.distance[i] = 0.01 * at[0] - 0.02 * at[1] + 0.03 * at[2];
                block.weight[i] = 1.0;
            }
        }
        let mut look = volume.look();
        for at in [[0.0, 0.0, 0.0], [-0.5, 3.25, 0.75], [-7.9, 6.5, -0.1], [6.9, -1.5, 2.0]] {
            let expected = 0.01 * at[0] - 0.02 * at[1] + 0.03 * at[2];
            assert!((f64::from(look.between(at).unwrap()) - expected).abs() < 1e-6, "{at:?}");
        }
        assert_eq!(look.between([7.5, 0.0, 0.0]), None, "there is no block beyond");
        assert!((look.nearest([3.4, 0.0, 0.0]).unwrap() - 0.03).abs() < 1e-6);
    }
}
