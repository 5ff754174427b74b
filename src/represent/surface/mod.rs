//! From a network of neurons to a surface: triangles over the neurons, closed where the cloud is.
//!
//! The space between the neurons is cut into Delaunay tetrahedra, and every one is put on one of two sides;
//! the surface is what lies between the sides. So it never crosses itself, no edge has a face too many, all
//! faces are wound alike, and it is closed by itself: what is not there in the cloud is taken out again.
//!
//! - [`links`]: which neurons lie side by side, by the network and by the cloud;
//! - [`evidence`]: what each facet says of the two cells it parts;
//! - [`sides`]: the sides that follow, the surest first;
//! - [`skin`]: the faces between the sides, [`trim`]med where nothing was scanned;
//! - [`split`]: the mesh, with pieces that touch drawn apart.
//!
//! The network's edges are a part of the Delaunay triangulation that the surface induces (Martinetz and
//! Schulten 1994), but triangles of edges alone leave a quarter of a surface open.

mod beyond;
mod error;
mod evidence;
mod facing;
mod fit;
mod links;
mod options;
mod rims;
mod sides;
mod skin;
mod split;
mod trim;

pub use error::SurfaceError;
pub use fit::{Distances, Fit, fit};
pub use options::SurfaceOptions;
pub use rims::{Rim, rims};

use super::gng::NeuronGraph;
use crate::geom::{PointCloud, TriMesh, delaunay};
use crate::progress::Progress;
use links::Links;
use skin::Skin;

/// A network's surface.
#[derive(Debug, Clone, PartialEq)]
pub struct NetworkSurface {
    /// The surface. Its vertices are neurons, in another order; a neuron in which pieces touch has one for each.
    pub mesh: TriMesh,
    /// How many gaps were filled.
    pub n_filled: usize,
    /// The longest rim that was closed, if any rim was that long [mm].
    pub longest_rim: f64,
    /// The mean distance of a neuron from the six nearest [mm].
    pub spacing: f64,
}

/// The surface of `graph`, a network that stands for `cloud` or for one that is not at hand.
///
/// The mesh has no edge with more than two triangles and no vertex in which more than one fan of them ends, whatever
/// the network is.
pub fn surface(
    graph: &NeuronGraph,
    cloud: Option<&PointCloud>,
    options: &SurfaceOptions,
    progress: &dyn Progress,
) -> Result<NetworkSurface, SurfaceError> {
    options.check()?;
    check(graph)?;
    let points = &graph.neurons.points;
    let cells = delaunay(points, progress)?;
    let links = Links::of(graph, cloud, progress)?;
    let spacing = links.mean_spacing().ok_or(SurfaceError::Nothing)?;
    let longest_rim = options.longest_rim(spacing);
    let facets = evidence::facets(points, &cells, &links);
    let mut sides = sides::sides(cells.len(), &facets, progress)?;
    beyond::close(points, &cells, &mut sides, longest_rim);
    let outside = beyond::outside(&cells, &sides);
    let skin = Skin::between(&cells, &sides, &links);
    let (skin, n_filled) = trim::trimmed(skin, points, longest_rim);
    if skin.faces.is_empty() {
        return Err(SurfaceError::Nothing);
    }
    let normals = facing::normals(graph, cloud);
    let mut skin = facing::faced(skin, points, normals.as_deref(), outside);
    split::uncross(&mut skin);
    let mesh = split::mesh(&skin, graph, spacing);
    Ok(NetworkSurface { mesh, n_filled, longest_rim, spacing })
}

fn check(graph: &NeuronGraph) -> Result<(), SurfaceError> {
    let points = &graph.neurons.points;
    if let Some(i) = points.iter().position(|p| !p.iter().all(|x| x.is_finite())) {
        let [x, y, z] = points[i].into();
        return Err(SurfaceError::NotFinite { number: i + 1, x, y, z });
    }
    let n_neurons = points.len();
    let is_wild =
        |ends: &[u32; 2]| ends[0] == ends[1] || ends.iter().any(|&i| i as usize >= n_neurons);
    if let Some(i) = graph.edges.iter().position(|edge| is_wild(&edge.ends)) {
        let [a, b] = graph.edges[i].ends;
        return Err(SurfaceError::Edge { number: i + 1, a, b, n_neurons });
    }
    Ok(())
}

#[cfg(test)]
mod tests;
