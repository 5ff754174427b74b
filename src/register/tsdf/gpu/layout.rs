//! Mirrors of the kernels' structs. A test beside [`kernels`](super::kernels) compares their offsets
//! with those of the WGSL.

use bytemuck::{Pod, Zeroable};

/// Mirrors `View` of `kernels/tsdf/integrate.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub(super) struct View {
    pub(super) along_x: [f32; 4],
    pub(super) along_y: [f32; 4],
    pub(super) along_z: [f32; 4],
    pub(super) focal: [f32; 2],
    pub(super) center: [f32; 2],
    pub(super) size: [u32; 2],
    pub(super) truncation: f32,
    pub(super) sure: f32,
    pub(super) most_weight: f32,
    pub(super) most_colors: u32,
    pub(super) begin: u32,
    pub(super) end: u32,
}

/// Mirrors `Touched` of `kernels/tsdf/integrate.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub(super) struct Touched {
    pub(super) first: [f32; 3],
    pub(super) slot: u32,
}

/// Mirrors `Cast` of `kernels/tsdf/cast.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub(super) struct Cast {
    pub(super) eye: [f32; 4],
    pub(super) right: [f32; 4],
    pub(super) down: [f32; 4],
    pub(super) ahead: [f32; 4],
    pub(super) origin: [i32; 4],
    pub(super) focal: [f32; 2],
    pub(super) center: [f32; 2],
    pub(super) size: [u32; 2],
    pub(super) n_columns: u32,
    pub(super) mask: u32,
    pub(super) voxel: f32,
    pub(super) truncation: f32,
    pub(super) pad_a: u32,
    pub(super) pad_b: u32,
}
