//! Triangles cut into ever smaller pieces.

use super::frame::Run;
use crate::geom::{Lanes, WIDTH};
use fearless_simd::{f32x16, prelude::*};

/// How often halving makes sixteen of one.
const HALVINGS: usize = WIDTH.ilog2() as usize;
/// Which lanes keep the second half, at each halving.
const SECOND: [Lanes; HALVINGS] = second_halves();

/// The corners of a triangle, or a point, seen from the tool.
pub(super) type Piece<const N: usize> = [Run<f32>; N];

/// One of sixteen.
pub(super) fn piece_of<S: Simd, const N: usize>(
    pieces: &[Run<f32x16<S>>; N],
    lane: usize,
) -> Piece<N> {
    let mut piece = [[[0.0; 3]; 3]; N];
    for (corner, of_pieces) in piece.iter_mut().zip(pieces) {
        for k in 0..9 {
            corner[k / 3][k % 3] = of_pieces[k / 3][k % 3][lane];
        }
    }
    piece
}

/// The longest side of a piece, squared.
pub(super) fn longest2<const N: usize>(piece: &Piece<N>) -> f32 {
    let side2 = |i: usize| {
        let ([from, ..], [to, ..]) = (&piece[i], &piece[(i + 1) % N]);
        (0..3).map(|axis| (to[axis] - from[axis]).powi(2)).sum::<f32>()
    };
    (0..N).map(side2).fold(0.0, f32::max)
}

/// A triangle as sixteen, halved four times across its longest side: pieces of a needle are no
/// needles. A point is sixteen times itself.
#[inline(always)]
pub(super) fn cut<S: Simd, const N: usize>(simd: S, piece: &Piece<N>) -> [Run<f32x16<S>>; N] {
    let zero = f32x16::splat(simd, 0.0);
    let mut pieces = [[[zero; 3]; 3]; N];
    for (corners, corner) in pieces.iter_mut().zip(piece) {
        for k in 0..9 {
            corners[k / 3][k % 3] = f32x16::splat(simd, corner[k / 3][k % 3]);
        }
    }
    for second in &SECOND {
        halve(simd, &mut pieces, second);
    }
    pieces
}

/// Each lane's half, the second where `second` is 1: the middle of the longest side takes the place
/// of one of its ends.
#[inline(always)]
fn halve<S: Simd, const N: usize>(simd: S, pieces: &mut [Run<f32x16<S>>; N], second: &Lanes) {
    let is_second = f32x16::from_slice(simd, second).simd_gt(0.0);
    let mut longest2 = length2(pieces, 0);
    let mut middle = between(&pieces[0], &pieces[1 % N]);
    let splat = |corner: usize| f32x16::splat(simd, corner as f32);
    let mut leaves = is_second.select(splat(0), splat(1 % N));
    for i in 1..N {
        let j = (i + 1) % N;
        let length2 = length2(pieces, i);
        let is_longer = length2.simd_gt(longest2);
        longest2 = longest2.max(length2);
        leaves = is_longer.select(is_second.select(splat(i), splat(j)), leaves);
        let of_side = between(&pieces[i], &pieces[j]);
        for k in 0..9 {
            let (k, axis) = (k / 3, k % 3);
            middle[k][axis] = is_longer.select(of_side[k][axis], middle[k][axis]);
        }
    }
    for (i, corner) in pieces.iter_mut().enumerate() {
        let is_replaced = leaves.simd_eq(i as f32);
        for k in 0..9 {
            let (k, axis) = (k / 3, k % 3);
            corner[k][axis] = is_replaced.select(middle[k][axis], corner[k][axis]);
        }
    }
}

/// Of the side from one corner to the next, squared.
#[inline(always)]
fn length2<S: Simd, const N: usize>(pieces: &[Run<f32x16<S>>; N], i: usize) -> f32x16<S> {
    let ([from, ..], [to, ..]) = (&pieces[i], &pieces[(i + 1) % N]);
    let [x, y, z] = [to[0] - from[0], to[1] - from[1], to[2] - from[2]];
    x * x + y * y + z * z
}

#[inline(always)]
fn between<S: Simd>(from: &Run<f32x16<S>>, to: &Run<f32x16<S>>) -> Run<f32x16<S>> {
    let mut middle = *from;
    for k in 0..9 {
        let (k, axis) = (k / 3, k % 3);
        middle[k][axis] = (from[k][axis] + to[k][axis]) * 0.5;
    }
    middle
}

const fn second_halves() -> [Lanes; HALVINGS] {
    let mut second = [[0.0; WIDTH]; HALVINGS];
    let mut lane = 0;
    while lane < WIDTH {
        let mut bit = 0;
        while bit < HALVINGS {
            second[bit][lane] = (lane >> bit & 1) as f32;
            bit += 1;
        }
        lane += 1;
    }
    second
}

#[cfg(test)]
mod tests {
    use super::*;
    use fearless_simd::{Level, dispatch};

    #[test]
    fn a_triangle_is_its_sixteen_pieces_and_they_are_no_needles() {
        let corner = |x: f32, y: f32| [[x, y, 1.0], [2.0 * x, 0.0, y], [0.0; 3]];
        let whole = [corner(0.0, 0.0), corner(4.0, 0.0), corner(0.0, 1.0)];
        let pieces: [Piece<3>; WIDTH] = dispatch!(Level::new(), simd => {
            let pieces = cut(simd, &whole);
            std::array::from_fn(|lane| piece_of(&pieces, lane))
        });
        let mut area = 0.0;
        let mut middles = Vec::new();
        for [a, b, c] in pieces {
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
