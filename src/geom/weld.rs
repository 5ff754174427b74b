//! Points at exactly the same place are one point.

use super::Point3;
use rayon::prelude::*;

/// For every point the lowest index of a point at exactly the same position (-0 and 0 are the same).
///
/// Exact, because a tolerance would close gaps that are really there; the corners that a soup
/// repeats are repeated bit for bit. O(n log n), on all cores.
pub fn weld(points: &[Point3]) -> Vec<u32> {
    let mut order: Vec<([f64; 3], u32)> = points
        .par_iter()
        .enumerate()
        .map(|(i_point, p)| ([p.x + 0.0, p.y + 0.0, p.z + 0.0], i_point as u32))
        .collect();
    order.par_sort_unstable_by(|(p, i), (q, j)| compare(p, q).then(i.cmp(j)));
    let mut first = vec![0; points.len()];
    for same in order.chunk_by(|(p, _), (q, _)| compare(p, q).is_eq()) {
        for &(_, i_point) in same {
            first[i_point as usize] = same[0].1;
        }
    }
    first
}

fn compare(p: &[f64; 3], q: &[f64; 3]) -> std::cmp::Ordering {
    (0..3)
        .map(|k| p[k].total_cmp(&q[k]))
        .find(|order| order.is_ne())
        .unwrap_or(std::cmp::Ordering::Equal)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_positions_get_the_lowest_index_and_near_ones_stay_apart() {
        let points = [
            Point3::new(1.0, 0.0, 0.0),
            Point3::new(0.0, 0.0, 0.0),
            Point3::new(1.0, -0.0, 0.0),
            Point3::new(1.0 + 1e-15, 0.0, 0.0),
            Point3::new(0.0, 0.0, 0.0),
        ];
        assert_eq!(weld(&points), [0, 1, 0, 3, 1]);
        assert!(weld(&[]).is_empty());
    }
}
