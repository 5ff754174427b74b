//! The blocks a job begins with.

use super::dexels::Stock;
use super::layout::{Kind, Layout};
use super::scan;
use crate::geom::TriMesh;
use rayon::prelude::*;

/// A block is grown by balls no farther apart than this share of their radius, along X, around and
/// outwards: between them it lacks a few hundredths of that.
const BALL_SPACING: f64 = 0.25;

impl Stock {
    /// A cylinder about the spindle axis, over all of `layout`; on a table it is a full block of
    /// that height.
    pub fn cylinder(layout: Layout, radius: f64) -> Self {
        let end = match layout.kind {
            Kind::Turned => radius.min(layout.top),
            Kind::Table => layout.top,
        };
        let ends = vec![end.max(layout.floor); layout.n_rows * layout.n_columns];
        Self::new(layout, ends)
    }

    /// The body `mesh`, in the part's frame: a moulded block, a box, or the part itself. Each ray
    /// keeps the outermost place at which it meets the mesh.
    pub fn of_mesh(layout: Layout, mesh: &TriMesh) -> Self {
        let ends = scan::ends(&layout, mesh);
        Self::new(layout, ends)
    }

    /// The same body with `margin` more all over: all that lies within `margin` of what its rays
    /// end at.
    #[must_use]
    pub fn grown(self, margin: f64) -> Self {
        if margin.is_nan() || margin <= 0.0 {
            return self;
        }
        let balls = Balls::on(&self, margin);
        let Self { layout, mut ends, .. } = self;
        ends.par_chunks_mut(layout.n_columns).enumerate().for_each(|(row, ends)| {
            let x = layout.row_x(row);
            for &(at, row_of) in balls.near(&layout, x) {
                balls.raise(&layout, x - layout.row_x(row_of), at, ends);
            }
        });
        Self::new(layout, ends)
    }
}

/// Balls along the surface of a body, in the order of their rows.
struct Balls {
    radius: f64,
    /// Column and end, with the row.
    places: Vec<([f64; 2], usize)>,
}

impl Balls {
    /// One for the outermost ray of every patch of the surface; where a patch is steep along X, one
    /// for every row of it.
    fn on(stock: &Stock, radius: f64) -> Self {
        let layout = &stock.layout;
        let real = layout.resolution();
        let stride = |step: f64| ((BALL_SPACING * radius / step) as usize).max(1);
        let (rows, columns) = (stride(real.along), stride(real.across));
        let end = |row: usize, column: usize| stock.ends[row * layout.n_columns + column];
        let mut places = Vec::new();
        for first_row in (0..layout.n_rows).step_by(rows) {
            for first in (0..layout.n_columns).step_by(columns) {
                let in_row = |row: usize| {
                    let columns = first..(first + columns).min(layout.n_columns);
                    let outermost = columns.max_by(|&a, &b| end(row, a).total_cmp(&end(row, b)))?;
                    let end = end(row, outermost);
                    (end > layout.floor).then_some(([outermost as f64, end], row))
                };
                let patch = first_row..(first_row + rows).min(layout.n_rows);
                let by_row: Vec<_> = patch.filter_map(in_row).collect();
                let ends = || by_row.iter().map(|([_, end], _)| *end);
                let (low, high) = (
                    ends().fold(f64::INFINITY, f64::min),
                    ends().fold(f64::NEG_INFINITY, f64::max),
                );
                if high - low > BALL_SPACING * radius {
                    places.extend(by_row);
                } else {
                    places
                        .extend(by_row.into_iter().max_by(|(a, _), (b, _)| a[1].total_cmp(&b[1])));
                }
            }
        }
        places.sort_by_key(|(_, row)| *row);
        Self { radius, places }
    }

    fn near(&self, layout: &Layout, x: f64) -> &[([f64; 2], usize)] {
        let rows = layout.rows_within([x - self.radius, x + self.radius]);
        let place = |row: usize| self.places.partition_point(|(_, at)| *at < row);
        &self.places[place(rows.start)..place(rows.end)]
    }

    /// Raises the rays of a row to where they leave a ball `dx` beside it.
    fn raise(&self, layout: &Layout, dx: f64, [column, end]: [f64; 2], ends: &mut [f64]) {
        let section2 = self.radius * self.radius - dx * dx;
        if section2 < 0.0 {
            return;
        }
        let (section, n) = (section2.sqrt(), layout.n_columns_signed());
        let step = layout.across[1];
        let half = match layout.kind {
            Kind::Table => section / step,
            // A ball over the axis is met by every ray.
            Kind::Turned if end <= section => layout.n_columns as f64,
            Kind::Turned => (section / end).asin() / step,
        };
        let half = (half as i64).min(n / 2);
        for offset in -half..=half {
            let at = column as i64 + offset;
            let out = match layout.kind {
                Kind::Turned => {
                    let (sin, cos) = (offset as f64 * step).sin_cos();
                    let across = end * sin;
                    end * cos + (section2 - across * across).max(0.0).sqrt()
                }
                Kind::Table => {
                    let across = offset as f64 * step;
                    end + (section2 - across * across).max(0.0).sqrt()
                }
            };
            let at = match layout.kind {
                Kind::Turned => at.rem_euclid(n),
                Kind::Table if (0..n).contains(&at) => at,
                Kind::Table => continue,
            } as usize;
            ends[at] = ends[at].max(out.min(layout.top));
        }
    }
}
