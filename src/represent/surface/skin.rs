//! The triangles between the two sides, and how they hang together.

use super::links::Links;
use crate::geom::{BEYOND, Cell, Point3};

/// Triangles over the neurons, wound counter-clockwise as seen from the side of the `false` cells.
pub(super) struct Skin {
    pub(super) faces: Vec<Face>,
}

/// A triangle of the surface.
#[derive(Debug, Clone, Copy)]
pub(super) struct Face {
    /// Its neurons.
    pub(super) corners: [u32; 3],
    /// The face beyond each side, that from corner `i` to the next; nothing where the surface ends.
    pub(super) beyond: [Option<u32>; 3],
    /// Which sides span no gap.
    pub(super) whole: [bool; 3],
}

impl Face {
    /// The side from corner `i` to the next.
    pub(super) fn side(&self, i: usize) -> [u32; 2] {
        [self.corners[i], self.corners[(i + 1) % 3]]
    }

    /// True if no side spans a gap.
    pub(super) fn is_whole(&self) -> bool {
        self.whole == [true; 3]
    }
}

impl Skin {
    /// What lies between the cells of both sides.
    ///
    /// Where more than two faces meet in an edge, those are neighbours that have the same wedge of `true`
    /// cells between them: pieces that touch stay pieces.
    pub(super) fn between(cells: &[Cell], sides: &[bool], links: &Links<'_>) -> Self {
        let is_face = |cell: u32, k: usize| {
            let cell = &cells[cell as usize];
            !sides[cell.across[k] as usize] && !cell.facet(k).contains(&BEYOND)
        };
        let within = (0..cells.len() as u32).filter(|&cell| sides[cell as usize]);
        let all = within.flat_map(|cell| (0..4).map(move |k| (cell, k)));
        let places: Vec<(u32, usize)> = all.filter(|&(cell, k)| is_face(cell, k)).collect();
        let mate = |cell: u32, k: usize, side: [u32; 2]| {
            let place = turn_about(cells, sides, cell, k, side);
            is_face(place.0, place.1)
                .then(|| places.binary_search(&place).ok().map(|i| i as u32))?
        };
        let face = |&(cell, k): &(u32, usize)| {
            let corners = cells[cell as usize].facet(k);
            let sides = [0, 1, 2].map(|i| [corners[i], corners[(i + 1) % 3]]);
            let beyond = sides.map(|side| mate(cell, k, side));
            Face { corners, beyond, whole: sides.map(|[a, b]| links.span_no_gap(a, b)) }
        };
        Self { faces: places.iter().map(face).collect() }
    }

    /// Faces that hang together, found over the sides that `holds` accepts, in order.
    pub(super) fn pieces(&self, holds: impl Fn(&Face, usize) -> bool) -> Vec<Vec<u32>> {
        let mut is_done = vec![false; self.faces.len()];
        let mut pieces = Vec::new();
        for first in 0..self.faces.len() as u32 {
            if std::mem::replace(&mut is_done[first as usize], true) {
                continue;
            }
            let mut piece = vec![first];
            let mut next = 0;
            while let Some(&here) = piece.get(next) {
                next += 1;
                let face = &self.faces[here as usize];
                for i in 0..3 {
                    let Some(there) = face.beyond[i].filter(|_| holds(face, i)) else { continue };
                    if !std::mem::replace(&mut is_done[there as usize], true) {
                        piece.push(there);
                    }
                }
            }
            pieces.push(piece);
        }
        pieces
    }

    /// The skin without the faces that are not `kept`.
    #[must_use]
    pub(super) fn only(self, kept: &[bool]) -> Self {
        let mut n = 0;
        let number = |&is_kept: &bool| is_kept.then(|| (n, n += 1).0);
        let places: Vec<Option<u32>> = kept.iter().map(number).collect();
        let faces = self.faces.into_iter().zip(kept).filter(|(_, is_kept)| **is_kept);
        let place = |face: Option<u32>| face.and_then(|face| places[face as usize]);
        let faces = faces.map(|(face, _)| Face { beyond: face.beyond.map(place), ..face });
        Self { faces: faces.collect() }
    }

    /// Turned over.
    #[must_use]
    pub(super) fn turned(mut self, faces: &[u32]) -> Self {
        for &face in faces {
            let Face { corners, beyond, whole } = &mut self.faces[face as usize];
            corners.swap(0, 1);
            beyond.swap(1, 2);
            whole.swap(1, 2);
        }
        self
    }

    /// How long the rim of some faces is: sides that `is_within` says are not between two of them [mm].
    pub(super) fn rim(
        &self,
        points: &[Point3],
        piece: &[u32],
        is_within: impl Fn(&Face, usize) -> bool,
    ) -> f64 {
        let faces = piece.iter().map(|&face| &self.faces[face as usize]);
        let sides = faces.flat_map(|face| (0..3).map(move |i| (face, i)));
        let length = |(face, i): (&Face, usize)| {
            let [a, b] = face.side(i).map(|corner| points[corner as usize]);
            (a - b).norm()
        };
        sides.filter(|(face, i)| !is_within(face, *i)).map(length).sum()
    }
}

/// The next place where the sides change, going round the edge `side` from facet `k` of `cell` through cells
/// on the same side as that.
fn turn_about(cells: &[Cell], sides: &[bool], cell: u32, k: usize, side: [u32; 2]) -> (u32, usize) {
    let (mut here, mut behind) = (cell, cells[cell as usize].corners[k]);
    loop {
        let Cell { corners, across } = &cells[here as usize];
        let is_out = |corner: &u32| *corner != behind && !side.contains(corner);
        let out = corners.iter().position(is_out).unwrap_or(k);
        let there = across[out];
        if sides[there as usize] != sides[here as usize] {
            return (here, out);
        }
        let next = &cells[there as usize];
        let back = next.across.iter().position(|&cell| cell == here).unwrap_or(0);
        (here, behind) = (there, next.corners[back]);
    }
}
