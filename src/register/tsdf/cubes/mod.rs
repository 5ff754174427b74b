//! Marching cubes: the surface where the distance is 0.
//!
//! Vertices are shared, over the borders of blocks too; where all corners are known the surface has no
//! cracks, and it ends where something is not known.

mod table;

use super::block::{Key, SIDE, coords_of, index_of, step};
use super::volume::{CORNERS, Look};
use super::{TsdfError, Volume};
use crate::geom::{Point3, TriMesh};
use rayon::prelude::*;
use table::{CASES, N_EDGES, start_of};

/// Which vertex: block, lattice point and, in three bits, the axis of the edge or (from 3 on) which
/// middle of the cell.
type VertexKey = u64;
const POINT_BITS: u32 = 12;
const KIND_BITS: u32 = 3;
/// Kinds below are axes.
const MIDDLE: u64 = 3;

/// Vertices keep this share of an edge away from its ends: two in one place would leave triangles
/// without area, and open edges once a file has rounded them.
const MARGIN: f64 = 1e-3;

/// Lattice points along the side of a block with the first ones of the next.
const WIDE: usize = SIDE + 1;

impl Volume {
    /// The surface, counter-clockwise seen from outside, with colours if there were any.
    ///
    /// The same for any number of threads. [`TsdfError::Option`] if it has more vertices than an index
    /// can tell apart.
    pub fn mesh(&self) -> Result<TriMesh, TsdfError> {
        let of_blocks: Vec<Vec<[VertexKey; 3]>> =
            (0..self.n_blocks()).into_par_iter().map(|i| self.triangles(i)).collect();
        let corners = of_blocks.concat();
        let mut vertices: Vec<VertexKey> = corners.par_iter().flatten_iter().copied().collect();
        vertices.par_sort_unstable();
        vertices.dedup();
        if vertices.len() > u32::MAX as usize {
            let must = "greater: the surface has more vertices than can be counted";
            return Err(TsdfError::Option { option: "--voxel", value: self.options().voxel, must });
        }
        // Every key is there: it comes from the same list.
        let number = |key: &VertexKey| vertices.partition_point(|other| other < key) as u32;
        let triangles = corners.par_iter().map(|corners| corners.each_ref().map(number)).collect();
        let at = |key: &VertexKey| self.vertex(&mut self.look(), *key);
        let (points, colors): (Vec<Point3>, Vec<Option<[u8; 3]>>) =
            vertices.par_iter().map(at).unzip();
        let colors = colors.iter().any(Option::is_some).then(|| {
            let grey = [128; 3];
            colors.iter().map(|color| color.unwrap_or(grey)).collect()
        });
        Ok(TriMesh { points, triangles, normals: None, colors })
    }

    /// The triangles of the cells that begin in a block.
    fn triangles(&self, i_block: usize) -> Vec<[VertexKey; 3]> {
        let around = Around::of(self, i_block);
        let mut triangles = Vec::new();
        for i in 0..SIDE * SIDE * SIDE {
            let [x, y, z] = coords_of(i);
            let corner = |c: usize| {
                let [dx, dy, dz] = CORNERS[c];
                [x + dx, y + dy, z + dz]
            };
            let mut inside = 0;
            let mut is_known = true;
            for c in 0..8 {
                let distance = around.distance[wide_index(corner(c))];
                is_known &= !distance.is_nan();
                inside |= usize::from(distance < 0.0) << c;
            }
            if !is_known {
                continue;
            }
            let key = |vertex: u8| -> VertexKey {
                let vertex = usize::from(vertex);
                if vertex < N_EDGES {
                    around.key(corner(start_of(vertex)), (vertex / 4) as u64)
                } else {
                    around.key([x, y, z], MIDDLE + (vertex - N_EDGES) as u64)
                }
            };
            triangles.extend(CASES[inside].triangles.iter().map(|corners| corners.map(key)));
        }
        triangles
    }

    /// Where a vertex is, and its colour.
    fn vertex(&self, look: &mut Look, vertex: VertexKey) -> (Point3, Option<[u8; 3]>) {
        let block = self.lattice.keys[(vertex >> POINT_BITS) as usize];
        let within = coords_of((vertex >> KIND_BITS) as usize & (SIDE * SIDE * SIDE - 1));
        let point = lattice_point(block, within);
        let kind = vertex & ((1 << KIND_BITS) - 1);
        if kind < MIDDLE {
            return self.on_edge(look, point, kind as usize);
        }
        let inside = (0..8).fold(0, |inside, c| {
            let at = step(point, CORNERS[c]);
            let is_inside = look.known(at).is_some_and(|distance| distance < 0.0);
            inside | usize::from(is_inside) << c
        });
        let around = &CASES[inside].middles[(kind - MIDDLE) as usize];
        let mut sum = nalgebra::Vector3::zeros();
        let mut color = None;
        for &edge in around {
            let start = step(point, CORNERS[start_of(edge.into())]);
            let (place, seen) = self.on_edge(look, start, usize::from(edge) / 4);
            sum += place.coords;
            color = color.or(seen);
        }
        (Point3::from(sum / around.len() as f64), color)
    }

    fn on_edge(&self, look: &mut Look, start: [i32; 3], axis: usize) -> (Point3, Option<[u8; 3]>) {
        let mut one = [0; 3];
        one[axis] = 1;
        let ends = [start, step(start, one)].map(|point| {
            let place = look.place(point);
            place.map_or((0.0, [0; 4]), |(block, i)| (block.distance[i], block.color[i]))
        });
        let [(a, color_a), (b, color_b)] = ends;
        let (a, b) = (f64::from(a), f64::from(b));
        let share = (a / (a - b)).clamp(MARGIN, 1.0 - MARGIN);
        let mut at = start.map(f64::from);
        at[axis] += share;
        let color = match (color_a[3] > 0, color_b[3] > 0) {
            (true, true) => Some(mixed(color_a, color_b, share)),
            (true, false) => Some(mixed(color_a, color_a, 0.0)),
            (false, true) => Some(mixed(color_b, color_b, 0.0)),
            (false, false) => None,
        };
        (Point3::from(at.map(|c| c * self.options().voxel)), color)
    }
}

/// The distances of a block and of the first points of those after it; NaN where nothing is known.
struct Around {
    distance: [f32; WIDE * WIDE * WIDE],
    /// The blocks beside it, by bits as [`CORNERS`]; those that are not there are never asked for.
    blocks: [Option<usize>; 8],
}

impl Around {
    fn of(volume: &Volume, i_block: usize) -> Self {
        let key = volume.lattice.keys[i_block];
        let blocks = CORNERS.map(|corner| volume.lattice.find(&step(key, corner)));
        let mut distance = [f32::NAN; WIDE * WIDE * WIDE];
        for (i, distance) in distance.iter_mut().enumerate() {
            let at = [i % WIDE, i / WIDE % WIDE, i / (WIDE * WIDE)];
            let (corner, within) = split(at);
            if let Some(block) = blocks[corner] {
                let known = volume.blocks[block].known(index_of(within));
                *distance = known.unwrap_or(f32::NAN);
            }
        }
        Self { distance, blocks }
    }

    fn key(&self, at: [usize; 3], kind: u64) -> VertexKey {
        let (corner, within) = split(at);
        // A vertex lies between points that are known: their blocks are there.
        let block = self.blocks[corner].unwrap_or_default() as u64;
        block << POINT_BITS | (index_of(within) as u64) << KIND_BITS | kind
    }
}

/// Which of the blocks beside a point lies in, and where there.
fn split(at: [usize; 3]) -> (usize, [usize; 3]) {
    let corner = (0..3).map(|k| (at[k] / SIDE) << k).sum();
    (corner, at.map(|c| c % SIDE))
}

fn wide_index([x, y, z]: [usize; 3]) -> usize {
    x + WIDE * (y + WIDE * z)
}

fn lattice_point(block: Key, within: [usize; 3]) -> [i32; 3] {
    step(block.map(|c| c << 3), within)
}

fn mixed(a: [u16; 4], b: [u16; 4], share: f64) -> [u8; 3] {
    [0, 1, 2].map(|k| {
        let mean = f64::from(a[k]) * (1.0 - share) + f64::from(b[k]) * share;
        (mean / 256.0).round().min(255.0) as u8
    })
}

#[cfg(test)]
mod tests;
