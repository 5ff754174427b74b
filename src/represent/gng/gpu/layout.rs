//! What the kernels of growing neural gas see: mirrors of their structs.

use bytemuck::{Pod, Zeroable};

/// `Batch` of `kernels/gng_winners.wgsl`.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(super) struct Batch {
    pub(super) n_neurons: u32,
    pub(super) begin: u32,
    pub(super) end: u32,
    pub(super) pad: u32,
}

/// `Answer` of `kernels/gng_winners.wgsl`.
#[derive(Debug, Clone, Copy, Default, Pod, Zeroable)]
#[repr(C)]
pub(super) struct Answer {
    pub(super) first: u32,
    pub(super) second: u32,
    pub(super) square: f32,
    pub(super) is_whole: u32,
}

/// `Lesson` of `kernels/gng_learn.wgsl`.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(super) struct Lesson {
    pub(super) n_neurons: u32,
    pub(super) begin: u32,
    pub(super) end: u32,
    pub(super) width: u32,
    pub(super) max_age: u32,
    pub(super) winner_rate: f32,
    pub(super) neighbour_rate: f32,
    pub(super) signal_decay: f32,
}

/// `Outcome` of `kernels/gng_learn.wgsl`.
#[derive(Debug, Clone, Copy, Default, Pod, Zeroable)]
#[repr(C)]
pub(super) struct Outcome {
    pub(super) n_learned: u32,
    pub(super) is_full: u32,
    pub(super) distances: f32,
    pub(super) pad: u32,
}

/// `Insertion` of `kernels/gng_insert.wgsl`.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(super) struct Insertion {
    pub(super) n_neurons: u32,
    pub(super) width: u32,
    pub(super) split_error: f32,
    pub(super) decay: f32,
}

/// A place as a kernel reads it.
pub(super) fn vec4(place: [f32; 3]) -> [f32; 4] {
    [place[0], place[1], place[2], 0.0]
}
