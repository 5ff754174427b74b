//! On which side of the surface each cell lies.
//!
//! Two cells, and later two regions of cells, are put together as they are likely to be: on the same side or
//! on opposite ones, whatever their common facets say most strongly, the most certain first. What comes out
//! is one region, every cell of it on one of two sides. Then single cells change sides where that is better.
//!
//! Greedy contraction of a signed graph after Keuper et al. (2015), with edges that turn a side over.

use super::evidence::Facet;
use crate::progress::{Cancelled, Progress};
use std::collections::{BTreeMap, BinaryHeap};

/// Contractions between two looks at whether to stop.
const CHUNK: u64 = 4096;

/// True for the cells on one side, false for those on the other.
pub(super) fn sides(
    n_cells: usize,
    facets: &[Facet],
    progress: &dyn Progress,
) -> Result<Vec<bool>, Cancelled> {
    progress.start("sides", n_cells as u64);
    let mut regions = Regions::of(n_cells, facets);
    let mut n_done = 0;
    while regions.contract() {
        n_done += 1;
        if n_done % CHUNK == 0 {
            progress.advance(CHUNK)?;
        }
    }
    let mut sides: Vec<bool> = (0..n_cells as u32).map(|cell| regions.find(cell).1).collect();
    polish(&mut sides, facets);
    Ok(sides)
}

struct Regions {
    /// The cell a cell hangs on, and whether it lies on the other side from that.
    parent: Vec<(u32, bool)>,
    /// What all common facets of two regions say together.
    likeness: Vec<BTreeMap<u32, f64>>,
    waiting: BinaryHeap<(u64, u32, u32)>,
}

impl Regions {
    fn of(n_cells: usize, facets: &[Facet]) -> Self {
        let parent = (0..n_cells as u32).map(|cell| (cell, false)).collect();
        let likeness = vec![BTreeMap::new(); n_cells];
        let mut regions = Self { parent, likeness, waiting: BinaryHeap::new() };
        for &Facet { cells: [a, b], likeness, .. } in facets {
            regions.add(a, b, likeness);
        }
        regions
    }

    fn add(&mut self, a: u32, b: u32, likeness: f64) {
        let sum = self.likeness[a as usize].entry(b).or_insert(0.0);
        *sum += likeness;
        let sum = *sum;
        self.likeness[b as usize].insert(a, sum);
        self.waiting.push((sum.abs().to_bits(), a.min(b), a.max(b)));
    }

    /// Puts the two regions together that say most surely how they lie; false if all are one.
    fn contract(&mut self) -> bool {
        while let Some((bits, a, b)) = self.waiting.pop() {
            // What was said since makes older entries void.
            let Some(&likeness) = self.likeness[a as usize].get(&b) else { continue };
            if likeness.abs().to_bits() != bits {
                continue;
            }
            let n = |region: u32| self.likeness[region as usize].len();
            let (kept, gone) = if n(a) < n(b) { (b, a) } else { (a, b) };
            let is_turned = likeness < 0.0;
            self.parent[gone as usize] = (kept, is_turned);
            for (other, likeness) in std::mem::take(&mut self.likeness[gone as usize]) {
                self.likeness[other as usize].remove(&gone);
                if other != kept {
                    self.add(kept, other, if is_turned { -likeness } else { likeness });
                }
            }
            return true;
        }
        false
    }

    /// The region of a cell, and whether the cell lies on the other side from what the region began with.
    fn find(&mut self, cell: u32) -> (u32, bool) {
        let mut way = Vec::new();
        let mut here = cell;
        while self.parent[here as usize].0 != here {
            way.push(here);
            here = self.parent[here as usize].0;
        }
        let mut turned = false;
        for cell in way.into_iter().rev() {
            turned ^= self.parent[cell as usize].1;
            self.parent[cell as usize] = (here, turned);
        }
        (here, turned)
    }
}

/// Cells change sides one by one as long as the surface gets cheaper.
fn polish(sides: &mut [bool], facets: &[Facet]) {
    let mut of_cell: Vec<Vec<u32>> = vec![Vec::new(); sides.len()];
    for (i, facet) in (0..).zip(facets) {
        for cell in facet.cells {
            of_cell[cell as usize].push(i);
        }
    }
    let mut waiting: Vec<u32> = (0..sides.len() as u32).rev().collect();
    while let Some(cell) = waiting.pop() {
        let around = &of_cell[cell as usize];
        let gain = |&i: &u32| {
            let facet = &facets[i as usize];
            let [a, b] = facet.cells;
            if sides[a as usize] == sides[b as usize] { -facet.cost() } else { facet.cost() }
        };
        if around.iter().map(gain).sum::<f64>() > 1e-9 {
            sides[cell as usize] = !sides[cell as usize];
            let cells = around.iter().flat_map(|&i| facets[i as usize].cells);
            waiting.extend(cells.filter(|&other| other != cell));
        }
    }
}
