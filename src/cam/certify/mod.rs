//! Between two steps: a bound of the gouge over every whole move, and the steps it takes to keep it.
//!
//! A path is exact at its positions; between them all axes interpolate linearly, and the tool may
//! sink in. Gouge is the exact height of the part less the height the tool runs through, along the
//! attack axis. [`certify`] proves of every move that it is nowhere more than allowed ([`prove`] by
//! [`sweep`] of the search tree), and puts steps in where it is ([`refine`]). ARCHITECTURE section 4
//! derives the bound.

mod certificate;
mod motion;
mod prove;
mod refine;
mod sweep;

pub use certificate::{Certificate, Lift, ShortestStep};

use super::digitize::{Contact, Digitizer, Memory, Tree};
use super::toolpath::Position;
use crate::geom::{PatchTree, Point3, Vector3, WIDTH};
use crate::machine::{AxisKind, AxisValues, MAX_AXES, Machine};
use crate::progress::{Cancelled, Progress};
use crate::tool::{Cutter, HeightFunction};
use fearless_simd::{Level, Simd, dispatch};
use motion::Lever;
use prove::Prover;
use rayon::prelude::*;
use refine::Stretch;
use std::ops::Range;
use sweep::Waiting;

/// Moves one thread takes at a time: stopped within a second, whatever they need.
const CHUNK: usize = 128;

/// What is asked of a path.
#[derive(Debug, Clone, PartialEq)]
pub struct CertifyOptions {
    /// The deepest gouge allowed anywhere [mm].
    pub gouge: f64,
    /// The words that steps put in may have.
    pub grid: Grid,
    /// No step is made shorter than this, by linear or by rotary axes [mm, rad].
    pub least_step: [f64; 2],
    /// Leave out steps that are not needed.
    pub thin: bool,
}

/// The words a control can be told: multiples of the last decimal. Where the tool is digitized only
/// at such words, what is proved of them holds for the program as written.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grid(AxisValues);

/// A path with what is proved of it.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Certified {
    /// The path.
    pub positions: Vec<Position>,
    /// What is proved.
    pub certificate: Certificate,
}

/// A path that is exact at its positions.
#[derive(Debug, Clone, Copy)]
pub struct Draft<'a, F> {
    /// The machine that runs along it.
    pub machine: &'a Machine,
    /// How many positions it has.
    pub n_positions: usize,
    /// The words at each, attack axis included, and the exact contact; `None` where the tool meets
    /// nothing, and the attack word is anybody's choice.
    pub position: F,
}

/// Proves of a path that no move gouges more than allowed, with steps put in (and left out) as that
/// needs. All threads of the current pool work; their number changes no bit.
pub fn certify<F>(
    digitizer: &Digitizer,
    draft: &Draft<F>,
    options: &CertifyOptions,
    progress: &dyn Progress,
) -> Result<Certified, Cancelled>
where
    F: Fn(usize) -> (AxisValues, Option<Contact>) + Sync,
{
    progress.start("certifying", draft.n_positions.saturating_sub(1) as u64);
    let lever = match digitizer.part.tree() {
        Tree::Triangles(tree) => Lever::new(draft.machine, corners(tree)),
        Tree::Points(tree) => Lever::new(draft.machine, corners(tree)),
    };
    let job = Job { digitizer, draft, lever, options, progress };
    match (&digitizer.cutter, digitizer.part.tree()) {
        (Cutter::Wheel(wheel), Tree::Triangles(tree)) => job.run(wheel, tree),
        (Cutter::Wheel(wheel), Tree::Points(tree)) => job.run(wheel, tree),
        (Cutter::Mill(mill), Tree::Triangles(tree)) => job.run(mill, tree),
        (Cutter::Mill(mill), Tree::Points(tree)) => job.run(mill, tree),
    }
}

struct Job<'a, F> {
    digitizer: &'a Digitizer<'a>,
    draft: &'a Draft<'a, F>,
    lever: Lever<'a>,
    options: &'a CertifyOptions,
    progress: &'a dyn Progress,
}

impl<F: Fn(usize) -> (AxisValues, Option<Contact>) + Sync> Job<'_, F> {
    fn run<const N: usize>(
        &self,
        tool: &impl HeightFunction,
        tree: &PatchTree<N>,
    ) -> Result<Certified, Cancelled> {
        let n_moves = self.draft.n_positions.saturating_sub(1);
        let stretches = (0..n_moves.div_ceil(CHUNK)).into_par_iter().map(|i_chunk| {
            let start = i_chunk * CHUNK;
            let moves = start..n_moves.min(start + CHUNK);
            let n = moves.len() as u64;
            let made = dispatch!(Level::new(), simd => self.stretch(simd, tool, tree, moves));
            self.progress.advance(n)?;
            Ok(made)
        });
        let stretches = stretches.collect::<Result<Vec<_>, Cancelled>>()?;
        Ok(self.joined(stretches))
    }

    #[inline(always)]
    fn stretch<S: Simd, const N: usize>(
        &self,
        simd: S,
        tool: &impl HeightFunction,
        tree: &PatchTree<N>,
        moves: Range<usize>,
    ) -> Certified {
        let prover = Prover {
            simd,
            part: self.digitizer.part,
            tree,
            tool,
            lever: self.lever,
            gouge: self.options.gouge,
            memory: Memory::default(),
            waiting: Waiting::default(),
            doubtful: f64::INFINITY,
        };
        // Most stretches need no step more than they have, and all wait for the last of them: none
        // takes room that it will not need.
        let positions = Vec::with_capacity(moves.len());
        let made = Certified { positions, ..Certified::default() };
        let mut stretch = Stretch { prover, options: self.options, made };
        stretch.follow(moves.len() + 1, |i| (self.draft.position)(moves.start + i));
        stretch.made.positions.shrink_to_fit();
        stretch.made
    }

    fn joined(&self, stretches: Vec<Certified>) -> Certified {
        let n = stretches.iter().map(|stretch| stretch.positions.len()).sum::<usize>();
        let mut whole = Certified::default();
        whole.positions.reserve_exact(n + 1);
        if 0 < self.draft.n_positions {
            let (words, contact) = (self.draft.position)(0);
            whole.positions.push(Position { words, touched: contact.map(|contact| contact.point) });
        }
        for mut stretch in stretches {
            whole.positions.append(&mut stretch.positions);
            whole.certificate.add(&stretch.certificate);
        }
        whole.certificate.gouge = self.options.gouge;
        whole.certificate.n_moves = whole.positions.len().saturating_sub(1);
        whole
    }
}

fn corners<const N: usize>(tree: &PatchTree<N>) -> impl Iterator<Item = Point3> {
    tree.leaves.iter().flat_map(|leaf| &leaf.corners).flat_map(|[x, y, z]| {
        (0..WIDTH)
            .map(|lane| tree.origin + Vector3::new(x[lane].into(), y[lane].into(), z[lane].into()))
    })
}

impl Grid {
    /// The grid of words with `linear` millimetres and `rotary` radians between neighbours; 0 is no
    /// grid.
    pub fn new(machine: &Machine, linear: f64, rotary: f64) -> Self {
        Self(by_kind(machine, [linear, rotary]))
    }

    /// The nearest words of the grid, but for the attack axis.
    #[must_use]
    pub fn round(&self, machine: &Machine, words: &AxisValues) -> AxisValues {
        std::array::from_fn(|i| {
            let step = self.0[i];
            let is_free = i == machine.attack || step <= 0.0;
            if is_free { words[i] } else { (words[i] / step).round() * step }
        })
    }
}

impl CertifyOptions {
    /// The position halfway, on the grid; `None` if it is closer to an end than a step may be.
    fn middle(&self, machine: &Machine, from: &AxisValues, to: &AxisValues) -> Option<AxisValues> {
        let middle = std::array::from_fn(|i| f64::midpoint(from[i], to[i]));
        let middle = self.grid.round(machine, &middle);
        let is_step = |end: &AxisValues| 1.0 <= self.step(machine, end, &middle).in_least_steps;
        (is_step(from) && is_step(to)).then_some(middle)
    }

    /// The way from one to the other in least steps; none along the attack axis.
    fn in_steps(&self, machine: &Machine, from: &AxisValues, to: &AxisValues) -> AxisValues {
        let least = by_kind(machine, self.least_step);
        let mut steps = [0.0; MAX_AXES];
        for i in (0..machine.axes.len()).filter(|&i| i != machine.attack) {
            if machine.axes[i].follows.is_none() {
                steps[i] = (to[i] - from[i]) / least[i];
            }
        }
        steps
    }

    fn step(&self, machine: &Machine, from: &AxisValues, to: &AxisValues) -> ShortestStep {
        let steps = self.in_steps(machine, from, to);
        let farthest = |kind: AxisKind| {
            let axes = machine.axes.iter().zip(steps);
            let steps = axes.filter(|(axis, _)| axis.kind == kind).map(|(_, step)| step.abs());
            steps.fold(0.0, f64::max)
        };
        let (linear, rotary) = (farthest(AxisKind::Linear), farthest(AxisKind::Rotary));
        ShortestStep {
            mm: linear * self.least_step[0],
            deg: (rotary * self.least_step[1]).to_degrees(),
            in_least_steps: linear.max(rotary),
        }
    }
}

/// `linear` for each linear axis, `rotary` for each rotary one, 0 for axes there are none.
fn by_kind(machine: &Machine, [linear, rotary]: [f64; 2]) -> AxisValues {
    let mut values = [0.0; MAX_AXES];
    for (value, axis) in values.iter_mut().zip(&machine.axes) {
        *value = if axis.kind == AxisKind::Linear { linear } else { rotary };
    }
    values
}

#[cfg(test)]
mod tests;
