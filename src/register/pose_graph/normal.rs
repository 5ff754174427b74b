//! The sparse normal equations of a graph, and a damped step by their Cholesky factors.

use super::residual::{residual, stepped};
use super::{Edge, PoseGraph};
use crate::geom::Pose;
use nalgebra::{DVector, Matrix6, Vector6};
use nalgebra_sparse::factorization::CscCholesky;
use nalgebra_sparse::{CooMatrix, CscMatrix};
use std::collections::BTreeMap;

/// Numbers of a node.
const SIDE: usize = 6;
/// A direction that nothing holds is damped by this share of what holds the others.
const LEAST_HOLD: f64 = 1e-12;

/// `h x = -g` over all nodes but the one that is fixed, in blocks of six.
pub(super) struct Normal {
    /// Which block a node is; the fixed one is none.
    places: Vec<Option<usize>>,
    /// The lower triangle, by row and column of blocks.
    blocks: BTreeMap<(usize, usize), Matrix6<f64>>,
    gradient: DVector<f64>,
}

impl Normal {
    /// The normal equations at `poses`, edges counting by `weights`.
    pub(super) fn new(graph: &PoseGraph, poses: &[Pose], weights: &[f64]) -> Self {
        let place =
            |node: usize| (node != graph.fixed).then(|| node - usize::from(graph.fixed < node));
        let places: Vec<Option<usize>> = (0..poses.len()).map(place).collect();
        let n = SIDE * poses.len().saturating_sub(1);
        let mut normal = Self { places, blocks: BTreeMap::new(), gradient: DVector::zeros(n) };
        for (edge, &weight) in graph.edges.iter().zip(weights) {
            normal.add(edge, weight, poses);
        }
        normal
    }

    fn add(&mut self, edge: &Edge, weight: f64, poses: &[Pose]) {
        let found = residual(edge, &poses[edge.a], &poses[edge.b]);
        let information = edge.information * weight;
        let ends = [(self.places[edge.a], found.by_a), (self.places[edge.b], found.by_b)];
        let held: Vec<(usize, Matrix6<f64>)> =
            ends.into_iter().filter_map(|(place, by)| Some((place?, by))).collect();
        for (row, by_row) in &held {
            let known = by_row.transpose() * information;
            let slope = known * found.value;
            for k in 0..SIDE {
                self.gradient[SIDE * row + k] += slope[k];
            }
            for (column, by_column) in held.iter().filter(|(column, _)| column <= row) {
                let block = self.blocks.entry((*row, *column)).or_insert_with(Matrix6::zeros);
                *block += known * by_column;
            }
        }
    }

    /// The poses after the step that solves the equations damped by the share `damping` of their
    /// diagonal; `None` if they cannot be solved.
    pub(super) fn step(&self, poses: &[Pose], damping: f64) -> Option<Vec<Pose>> {
        let factors = CscCholesky::factor(&self.matrix(damping)).ok()?;
        let step = factors.solve(&-&self.gradient);
        let moved = |(pose, place): (&Pose, &Option<usize>)| match place {
            Some(place) => {
                let own = step.rows(SIDE * place, SIDE);
                stepped(pose, &Vector6::from_iterator(own.iter().copied()))
            }
            None => *pose,
        };
        let moved: Vec<Pose> = poses.iter().zip(&self.places).map(moved).collect();
        let is_finite = |pose: &Pose| pose.to_homogeneous().iter().all(|x| x.is_finite());
        moved.iter().all(is_finite).then_some(moved)
    }

    fn matrix(&self, damping: f64) -> CscMatrix<f64> {
        let n = self.gradient.len();
        let diagonals = self.blocks.iter().filter(|((row, column), _)| row == column);
        // Turns and shifts are held by numbers of different sizes.
        let mut most = Vector6::repeat(f64::MIN_POSITIVE);
        for (_, block) in diagonals {
            most = most.sup(&block.diagonal());
        }
        let mut matrix = CooMatrix::new(n, n);
        for (&(row, column), block) in &self.blocks {
            for (a, b) in (0..SIDE).flat_map(|a| (0..SIDE).map(move |b| (a, b))) {
                let mut value = block[(a, b)];
                if row == column && a == b {
                    value += (damping * value).max(LEAST_HOLD * most[a]);
                }
                let (i, j) = (SIDE * row + a, SIDE * column + b);
                matrix.push(i, j, value);
                // The fill is found by the upper triangle, the factors by the lower one.
                if row != column {
                    matrix.push(j, i, value);
                }
            }
        }
        CscMatrix::from(&matrix)
    }
}
