//! What a signal costs, by every way there is to learn it.

use crate::clouds;
use crate::plain_gng::PlainGng;
use horma::compute::ComputeChoice;
use horma::geom::{Aabb, PointCloud};
use horma::progress::Silent;
use horma::represent::gng::{GngOptions, NeuronGraph, Search, grow};
use std::time::Instant;

/// A way to learn.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Learner {
    /// As one writes it down.
    Plain,
    /// Every neuron, many side by side.
    Scan,
    /// Winners of a batch on all threads, by cells.
    Batch,
    /// By cells.
    Cells,
    /// One signal after the other on the device of that name.
    Device(String),
}

/// A network of `n` neurons over the cloud, grown from `begin`.
pub(crate) fn network(
    cloud: &PointCloud,
    begin: Option<&NeuronGraph>,
    n: usize,
) -> anyhow::Result<NeuronGraph> {
    Ok(grow(&mut &*cloud, begin, Some(n), &GngOptions::default(), &Silent)?.graph)
}

impl Learner {
    /// What it is called in a table.
    pub(crate) fn name(&self) -> String {
        match self {
            Self::Plain => "CPU, plain loop".to_owned(),
            Self::Scan => "CPU, vectorised".to_owned(),
            Self::Batch => "CPU, batches on all threads".to_owned(),
            Self::Cells => "CPU, indexed".to_owned(),
            Self::Device(name) => name.clone(),
        }
    }

    /// The time of a signal [ns], the network being `graph`; the best of three.
    pub(crate) fn ns(&self, cloud: &PointCloud, graph: &NeuronGraph) -> anyhow::Result<f64> {
        let n = graph.neurons.points.len();
        let mut best = f64::INFINITY;
        for _ in 0..3 {
            best = best.min(match self {
                Self::Plain => plain(cloud, graph, (2_000_000 / n).max(500)),
                Self::Scan => self.ours(cloud, graph, 50_000)?,
                Self::Batch | Self::Cells => self.ours(cloud, graph, 500_000)?,
                Self::Device(_) => self.ours(cloud, graph, 2000)?,
            });
        }
        Ok(best)
    }

    fn options(&self, lambda: u32) -> GngOptions {
        let options = GngOptions { lambda, ..GngOptions::default() };
        match self {
            Self::Plain | Self::Cells => options,
            Self::Scan => GngOptions { search: Search::Scan, ..options },
            Self::Batch => GngOptions { batch: Some(1000), ..options },
            Self::Device(name) => {
                GngOptions { compute: ComputeChoice::Gpu, adapter: Some(name.clone()), ..options }
            }
        }
    }

    /// The time of a signal, what it takes to begin taken off.
    fn ours(&self, cloud: &PointCloud, graph: &NeuronGraph, n_signals: u32) -> anyhow::Result<f64> {
        let seconds = |lambda: u32| -> anyhow::Result<f64> {
            let n = Some(graph.neurons.points.len());
            let begin = Instant::now();
            grow(&mut &*cloud, Some(graph), n, &self.options(lambda), &Silent)?;
            Ok(begin.elapsed().as_nanos() as f64)
        };
        let few = n_signals / 10;
        Ok((seconds(n_signals)? - seconds(few)?) / f64::from(n_signals - few))
    }
}

fn plain(cloud: &PointCloud, graph: &NeuronGraph, n_signals: usize) -> f64 {
    let origin = Aabb::around(&cloud.points).center();
    let mut network = PlainGng::of_graph(graph, &origin);
    let begin = Instant::now();
    network.learn(clouds::signals(cloud, &origin).take(n_signals));
    begin.elapsed().as_nanos() as f64 / n_signals as f64
}
