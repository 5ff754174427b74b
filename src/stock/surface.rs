//! The stock as a surface to look at and to measure.

use super::dexels::Stock;
use super::layout::Kind;
use crate::geom::{Point3, TriMesh};

impl Stock {
    /// The surface in the part's frame. Vertex `row * n_columns + column` is the end of that ray;
    /// round a spindle two more close the ends, where there is material.
    ///
    /// On a table it is the upper side alone. Where nothing is left there are no triangles.
    pub fn to_mesh(&self) -> TriMesh {
        let (n_rows, n_columns) = (self.layout.n_rows, self.layout.n_columns);
        let point = |i: usize| self.layout.point(i / n_columns, i % n_columns, self.ends[i]);
        let mut mesh = TriMesh::new((0..n_rows * n_columns).map(point).collect(), Vec::new());
        let is_turned = self.layout.kind == Kind::Turned;
        let n_quads = if is_turned { n_columns } else { n_columns - 1 };
        for row in 0..n_rows - 1 {
            for column in 0..n_quads {
                let next = (column + 1) % n_columns;
                let [a, b] = [row * n_columns + column, row * n_columns + next];
                let quad = [a, b, b + n_columns, a + n_columns];
                if quad.iter().any(|&i| self.ends[i] > self.layout.floor) {
                    let [a, b, c, d] = quad.map(|i| i as u32);
                    // Turned rows run from Y to Z, rows on a table towards +Z: both outwards.
                    let triangles = [[a, b, c], [a, c, d]];
                    mesh.triangles.extend(triangles);
                }
            }
        }
        if is_turned {
            self.close(&mut mesh, 0, true);
            self.close(&mut mesh, n_rows - 1, false);
        }
        mesh
    }

    /// A fan over the material at one end.
    fn close(&self, mesh: &mut TriMesh, row: usize, is_first: bool) {
        let n = self.layout.n_columns;
        let middle = mesh.points.len() as u32;
        mesh.points.push(self.layout.point(row, 0, 0.0));
        for column in 0..n {
            let [a, b] = [row * n + column, row * n + (column + 1) % n];
            if self.ends[a] > 0.0 || self.ends[b] > 0.0 {
                let (a, b) = if is_first { (b as u32, a as u32) } else { (a as u32, b as u32) };
                mesh.triangles.push([middle, a, b]);
            }
        }
    }

    /// Where a ray ends, or where it begins if nothing is left, in the part's frame [mm].
    pub fn point(&self, row: usize, column: usize) -> Point3 {
        self.layout.point(row, column, self.ends[row * self.layout.n_columns + column])
    }

    /// What the end of a ray stands for of the surface, from the middle between its neighbours to
    /// the middle between them on the other side [mm2].
    pub fn area_at(&self, row: usize, column: usize) -> f64 {
        let (n_rows, n_columns) = (self.layout.n_rows, self.layout.n_columns);
        let rows = [row.saturating_sub(1), (row + 1).min(n_rows - 1)];
        let columns = match self.layout.kind {
            Kind::Turned => [(column + n_columns - 1) % n_columns, (column + 1) % n_columns],
            Kind::Table => [column.saturating_sub(1), (column + 1).min(n_columns - 1)],
        };
        let along = self.point(rows[1], column) - self.point(rows[0], column);
        let across = self.point(row, columns[1]) - self.point(row, columns[0]);
        let n_steps = match self.layout.kind {
            Kind::Turned => 2,
            Kind::Table => columns[1] - columns[0],
        };
        // Over the whole way to the neighbours on both sides, of which half belongs to this ray.
        let share = self.layout.row_weight(row) / self.layout.along[1] / (rows[1] - rows[0]) as f64
            * (self.layout.column_weight(column) / self.layout.across[1] / n_steps as f64);
        along.cross(&across).norm() * share
    }
}
