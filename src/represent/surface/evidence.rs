//! What each facet says of the two cells it parts: whether they lie on the same side of the surface.

use super::links::Links;
use crate::geom::{BEYOND, Cell, Matrix3, Point3, Vector3};
use rayon::prelude::*;
use std::f64::consts::FRAC_PI_2;

/// What a facet says that no pair of neurons speaks for, however shallow: nothing lies between.
const NOTHING_THERE: f64 = 0.1;
/// How much a facet says, by how many of its sides are pairs of neurons.
const SUPPORT: [f64; 4] = [0.0, 0.0, 0.5, 1.0];
/// The weight of a facet's area among what is polished.
const AREA: f64 = 0.2;

/// A facet between two cells.
#[derive(Debug, Clone, Copy)]
pub(super) struct Facet {
    /// The cells, the lower number first.
    pub(super) cells: [u32; 2],
    /// Above 0 if they are likely to lie on the same side, below if on opposite ones.
    pub(super) likeness: f64,
    /// Its area, in mean areas of those that all neurons speak for.
    pub(super) area: f64,
}

impl Facet {
    /// What it costs to have the surface run here.
    pub(super) fn cost(&self) -> f64 {
        self.likeness + AREA * self.area
    }
}

/// All facets.
///
/// Where balls of neighbouring cells reach deep into each other, both lie on the same side; where they hardly
/// do, a surface runs between them, if neurons speak for it. The depth is the angle under which the balls meet
/// (Amenta, Choi and Kolluri 2001). Beyond the hull, where balls are
/// half-spaces, it is that between facets.
pub(super) fn facets(points: &[Point3], cells: &[Cell], links: &Links<'_>) -> Vec<Facet> {
    let middles = cells.par_iter().map(|cell| middle_of_ball(points, cell)).collect();
    let space = Space { points, cells, links, middles };
    let of_cell = |i: usize| (0..4).map(move |k| (i, k));
    let places = (0..cells.len()).into_par_iter().flat_map_iter(of_cell);
    let mut facets: Vec<(Facet, usize)> = places.filter_map(|(i, k)| space.facet(i, k)).collect();
    let whole = facets.iter().filter(|(_, n_links)| *n_links == 3);
    let (n, sum) = whole.fold((0.0, 0.0), |(n, sum), (facet, _)| (n + 1.0, sum + facet.area));
    let mean = if sum > 0.0 { sum / n } else { 1.0 };
    for (facet, _) in &mut facets {
        facet.area /= mean;
    }
    facets.into_iter().map(|(facet, _)| facet).collect()
}

/// The cells, and what is known of them.
struct Space<'a> {
    points: &'a [Point3],
    cells: &'a [Cell],
    links: &'a Links<'a>,
    /// The middles of the balls; nothing for cells beyond the hull.
    middles: Vec<Option<Point3>>,
}

impl Space<'_> {
    /// The facet of a cell opposite to corner `k` and how many of its sides are pairs of neurons; nothing if it
    /// is the other cell's to tell of.
    fn facet(&self, i_cell: usize, k: usize) -> Option<(Facet, usize)> {
        let cell = &self.cells[i_cell];
        let outer = cell.across[k];
        if outer as usize <= i_cell {
            return None;
        }
        let cells = [i_cell as u32, outer];
        let corners = cell.facet(k);
        if corners.contains(&BEYOND) {
            let likeness = bend(self.points, cell, &self.cells[outer as usize]).max(0.0);
            return Some((Facet { cells, likeness, area: 0.0 }, 0));
        }
        let [a, b, c] = corners.map(|i| self.points[i as usize]);
        let normal = (b - a).cross(&(c - a));
        let area = normal.norm() / 2.0;
        let normal = normal / (2.0 * area).max(f64::MIN_POSITIVE);
        // Both middles lie on the axis of the facet's circle; seen from a corner they are at these slopes.
        let slope = |middle: Option<Point3>, beyond: f64| {
            let Some(middle) = middle else { return beyond };
            let out = middle - a;
            let height = normal.dot(&out);
            height.atan2((out.norm_squared() - height * height).max(0.0).sqrt())
        };
        let (here, there) = (self.middles[i_cell], self.middles[outer as usize]);
        let depth = (slope(there, FRAC_PI_2) - slope(here, -FRAC_PI_2)).cos();
        let n_links = self.links.n_of(corners);
        let support = SUPPORT[n_links];
        let likeness =
            if depth >= 0.0 { depth } else { depth * support + NOTHING_THERE * (1.0 - support) };
        Some((Facet { cells, likeness, area }, n_links))
    }
}

/// How much alike the facets of the hull face that two cells lie beyond: 1 on a flat hull.
fn bend(points: &[Point3], cell: &Cell, other: &Cell) -> f64 {
    let normal = |cell: &Cell| {
        let k = cell.corners.iter().position(|&corner| corner == BEYOND)?;
        let [a, b, c] = cell.facet(k).map(|i| points[i as usize]);
        (b - a).cross(&(c - a)).try_normalize(0.0)
    };
    normal(cell).zip(normal(other)).map_or(0.0, |(a, b)| a.dot(&b))
}

/// The middle of the ball through the corners; nothing for cells beyond the hull.
fn middle_of_ball(points: &[Point3], cell: &Cell) -> Option<Point3> {
    if cell.is_beyond() {
        return None;
    }
    let [a, b, c, d] = cell.corners.map(|i| points[i as usize]);
    let rows = [b - a, c - a, d - a];
    let [u, v, w] = rows;
    let squares = rows.map(|row| row.norm_squared());
    let sum: Vector3 =
        v.cross(&w) * squares[0] + w.cross(&u) * squares[1] + u.cross(&v) * squares[2];
    let volume = Matrix3::from_columns(&rows).determinant();
    Some(a + sum / (2.0 * volume))
}
