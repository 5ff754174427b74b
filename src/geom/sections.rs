//! An ordered grid of section points, as mechanical copiers and older lathe software exchange it.

use super::{Point3, TriMesh};

/// Points in rows of stations along the spindle and columns of angles around it.
#[derive(Debug, Clone, PartialEq)]
pub struct SectionGrid {
    /// Number of columns: points per turn, the same at every station.
    pub n_columns: usize,
    /// Row by row, `n_columns` points each [mm].
    pub points: Vec<Point3>,
}

impl SectionGrid {
    /// Number of stations.
    pub fn n_rows(&self) -> usize {
        self.points.len() / self.n_columns.max(1)
    }

    /// The grid as a surface: two triangles per cell, columns closed into rings, ends left open.
    pub fn to_mesh(&self) -> TriMesh {
        let n = self.n_columns;
        let index = |row: usize, column: usize| (row * n + column % n) as u32;
        let mut triangles = Vec::with_capacity(2 * n * self.n_rows().saturating_sub(1));
        for row in 1..self.n_rows() {
            for column in 0..n {
                let (a, b) = (index(row - 1, column), index(row - 1, column + 1));
                let (c, d) = (index(row, column), index(row, column + 1));
                triangles.extend([[a, b, d], [a, d, c]]);
            }
        }
        TriMesh::new(self.points.clone(), triangles)
    }
}
