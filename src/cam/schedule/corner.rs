//! Where two moves meet: a control does not stop there but rounds the corner.
//!
//! The corner is replaced by a parabola, run through with the velocity of each axis growing evenly
//! from that of the one move to that of the other. It begins and ends at most half a move away, no
//! farther than the axes' rounding allows, and no farther than top speed needs. On a path of short
//! moves the parabolas join at the middles of the moves into one smooth curve, and
//! `|v_k+1 - v_k| <= a (t_k + t_k+1) / 2` holds for each axis. At a lone corner of angle `d` the speed
//! is `v^2 = 8 a delta / d^2` for a rounding `delta`, to first order GRBL's junction formula.

use super::Drive;
use super::leg::Leg;
use crate::machine::{AxisValues, MAX_AXES};

/// At top speed the turn takes this share of an axis' acceleration; rounding a corner more than
/// that gains nothing, and leaves less room to speed up in.
const GENTLE: f64 = 0.125;

/// Parabolas shorter than this part of a move are none: the moves go on in one line.
const NEGLIGIBLE: f64 = 1e-9;

/// Where two moves meet the square of the speed may be this much above the slower one's top. Along a
/// path whose steps change a little in length it goes evenly from top to top, and each move takes
/// its time; a single slow one may be shorter by a fortieth.
const ABOVE_TOP: f64 = 1.1;

/// Axes that go along with each other, as the two spindles of a pair, have the same rows, and
/// rounding would decide which of them is fulfilled and which broken.
const SAME_ROW: f64 = 1e-9;

/// A rounded corner: two bends that meet where the moves do, since each has its own top speed.
#[derive(Debug)]
pub(super) struct Corner {
    /// Length of it that lies on the first move [s].
    pub(super) before: f64,
    /// Length of it that lies on the second move [s].
    pub(super) after: f64,
    /// `None` where the moves go on in one line.
    bends: Option<[Bend; 2]>,
}

impl Corner {
    /// The corner between `first` and `second`.
    pub(super) fn new(first: &Leg, second: &Leg, drives: &[Drive]) -> Self {
        let half = half_width(first, second, drives);
        let (before, after) = (half.min(0.5 * first.length), half.min(0.5 * second.length));
        let width = before + after;
        if width <= NEGLIGIBLE * first.length.min(second.length) {
            return Self { before: 0.0, after: 0.0, bends: None };
        }
        let mut middle = first.direction;
        for (at, to) in middle.iter_mut().zip(&second.direction) {
            *at += (to - *at) * (before / width);
        }
        let bends = [
            Bend::new([&first.direction, &middle], before, drives),
            Bend::new([&middle, &second.direction], after, drives),
        ];
        Self { before, after, bends: Some(bends) }
    }

    /// The greatest squares of speed where it begins and in its middle from which one up to
    /// `most_after` can be had at its end; `tops` are those of its moves.
    pub(super) fn most_before(&self, tops: [f64; 2], most_after: f64) -> [f64; 2] {
        let Some([first, second]) = &self.bends else { return [tops[0].min(most_after); 2] };
        let slower = tops[0].min(tops[1]);
        let top = (0.5 * (tops[0] + tops[1])).min(ABOVE_TOP * slower);
        let middle = second.most_before(top, most_after);
        [first.most_before(tops[0], middle), middle]
    }

    /// The greatest squares of speed in its middle and at its end, each up to its bound, after
    /// `enter`.
    pub(super) fn most_after(&self, enter: f64, [middle, after]: [f64; 2]) -> [f64; 2] {
        let Some([first, second]) = &self.bends else { return [enter.min(after); 2] };
        let middle = first.most_after(enter, middle);
        [middle, second.most_after(middle, after)]
    }

    /// Times on the first and on the second move.
    pub(super) fn seconds(&self, squares: [f64; 3]) -> [f64; 2] {
        let [from, at, to] = squares.map(f64::sqrt);
        let time = |way: f64, speeds: f64| if way > 0.0 { 2.0 * way / speeds } else { 0.0 };
        [time(self.before, from + at), time(self.after, at + to)]
    }

    /// The share of its acceleration that the axis uses which works hardest, and which it is.
    pub(super) fn hardest(&self, [enter, middle, leave]: [f64; 3]) -> (f64, usize) {
        let Some([first, second]) = &self.bends else { return (0.0, 0) };
        let (one, other) = (first.hardest(enter, middle), second.hardest(middle, leave));
        if other.0 > one.0 { other } else { one }
    }
}

/// A piece on which the direction changes evenly and the acceleration along the path is one.
///
/// With `x` the square of the speed along the path, `a` where the piece begins and `b` where it
/// ends, the acceleration of each axis is linear in x at both ends:
/// `q1 (x_b - x_a) / 2w + (q2 - q1) / w x_a` and `q2 (x_b - x_a) / 2w + (q2 - q1) / w x_b`, where q1
/// and q2 are the directions and w the length. Between the ends it is in between.
#[derive(Debug)]
struct Bend {
    /// `|row . (x_a, x_b)| <= 1`, two for each axis.
    rows: [[f64; 2]; 2 * MAX_AXES],
    n_rows: usize,
}

impl Bend {
    fn new([from, to]: [&AxisValues; 2], width: f64, drives: &[Drive]) -> Self {
        let mut rows = [[0.0; 2]; 2 * MAX_AXES];
        let pairs = rows.chunks_exact_mut(2).zip(from.iter().zip(to));
        for ((rows, (q1, q2)), drive) in pairs.zip(drives) {
            let scale = 1.0 / (2.0 * width * drive.acceleration);
            rows[0] = [(2.0 * q2 - 3.0 * q1) * scale, q1 * scale];
            rows[1] = [-q2 * scale, (3.0 * q2 - 2.0 * q1) * scale];
        }
        Self { rows, n_rows: 2 * drives.len().min(MAX_AXES) }
    }

    /// The greatest `x_a`, up to `most`, from which some `x_b` up to `most_after` can be had: a
    /// linear program in two variables, one half-plane after another (Seidel 1991).
    fn most_before(&self, most: f64, most_after: f64) -> f64 {
        let (mut before, mut after) = (most, most_after);
        for (i, row) in self.rows().iter().enumerate() {
            let value = row[0] * before + row[1] * after;
            if value.abs() <= 1.0 + SAME_ROW {
                continue;
            }
            // The optimum lies where this row is fulfilled exactly.
            let bound = value.signum();
            if row[1].abs() <= 1e-12 * row[0].abs() {
                before = bound / row[0];
                after = self.most_after_by(i, before, most_after);
            } else {
                // x_b = start + slope x_a
                let (start, slope) = (bound / row[1], -row[0] / row[1]);
                before = self.most_along(i, [start, slope], most_after).min(most);
                after = (start + slope * before).clamp(0.0, most_after);
            }
        }
        before.clamp(0.0, most)
    }

    /// The greatest `x_b`, up to `most`, after `before`.
    fn most_after(&self, before: f64, most: f64) -> f64 {
        self.most_after_by(self.n_rows, before, most)
    }

    fn hardest(&self, enter: f64, leave: f64) -> (f64, usize) {
        let used = self.rows().iter().map(|row| (row[0] * enter + row[1] * leave).abs());
        let most = |most: (f64, usize), (i, used): (usize, f64)| {
            if used > most.0 { (used, i / 2) } else { most }
        };
        used.enumerate().fold((0.0, 0), most)
    }

    fn rows(&self) -> &[[f64; 2]] {
        &self.rows[..self.n_rows]
    }

    /// The greatest `x_b` that the first `n` rows leave.
    fn most_after_by(&self, n: usize, before: f64, most: f64) -> f64 {
        let bounds = self.rows[..n].iter().filter(|row| row[1] != 0.0);
        let bounds = bounds.map(|row| (1.0 - row[0] * before * row[1].signum()) / row[1].abs());
        bounds.fold(most, f64::min).max(0.0)
    }

    /// The greatest `x_a` on the line `x_b = start + slope x_a` that the first `n` rows leave, and
    /// an `x_b` from 0 to `most_after`.
    fn most_along(&self, n: usize, [start, slope]: [f64; 2], most_after: f64) -> f64 {
        let box_sides = [(slope, most_after - start), (-slope, start)];
        let sides = self.rows[..n].iter().flat_map(|row| {
            let (rise, at) = (row[0] + row[1] * slope, row[1] * start);
            // Along the line of a row like this one nothing changes.
            let is_same = rise.abs() <= SAME_ROW * row[0].abs();
            let rise = if is_same { 0.0 } else { rise };
            [(rise, 1.0 - at), (-rise, 1.0 + at)]
        });
        let above = box_sides.into_iter().chain(sides).filter(|(rise, _)| *rise > 0.0);
        above.map(|(rise, room)| room / rise).fold(f64::INFINITY, f64::min).max(0.0)
    }
}

/// How far from the corner the parabola may begin and end.
fn half_width(first: &Leg, second: &Leg, drives: &[Drive]) -> f64 {
    let fastest = first.fastest.max(second.fastest);
    let (mut allowed, mut needed) = (f64::INFINITY, 0.0);
    for ((q1, q2), drive) in first.direction.iter().zip(&second.direction).zip(drives) {
        let turn = (q2 - q1).abs();
        // The parabola passes the corner at a quarter of the change of direction.
        allowed = f64::min(allowed, 4.0 * drive.rounding / turn);
        needed = f64::max(needed, 0.5 * fastest * turn / (GENTLE * drive.acceleration));
    }
    allowed.min(needed)
}
