//! Where each block is kept, as a table that a kernel can look into.

use crate::register::tsdf::block::Key;

/// The table of `keys`: block and place, by hash; -1 for the place where there is none. A power of two
/// of entries, at most half of them taken, so that the next free one is near.
pub(super) fn table(keys: &[Key]) -> Vec<[i32; 4]> {
    let n_entries = (2 * keys.len()).next_power_of_two().max(2);
    let mask = n_entries - 1;
    let mut table = vec![[0, 0, 0, -1]; n_entries];
    for (slot, &[x, y, z]) in (0..).zip(keys) {
        let mut i = hash([x, y, z]) as usize & mask;
        while table[i][3] >= 0 {
            i = (i + 1) & mask;
        }
        table[i] = [x, y, z, slot];
    }
    table
}

/// `hash` of `kernels/tsdf/cast.wgsl`.
fn hash(key: Key) -> u32 {
    let stirred = |h: u32, number: i32| {
        let more = (h ^ number.cast_unsigned()).wrapping_mul(0x9e37_79b1);
        more ^ (more >> 15)
    };
    let h = key.into_iter().fold(0, stirred).wrapping_mul(0x85eb_ca6b);
    h ^ (h >> 13)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_block_is_found_near_where_its_hash_points() {
        let keys: Vec<Key> =
            (0..8000).map(|i| [i % 20 - 10, i / 20 % 20 - 10, i / 400 - 10]).collect();
        let table = table(&keys);
        assert_eq!(table.len(), 16_384);
        let mut n_probes = 0;
        for (slot, key) in (0..).zip(&keys) {
            let mut i = hash(*key) as usize & (table.len() - 1);
            while table[i][..3] != key[..] {
                assert!(table[i][3] >= 0, "{key:?} is not there");
                i = (i + 1) & (table.len() - 1);
                n_probes += 1;
            }
            assert_eq!(table[i][3], slot);
        }
        assert!(n_probes < keys.len(), "{n_probes} probes beyond the first");
        assert_eq!(super::table(&[]), [[0, 0, 0, -1]; 2]);
    }
}
