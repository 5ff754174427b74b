//! Where a cell of a level is: bits of x, y and z in turn (Morton, 1966).

use crate::geom::Cells;

/// The place of a cell in its level. The code of the cell above is this one without its last three bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Code(pub(super) u64);

impl Code {
    /// The least depth whose root, with its middle at the origin of the cells, holds them all.
    pub(super) fn depth_of(keys: impl Iterator<Item = u64>) -> u32 {
        // -1 lies as far out as 0.
        let out = |x: i32| if x < 0 { -x } else { x + 1 } as u32;
        let farthest = keys.flat_map(Cells::along).map(out).max().unwrap_or(1);
        1 + farthest.next_power_of_two().trailing_zeros()
    }

    /// The leaf, `depth` levels below the root, that is the cell `key`.
    pub(super) fn of_cell(key: u64, depth: u32) -> Self {
        let half = 1_i32 << (depth - 1);
        Self::at(Cells::along(key).map(|x| (x + half) as u32))
    }

    /// The cell so many cells from the lowest corner of the root.
    pub(super) fn at(along: [u32; 3]) -> Self {
        let [x, y, z] = along.map(spread);
        Self(x << 2 | y << 1 | z)
    }

    /// How many cells it is from the lowest corner of the root, along each axis.
    pub(super) fn along(self) -> [u32; 3] {
        [2, 1, 0].map(|k| gather(self.0 >> k))
    }

    /// The cell above.
    pub(super) fn above(self) -> Self {
        Self(self.0 >> 3)
    }

    /// Which of the eight it is in the cell above.
    pub(super) fn octant(self) -> u8 {
        (self.0 & 7) as u8
    }
}

/// The bits of `x`, two zeros between them.
fn spread(x: u32) -> u64 {
    (0..21).fold(0, |code, bit| code | u64::from(x >> bit & 1) << (3 * bit))
}

/// Every third bit of `code`.
fn gather(code: u64) -> u32 {
    (0..21).fold(0, |x, bit| x | ((code >> (3 * bit) & 1) as u32) << bit)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Point3;

    #[test]
    fn a_code_says_where_the_cell_is() {
        for along in [[0, 0, 0], [1, 2, 3], [0x1f_ffff, 0, 0x15_5555]] {
            assert_eq!(Code::at(along).along(), along);
        }
        let code = Code::at([5, 2, 7]);
        assert_eq!((code.above().along(), code.octant()), ([2, 1, 3], 0b101));
    }

    #[test]
    fn the_root_is_no_larger_than_it_must_be() {
        let cells = Cells::new(Point3::origin(), 1.0, 100.0).unwrap();
        let depth = |x: f64| Code::depth_of([cells.key(&Point3::new(x, 0.0, 0.0))].into_iter());
        assert_eq!([0.5, -0.5, 1.5, -2.0, -2.1, 3.9, 4.0].map(depth), [1, 1, 2, 2, 3, 3, 4]);
    }
}
