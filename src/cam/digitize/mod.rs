//! Virtual digitizing: where the tool stops when it comes down on the part.
//!
//! For every position of a trajectory the part is turned under the tool, and the first point to
//! touch sets the height (Morell 2014, section 4.4, algorithm 3). On triangles that point is found
//! exactly ([`touch`]): facet, edge or vertex. On a cloud it is one of its points: the thesis' mode.
//!
//! Two ways give the same contacts, bit for bit: [`exhaustive`] tries every primitive and is the
//! reference; [`indexed`] descends a tree from the last contact. The rules that make it so: an edge
//! is evaluated from its lexicographically smaller end; the greatest height wins, then the lowest
//! primitive number; in one triangle facet before edge before vertex; bounds are rounded up and only
//! what is strictly below the best is dropped. A third way, [`gpu`], has a device find what may be
//! touched and the processor decide between that: the same bits again.

mod bound;
mod exhaustive;
mod gpu;
mod indexed;
mod list;
mod part;
mod touch;
mod view;

pub(super) use bound::highest_rise;
pub use gpu::{Device, DigitizeError, Digitized};
pub(super) use indexed::{Memory, drop as drop_indexed};
pub use part::Part;
pub(super) use part::{Found, Tree};
pub use touch::ContactKind;
pub(super) use view::View;

use crate::geom::{Point3, Pose, Vector3};
use crate::progress::{Cancelled, Progress};
use crate::tool::{Cutter, HeightFunction};
use fearless_simd::{Level, Simd, dispatch};
use rayon::prelude::*;

/// Positions one thread takes at a time; the search of each starts from the one before.
const CHUNK: usize = 512;
/// The same for the method that tries every primitive: still stopped within a second.
const CHUNK_EXHAUSTIVE: usize = 8;

/// Where the tool touches the part at one position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// Motion of the attack axis, part to tool, at which it touches [mm].
    pub height: f64,
    /// The point of the part that is touched, in the part frame [mm].
    pub point: Point3,
    /// The part's unit normal there, in the part frame.
    pub normal: Vector3,
    /// Number of the triangle or point touched.
    pub primitive: u32,
    /// What of it is touched.
    pub kind: ContactKind,
}

/// How the first point to touch is found; the answers are the same.
#[derive(
    Debug,
    Clone,
    Copy,
    Default,
    PartialEq,
    Eq,
    serde::Serialize,
    serde::Deserialize,
    clap::ValueEnum,
)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// By a search tree.
    #[default]
    Indexed,
    /// By trying every primitive: the reference, slow.
    Exhaustive,
}

/// A part, a tool and a method: what it takes to find contacts.
#[derive(Debug, Clone, Copy)]
pub struct Digitizer<'a> {
    /// What is touched.
    pub part: &'a Part,
    /// What touches.
    pub cutter: Cutter,
    /// How the contact is found.
    pub method: Method,
}

impl Digitizer<'_> {
    /// The contact at each of `n_positions` positions; `None` where the tool meets nothing.
    ///
    /// `attack_from_part(i)` is the pose of the part under the tool at position `i`, the attack
    /// axis at motion 0. Positions that follow each other should lie close together; that decides
    /// the time, never the answer. All threads of the current pool work; their number changes no
    /// bit.
    pub fn run(
        &self,
        n_positions: usize,
        attack_from_part: impl Fn(usize) -> Pose + Sync,
        progress: &dyn Progress,
    ) -> Result<Vec<Option<Contact>>, Cancelled> {
        progress.start("digitizing", n_positions as u64);
        match &self.cutter {
            Cutter::Wheel(wheel) => self.fill(wheel, n_positions, attack_from_part, progress),
            Cutter::Mill(mill) => self.fill(mill, n_positions, attack_from_part, progress),
        }
    }

    fn fill<H: HeightFunction>(
        &self,
        tool: &H,
        n_positions: usize,
        attack_from_part: impl Fn(usize) -> Pose + Sync,
        progress: &dyn Progress,
    ) -> Result<Vec<Option<Contact>>, Cancelled> {
        let at_a_time = match self.method {
            Method::Indexed => CHUNK,
            Method::Exhaustive => CHUNK_EXHAUSTIVE,
        };
        let mut contacts = vec![None; n_positions];
        contacts.par_chunks_mut(at_a_time).enumerate().try_for_each(|(i_chunk, chunk)| {
            let poses = |i: usize| attack_from_part(i_chunk * at_a_time + i);
            dispatch!(Level::new(), simd => self.fill_chunk(simd, tool, chunk, poses));
            progress.advance(chunk.len() as u64)
        })?;
        Ok(contacts)
    }

    /// Inlined with all it calls, so that it is compiled for each level of vector instructions.
    /// Their width changes no bit of a contact: it only serves to bound.
    #[inline(always)]
    fn fill_chunk<S: Simd>(
        &self,
        simd: S,
        tool: &impl HeightFunction,
        chunk: &mut [Option<Contact>],
        attack_from_part: impl Fn(usize) -> Pose,
    ) {
        let mut memory = Memory::default();
        for (i, slot) in chunk.iter_mut().enumerate() {
            let view = View::new(&attack_from_part(i));
            let found = match self.method {
                Method::Indexed => indexed::drop(simd, self.part, tool, &view, &mut memory),
                Method::Exhaustive => exhaustive::drop(simd, self.part, tool, &view),
            };
            *slot = found.map(|found| found.contact(self.part, tool, &view));
        }
    }
}
