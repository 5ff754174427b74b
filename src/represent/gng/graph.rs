//! A network as others see it: places, edges, and what is needed to let it grow on.

use crate::geom::PointCloud;

/// What growing neural gas made of a cloud.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct NeuronGraph {
    /// Where the neurons are, with the mean normal and colour of the points each stands for.
    pub neurons: PointCloud,
    /// Which are joined.
    pub edges: Vec<GraphEdge>,
    /// How far off each neuron's signals were of late: sums of squares, decayed [mm^2].
    pub errors: Vec<f64>,
}

/// An edge of a [`NeuronGraph`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct GraphEdge {
    /// The neurons it joins, the lower number first.
    pub ends: [u32; 2],
    /// How often they have won since a signal confirmed it.
    pub age: u32,
}

impl NeuronGraph {
    /// The neurons joined to each neuron, by rising number.
    pub fn neighbours(&self) -> Vec<Vec<u32>> {
        let mut neighbours = vec![Vec::new(); self.neurons.points.len()];
        for edge in &self.edges {
            let [a, b] = edge.ends;
            neighbours[a as usize].push(b);
            neighbours[b as usize].push(a);
        }
        for row in &mut neighbours {
            row.sort_unstable();
        }
        neighbours
    }

    /// The mean length of an edge [mm]; nothing where there is none.
    pub fn mean_edge(&self) -> Option<f64> {
        let length = |edge: &GraphEdge| {
            let [a, b] = edge.ends.map(|i| self.neurons.points[i as usize]);
            (a - b).norm()
        };
        let sum: f64 = self.edges.iter().map(length).sum();
        (!self.edges.is_empty()).then(|| sum / self.edges.len() as f64)
    }
}
