//! The kernels of growing neural gas.

use crate::compute::{Kernel, Precision};

const TWO_NEAREST: &str = include_str!("../../../../kernels/common/two_nearest.wgsl");
const WINNERS: &str = include_str!("../../../../kernels/gng_winners.wgsl");
const LEARN: &str = include_str!("../../../../kernels/gng_learn.wgsl");
const INSERT: &str = include_str!("../../../../kernels/gng_insert.wgsl");

/// Threads of a workgroup: [M] found 256 best.
pub(super) const WORKGROUP: u32 = 256;

pub(super) fn winners() -> Kernel {
    kernel("gng_winners", vec![WINNERS, TWO_NEAREST])
}

pub(super) fn learn() -> Kernel {
    kernel("gng_learn", vec![LEARN, TWO_NEAREST])
}

pub(super) fn insert() -> Kernel {
    kernel("gng_insert", vec![INSERT])
}

fn kernel(name: &'static str, parts: Vec<&'static str>) -> Kernel {
    Kernel { name, parts, precision: Precision::Single, workgroup: WORKGROUP }
}

#[cfg(test)]
mod tests {
    use super::super::layout::{Answer, Batch, Insertion, Lesson, Outcome};
    use super::*;
    use crate::compute::judge::{assert_valid, in_rust, in_wgsl};
    use crate::represent::gng::links::Slot;

    #[test]
    fn every_kernel_is_valid() {
        for kernel in [winners(), learn(), insert()] {
            assert_valid(&kernel);
        }
    }

    #[test]
    fn every_struct_lies_in_memory_as_its_mirror_does() {
        let (winners, learn, insert) = (winners(), learn(), insert());
        for (kernel, name, mirror) in [
            (&winners, "Batch", in_rust!(Batch: n_neurons, begin, end, pad)),
            (&winners, "Answer", in_rust!(Answer: first, second, square, is_whole)),
            (
                &learn,
                "Lesson",
                in_rust!(
                    Lesson: n_neurons, begin, end, width, max_age, winner_rate, neighbour_rate,
                    signal_decay
                ),
            ),
            (&learn, "Outcome", in_rust!(Outcome: n_learned, is_full, distances, pad)),
            (&insert, "Insertion", in_rust!(Insertion: n_neurons, width, split_error, decay)),
            (&learn, "Slot", in_rust!(Slot: to, confirmed)),
            (&insert, "Slot", in_rust!(Slot: to, confirmed)),
        ] {
            assert_eq!(in_wgsl(kernel, name), mirror, "{name}");
        }
    }
}
