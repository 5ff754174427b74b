//! How a surface passes through a cell, for each of the 256 ways its corners lie inside or outside.
//!
//! Lorensen and Cline (1987) drew them by hand. Here they are made: each face of the cell is cut by
//! itself, around every run of corners inside, so that both cells at a face cut it alike; the cuts of
//! the six faces join to loops; and each loop is filled with triangles. A side that a triangle has
//! within its cell never lies in a face, where the next cell could have the same: so no edge of the
//! surface has more than two triangles.

use std::sync::LazyLock;

/// Edges of a cell: axis times 4 and which of the four along it.
pub(super) const N_EDGES: usize = 12;

/// How the surface passes through one kind of cell.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Case {
    /// Corners of triangles: an edge, or [`N_EDGES`] and above the middle of a loop; counter-clockwise
    /// seen from outside.
    pub(super) triangles: Vec<[u8; 3]>,
    /// The loops that need a middle.
    pub(super) middles: Vec<Vec<u8>>,
}

/// The cases; bit `c` of the place is set if corner `c` is inside.
pub(super) static CASES: LazyLock<Vec<Case>> = LazyLock::new(|| (0..=255).map(case).collect());

/// The corner an edge begins at; it ends one step along its axis.
pub(super) fn start_of(edge: usize) -> usize {
    let (axis, k) = (edge / 4, edge % 4);
    ((k & 1) << ((axis + 1) % 3)) | ((k >> 1) << ((axis + 2) % 3))
}

/// The edge between two corners that differ in one bit.
fn edge_between(a: usize, b: usize) -> u8 {
    let axis = (a ^ b).trailing_zeros() as usize;
    let start = a & b;
    let bit = |axis: usize| start >> (axis % 3) & 1;
    (4 * axis + bit(axis + 1) + 2 * bit(axis + 2)) as u8
}

/// The corners of the six faces, counter-clockwise seen from outside the cell.
fn faces() -> [[usize; 4]; 6] {
    std::array::from_fn(|i| {
        let (axis, is_far) = (i / 2, i % 2 == 1);
        let [b, c] = [1 << ((axis + 1) % 3), 1 << ((axis + 2) % 3)];
        if is_far { [0, b, b | c, c].map(|corner| corner | 1 << axis) } else { [0, c, b | c, b] }
    })
}

fn case(inside: usize) -> Case {
    let is_inside = |corner: usize| inside >> corner & 1 == 1;
    // From where the walk around a face comes inside to where it leaves again.
    let mut next = [None; N_EDGES];
    for face in faces() {
        let corner = |i: usize| face[i % 4];
        for i in 0..4 {
            if is_inside(corner(i)) || !is_inside(corner(i + 1)) {
                continue;
            }
            let mut last = i + 1;
            while is_inside(corner(last + 1)) {
                last += 1;
            }
            let enters = edge_between(corner(i), corner(i + 1));
            next[usize::from(enters)] = Some(edge_between(corner(last), corner(last + 1)));
        }
    }
    let mut case = Case::default();
    for first in 0..N_EDGES as u8 {
        let mut around = Vec::new();
        let mut edge = first;
        while let Some(following) = next[usize::from(edge)].take() {
            around.push(edge);
            edge = following;
        }
        if !around.is_empty() {
            case.fill(around);
        }
    }
    case
}

impl Case {
    fn fill(&mut self, around: Vec<u8>) {
        if let Some(triangles) = filled(&around) {
            self.triangles.extend(triangles);
            return;
        }
        let middle = (N_EDGES + self.middles.len()) as u8;
        for (i, &edge) in around.iter().enumerate() {
            self.triangles.push([edge, around[(i + 1) % around.len()], middle]);
        }
        self.middles.push(around);
    }
}

/// Triangles of a loop whose sides within the cell lie in no face; `None` if there are no such.
fn filled(around: &[u8]) -> Option<Vec<[u8; 3]>> {
    let n = around.len();
    if n == 3 {
        return Some(vec![[around[0], around[1], around[2]]]);
    }
    // The triangle over the side from the last to the first, and what is left on its two sides.
    (1..n - 1).find_map(|apex| {
        let sides = [&around[..=apex], &around[apex..]];
        let mut triangles = vec![[around[0], around[apex], around[n - 1]]];
        for side in sides.into_iter().filter(|side| side.len() > 2) {
            let is_in_a_face = share_a_face(side[0], side[side.len() - 1]);
            triangles.extend(if is_in_a_face { None } else { filled(side) }?);
        }
        Some(triangles)
    })
}

fn share_a_face(a: u8, b: u8) -> bool {
    let sides = |edge: u8| {
        let (axis, start) = (usize::from(edge) / 4, start_of(edge.into()));
        (0..3).filter(move |k| *k != axis).map(move |k| (k, start >> k & 1))
    };
    sides(a).any(|side| sides(b).any(|other| other == side))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_have_their_ends() {
        for edge in 0..N_EDGES {
            let start = start_of(edge);
            assert_eq!(usize::from(edge_between(start, start | 1 << (edge / 4))), edge);
        }
    }

    #[test]
    fn one_corner_inside_is_cut_off_by_a_triangle_that_looks_away_from_it() {
        let [triangle] = CASES[1].triangles[..] else { panic!() };
        let first = triangle.iter().position(|edge| *edge == 0).unwrap();
        let turned = [0, 1, 2].map(|i| triangle[(first + i) % 3]);
        // Along x, y, z: their ends seen from (1, 1, 1) are counter-clockwise.
        assert_eq!(turned, [0, 4, 8]);
    }

    #[test]
    fn every_side_in_a_cell_has_two_triangles_and_lies_in_no_face() {
        for (inside, case) in CASES.iter().enumerate() {
            let mut sides = std::collections::HashMap::new();
            for [a, b, c] in &case.triangles {
                for (from, to) in [(a, b), (b, c), (c, a)] {
                    let key = (*from.min(to), *from.max(to));
                    sides.entry(key).or_insert_with(Vec::new).push(from < to);
                }
            }
            for ((a, b), uses) in sides {
                let is_in_a_face = usize::from(b) < N_EDGES && share_a_face(a, b);
                if is_in_a_face {
                    assert_eq!(uses.len(), 1, "case {inside}: {a} {b} is a cut of a face");
                } else {
                    assert!(uses.len() == 2 && uses[0] != uses[1], "case {inside}: {a} {b}");
                }
            }
            let n_cut = (0..N_EDGES).filter(|&e| {
                (inside >> start_of(e) ^ inside >> (start_of(e) | 1 << (e / 4))) & 1 == 1
            });
            let mut used: Vec<u8> = case.triangles.iter().flatten().copied().collect();
            used.retain(|edge| usize::from(*edge) < N_EDGES);
            used.sort_unstable();
            used.dedup();
            assert_eq!(used.len(), n_cut.count(), "case {inside}: every cut edge has its vertex");
        }
        assert!(CASES[0].triangles.is_empty() && CASES[255].triangles.is_empty());
    }
}
