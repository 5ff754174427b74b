//! Down to where the edges fit best, each counting for what it is given: damped Gauss-Newton steps.

use super::normal::Normal;
use super::residual::value;
use super::{Edge, PoseGraph, Settled};
use crate::geom::Pose;
use crate::progress::{Cancelled, Progress};

/// Steps of a descent at most.
const STEPS: u32 = 100;
/// A descent ends when the cost falls by less than this share of itself.
const STILL: f64 = 1e-10;
/// The first damping, and by what it grows where a step leads uphill.
const DAMPING: [f64; 2] = [1e-6, 10.0];
/// Dampings tried.
const TRIES: u32 = 10;
/// A graph on its way down.
pub(super) struct Descent<'a> {
    graph: &'a PoseGraph,
    poses: Vec<Pose>,
    /// What each edge counts for.
    pub(super) weights: Vec<f64>,
    first_cost: f64,
    n_steps: u32,
    converged: bool,
}

impl<'a> Descent<'a> {
    pub(super) fn new(graph: &'a PoseGraph) -> Self {
        let poses = graph.world_from_node.clone();
        let weights = vec![1.0; graph.edges.len()];
        let mut descent =
            Self { graph, poses, weights, first_cost: 0.0, n_steps: 0, converged: false };
        descent.first_cost = descent.cost(&descent.poses);
        descent
    }

    /// How far each edge is off, squared.
    pub(super) fn squares(&self) -> Vec<f64> {
        self.graph.edges.iter().map(|edge| square(edge, &self.poses)).collect()
    }

    fn cost(&self, poses: &[Pose]) -> f64 {
        let edges = self.graph.edges.iter().zip(&self.weights);
        0.5 * edges.map(|(edge, weight)| weight * square(edge, poses)).sum::<f64>()
    }

    /// Down to where steps are small, with the weights as they are.
    pub(super) fn run(&mut self, progress: &dyn Progress) -> Result<(), Cancelled> {
        let mut cost = self.cost(&self.poses);
        self.converged = false;
        for _ in 0..STEPS {
            progress.advance(0)?;
            let normal = Normal::new(self.graph, &self.poses, &self.weights);
            let Some((poses, after)) = self.downhill(&normal, cost) else {
                // No step makes the cost smaller: this is the bottom.
                self.converged = true;
                break;
            };
            self.n_steps += 1;
            self.poses = poses;
            let fell = cost - after;
            cost = after;
            if fell <= STILL * cost.max(f64::MIN_POSITIVE) {
                self.converged = true;
                break;
            }
        }
        Ok(())
    }

    fn downhill(&self, normal: &Normal, cost: f64) -> Option<(Vec<Pose>, f64)> {
        let [first, factor] = DAMPING;
        let mut damping = 0.0;
        for _ in 0..TRIES {
            if let Some(poses) = normal.step(&self.poses, damping) {
                let after = self.cost(&poses);
                if after < cost {
                    return Some((poses, after));
                }
            }
            damping = if damping == 0.0 { first } else { damping * factor };
        }
        None
    }

    pub(super) fn settled(self) -> Settled {
        let off = self.squares().iter().map(|square| square.sqrt()).collect();
        let cost = [self.first_cost, self.cost(&self.poses)];
        let (n_steps, converged) = (self.n_steps, self.converged);
        Settled {
            world_from_node: self.poses,
            weights: self.weights,
            off,
            cost,
            n_steps,
            converged,
        }
    }
}

/// How far an edge is off [standard deviations, squared].
fn square(edge: &Edge, poses: &[Pose]) -> f64 {
    let off = value(edge, &poses[edge.a], &poses[edge.b]);
    off.dot(&(edge.information * off)).max(0.0)
}
