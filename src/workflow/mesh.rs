//! A cloud, or the network that stands for one, becomes a surface.

use crate::geom::{MeshReport, PointCloud, TriMesh, topology};
use crate::progress::{Cancelled, Progress};
use crate::represent::gng::{GngError, GngOptions, NeuronGraph, Stopped, grow};
use crate::represent::surface::{
    Fit, NetworkSurface, Rim, SurfaceError, SurfaceOptions, fit, rims, surface,
};
use serde::Serialize;

/// Neurons a network gets that nobody asks a number of: a third of the points, at most these.
const MOST_NEURONS: usize = 20_000;
/// Points to a neuron, at least, where nobody asks for a number.
const POINTS_TO_A_NEURON: usize = 3;

/// What is to become a surface.
#[derive(Debug)]
pub struct MeshJob<'a> {
    /// What stands for the surface.
    pub source: MeshSource<'a>,
    /// What of the surface is closed.
    pub options: &'a SurfaceOptions,
    /// What the user must know about the inputs.
    pub notes: Vec<String>,
}

/// What stands for a surface.
#[derive(Debug, Clone, Copy)]
pub enum MeshSource<'a> {
    /// A cloud: it is learned by a network first.
    Cloud {
        /// The cloud.
        cloud: &'a PointCloud,
        /// How many neurons its network gets, if somebody says so.
        n_neurons: Option<usize>,
        /// How the network learns.
        gng: &'a GngOptions,
    },
    /// A network that was grown before.
    Network {
        /// The network.
        graph: &'a NeuronGraph,
        /// The cloud it stands for, if that is at hand.
        cloud: Option<&'a PointCloud>,
    },
}

/// The result.
#[derive(Debug, Clone, PartialEq)]
pub struct Meshed {
    /// The surface.
    pub mesh: TriMesh,
    /// What is to be known about it.
    pub report: MeshedReport,
}

/// What is told about a surface; lengths in mm.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MeshedReport {
    /// Points of the cloud, where there was one.
    pub n_points: Option<usize>,
    /// Neurons of the network.
    pub n_neurons: usize,
    /// Signals the network learned from, where it was grown for this.
    pub n_signals: Option<u64>,
    /// The mean distance of a neuron from the six nearest.
    pub spacing: f64,
    /// How the triangles hang together.
    pub topology: MeshReport,
    /// True if the surface has no border.
    pub is_closed: bool,
    /// Vertices less edges and triangles: 2 for a ball, 0 for a ring, one less for every rim.
    pub euler: isize,
    /// Where it ends, the longest first.
    pub rims: Vec<Rim>,
    /// Rims no longer than this were closed.
    pub longest_rim: f64,
    /// Gaps that were filled.
    pub n_filled: usize,
    /// How far it is from the cloud, where there was one.
    pub fit: Option<Fit>,
    /// What the user must know about the inputs.
    pub notes: Vec<String>,
}

/// Why there is no surface.
#[derive(Debug, thiserror::Error)]
pub enum MeshError {
    /// The cloud could not be learned.
    #[error(transparent)]
    Learn(#[from] GngError),
    /// The network has no surface.
    #[error(transparent)]
    Surface(#[from] SurfaceError),
    /// The caller asked to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// The surface of a cloud or a network.
pub fn mesh(job: MeshJob<'_>, progress: &dyn Progress) -> Result<Meshed, MeshError> {
    job.options.check()?;
    let mut notes = job.notes;
    let grown;
    let (graph, cloud, n_signals) = match job.source {
        MeshSource::Network { graph, cloud } => (graph, cloud, None),
        MeshSource::Cloud { mut cloud, n_neurons, gng } => {
            let n_neurons = n_neurons.unwrap_or_else(|| usual_count(cloud.points.len()));
            grown = grow(&mut cloud, None, Some(n_neurons), gng, progress)?;
            if grown.stopped != Stopped::Count {
                let n = grown.graph.neurons.points.len();
                notes.push(format!("the network stopped at {n} of {n_neurons} neurons"));
            }
            (&grown.graph, Some(cloud), Some(grown.n_signals))
        }
    };
    let found = surface(graph, cloud, job.options, progress)?;
    let NetworkSurface { mesh, n_filled, longest_rim, spacing } = found;
    let fit = match cloud.filter(|cloud| !cloud.points.is_empty()) {
        Some(cloud) => Some(fit(&mesh, cloud, spacing, progress)?),
        None => None,
    };
    let topology = topology(&mesh);
    let report = MeshedReport {
        n_points: cloud.map(|cloud| cloud.points.len()),
        n_neurons: graph.neurons.points.len(),
        n_signals,
        spacing,
        is_closed: topology.is_closed(),
        euler: euler(&topology),
        topology,
        rims: rims(&mesh),
        longest_rim,
        n_filled,
        fit,
        notes,
    };
    Ok(Meshed { mesh, report })
}

fn usual_count(n_points: usize) -> usize {
    (n_points / POINTS_TO_A_NEURON).clamp(2, MOST_NEURONS)
}

/// Vertices less edges and triangles of a manifold.
fn euler(report: &MeshReport) -> isize {
    let [n_points, n_triangles, n_open] =
        [report.n_points, report.n_triangles, report.n_open_edges].map(usize::cast_signed);
    let n_inner = (3 * n_triangles - n_open) / 2;
    n_points - (n_open + n_inner) + n_triangles
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::{Point3, shapes};
    use crate::progress::Silent;

    fn ball() -> PointCloud {
        let points = shapes::sphere(&Point3::new(1.0, 2.0, 3.0), 20.0, 40).points;
        PointCloud { points, ..PointCloud::default() }
    }

    fn job<'a>(source: MeshSource<'a>, options: &'a SurfaceOptions) -> MeshJob<'a> {
        MeshJob { source, options, notes: Vec::new() }
    }

    #[test]
    fn a_cloud_and_its_network_have_the_same_surface() {
        let (cloud, options) = (ball(), SurfaceOptions::default());
        let gng = GngOptions { lambda: 200, ..GngOptions::default() };
        let source = MeshSource::Cloud { cloud: &cloud, n_neurons: Some(300), gng: &gng };
        let from_cloud = mesh(job(source, &options), &Silent).unwrap();
        let report = &from_cloud.report;
        assert_eq!((report.is_closed, report.euler, report.n_neurons), (true, 2, 300));
        assert_eq!((report.rims.len(), report.n_points), (0, Some(cloud.points.len())));
        let fit = report.fit.unwrap();
        assert!(fit.cloud_to_mesh.max < report.spacing && fit.cloud_to_mesh.mean < 0.5);
        let graph = grow(&mut &cloud, None, Some(300), &gng, &Silent).unwrap().graph;
        let source = MeshSource::Network { graph: &graph, cloud: Some(&cloud) };
        assert_eq!(mesh(job(source, &options), &Silent).unwrap().mesh, from_cloud.mesh);
        let alone = MeshSource::Network { graph: &graph, cloud: None };
        let alone = mesh(job(alone, &options), &Silent).unwrap().report;
        assert_eq!((alone.is_closed, alone.fit, alone.n_signals), (true, None, None));
    }

    #[test]
    fn a_network_that_stops_early_is_told() {
        let (cloud, options) = (ball(), SurfaceOptions::default());
        let gng = GngOptions { max_signals: Some(60_000), ..GngOptions::default() };
        let source = MeshSource::Cloud { cloud: &cloud, n_neurons: None, gng: &gng };
        let report = mesh(job(source, &options), &Silent).unwrap().report;
        assert!(report.n_neurons < cloud.points.len() / 3);
        assert!(report.notes[0].starts_with("the network stopped at "), "{:?}", report.notes);
    }

    #[test]
    fn the_usual_count_is_a_third_of_the_points() {
        assert_eq!([0, 30, 60_000, 1_000_000].map(usual_count), [2, 10, 20_000, 20_000]);
    }
}
