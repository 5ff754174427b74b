//! Triangles cut into ever smaller pieces.

use super::frame::Run;
use crate::geom::{Lanes, WIDTH};

/// The corners of a triangle, or a point, seen from the tool.
pub(super) type Piece<const N: usize> = [Run<f32>; N];

/// One of sixteen.
pub(super) fn piece_of<const N: usize>(pieces: &[Run<Lanes>; N], lane: usize) -> Piece<N> {
    std::array::from_fn(|corner| {
        std::array::from_fn(|i| std::array::from_fn(|axis| pieces[corner][i][axis][lane]))
    })
}

/// A triangle as sixteen, halved four times across its longest side: pieces of a needle are no
/// needles. A point is sixteen times itself.
pub(super) fn cut<const N: usize>(piece: &Piece<N>) -> [Run<Lanes>; N] {
    let mut pieces = [*piece; WIDTH];
    let mut n = 1;
    while n < WIDTH {
        for i in 0..n {
            [pieces[i], pieces[n + i]] = halves(&pieces[i]);
        }
        n *= 2;
    }
    let mut lanes = [[[[0.0; WIDTH]; 3]; 3]; N];
    for (lane, piece) in pieces.iter().enumerate() {
        for corner in 0..N {
            for k in 0..9 {
                lanes[corner][k / 3][k % 3][lane] = piece[corner][k / 3][k % 3];
            }
        }
    }
    lanes
}

fn halves<const N: usize>(piece: &Piece<N>) -> [Piece<N>; 2] {
    let mut longest = (-1.0, [0, 0]);
    for i in 0..N {
        let j = (i + 1) % N;
        let ([from, ..], [to, ..]) = (piece[i], piece[j]);
        let length2 = (0..3).map(|axis| (to[axis] - from[axis]).powi(2)).sum::<f32>();
        if longest.0 < length2 {
            longest = (length2, [i, j]);
        }
    }
    let [i, j] = longest.1;
    let mut middle = piece[i];
    for k in 0..9 {
        middle[k / 3][k % 3] = f32::midpoint(piece[i][k / 3][k % 3], piece[j][k / 3][k % 3]);
    }
    let mut halves = [*piece; 2];
    (halves[0][j], halves[1][i]) = (middle, middle);
    halves
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_triangle_is_its_sixteen_pieces_and_they_are_no_needles() {
        let corner = |x: f32, y: f32| [[x, y, 1.0], [2.0 * x, 0.0, y], [0.0; 3]];
        let whole = [corner(0.0, 0.0), corner(4.0, 0.0), corner(0.0, 1.0)];
        let pieces = cut(&whole);
        let mut area = 0.0;
        let mut middles = Vec::new();
        for lane in 0..WIDTH {
            let [a, b, c] = piece_of(&pieces, lane);
            let [u, v] = [b, c].map(|end| [end[0][0] - a[0][0], end[0][1] - a[0][1]]);
            assert!(u[0].abs().max(v[0].abs()) <= 1.0, "{u:?}, {v:?}");
            area += (u[0] * v[1] - u[1] * v[0]).abs() / 2.0;
            middles.push([0, 1].map(|k| (a[0][k] + b[0][k] + c[0][k]).to_bits()));
            for corner in [a, b, c] {
                let [x, y, _] = corner[0];
                assert!(0.0 <= x && 0.0 <= y && x + 4.0 * y <= 4.0);
                assert_eq!(corner[1], [2.0 * x, 0.0, y]);
            }
        }
        middles.sort_unstable();
        middles.dedup();
        assert_eq!((area, middles.len()), (2.0, WIDTH));
    }
}
