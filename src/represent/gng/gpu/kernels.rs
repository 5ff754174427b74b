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
    use crate::represent::gng::links::Slot;
    use naga::valid::{Capabilities, ValidationFlags, Validator};
    use std::mem::offset_of;

    fn module(kernel: &Kernel) -> naga::Module {
        let source = kernel.source();
        naga::front::wgsl::parse_str(&source)
            .unwrap_or_else(|error| panic!("{}: {}", kernel.name, error.emit_to_string(&source)))
    }

    #[test]
    fn every_kernel_is_valid() {
        for kernel in [winners(), learn(), insert()] {
            let mut validator = Validator::new(ValidationFlags::all(), Capabilities::empty());
            if let Err(error) = validator.validate(&module(&kernel)) {
                panic!("{}: {}", kernel.name, error.emit_to_string(&kernel.source()));
            }
        }
    }

    /// Name and offset of each member, and the size of the struct.
    fn in_wgsl(kernel: &Kernel, name: &str) -> (Vec<(String, usize)>, usize) {
        let module = module(kernel);
        let found = module.types.iter().find(|(_, found)| found.name.as_deref() == Some(name));
        let naga::TypeInner::Struct { members, span } = &found.expect(name).1.inner else {
            panic!("{name} is no struct")
        };
        let member = |m: &naga::StructMember| (m.name.clone().unwrap(), m.offset as usize);
        (members.iter().map(member).collect(), *span as usize)
    }

    macro_rules! in_rust {
        ($of:ty: $($member:ident),+) => {
            (
                vec![$((stringify!($member).to_owned(), offset_of!($of, $member))),+],
                size_of::<$of>(),
            )
        };
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
