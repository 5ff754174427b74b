//! What is made small: residuals of pairs, and the normal equations of a small step.
//!
//! A pair's cost is a sum of squares along a few directions, and a share of the plain squared
//! distance. With unit normals `n` of the target and `m` of the turned source, the generalised cost
//! (Segal et al. 2009) needs no matrix inverse: covariances of flat discs are `I - (1 - e) n nᵀ`, and
//!
//! ```text
//! (2 I - s (n nᵀ + m mᵀ))⁻¹ = I / 2 + a u uᵀ + b v vᵀ,   s = 1 - e,  c = n · m,
//! u = n + m,  a = s / (4 (2 - s (1 + c))),   v = n - m,  b = s / (4 (2 - s (1 - c)))
//! ```
//!
//! because `u` and `v` are eigenvectors of the sum. Here it is scaled by `2 e`, so that for equal
//! normals it is the squared distance from the plane: residuals are lengths.
//!
//! A step is `x' = exp(w) x + v`, from the left; its derivative of a residual along `a` is
//! `(x × a) · w + a · v`.

use super::options::Metric;
use super::pair::Pair;
use super::view::View;
use crate::geom::{Matrix3, Point3, Pose, Vector3};
use nalgebra::{Matrix6, Vector6};
use rayon::prelude::*;

/// How thick a flat disc is, as a share of its radius, squared. Segal et al. (2009).
const THICKNESS: f64 = 1e-3;
/// Pairs summed up in a row: sums are the same for any number of threads.
pub(super) const CHUNK: usize = 1024;

/// What is made small, between two views.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cost<'a> {
    pub(super) source: &'a View,
    pub(super) target: &'a View,
    pub(super) metric: Metric,
    /// What a unit of brightness counts for [mm].
    pub(super) colour_scale: f64,
}

/// A pose as it is applied to many points.
#[derive(Debug, Clone, Copy)]
pub(super) struct Motion {
    pub(super) rotation: Matrix3,
    pub(super) translation: Vector3,
}

/// The normal equations `h step = -g`, and the sum of squares.
#[derive(Debug, Clone, Copy)]
pub(in crate::register) struct Normal {
    pub(in crate::register) h: Matrix6<f64>,
    pub(in crate::register) g: Vector6<f64>,
    pub(in crate::register) cost: f64,
}

impl std::ops::Mul<f64> for Normal {
    type Output = Self;

    /// The same, counting for `scale` times as much.
    fn mul(self, scale: f64) -> Self {
        Self { h: self.h * scale, g: self.g * scale, cost: self.cost * scale }
    }
}

/// A residual along a direction.
#[derive(Debug, Clone, Copy)]
struct Row {
    along: Vector3,
    residual: f64,
    weight: f64,
}

/// All of a pair's cost.
struct Terms {
    at: Vector3,
    /// From the target to the moved source point.
    out: Vector3,
    /// What the plain squared distance counts for.
    even: f64,
    rows: [Row; 3],
}

impl From<&Pose> for Motion {
    fn from(pose: &Pose) -> Self {
        let rotation = pose.rotation.to_rotation_matrix().into_inner();
        Self { rotation, translation: pose.translation.vector }
    }
}

impl Motion {
    pub(super) fn apply(&self, point: &Point3) -> Point3 {
        Point3::from(self.rotation * point.coords + self.translation)
    }
}

impl Cost<'_> {
    /// The squared geometric and photometric residual of a pair; the latter in squared brightness.
    pub(super) fn squares(&self, motion: &Motion, pair: &Pair) -> [f64; 2] {
        let terms = self.terms(motion, pair);
        let colour = terms.rows[2].residual;
        let geometry = terms.even * terms.out.norm_squared()
            + terms.rows[..2].iter().map(Row::square).sum::<f64>();
        [geometry, colour * colour]
    }

    /// A pair's whole squared residual [mm²].
    pub(super) fn square(&self, motion: &Motion, pair: &Pair) -> f64 {
        let [geometry, colour] = self.squares(motion, pair);
        geometry + colour * self.colour_scale.powi(2)
    }

    /// The weighted sum of squares.
    pub(super) fn sum(&self, motion: &Motion, pairs: &[Pair]) -> f64 {
        let of = |pair: &Pair| pair.weight * self.square(motion, pair);
        let sums: Vec<f64> =
            pairs.par_chunks(CHUNK).map(|chunk| chunk.iter().map(of).sum()).collect();
        sums.iter().sum()
    }

    /// The normal equations of all pairs.
    pub(super) fn normal(&self, motion: &Motion, pairs: &[Pair]) -> Normal {
        let sums: Vec<Sums> = pairs
            .par_chunks(CHUNK)
            .map(|chunk| {
                let mut sums = Sums::default();
                for pair in chunk {
                    sums.add(&self.terms(motion, pair), pair.weight);
                }
                sums
            })
            .collect();
        let mut total = Sums::default();
        for sums in &sums {
            total.join(sums);
        }
        total.normal()
    }

    #[inline]
    fn terms(&self, motion: &Motion, pair: &Pair) -> Terms {
        let (i, j) = (pair.source as usize, pair.target as usize);
        let at = motion.apply(&self.source.points[i]);
        let n = self.target.normals[j];
        let out = at - self.target.points[j];
        let mut terms = Terms { at: at.coords, out, even: 0.0, rows: [Row::NONE; 3] };
        if self.metric == Metric::PointToPoint {
            terms.even = 1.0;
            return terms;
        }
        if self.metric == Metric::PointToPlane && !pair.is_turned {
            terms.rows[0] = Row::new(n, &out, 1.0);
            return terms;
        }
        let turned = motion.rotation * self.source.normals[i];
        // Normals of scans have no side; those that look the same way are meant.
        let m = if turned.dot(&n) < 0.0 { -turned } else { turned };
        if self.metric == Metric::PointToPlane {
            // The plane is the source's and turns with it, which moves the lever to the target point:
            // `x × m + m × (x - y) = y × m`. So swapped clouds have the same cost and the same slope.
            terms.rows[0] = Row::new(m, &out, 1.0);
            terms.at = self.target.points[j].coords;
            return terms;
        }
        if self.metric == Metric::Symmetric {
            terms.rows[0] = Row::new((n + m) / 2.0, &out, 1.0);
            return terms;
        }
        let s = 1.0 - THICKNESS;
        let c = n.dot(&m);
        let share = |sign: f64| 2.0 * THICKNESS * s / (4.0 * (2.0 - s * (1.0 + sign * c)));
        terms.even = THICKNESS;
        terms.rows[0] = Row::new(n + m, &out, share(1.0));
        terms.rows[1] = Row::new(n - m, &out, share(-1.0));
        if let (Some(seen), Some(known)) = (&self.source.colours, &self.target.colours)
            && self.metric == Metric::Coloured
        {
            // The mean of both gradients is right to second order, and the same from either side.
            let gradient = (known.gradient[j] + motion.rotation * seen.gradient[i]) / 2.0;
            let expected = known.intensity[j] + gradient.dot(&out);
            let residual = expected - seen.intensity[i];
            terms.rows[2] = Row { along: gradient, residual, weight: self.colour_scale.powi(2) };
        }
        terms
    }
}

impl Row {
    const NONE: Self = Self { along: Vector3::new(0.0, 0.0, 0.0), residual: 0.0, weight: 0.0 };

    fn new(along: Vector3, out: &Vector3, weight: f64) -> Self {
        Self { along, residual: along.dot(out), weight }
    }

    fn square(&self) -> f64 {
        self.weight * self.residual * self.residual
    }
}

/// Sums over pairs; the plain squared distance is kept in moments and multiplied out once.
#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    /// The upper triangle, row by row.
    h: [f64; 21],
    g: [f64; 6],
    cost: f64,
    even: f64,
    at: Vector3,
    at_at: Matrix3,
}

impl Sums {
    #[inline]
    fn add(&mut self, terms: &Terms, weight: f64) {
        let Terms { at, out, even, rows } = terms;
        for row in rows {
            let w = weight * row.weight;
            if w == 0.0 {
                continue;
            }
            let turn = at.cross(&row.along);
            let j = [turn.x, turn.y, turn.z, row.along.x, row.along.y, row.along.z];
            let mut place = 0;
            for a in 0..6 {
                let wj = w * j[a];
                self.g[a] += wj * row.residual;
                for jb in &j[a..] {
                    self.h[place] += wj * jb;
                    place += 1;
                }
            }
            self.cost += w * row.residual * row.residual;
        }
        let w = weight * even;
        if w > 0.0 {
            let turn = at.cross(out);
            for k in 0..3 {
                self.g[k] += w * turn[k];
                self.g[k + 3] += w * out[k];
            }
            self.cost += w * out.norm_squared();
            self.even += w;
            self.at += at * w;
            self.at_at += (at * w) * at.transpose();
        }
    }

    fn join(&mut self, other: &Self) {
        self.h.iter_mut().zip(&other.h).for_each(|(a, b)| *a += b);
        self.g.iter_mut().zip(&other.g).for_each(|(a, b)| *a += b);
        self.cost += other.cost;
        self.even += other.even;
        self.at += other.at;
        self.at_at += other.at_at;
    }

    fn normal(&self) -> Normal {
        let mut h = Matrix6::zeros();
        let mut place = 0;
        for a in 0..6 {
            for b in a..6 {
                h[(a, b)] = self.h[place];
                h[(b, a)] = self.h[place];
                place += 1;
            }
        }
        // Of the plain distance: `[x]ᵀ[x] = (x · x) I - x xᵀ` for turning, `[x]` between both.
        let turning = Matrix3::from_diagonal_element(self.at_at.trace()) - self.at_at;
        let cross = self.at.cross_matrix();
        for a in 0..3 {
            for b in 0..3 {
                h[(a, b)] += turning[(a, b)];
                h[(a, b + 3)] += cross[(a, b)];
                h[(b + 3, a)] += cross[(a, b)];
            }
            h[(a + 3, a + 3)] += self.even;
        }
        Normal { h, g: Vector6::from_column_slice(&self.g), cost: self.cost }
    }
}
