//! Which blocks there are.

use super::block::{Block, ByKey, Key};
use super::touch::touched;
use super::{Readings, TsdfError, TsdfOptions};
use crate::geom::Pose;
use std::collections::HashMap;

/// The blocks that frames have touched, wherever it is that they are kept.
///
/// The lattice has a point at the origin of the world and one every voxel along each axis.
#[derive(Debug, Clone)]
pub(super) struct Lattice {
    pub(super) options: TsdfOptions,
    /// In the order they came; those of one frame by their keys.
    pub(super) keys: Vec<Key>,
    index: HashMap<Key, u32, ByKey>,
    most_blocks: usize,
}

/// What a block takes besides itself: key, place, and its entry in a table that is never full.
const BESIDES: usize = 60;
/// Lattice points are counted up to here: well within `i32`.
const FARTHEST: f64 = 5e8;

impl Lattice {
    /// Without any block.
    pub(super) fn new(options: &TsdfOptions) -> Result<Self, TsdfError> {
        options.check()?;
        let most_blocks = (options.memory << 20) / (size_of::<Block>() + BESIDES);
        Ok(Self {
            options: options.clone(),
            keys: Vec::new(),
            index: HashMap::default(),
            most_blocks: most_blocks.min(u32::MAX as usize),
        })
    }

    /// How many there are.
    pub(super) fn n_blocks(&self) -> usize {
        self.keys.len()
    }

    /// What that many blocks take [bytes].
    pub(super) fn memory(&self) -> usize {
        self.n_blocks() * (size_of::<Block>() + BESIDES)
    }

    /// The place of a block among all.
    pub(super) fn find(&self, key: &Key) -> Option<usize> {
        self.index.get(key).map(|i| *i as usize)
    }

    /// The blocks that a frame has something to say about, taken from `world_from_camera`.
    pub(super) fn touched(
        &self,
        readings: &Readings,
        world_from_camera: &Pose,
    ) -> Result<Vec<Key>, TsdfError> {
        let voxel = self.options.voxel;
        let reach = self.options.max_depth + self.options.truncation();
        let distance = world_from_camera.translation.vector.amax();
        // A comparison that NaN fails.
        let is_within = distance + 2.0 * reach < FARTHEST * voxel;
        if !is_within {
            return Err(TsdfError::TooFar { distance, voxel });
        }
        Ok(touched(readings, world_from_camera, &self.options))
    }

    /// Refuses more blocks than the memory holds that the options allow.
    pub(super) fn allows(&self, n_blocks: usize) -> Result<(), TsdfError> {
        if n_blocks > self.most_blocks {
            let needed = (n_blocks * (size_of::<Block>() + BESIDES)).div_ceil(1 << 20);
            return Err(TsdfError::Memory { needed, allowed: self.options.memory });
        }
        Ok(())
    }

    /// Numbers the blocks of `keys` that are not there yet, all of them or none; how many those were.
    pub(super) fn make(&mut self, keys: &[Key]) -> Result<usize, TsdfError> {
        let is_new = |key: &&Key| !self.index.contains_key(*key);
        let fresh: Vec<Key> = keys.iter().filter(is_new).copied().collect();
        let n_blocks = self.n_blocks() + fresh.len();
        self.allows(n_blocks)?;
        for key in &fresh {
            self.index.insert(*key, self.keys.len() as u32);
            self.keys.push(*key);
        }
        Ok(fresh.len())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_model_too_large_is_refused_and_left_as_it_was() {
        let options = TsdfOptions { memory: 1, ..TsdfOptions::default() };
        let mut lattice = Lattice::new(&options).unwrap();
        let keys = |n: i32| (0..n).map(|x| [x, 0, 0]).collect::<Vec<Key>>();
        assert_eq!(lattice.make(&keys(100)).unwrap(), 100);
        assert_eq!(lattice.make(&keys(100)).unwrap(), 0, "they are there");
        let error = lattice.make(&keys(1000)).unwrap_err();
        assert_eq!(error, TsdfError::Memory { needed: 8, allowed: 1 });
        assert!(lattice.n_blocks() == 100 && lattice.memory() < 1 << 20);
    }
}
