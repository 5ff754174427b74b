//! One batch of steps after the other: the device looks, the processor settles what it found.

use super::layout::{Job, Layout, Listed};
use super::pieces::{Piece, pieces};
use super::slack::Slack;
use super::{Device, DigitizeError, Digitized, kernels, steps};
use crate::cam::digitize::{Contact, Digitizer, Found, Memory, View, indexed};
use crate::compute::{Buffer, Kernel, Pace};
use crate::progress::Progress;
use crate::tool::HeightFunction;
use fearless_simd::{Level, Simd, dispatch};
use rayon::prelude::*;
use std::time::Instant;

/// Steps a thread settles at a time.
const CHUNK: usize = 128;

/// A job on its device, ready for one batch of steps after the other.
pub(super) struct Batches<'a, H, L> {
    digitizer: &'a Digitizer<'a>,
    device: &'a Device<'a>,
    tool: &'a H,
    slack: Slack<L>,
    kernel: Kernel,
    on_device: Buffer,
    pieces: Vec<Piece>,
}

/// A batch that the device is done with.
struct Done<S> {
    views: Vec<View>,
    states: Vec<S>,
    /// Runs of the kernel that each step took.
    n_runs: u32,
}

impl<'a, H: HeightFunction, L: Layout> Batches<'a, H, L> {
    pub(super) fn new(
        digitizer: &'a Digitizer<'a>,
        device: &'a Device<'a>,
        tool: &'a H,
    ) -> Result<Self, DigitizeError> {
        let slack = Slack::new(digitizer.part, &digitizer.cutter);
        let on_device = device.gpu.upload("tool", &[L::tool(&digitizer.cutter)])?;
        let pieces = pieces::<L>(digitizer, device, slack.centre)?;
        let kernel = kernels::kernel(digitizer, device);
        Ok(Self { digitizer, device, tool, slack, kernel, on_device, pieces })
    }

    /// All batches. While the device looks at one, the processor settles the one before.
    pub(super) fn run(
        &self,
        n_positions: usize,
        views: impl Fn(usize) -> View + Sync,
        progress: &dyn Progress,
    ) -> Result<Digitized, DigitizeError> {
        let mut contacts = Vec::with_capacity(n_positions);
        let mut n_undecided = 0;
        let mut pace = Pace::new();
        let mut before: Option<Done<L::State>> = None;
        let mut from = 0;
        loop {
            let to = (from + self.device.batch.max(1)).min(n_positions);
            let views: Vec<View> = (from..to).into_par_iter().map(&views).collect();
            let settled = || before.as_ref().map(|done| self.settle(done)).unwrap_or_default();
            let searched = || self.search(&views, &mut pace, progress);
            let ((mut settled, n), found) = rayon::join(settled, searched);
            contacts.append(&mut settled);
            n_undecided += n;
            if views.is_empty() {
                return Ok(Digitized { contacts, n_undecided });
            }
            let (states, n_runs) = found?;
            before = Some(Done { views, states, n_runs });
            progress.advance((to - from) as u64)?;
            from = to;
        }
    }

    /// What the device finds at these steps, and in how many runs.
    fn search(
        &self,
        views: &[View],
        pace: &mut Pace,
        progress: &dyn Progress,
    ) -> Result<(Vec<L::State>, u32), DigitizeError> {
        if views.is_empty() {
            return Ok((Vec::new(), 0));
        }
        let (gpu, method) = (self.device.gpu, self.digitizer.method);
        let steps = steps::steps::<L>(views, &self.slack)?;
        let steps = gpu.upload("steps", &steps)?;
        let states = gpu.upload("states", &vec![L::nothing_yet(); views.len()])?;
        let mut n_runs = 0;
        for piece in &self.pieces {
            let mut begin = 0;
            while begin < piece.n_shares {
                let n =
                    (pace.n_units() / views.len() as u64).clamp(1, self.device.run as u64) as usize;
                let end = (begin + n).min(piece.n_shares);
                let job = Job {
                    n_steps: views.len() as u32,
                    begin: begin as u32,
                    end: end as u32,
                    ..piece.job
                };
                let job = gpu.upload("job", &[job])?;
                let mut buffers = vec![&job, &self.on_device, &piece.primitives, &steps, &states];
                buffers.extend(&piece.others);
                let started = Instant::now();
                let in_group = self.device.workgroup * kernels::steps_a_thread(method);
                let n_groups = (views.len() as u32).div_ceil(in_group);
                gpu.run(&self.kernel, &buffers, n_groups)?;
                pace.took(((end - begin) * views.len()) as u64, started.elapsed());
                // To be stopped between two.
                progress.advance(0)?;
                begin = end;
                n_runs += 1;
            }
        }
        Ok((gpu.download("states", &states)?, n_runs))
    }

    /// The contacts of a batch, and at how many steps the device could not decide.
    fn settle(&self, done: &Done<L::State>) -> (Vec<Option<Contact>>, usize) {
        let mut contacts = vec![None; done.views.len()];
        let n_undecided = contacts
            .par_chunks_mut(CHUNK)
            .zip(done.views.par_chunks(CHUNK))
            .zip(done.states.par_chunks(CHUNK))
            .map(|((contacts, views), states)| {
                let states = states.iter().map(|state| L::listed(state, done.n_runs));
                dispatch!(Level::new(), simd => self.settle_chunk(simd, contacts, views, states))
            })
            .sum();
        (contacts, n_undecided)
    }

    #[inline(always)]
    fn settle_chunk<S: Simd>(
        &self,
        simd: S,
        contacts: &mut [Option<Contact>],
        views: &[View],
        states: impl Iterator<Item = Listed>,
    ) -> usize {
        let (part, tool) = (self.digitizer.part, self.tool);
        let mut memory = Memory::default();
        let mut n_undecided = 0;
        for ((slot, view), listed) in contacts.iter_mut().zip(views).zip(states) {
            let found: Option<Found> = if listed.is_whole {
                let mut best = None;
                for &primitive in listed.primitives() {
                    part.try_one(simd, tool, view, primitive, &mut best);
                }
                best
            } else {
                n_undecided += 1;
                indexed::drop(simd, part, tool, view, &mut memory)
            };
            *slot = found.map(|found| found.contact(part, tool, view));
        }
        n_undecided
    }
}
