//! The distance from the outline of a shadow, on a grid.

use super::Across;

/// Distances from the outline at the middles of cells, positive outside [mm].
pub(super) struct Field {
    /// The middle of the first cell [mm].
    origin: Across,
    /// The side of a cell [mm].
    pub(super) cell: f64,
    /// Cells along x and z.
    pub(super) size: [usize; 2],
    values: Vec<f64>,
}

impl Field {
    /// The field of the shadow of `triangles` and `margin` around it, in cells of `cell` or, where
    /// they would be more than `most`, larger ones. `None` without triangles.
    pub(super) fn around(
        triangles: &[[Across; 3]],
        margin: f64,
        cell: f64,
        most: f64,
    ) -> Option<Self> {
        let [least, greatest] = range(triangles)?;
        let sides = [0, 1].map(|k| greatest[k] - least[k] + 2.0 * margin);
        let cell = cell.max((sides[0] * sides[1] / most).sqrt()).max(sides[0].max(sides[1]) / most);
        // Two cells more on either side: beyond the outermost ring there must be something.
        let origin = least.map(|low| low - margin - 2.0 * cell);
        let size = sides.map(|side| (side / cell).ceil() as usize + 5);
        let mut field = Self { origin, cell, size, values: Vec::new() };
        let shadow = field.shadow(triangles);
        let [out, inside] = [true, false].map(|of| distances(&shadow, size, of));
        // From middle to middle; the outline lies half a cell before either.
        field.values = out
            .iter()
            .zip(&inside)
            .map(|(out, inside)| cell * if *out > 0.0 { out - 0.5 } else { 0.5 - inside })
            .collect();
        Some(field)
    }

    /// The distance at the middle of cell `(i, j)`.
    pub(super) fn at(&self, i: usize, j: usize) -> f64 {
        self.values[j * self.size[0] + i]
    }

    /// Where the middle of cell `(i, j)` lies; between cells too.
    pub(super) fn place(&self, i: f64, j: f64) -> Across {
        [self.origin[0] + i * self.cell, self.origin[1] + j * self.cell]
    }

    /// The distance farthest inside.
    pub(super) fn deepest(&self) -> f64 {
        self.values.iter().copied().fold(f64::INFINITY, f64::min)
    }

    /// Which cells have their middle, or a corner of a triangle, in the shadow.
    fn shadow(&self, triangles: &[[Across; 3]]) -> Vec<bool> {
        let [wide, _] = self.size;
        let mut shadow = vec![false; self.size[0] * self.size[1]];
        for triangle in triangles {
            let corners = triangle
                .map(|[x, z]| [(x - self.origin[0]) / self.cell, (z - self.origin[1]) / self.cell]);
            for [x, z] in corners {
                shadow[z.round() as usize * wide + x.round() as usize] = true;
            }
            let z = corners.map(|corner| corner[1]);
            let (low, high) = (z[0].min(z[1]).min(z[2]), z[0].max(z[1]).max(z[2]));
            for j in low.ceil() as usize..=high.floor() as usize {
                if let Some([from, to]) = crossing(&corners, j as f64) {
                    let cells = from.ceil() as usize..(to.floor() + 1.0) as usize;
                    shadow[j * wide..(j + 1) * wide][cells].fill(true);
                }
            }
        }
        shadow
    }
}

fn range(triangles: &[[Across; 3]]) -> Option<[Across; 2]> {
    let first = triangles.first()?[0];
    Some(triangles.iter().flatten().fold([first; 2], |[least, greatest], corner| {
        [
            [least[0].min(corner[0]), least[1].min(corner[1])],
            [greatest[0].max(corner[0]), greatest[1].max(corner[1])],
        ]
    }))
}

/// The stretch of x in which the line z = `z` crosses a triangle.
fn crossing(corners: &[Across; 3], z: f64) -> Option<[f64; 2]> {
    let mut range: Option<[f64; 2]> = None;
    for (from, to) in [(0, 1), (1, 2), (2, 0)] {
        let ([x0, z0], [x1, z1]) = (corners[from], corners[to]);
        if z0.min(z1) <= z && z <= z0.max(z1) {
            let ends = if z0 == z1 { [x0, x1] } else { [x0 + (x1 - x0) * (z - z0) / (z1 - z0); 2] };
            for x in ends {
                let [low, high] = range.unwrap_or([x; 2]);
                range = Some([low.min(x), high.max(x)]);
            }
        }
    }
    range
}

/// The distance from every cell to the nearest one whose mark is `to`, in cells; infinite if there
/// is none. Felzenszwalb and Huttenlocher (2012), "Distance transforms of sampled functions".
fn distances(marks: &[bool], [wide, deep]: [usize; 2], to: bool) -> Vec<f64> {
    let mut squares: Vec<f64> =
        marks.iter().map(|mark| if *mark == to { 0.0 } else { f64::INFINITY }).collect();
    let mut envelope = Envelope::default();
    for row in squares.chunks_mut(wide) {
        envelope.transform(row);
    }
    let mut column = vec![0.0; deep];
    for i in 0..wide {
        for (j, value) in column.iter_mut().enumerate() {
            *value = squares[j * wide + i];
        }
        envelope.transform(&mut column);
        for (j, value) in column.iter().enumerate() {
            squares[j * wide + i] = *value;
        }
    }
    squares.iter().map(|square| square.sqrt()).collect()
}

/// The lower envelope of parabolas, one over each finite value of a line.
#[derive(Default)]
struct Envelope {
    /// Foot and height of each parabola, and where it takes over from the one before.
    parabolas: Vec<(f64, f64, f64)>,
}

impl Envelope {
    /// Replaces each value by the least `(i - k)^2 + value[k]`.
    fn transform(&mut self, values: &mut [f64]) {
        self.parabolas.clear();
        for (i, &height) in values.iter().enumerate().filter(|(_, height)| height.is_finite()) {
            let foot = i as f64;
            let mut from = f64::NEG_INFINITY;
            while let Some(&(last_foot, last_height, last_from)) = self.parabolas.last() {
                let lead = height + foot * foot - last_height - last_foot * last_foot;
                from = lead / (2.0 * (foot - last_foot));
                if last_from < from {
                    break;
                }
                self.parabolas.pop();
                from = f64::NEG_INFINITY;
            }
            self.parabolas.push((foot, height, from));
        }
        let mut k = 0;
        for (i, value) in values.iter_mut().enumerate() {
            let at = i as f64;
            while self.parabolas.get(k + 1).is_some_and(|next| next.2 < at) {
                k += 1;
            }
            if let Some((foot, height, _)) = self.parabolas.get(k) {
                *value = (at - foot).powi(2) + height;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_those_of_a_search_over_all_cells() {
        let size = [23, 17];
        let marks: Vec<bool> = (0..size[0] * size[1]).map(|i| (i * i) % 37 == 7).collect();
        let found = distances(&marks, size, true);
        for (cell, found) in found.iter().enumerate() {
            let at = |i: usize| [(i % size[0]) as f64, (i / size[0]) as f64];
            let [x, z] = at(cell);
            let marked = (0..marks.len()).filter(|&i| marks[i]).map(at);
            let nearest = marked.map(|[a, b]| (a - x).hypot(b - z)).fold(f64::INFINITY, f64::min);
            assert!((found - nearest).abs() < 1e-9, "cell {cell}: {found} is not {nearest}");
        }
        assert!(distances(&marks, size, false).iter().zip(&marks).all(|(d, m)| (*d == 0.0) != *m));
    }

    #[test]
    fn a_shadow_thinner_than_a_cell_is_seen_at_its_corners() {
        let thin = [[[0.0, 0.0], [10.0, 0.0], [10.0, 0.01]]];
        let field = Field::around(&thin, 5.0, 1.0, 1e6).unwrap();
        assert!(field.deepest() < 0.0);
    }

    #[test]
    fn a_field_too_large_gets_larger_cells() {
        let wide = [[[0.0, 0.0], [1e6, 0.0], [1e6, 1e6]]];
        let field = Field::around(&wide, 5.0, 0.1, 1e4).unwrap();
        assert!(field.size[0] * field.size[1] < 12_000, "{:?}", field.size);
        let line = [[[0.0, 0.0], [1e7, 0.0], [1e7, 0.0]]];
        let field = Field::around(&line, 0.01, 0.001, 1e4).unwrap();
        assert!(field.size[0] * field.size[1] < 100_000, "{:?}", field.size);
    }
}
