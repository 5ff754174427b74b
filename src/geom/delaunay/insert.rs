//! One more point: the cells whose balls hold it make way for cells that end in it.

use super::{BEYOND, Cell};
use crate::geom::Point3;
use robust::{Coord3D, insphere, orient3d};

/// Tetrahedra under way.
pub(super) struct Insertion<'a> {
    points: &'a [Point3],
    cells: Vec<Cell>,
    /// Slots of cells that made way.
    free: Vec<u32>,
    /// What each cell was last found to be, and for which insertion.
    found: Vec<(u32, Role)>,
    n_insertions: u32,
    /// Where the next search begins.
    last: u32,
    cavity: Vec<u32>,
    /// New facets that wait for the cell on their other side, by the edge they share with the cavity's rim.
    seams: Vec<([u32; 2], u32, u8)>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Role {
    Holds,
    Stays,
    Free,
}

impl<'a> Insertion<'a> {
    /// Begins with the first four points of `order` that span a body, and hands back the others.
    pub(super) fn begin(points: &'a [Point3], order: &[u32]) -> Option<(Self, Vec<u32>)> {
        let mut corners = first_four(points, order)?;
        let rest = order.iter().copied().filter(|i| !corners.contains(i)).collect();
        if volume_sign(&corners.map(|i| points[i as usize])) < 0.0 {
            corners.swap(0, 1);
        }
        let [a, b, c, d] = corners;
        // Cell 0 is the tetrahedron, cell i + 1 lies beyond its facet i, turned over: wound as seen from there.
        let beyond = [[BEYOND, b, d, c], [a, BEYOND, d, c], [a, d, BEYOND, b], [a, c, b, BEYOND]];
        let mut cells = vec![Cell { corners, across: [1, 2, 3, 4] }];
        cells.extend(beyond.map(|corners| Cell { corners, across: [0; 4] }));
        for cell in &mut cells[1..] {
            // Across the facet opposite to a corner of the tetrahedron lies what lacks that corner too.
            let place = |c: u32| corners.iter().position(|&corner| corner == c);
            cell.across = cell.corners.map(|c| place(c).map_or(0, |i| i as u32 + 1));
        }
        let found = vec![(0, Role::Stays); cells.len()];
        let (free, cavity, seams) = Default::default();
        let n_insertions = 0;
        Some((Self { points, cells, free, found, n_insertions, last: 0, cavity, seams }, rest))
    }

    /// Adds a point that is none of the corners yet.
    pub(super) fn insert(&mut self, i_point: u32) {
        self.n_insertions += 1;
        let point = self.points[i_point as usize];
        let start = self.locate(&point);
        self.hollow(start, &point);
        self.seams.clear();
        for i in 0..self.cavity.len() {
            let cell = self.cells[self.cavity[i] as usize];
            for k in 0..4 {
                let outer = cell.across[k];
                if self.role(outer) == Some(Role::Stays) {
                    let mut corners = cell.corners;
                    corners[k] = i_point;
                    self.add(corners, k, outer, self.cavity[i]);
                }
            }
        }
        self.sew();
        for &old in &self.cavity {
            self.found[old as usize].1 = Role::Free;
        }
        self.free.append(&mut self.cavity);
    }

    /// All cells, without gaps.
    pub(super) fn into_cells(self) -> Vec<Cell> {
        let mut places = vec![0; self.cells.len()];
        let is_used = |i: usize| self.found[i].1 != Role::Free;
        let used = (0..self.cells.len()).filter(|&i| is_used(i));
        for (place, i) in (0..).zip(used.clone()) {
            places[i] = place;
        }
        used.map(|i| self.cells[i])
            .map(|cell| Cell { across: cell.across.map(|i| places[i as usize]), ..cell })
            .collect()
    }

    /// A cell whose ball holds `point`: the one it lies in, found by walking towards it.
    fn locate(&self, point: &Point3) -> u32 {
        let mut here = self.last;
        if let Some(k) = self.cells[here as usize].corners.iter().position(|&c| c == BEYOND) {
            here = self.cells[here as usize].across[k];
        }
        'walk: loop {
            let cell = &self.cells[here as usize];
            if cell.is_beyond() {
                return here;
            }
            let corners = cell.corners.map(|i| self.points[i as usize]);
            for k in 0..4 {
                let mut seen = corners;
                seen[k] = *point;
                if volume_sign(&seen) < 0.0 {
                    here = cell.across[k];
                    continue 'walk;
                }
            }
            return here;
        }
    }

    /// Collects the cells whose balls hold `point`; they hang together.
    fn hollow(&mut self, start: u32, point: &Point3) {
        self.cavity.clear();
        self.cavity.push(start);
        self.found[start as usize] = (self.n_insertions, Role::Holds);
        let mut next = 0;
        while let Some(&here) = self.cavity.get(next) {
            next += 1;
            for outer in self.cells[here as usize].across {
                if self.role(outer).is_none() {
                    let holds = self.holds(outer, point);
                    let role = if holds { Role::Holds } else { Role::Stays };
                    self.found[outer as usize] = (self.n_insertions, role);
                    if holds {
                        self.cavity.push(outer);
                    }
                }
            }
        }
    }

    /// What `cell` was found to be for this point.
    fn role(&self, cell: u32) -> Option<Role> {
        let (when, role) = self.found[cell as usize];
        (when == self.n_insertions).then_some(role)
    }

    /// True if the ball of `cell` holds `point`; beyond the hull the ball is a half-space.
    fn holds(&self, cell: u32, point: &Point3) -> bool {
        let cell = &self.cells[cell as usize];
        if let Some(k) = cell.corners.iter().position(|&c| c == BEYOND) {
            let corner =
                |i: usize| if i == k { *point } else { self.points[cell.corners[i] as usize] };
            let side = volume_sign(&std::array::from_fn(corner));
            // In the plane of the facet the ball is that of its circle, which the cell inside has too.
            return side > 0.0 || (side == 0.0 && self.holds(cell.across[k], point));
        }
        in_ball(&cell.corners.map(|i| self.points[i as usize]), point) > 0.0
    }

    /// Puts a new cell into a free slot; its facet `k` closes against `outer`, where `old` was.
    fn add(&mut self, corners: [u32; 4], k: usize, outer: u32, old: u32) {
        let cell = Cell { corners, across: [u32::MAX; 4] };
        let place = if let Some(place) = self.free.pop() {
            self.cells[place as usize] = cell;
            place
        } else {
            self.cells.push(cell);
            self.found.push((0, Role::Stays));
            self.cells.len() as u32 - 1
        };
        // A new cell takes no part in this insertion.
        self.found[place as usize] = (0, Role::Stays);
        self.cells[place as usize].across[k] = outer;
        for back in &mut self.cells[outer as usize].across {
            if *back == old {
                *back = place;
                break;
            }
        }
        for i in (0..4).filter(|&i| i != k) {
            let mut edge = (0..4).filter(|&j| j != i && j != k).map(|j| corners[j]);
            if let (Some(a), Some(b)) = (edge.next(), edge.next()) {
                self.seams.push(([a.min(b), a.max(b)], place, i as u8));
            }
        }
        self.last = place;
    }

    /// Joins the new cells where they share a facet.
    fn sew(&mut self) {
        self.seams.sort_unstable();
        for pair in self.seams.chunks_exact(2) {
            let [(_, a, i), (_, b, j)] = [pair[0], pair[1]];
            self.cells[a as usize].across[i as usize] = b;
            self.cells[b as usize].across[j as usize] = a;
        }
    }
}

/// Four points that span a body, the first of them the first of `order`.
fn first_four(points: &[Point3], order: &[u32]) -> Option<[u32; 4]> {
    let at = |i: u32| points[i as usize];
    let (&a, rest) = order.split_first()?;
    let &b = rest.first()?;
    // Off the line, seen along any axis, is off the line.
    let is_off = |c: u32| {
        let [a, b, c] = [at(a), at(b), at(c)];
        [[0, 1], [1, 2], [2, 0]].iter().any(|&[x, y]| {
            let flat = |p: &Point3| robust::Coord { x: p[x], y: p[y] };
            robust::orient2d(flat(&a), flat(&b), flat(&c)) != 0.0
        })
    };
    let c = rest.iter().copied().find(|&c| is_off(c))?;
    let d = rest.iter().copied().find(|&d| volume_sign(&[at(a), at(b), at(c), at(d)]) != 0.0)?;
    Some([a, b, c, d])
}

/// Above 0 for corners wound as those of cells are.
pub(super) fn volume_sign(corners: &[Point3; 4]) -> f64 {
    let [a, b, c, d] = corners.each_ref().map(coordinates);
    orient3d(a, b, c, d)
}

/// Above 0 if `point` lies inside the ball around the corners of a cell.
pub(super) fn in_ball(corners: &[Point3; 4], point: &Point3) -> f64 {
    let [a, b, c, d] = corners.each_ref().map(coordinates);
    insphere(a, b, c, d, coordinates(point))
}

fn coordinates(p: &Point3) -> Coord3D<f64> {
    Coord3D { x: p.x, y: p.y, z: p.z }
}
