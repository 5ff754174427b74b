//! Networks of neurons as files: PLY with edges, to be read again; GLB with lines, to be looked at.

use super::fault::{Fault, ReadError};
use super::format::{Format, extension};
use super::output::WriteError;
use super::output_set::OutputSet;
use super::read::{opened, settle};
use super::{gltf, ply};
use crate::geom::{LengthUnit, Surface};
use crate::represent::gng::NeuronGraph;
use std::path::Path;

/// Reads the network in the PLY file `path`; lengths are in `unit` if it is given. Nothing if the file
/// holds something else: a cloud, a mesh.
pub fn read_network(
    path: &Path,
    unit: Option<LengthUnit>,
) -> Result<Option<NeuronGraph>, ReadError> {
    read(path, unit).map_err(|fault| ReadError { path: path.into(), fault })
}

fn read(path: &Path, unit: Option<LengthUnit>) -> Result<Option<NeuronGraph>, Fault> {
    opened(path, |format, source, _| {
        if format != Format::Ply {
            return Ok(None);
        }
        let (raw, net) = ply::read_all(source)?;
        let n_points = raw.surface.points().len();
        let reading = settle(raw, format, unit)?;
        let Surface::Points(neurons) = reading.surface else { return Ok(None) };
        // A neuron that is no number was dropped, and with it the numbers of the others.
        let is_whole = neurons.points.len() == n_points && !net.edges.is_empty();
        let errors = net.errors.iter().map(|error| error * reading.unit.in_mm().powi(2)).collect();
        Ok(is_whole.then_some(NeuronGraph { neurons, edges: net.edges, errors }))
    })
}

impl OutputSet {
    /// Writes a network as [`OutputSet::add`] does: `.ply` keeps all of it, `.glb` its lines, other formats
    /// the neurons as points.
    pub fn add_network(&mut self, path: &Path, graph: &NeuronGraph) -> Result<(), WriteError> {
        match extension(path).as_str() {
            "ply" => self.add(path, |out| ply::write_network(out, graph)),
            "glb" => self.add(path, |out| gltf::write_network(out, graph)),
            _ => self.add_surface(path, &Surface::Points(graph.neurons.clone())),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::{Point3, PointCloud};
    use crate::io::{Overwrite, read_surface};
    use crate::represent::gng::GraphEdge;

    fn graph() -> NeuronGraph {
        NeuronGraph {
            neurons: PointCloud {
                points: vec![
                    Point3::new(0.1, 20.0, 3.0),
                    Point3::new(100.0, 5.0, 6.0),
                    Point3::origin(),
                ],
                normals: None,
                colors: Some(vec![[1, 2, 3], [4, 5, 6], [7, 8, 9]]),
            },
            edges: [([0, 1], 7), ([1, 2], 0)].map(|(ends, age)| GraphEdge { ends, age }).to_vec(),
            errors: vec![0.5, 1e-7, 3.25],
        }
    }

    fn written(path: &Path) {
        let mut files = OutputSet::new(Overwrite::Replace);
        files.add_network(path, &graph()).unwrap();
        files.commit().unwrap();
    }

    #[test]
    fn a_network_reads_back_with_all_it_has() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("net.ply");
        written(&path);
        assert_eq!(read_network(&path, None).unwrap(), Some(graph()));
        let metres = read_network(&path, Some(LengthUnit::Metre)).unwrap().unwrap();
        assert_eq!((metres.neurons.points[1].x, metres.errors[0]), (100_000.0, 500_000.0));
        let cloud = read_surface(&path, None).unwrap();
        assert_eq!(cloud.surface.points(), graph().neurons.points);
        assert_eq!(cloud.notes[0], "2 edges of a network left out");
    }

    #[test]
    fn a_cloud_is_no_network() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["net.xyz", "net.glb"] {
            let path = folder.path().join(name);
            written(&path);
            assert_eq!(read_network(&path, None).unwrap(), None, "{name}");
        }
    }

    #[test]
    fn an_edge_to_a_vertex_that_is_not_there_is_told() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("net.ply");
        let head = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n";
        let edges =
            "element edge 1\nproperty int vertex1\nproperty int vertex2\nend_header\n1 2 3\n0 4\n";
        std::fs::write(&path, format!("{head}{edges}")).unwrap();
        let error = read_network(&path, None).unwrap_err().to_string();
        assert!(error.contains("line 12: an edge names vertex 4, but there are only 1"), "{error}");
    }
}
