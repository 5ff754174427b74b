//! A cloud in, a network out.

use super::error::GngError;
use super::graph::NeuronGraph;
use super::learn::{Learned, Stopped, learn};
use super::network::Network;
use super::options::{GngOptions, Search};
use super::signals::{Signals, place};
use super::winners::{Grid, Scan};
use crate::geom::{Aabb, CloudParts, PointCloud, Vector3, box_of_parts};
use crate::progress::Progress;

/// What growing led to.
#[derive(Debug, Clone, PartialEq)]
pub struct Grown {
    /// The network; its neurons have neither normals nor colours yet.
    pub graph: NeuronGraph,
    /// How many signals it learned from.
    pub n_signals: u64,
    /// Why it no longer grows.
    pub stopped: Stopped,
}

/// Grows a network over a cloud, from two neurons or from `begin`, to `n_neurons` or until the options stop it.
pub fn grow(
    parts: &mut dyn CloudParts,
    begin: Option<&NeuronGraph>,
    n_neurons: Option<usize>,
    options: &GngOptions,
    progress: &dyn Progress,
) -> Result<Grown, GngError> {
    options.check()?;
    check_count(parts.n_points(), n_neurons, options)?;
    let aabb = box_of_parts(parts)?;
    if aabb.size().max() == 0.0 {
        return Ok(in_one_place(&aabb));
    }
    let origin = aabb.center();
    let mut signals = Signals::new(parts, &aabb, options.seed)?;
    let mut network = match begin {
        Some(graph) => Network::of_graph(graph, &origin)?,
        None => {
            let mut first = [[0.0; 3]; 2];
            signals.fill(&mut first)?;
            Network::of_two(first)
        }
    };
    let n_begin = network.neurons.len();
    let n_neurons = n_neurons.unwrap_or(usize::MAX);
    progress.start("growing", n_neurons.saturating_sub(n_begin).min(u32::MAX as usize) as u64);
    let Learned { n_signals, stopped } = match options.search {
        Search::Grid => {
            let [low, high] = corners(&aabb);
            let winners = Grid::over(low, high, &network.neurons);
            learn(&mut network, winners, &mut signals, n_neurons, options, progress)
        }
        Search::Scan => {
            let winners = Scan::over(&network.neurons);
            learn(&mut network, winners, &mut signals, n_neurons, options, progress)
        }
    }?;
    Ok(Grown { graph: network.to_graph(&origin), n_signals, stopped })
}

fn check_count(
    n_points: u64,
    n_neurons: Option<usize>,
    options: &GngOptions,
) -> Result<(), GngError> {
    let GngOptions { max_signals, max_seconds, target_error, .. } = options;
    let is_endless = max_signals.is_none() && max_seconds.is_none() && target_error.is_none();
    match n_neurons {
        _ if n_points == 0 => Err(GngError::Empty),
        None if is_endless => Err(GngError::Endless),
        Some(n_neurons) if n_neurons < 2 && 1 < n_points => Err(GngError::TooFew { n_neurons }),
        Some(n_neurons) if n_points < n_neurons as u64 => {
            Err(GngError::TooMany { n_neurons, n_points })
        }
        _ => Ok(()),
    }
}

/// The lowest and the highest corner, from the middle.
fn corners(aabb: &Aabb) -> [[f32; 3]; 2] {
    let half: Vector3 = aabb.size() / 2.0;
    let middle = aabb.center();
    [middle - half, middle + half].map(|corner| place(&corner, &middle))
}

/// All points in one place: one neuron says it all.
fn in_one_place(aabb: &Aabb) -> Grown {
    let neurons = PointCloud { points: vec![aabb.center()], ..PointCloud::default() };
    let graph = NeuronGraph { neurons, edges: Vec::new(), errors: vec![0.0] };
    Grown { graph, n_signals: 0, stopped: Stopped::OnePlace }
}
