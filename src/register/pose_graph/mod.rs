//! A pose graph: nodes that are somewhere, edges that say where from each other, and the poses that fit
//! all edges best.
//!
//! A walk is a chain of edges, each a little off, and so the end is off by all of them. Where the camera
//! comes back to what it has seen, an edge closes the loop and says by how much; the sum of what all edges
//! are off, each by what is known of it, is made small by damped Gauss-Newton steps. Loops may be wrong
//! as a whole, because two places look alike; those that do not fit the others are given no weight.
//!
//! Lu and Milios (1997); Grisetti et al., *A tutorial on graph-based SLAM* (2010); Yang et al.,
//! *Graduated non-convexity for robust spatial perception* (2020).

mod descent;
mod normal;
mod options;
mod residual;
mod robust;

pub use options::{GraphOptions, LoopKernel};

use crate::geom::Pose;
use crate::progress::{Cancelled, Progress};
use descent::Descent;
use nalgebra::Matrix6;
use robust::Stage;

/// Rounds of a kernel at most.
const ROUNDS: u32 = 100;

/// What is measured, and where to begin.
#[derive(Debug, Clone, PartialEq)]
pub struct PoseGraph {
    /// Where each node is, roughly.
    pub world_from_node: Vec<Pose>,
    /// What was measured.
    pub edges: Vec<Edge>,
    /// The node that stays where it is.
    pub fixed: usize,
}

/// A motion that was measured between two nodes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Edge {
    /// One end.
    pub a: usize,
    /// The other.
    pub b: usize,
    /// The motion.
    pub a_from_b: Pose,
    /// What is known of it: information of a small step, turn [rad] before shift [mm], taken from the
    /// left.
    pub information: Matrix6<f64>,
    /// Whether it may be wrong as a whole.
    pub kind: EdgeKind,
}

/// Whether an edge may be wrong as a whole.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EdgeKind {
    /// It is right, but for noise.
    Step,
    /// It may be wrong.
    Loop,
}

/// Poses that fit the edges best.
#[derive(Debug, Clone, PartialEq)]
pub struct Settled {
    /// Where each node is.
    pub world_from_node: Vec<Pose>,
    /// What each edge counted for, from 0 to 1; below 1 only loops.
    pub weights: Vec<f64>,
    /// How far each edge is off [standard deviations].
    pub off: Vec<f64>,
    /// Half the weighted sum of squares at the start, with loops at full weight, and at the end.
    pub cost: [f64; 2],
    /// Steps taken.
    pub n_steps: u32,
    /// True if the last step was small.
    pub converged: bool,
}

/// Why a graph cannot be settled.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum GraphError {
    /// An edge to nowhere.
    #[error("edge {edge} goes to node {node}, but there are {n_nodes}")]
    Node {
        /// The edge, counted from 0.
        edge: usize,
        /// Its end.
        node: usize,
        /// How many nodes there are.
        n_nodes: usize,
    },
    /// Numbers that are none.
    #[error("{what} {number} is not finite, or its information is not that of anything")]
    Number {
        /// `node` or `edge`.
        what: &'static str,
        /// Which, counted from 0.
        number: usize,
    },
    /// Parts that nothing holds together.
    #[error("no chain of edges leads from node {fixed} to node {node}; leave it out")]
    Apart {
        /// The node that stays.
        fixed: usize,
        /// The one that is not held.
        node: usize,
    },
    /// A limit that is none.
    #[error("--loop-limit is {value}; it must be a number above 0")]
    Limit {
        /// What was given.
        value: f64,
    },
    /// The caller asked to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// The poses that fit the edges of `graph` best.
pub fn settle(
    graph: &PoseGraph,
    options: &GraphOptions,
    progress: &dyn Progress,
) -> Result<Settled, GraphError> {
    graph.check()?;
    options.check()?;
    let mut descent = Descent::new(graph);
    descent.run(progress)?;
    let loops: Vec<usize> =
        (0..graph.edges.len()).filter(|&i| graph.edges[i].kind == EdgeKind::Loop).collect();
    let squares = descent.squares();
    let of_loops = loops.iter().map(|&i| squares[i]);
    let mut stage = Stage::first(options.loop_kernel, options.loop_limit, of_loops);
    for _ in 0..ROUNDS {
        let squares = descent.squares();
        let before = descent.weights.clone();
        for &i in &loops {
            descent.weights[i] = stage.weight(squares[i]);
        }
        let of_loops: Vec<f64> = loops.iter().map(|&i| descent.weights[i]).collect();
        let pairs = descent.weights.iter().zip(&before);
        let changed = pairs.map(|(now, before)| (now - before).abs()).fold(0.0, f64::max);
        let is_last = stage.is_last(&of_loops);
        if changed > 0.0 {
            descent.run(progress)?;
        }
        if is_last || changed < 1e-6 && stage == stage.next() {
            break;
        }
        stage = stage.next();
    }
    Ok(descent.settled())
}

impl GraphOptions {
    /// Refuses numbers that mean nothing.
    pub fn check(&self) -> Result<(), GraphError> {
        let is_good = self.loop_limit > 0.0 && self.loop_limit.is_finite();
        if is_good { Ok(()) } else { Err(GraphError::Limit { value: self.loop_limit }) }
    }
}

impl PoseGraph {
    fn check(&self) -> Result<(), GraphError> {
        let n_nodes = self.world_from_node.len();
        let is_finite = |pose: &Pose| pose.to_homogeneous().iter().all(|x| x.is_finite());
        if let Some(number) = self.world_from_node.iter().position(|pose| !is_finite(pose)) {
            return Err(GraphError::Number { what: "node", number });
        }
        for (number, edge) in self.edges.iter().enumerate() {
            if let Some(node) = [edge.a, edge.b].into_iter().find(|node| *node >= n_nodes) {
                return Err(GraphError::Node { edge: number, node, n_nodes });
            }
            let spread = edge.information.diagonal();
            let is_known = edge.information.iter().all(|x| x.is_finite()) && spread.min() >= 0.0;
            if !(is_finite(&edge.a_from_b) && is_known) {
                return Err(GraphError::Number { what: "edge", number });
            }
        }
        match self.apart() {
            Some(node) => Err(GraphError::Apart { fixed: self.fixed, node }),
            None => Ok(()),
        }
    }

    /// A node that no chain of edges joins with the fixed one.
    fn apart(&self) -> Option<usize> {
        let mut is_held = vec![false; self.world_from_node.len()];
        *is_held.get_mut(self.fixed)? = true;
        let mut grows = true;
        while grows {
            grows = false;
            for edge in &self.edges {
                if is_held[edge.a] != is_held[edge.b] {
                    (is_held[edge.a], is_held[edge.b]) = (true, true);
                    grows = true;
                }
            }
        }
        is_held.iter().position(|held| !held)
    }
}

#[cfg(test)]
mod tests;
