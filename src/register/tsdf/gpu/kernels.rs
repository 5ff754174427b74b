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
    use crate::compute::judge::{assert_valid, in_rust, in_wgsl};
    use crate::register::tsdf::Reading;
    use crate::register::tsdf::block::{N, SIDE};
    use crate::register::tsdf::tiles::TILE;

    #[test]
    fn every_kernel_is_valid() {
        for kernel in [integrate(), cast()] {
            assert_valid(&kernel);
        }
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
