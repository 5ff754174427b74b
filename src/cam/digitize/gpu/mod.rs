//! The same answer by a device: it finds what may be touched, the processor decides.
//!
//! `kernels/digitize_exhaustive.wgsl` tries every primitive at every step, as
//! [`exhaustive`](super::exhaustive) does (Morell 2014, algorithm 4); `kernels/digitize_tree.wgsl`
//! descends the tree of [`indexed`](super::indexed). Their numbers are `f32`, which at the rim of a
//! tool, where its side is upright, may be off by micrometres. So a kernel computes no heights but
//! bounds of them: for each step a floor, at which the tool is held
//! for certain, and the few primitives that may hold it as high or higher. These are evaluated here
//! in `f64` by the rules of all methods. The contacts are those of the CPU, bit for bit, whatever the
//! device, its rounding, the size of its workgroups and batches; no path is cut deeper by a device.
//!
//! # Why the bounds hold
//!
//! Let `e` be the rounding unit of the device's numbers, `M` the greatest length that enters a
//! coordinate (the part about its centre, and the centre from the tool), `T` the size of the tool. A
//! coordinate is a sum of four products of rounded numbers: whatever the order, fused or not, it is
//! off by at most `8 e M`; on a point of a triangle made of three such by at most `16 e M`.
//!
//! - *A point.* The height function falls outwards along x and along z. Evaluated at a point drawn
//!   inwards by [`Slack::across`] it is an upper bound however steep it is there, and pushed outwards
//!   a lower one; there is no slope in the argument. What the evaluation itself is off by is of two
//!   kinds. Off the rim it is a few `e T` in height, with roots to within eight units in the last place
//!   (Vulkan asks for better), and [`Slack::along`] takes 128 of them. At the rim, where the root of a
//!   difference `d` of squares turns an error of `8 e T^2` into any share of the height, `d` itself
//!   grows by `2 T` times the way inwards: 128 `e T` of it are more than that error. Roots are taken of
//!   factors, so that these differences are not lost.
//! - *A triangle.* A tangent plane of the concave height function lies above all of it, and over a
//!   triangle it is highest at a corner. Its own slopes, where arcs are touched within 0.9 of their
//!   radius, are within 64 `e` of themselves; times the lengths they meet that is [`Slack::plane`] for
//!   each unit of steepness. Boxes of the tree are bounded as the CPU does it.
//!
//! The CPU ends an edge search some 1e-10 mm short of its goal, and is off by its own roundings: below
//! [`LEAST_SLACK`] no bound is claimed, so that `f64` on the device is safe too.

mod batches;
mod kernels;
mod layout;
mod pieces;
mod slack;
mod steps;
mod subtrees;

use super::{Contact, Digitizer, View};
use crate::compute::{Compute, Gpu, GpuError, Precision};
use crate::geom::Pose;
use crate::progress::{Cancelled, Progress};
use crate::tool::Cutter;
use batches::Batches;
use layout::{Double, Single};

/// Bounds claim no more than this [mm].
const LEAST_SLACK: f64 = 1e-9;

/// Some drivers end all loops of a thread after 65,535 turns (`expect_end` of
/// `kernels/common/candidates.wgsl`); a primitive takes one, and four more where it must be looked at again.
const MOST_OF_A_RUN: usize = 12_288;

/// A device, and how it is put to work. None of it changes a bit of the answer.
#[derive(Debug, Clone, Copy)]
pub struct Device<'a> {
    /// The device.
    pub gpu: &'a Gpu,
    /// The numbers its kernels compute with.
    pub precision: Precision,
    /// Threads of a workgroup.
    pub workgroup: u32,
    /// Steps sent at once.
    pub batch: usize,
    /// Primitives that a run of a kernel tries at most, one after the other.
    pub run: usize,
    /// Bytes of the part that a kernel sees at once; what is larger goes in pieces.
    pub binding: u64,
}

/// Contacts, and how they were found.
#[derive(Debug, Clone, PartialEq)]
pub struct Digitized {
    /// The contact at each position; `None` where the tool meets nothing.
    pub contacts: Vec<Option<Contact>>,
    /// Positions at which too much lay equally high for the device, or its driver ended it before its
    /// time, so that the processor searched on its own.
    pub n_undecided: usize,
}

/// Why a device found no contacts.
#[derive(Debug, thiserror::Error)]
pub enum DigitizeError {
    /// The device cannot.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// The part lies where the device's numbers end.
    #[error(
        "the part reaches {far:.1e} mm away from the tool, too far to compute in f32; check its units, or \
         use --compute cpu"
    )]
    TooFar {
        /// How far [mm].
        far: f64,
    },
    /// The caller asked to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl<'a> Device<'a> {
    /// The device, put to work in the usual way.
    pub fn new(gpu: &'a Gpu) -> Self {
        Self {
            gpu,
            precision: Precision::Single,
            workgroup: 64,
            batch: 8192,
            run: MOST_OF_A_RUN,
            binding: gpu.largest_binding(),
        }
    }
}

impl Digitizer<'_> {
    /// The same as [`run`](Self::run) on what `compute` says.
    pub fn run_on(
        &self,
        compute: &Compute,
        n_positions: usize,
        attack_from_part: impl Fn(usize) -> Pose + Sync,
        progress: &dyn Progress,
    ) -> Result<Digitized, DigitizeError> {
        match compute {
            Compute::Cpu => {
                let contacts = self.run(n_positions, attack_from_part, progress)?;
                Ok(Digitized { contacts, n_undecided: 0 })
            }
            Compute::Gpu(gpu) => {
                self.run_on_gpu(&Device::new(gpu), n_positions, attack_from_part, progress)
            }
        }
    }

    /// The same as [`run`](Self::run) on a device, by the same method.
    pub fn run_on_gpu(
        &self,
        device: &Device,
        n_positions: usize,
        attack_from_part: impl Fn(usize) -> Pose + Sync,
        progress: &dyn Progress,
    ) -> Result<Digitized, DigitizeError> {
        progress.start("digitizing", n_positions as u64);
        let views = |i| View::new(&attack_from_part(i));
        match (&self.cutter, device.precision) {
            (Cutter::Wheel(tool), Precision::Single) => {
                Batches::<_, Single>::new(self, device, tool)?.run(n_positions, views, progress)
            }
            (Cutter::Wheel(tool), Precision::Double) => {
                Batches::<_, Double>::new(self, device, tool)?.run(n_positions, views, progress)
            }
            (Cutter::Mill(tool), Precision::Single) => {
                Batches::<_, Single>::new(self, device, tool)?.run(n_positions, views, progress)
            }
            (Cutter::Mill(tool), Precision::Double) => {
                Batches::<_, Double>::new(self, device, tool)?.run(n_positions, views, progress)
            }
        }
    }
}
