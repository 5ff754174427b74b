//! The kernels of the model, put together.

use crate::compute::{Kernel, Precision};

const LATTICE: &str = include_str!("../../../../kernels/tsdf/lattice.wgsl");
const INTEGRATE: &str = include_str!("../../../../kernels/tsdf/integrate.wgsl");
const CAST: &str = include_str!("../../../../kernels/tsdf/cast.wgsl");

/// Threads of a workgroup: the rows of a block.
pub(super) const WORKGROUP: u32 = 64;

/// Fuses a frame.
pub(super) fn integrate() -> Kernel {
    kernel("tsdf/integrate", INTEGRATE)
}

/// Follows rays.
pub(super) fn cast() -> Kernel {
    kernel("tsdf/cast", CAST)
}

fn kernel(name: &'static str, own: &'static str) -> Kernel {
    let parts = vec![LATTICE, own];
    Kernel { name, parts, precision: Precision::Single, workgroup: WORKGROUP }
}

#[cfg(test)]
mod tests {
    use super::super::layout::{Cast, Touched, View};
    use super::*;
    use crate::register::tsdf::Reading;
    use crate::register::tsdf::block::{N, SIDE};
    use crate::register::tsdf::tiles::TILE;
    use naga::valid::{Capabilities, ValidationFlags, Validator};
    use std::mem::offset_of;

    fn module(kernel: &Kernel) -> naga::Module {
        let source = kernel.source();
        naga::front::wgsl::parse_str(&source)
            .unwrap_or_else(|error| panic!("{}", error.emit_to_string(&source)))
    }

    #[test]
    fn every_kernel_is_valid() {
        for kernel in [integrate(), cast()] {
            let module = module(&kernel);
            let mut validator = Validator::new(ValidationFlags::all(), Capabilities::empty());
            if let Err(error) = validator.validate(&module) {
                panic!("{}: {}", kernel.name, error.emit_to_string(&kernel.source()));
            }
            assert_eq!(module.entry_points.len(), 1, "{}", kernel.name);
        }
    }

    /// Name and offset of each member, and the size of the struct.
    type Shape = (Vec<(String, usize)>, usize);

    fn in_wgsl(kernel: &Kernel, name: &str) -> Shape {
        let module = module(kernel);
        let mut types = module.types.iter().map(|(_, found)| found);
        let found = types.find(|found| found.name.as_deref() == Some(name));
        let naga::TypeInner::Struct { members, span } = &found.expect(name).inner else {
            panic!("{name} is no struct")
        };
        let member = |member: &naga::StructMember| {
            (member.name.clone().unwrap_or_default(), member.offset as usize)
        };
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
        let view = in_rust!(
            View: along_x, along_y, along_z, focal, center, size, truncation, sure, most_weight,
            most_colors, begin, end
        );
        assert_eq!(in_wgsl(&integrate(), "View"), view);
        assert_eq!(in_wgsl(&integrate(), "Touched"), in_rust!(Touched: first, slot));
        let reading = in_rust!(Reading: depth, facing, weight, color);
        assert_eq!(in_wgsl(&integrate(), "Reading"), reading);
        let job = in_rust!(
            Cast: eye, right, down, ahead, origin, focal, center, size, n_columns, mask, voxel,
            truncation, pad_a, pad_b
        );
        assert_eq!(in_wgsl(&cast(), "Cast"), job);
    }

    #[test]
    fn the_kernels_have_the_sizes_the_host_believes() {
        assert!(LATTICE.contains(&format!("SIDE = {SIDE}u;")));
        assert!(LATTICE.contains(&format!("N_POINTS = {N}u;")));
        assert!(CAST.contains(&format!("TILE = {TILE}u;")));
        assert_eq!(WORKGROUP as usize, SIDE * SIDE);
    }
}
