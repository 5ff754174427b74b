//! A smooth curve through given values: the draughtsman's spline.

/// The natural cubic spline through knots `[x, value]`: twice continuously differentiable, straight
/// on beyond its ends.
#[derive(Debug, Clone)]
pub(super) struct Spline {
    knots: Vec<[f64; 2]>,
    /// Second derivative at each knot.
    bends: Vec<f64>,
}

impl Spline {
    /// Through at least two `knots` with increasing x.
    pub(super) fn through(knots: &[[f64; 2]]) -> Self {
        debug_assert!(knots.len() >= 2 && knots.windows(2).all(|k| k[0][0] < k[1][0]));
        Self { knots: knots.to_vec(), bends: bends(knots) }
    }

    /// The value at `x`.
    pub(super) fn at(&self, x: f64) -> f64 {
        let n = self.knots.len();
        let (first, last) = (self.knots[0], self.knots[n - 1]);
        if x < first[0] {
            return first[1] + self.slope(first[0]) * (x - first[0]);
        }
        if x > last[0] {
            return last[1] + self.slope(last[0]) * (x - last[0]);
        }
        let (i, h, a, b) = self.span(x);
        let bend = (a.powi(3) - a) * self.bends[i] + (b.powi(3) - b) * self.bends[i + 1];
        a * self.knots[i][1] + b * self.knots[i + 1][1] + bend * h * h / 6.0
    }

    /// The derivative at `x`, constant beyond the ends.
    pub(super) fn slope(&self, x: f64) -> f64 {
        let x = x.clamp(self.knots[0][0], self.knots[self.knots.len() - 1][0]);
        let (i, h, a, b) = self.span(x);
        let chord = (self.knots[i + 1][1] - self.knots[i][1]) / h;
        let bend = (3.0 * b * b - 1.0) * self.bends[i + 1] - (3.0 * a * a - 1.0) * self.bends[i];
        chord + bend * h / 6.0
    }

    /// The span that holds `x`, its length, and the weights of its two ends.
    fn span(&self, x: f64) -> (usize, f64, f64, f64) {
        let i = self.knots.partition_point(|k| k[0] <= x).clamp(1, self.knots.len() - 1) - 1;
        let (start, end) = (self.knots[i][0], self.knots[i + 1][0]);
        let h = end - start;
        (i, h, (end - x) / h, (x - start) / h)
    }
}

/// Second derivatives that make the first ones meet at every knot, zero at both ends: a tridiagonal
/// system, eliminated forwards and solved backwards.
fn bends(knots: &[[f64; 2]]) -> Vec<f64> {
    let n = knots.len();
    let (mut bends, mut carry) = (vec![0.0; n], vec![0.0; n]);
    for i in 1..n - 1 {
        let [before, here, after] = [knots[i - 1], knots[i], knots[i + 1]];
        let share = (here[0] - before[0]) / (after[0] - before[0]);
        let pivot = share * carry[i - 1] + 2.0;
        carry[i] = (share - 1.0) / pivot;
        let turn = (after[1] - here[1]) / (after[0] - here[0])
            - (here[1] - before[1]) / (here[0] - before[0]);
        bends[i] = (6.0 * turn / (after[0] - before[0]) - share * bends[i - 1]) / pivot;
    }
    for i in (0..n - 1).rev() {
        bends[i] += carry[i] * bends[i + 1];
    }
    bends
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spline_passes_through_its_knots_and_stays_straight_where_they_are() {
        let bent = Spline::through(&[[0.0, 1.0], [1.0, 3.0], [2.5, 2.0], [4.0, 5.0]]);
        for [x, value] in [[0.0, 1.0], [1.0, 3.0], [2.5, 2.0], [4.0, 5.0]] {
            assert!((bent.at(x) - value).abs() < 1e-12);
        }
        let straight = Spline::through(&[[0.0, 1.0], [1.0, 3.0], [3.0, 7.0]]);
        for x in [-1.0, 0.3, 2.0, 5.0] {
            assert!((straight.at(x) - (1.0 + 2.0 * x)).abs() < 1e-12);
        }
    }

    #[test]
    fn slope_is_the_derivative_of_the_value() {
        let spline = Spline::through(&[[0.0, 1.0], [1.0, 3.0], [2.5, 2.0], [4.0, 5.0]]);
        for x in [-0.5, 0.2, 1.0, 1.7, 3.9, 4.5] {
            let difference = (spline.at(x + 1e-6) - spline.at(x - 1e-6)) / 2e-6;
            assert!((spline.slope(x) - difference).abs() < 1e-6, "at {x}");
        }
    }
}
