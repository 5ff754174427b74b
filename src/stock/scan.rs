//! A mesh as dexels: every triangle is cut into lines along the rows, every line into rays.
//!
//! What a ray keeps is the outermost place at which it meets the mesh; hollows behind that are
//! filled. Any soup will do; nothing needs to be closed.

use super::layout::{Kind, Layout};
use crate::geom::TriMesh;
use rayon::prelude::*;

/// A triangle that ends this close before a row or ray is taken to meet it [mm or columns].
const HAIR: f64 = 1e-9;

/// Where the rays of `layout` meet `mesh` last, row by row; its floor where they do not.
pub(super) fn ends(layout: &Layout, mesh: &TriMesh) -> Vec<f64> {
    let seen: Vec<[f64; 3]> =
        mesh.points.iter().map(|point| (layout.rays_from_part * point).coords.into()).collect();
    let rows = rows_of(layout, mesh, &seen);
    let mut ends = vec![layout.floor; layout.n_rows * layout.n_columns];
    ends.par_chunks_mut(layout.n_columns).zip(rows).enumerate().for_each(|(row, (ends, mine))| {
        let x = layout.row_x(row);
        for i in mine {
            let corners = mesh.triangles[i as usize].map(|k| seen[k as usize]);
            if let Some(line) = line_at(&corners, x) {
                match layout.kind {
                    Kind::Turned => around(layout, line, ends),
                    Kind::Table => across(layout, line, ends),
                }
            }
        }
    });
    ends
}

/// The triangles each row meets.
fn rows_of(layout: &Layout, mesh: &TriMesh, seen: &[[f64; 3]]) -> Vec<Vec<u32>> {
    let mut rows = vec![Vec::new(); layout.n_rows];
    for (i, triangle) in mesh.triangles.iter().enumerate() {
        let x = triangle.map(|k| seen[k as usize][0]);
        let (low, high) = (x[0].min(x[1]).min(x[2]), x[0].max(x[1]).max(x[2]));
        for row in layout.rows_within([low - HAIR, high + HAIR]) {
            rows[row].push(i as u32);
        }
    }
    rows
}

/// The line a triangle and the plane at `x` have in common, as two places in y and z.
fn line_at(corners: &[[f64; 3]; 3], x: f64) -> Option<[[f64; 2]; 2]> {
    let low = corners.iter().map(|c| c[0]).fold(f64::INFINITY, f64::min);
    let high = corners.iter().map(|c| c[0]).fold(f64::NEG_INFINITY, f64::max);
    let x = x.clamp(low, high);
    let mut met: [Option<[f64; 2]>; 2] = [None; 2];
    let mut widest = -1.0;
    let mut places = Vec::with_capacity(3);
    for k in 0..3 {
        let (a, b) = (corners[k], corners[(k + 1) % 3]);
        if (a[0] - x) * (b[0] - x) <= 0.0 {
            let share = if a[0] == b[0] { 0.0 } else { (x - a[0]) / (b[0] - a[0]) };
            places.push([a[1] + (b[1] - a[1]) * share, a[2] + (b[2] - a[2]) * share]);
            if a[0] == b[0] {
                places.push([b[1], b[2]]);
            }
        }
    }
    for (i, a) in places.iter().enumerate() {
        for b in &places[i..] {
            let width = (a[0] - b[0]).hypot(a[1] - b[1]);
            if width > widest {
                widest = width;
                met = [Some(*a), Some(*b)];
            }
        }
    }
    Some([met[0]?, met[1]?])
}

/// Rays from the axis through the line from `a` to `b`.
fn around(layout: &Layout, [a, b]: [[f64; 2]; 2], ends: &mut [f64]) {
    let [cos, sin] = &layout.turns;
    let (step, n) = (layout.across[1], layout.n_columns_signed());
    let cross = |a: [f64; 2], b: [f64; 2]| a[0] * b[1] - a[1] * b[0];
    let from = a[1].atan2(a[0]);
    let turn = cross(a, b).atan2(a[0] * b[0] + a[1] * b[1]);
    let (low, high) = (from.min(from + turn), from.max(from + turn));
    let along = [b[0] - a[0], b[1] - a[1]];
    let farthest = a[0].hypot(a[1]).max(b[0].hypot(b[1]));
    for column in (low / step - HAIR).ceil() as i64..=(high / step + HAIR).floor() as i64 {
        let column = column.rem_euclid(n) as usize;
        let steepness = cos[column] * along[1] - sin[column] * along[0];
        let end = cross(a, along) / steepness;
        // A line that runs along the ray ends it at its farther end.
        let end = if end.is_finite() { end.clamp(0.0, farthest) } else { farthest };
        ends[column] = ends[column].max(end);
    }
}

/// Rays along the attack axis through the line from `a` to `b`.
fn across(layout: &Layout, [a, b]: [[f64; 2]; 2], ends: &mut [f64]) {
    let [first, step] = layout.across;
    let (a, b) = if a[1] <= b[1] { (a, b) } else { (b, a) };
    let low = ((a[1] - first) / step - HAIR).ceil().max(0.0) as usize;
    let high = ((b[1] - first) / step + HAIR).floor();
    if high < 0.0 {
        return;
    }
    let met = ends.iter_mut().enumerate().take(high as usize + 1).skip(low);
    for (column, outermost) in met {
        let share = (first + step * column as f64 - a[1]) / (b[1] - a[1]);
        let end = if share.is_finite() {
            a[0] + (b[0] - a[0]) * share.clamp(0.0, 1.0)
        } else {
            a[0].max(b[0])
        };
        *outermost = outermost.max(end);
    }
}
