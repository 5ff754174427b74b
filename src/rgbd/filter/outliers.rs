//! Readings that belong to no surface: lone ones, and those that hang in the air between the two sides
//! of a depth edge because their pixel saw both (*flying pixels*).

use crate::rgbd::Image;

/// What [`drop_outliers`] takes for one.
#[derive(Debug, Clone, PartialEq, clap::Args, serde::Serialize, serde::Deserialize)]
#[serde(default, rename_all = "kebab-case", deny_unknown_fields)]
pub struct OutlierOptions {
    /// Neighbours whose depth differs by more than this share are another surface.
    #[arg(long, value_name = "SHARE", default_value_t = Self::default().edge)]
    pub edge: f64,
    /// A reading with fewer of its eight neighbours on its surface is lone.
    #[arg(long, value_name = "N", default_value_t = Self::default().least_neighbours)]
    pub least_neighbours: usize,
}

impl Default for OutlierOptions {
    fn default() -> Self {
        Self { edge: 0.02, least_neighbours: 3 }
    }
}

/// How many readings were dropped.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, serde::Serialize)]
pub struct Outliers {
    /// Lone ones.
    pub n_lone: usize,
    /// Those between the two sides of an edge.
    pub n_flying: usize,
}

/// Half of the eight neighbours; the other half lies opposite.
const HALF: [[isize; 2]; 4] = [[1, 0], [1, 1], [0, 1], [-1, 1]];

/// The image without outliers, and how many there were. Each reading is judged by its neighbours as
/// they were.
pub fn drop_outliers(depth: &Image<f32>, options: &OutlierOptions) -> (Image<f32>, Outliers) {
    let (width, height) = (depth.width(), depth.height());
    let kinds = Image::from_rows(width, height, Kind::Good, |y, row| {
        for (x, kind) in row.iter_mut().enumerate() {
            *kind = judge(depth, [x, y], options);
        }
    });
    let mut outliers = Outliers::default();
    let mut left = depth.clone();
    for (depth, kind) in left.pixels_mut().iter_mut().zip(kinds.pixels()) {
        match kind {
            Kind::Good => continue,
            Kind::Lone => outliers.n_lone += 1,
            Kind::Flying => outliers.n_flying += 1,
        }
        *depth = 0.0;
    }
    (left, outliers)
}

#[derive(Debug, Clone, Copy)]
enum Kind {
    Good,
    Lone,
    Flying,
}

fn judge(depth: &Image<f32>, [x, y]: [usize; 2], options: &OutlierOptions) -> Kind {
    let own = depth[(x, y)];
    // NaN is no reading either.
    let is_reading = own > 0.0;
    if !is_reading {
        return Kind::Good;
    }
    let jump = options.edge as f32 * own;
    let at = |dx: isize, dy: isize| {
        let (x, y) = (x.checked_add_signed(dx)?, y.checked_add_signed(dy)?);
        depth.get(x, y).copied().filter(|other| *other > 0.0)
    };
    let mut n_near = 0;
    let mut is_flying = false;
    for [dx, dy] in HALF {
        let pair = [at(dx, dy), at(-dx, -dy)].map(|other| other.map(|other| other - own));
        n_near += pair.iter().flatten().filter(|step| step.abs() <= jump).count();
        if let [Some(a), Some(b)] = pair {
            is_flying |= a.abs().min(b.abs()) > jump && (a > 0.0) != (b > 0.0);
        }
    }
    if is_flying {
        Kind::Flying
    } else if n_near < options.least_neighbours {
        Kind::Lone
    } else {
        Kind::Good
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lone_and_flying_readings_go_and_surfaces_stay() {
        // Two planes with a column of flying pixels between them, and a lone reading on the left.
        let pixels = (0..12 * 10).map(|i| match i % 12 {
            0..=5 => 800.0,
            6 => 900.0,
            _ => 1000.0,
        });
        let mut depth = Image::new(12, 10, pixels.collect()).unwrap();
        depth[(2, 5)] = 500.0;
        let (left, outliers) = drop_outliers(&depth, &OutlierOptions::default());
        assert_eq!(outliers, Outliers { n_lone: 1, n_flying: 10 });
        for y in 0..10 {
            for x in 0..12 {
                let expected = if x == 6 || (x, y) == (2, 5) { 0.0 } else { depth[(x, y)] };
                assert_eq!(left[(x, y)], expected, "{x} {y}");
            }
        }
    }

    #[test]
    fn a_clean_edge_and_a_slanting_plane_are_kept_whole() {
        let edge = (0..100).map(|i| if i % 10 < 5 { 800.0 } else { 1000.0 }).collect();
        let slope = (0..100).map(|i| 800.0 + 10.0 * (i % 10) as f32).collect();
        for pixels in [edge, slope] {
            let depth = Image::new(10, 10, pixels).unwrap();
            let (left, outliers) = drop_outliers(&depth, &OutlierOptions::default());
            assert_eq!((left, outliers), (depth, Outliers::default()));
        }
    }

    #[test]
    fn no_readings_are_no_outliers() {
        let depth = Image::filled(4, 3, 0.0);
        assert_eq!(drop_outliers(&depth, &OutlierOptions::default()).1, Outliers::default());
    }
}
