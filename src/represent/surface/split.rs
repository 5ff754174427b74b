//! From a skin to a mesh in which pieces share no more than they should.

use super::skin::Skin;
use crate::geom::{Point3, TriMesh, Vector3};
use crate::represent::gng::NeuronGraph;

/// How far pieces that touch in one neuron are drawn apart, in distances of neurons.
const APART: f64 = 1e-3;

/// The mesh: of every neuron as many vertices as fans of faces end in it. The first stays where it is; others
/// go a little way into their own piece, so that nothing touches.
pub(super) fn mesh(skin: &Skin, graph: &NeuronGraph, spacing: f64) -> TriMesh {
    let fans = fans(skin);
    let mut n_copies = vec![0_u32; graph.neurons.points.len()];
    let mut vertex_of_fan = vec![u32::MAX; fans.len()];
    // A neuron's place among the mesh's, and which copy of it a vertex is.
    let mut vertices: Vec<(u32, u32)> = Vec::new();
    let mut triangles = Vec::with_capacity(skin.faces.len());
    let mut inwards: Vec<Vector3> = Vec::new();
    for (i_face, face) in skin.faces.iter().enumerate() {
        let [a, b, c] = face.corners.map(|i| graph.neurons.points[i as usize]);
        let normal = (b - a).cross(&(c - a));
        triangles.push([0, 1, 2].map(|i| {
            let vertex = &mut vertex_of_fan[fans[3 * i_face + i] as usize];
            if *vertex == u32::MAX {
                *vertex = vertices.len() as u32;
                let neuron = face.corners[i];
                vertices.push((neuron, n_copies[neuron as usize]));
                n_copies[neuron as usize] += 1;
                inwards.push(Vector3::zeros());
            }
            inwards[*vertex as usize] -= normal;
            *vertex
        }));
    }
    let place = |(&(neuron, copy), inwards): (&(u32, u32), &Vector3)| {
        let way = inwards.try_normalize(f64::MIN_POSITIVE).unwrap_or_else(Vector3::x);
        graph.neurons.points[neuron as usize] + way * (f64::from(copy) * APART * spacing)
    };
    let points: Vec<Point3> = vertices.iter().zip(&inwards).map(place).collect();
    let colors = graph.neurons.colors.as_ref();
    let colors = colors.map(|all| vertices.iter().map(|&(i, _)| all[i as usize]).collect());
    TriMesh { points, triangles, normals: None, colors }
}

/// Sees to it that no two ways of the surface through an edge share both its ends.
///
/// A fan may pass through an edge, go on around its neuron, and come back through the same edge. If it does so at
/// both ends, the two ways are crossed over: each fan falls in two, and the edge is two edges.
pub(super) fn uncross(skin: &mut Skin) {
    let faces = (0..).zip(&skin.faces);
    let mut uses: Vec<([u32; 2], u32)> = faces
        .flat_map(|(i_face, face)| (0..3).map(move |i| (sorted(face.side(i)), i_face)))
        .collect();
    uses.sort_unstable();
    for uses in uses.chunk_by(|a, b| a.0 == b.0).filter(|uses| 1 < uses.len()) {
        let edge = uses[0].0;
        for (n, &(_, first)) in uses.iter().enumerate() {
            for &(_, second) in &uses[n + 1..] {
                let is_one_way = skin.across(first, edge) == Some(second);
                if !is_one_way && edge.iter().all(|&end| skin.is_one_fan(end, first, second)) {
                    skin.cross_over(edge, first, second);
                }
            }
        }
    }
}

fn sorted([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

impl Skin {
    /// The face beyond the side `edge` of `face`.
    fn across(&self, face: u32, edge: [u32; 2]) -> Option<u32> {
        let face = &self.faces[face as usize];
        (0..3).find(|&i| sorted(face.side(i)) == edge).and_then(|i| face.beyond[i])
    }

    fn set_across(&mut self, face: u32, edge: [u32; 2], beyond: Option<u32>) {
        let face = &mut self.faces[face as usize];
        if let Some(i) = (0..3).find(|&i| sorted(face.side(i)) == edge) {
            face.beyond[i] = beyond;
        }
    }

    /// True if going round `neuron` from `first`, one way or the other, leads to `second`.
    fn is_one_fan(&self, neuron: u32, first: u32, second: u32) -> bool {
        let walk = |is_forward: bool| {
            let mut here = first;
            loop {
                let face = &self.faces[here as usize];
                let Some(i) = face.corners.iter().position(|&c| c == neuron) else { return false };
                // The side that leaves the neuron, or the one that comes back to it.
                match face.beyond[if is_forward { i } else { (i + 2) % 3 }] {
                    Some(next) if next == second => return true,
                    Some(next) if next != first => here = next,
                    _ => return false,
                }
            }
        };
        walk(true) || walk(false)
    }

    /// Of two ways through an edge, leads each on where the other led.
    fn cross_over(&mut self, edge: [u32; 2], first: u32, second: u32) {
        let runs_up = |face: u32| (0..3).any(|i| self.faces[face as usize].side(i) == edge);
        let beyond = self.across(second, edge);
        // Neighbours run through their edge in opposite directions.
        let (second, other) = if runs_up(first) == runs_up(second) {
            (beyond, Some(second))
        } else {
            (Some(second), beyond)
        };
        let partner = self.across(first, edge);
        for (a, b) in [(Some(first), second), (partner, other)] {
            for (a, b) in [(a, b), (b, a)] {
                if let Some(a) = a {
                    self.set_across(a, edge, b);
                }
            }
        }
    }
}

/// For every corner of every face the lowest corner of the fan it belongs to.
fn fans(skin: &Skin) -> Vec<u32> {
    let mut parent: Vec<u32> = (0..3 * skin.faces.len() as u32).collect();
    for (i_face, face) in (0..).zip(&skin.faces) {
        for i in 0..3 {
            let Some(there) = face.beyond[i] else { continue };
            let other = &skin.faces[there as usize];
            for (k, corner) in face.side(i).into_iter().enumerate() {
                let here = 3 * i_face + (i as u32 + k as u32) % 3;
                let Some(j) = other.corners.iter().position(|&c| c == corner) else { continue };
                let (a, b) = (root(&mut parent, here), root(&mut parent, 3 * there + j as u32));
                parent[a.max(b) as usize] = a.min(b);
            }
        }
    }
    (0..parent.len() as u32).map(|corner| root(&mut parent, corner)).collect()
}

fn root(parent: &mut [u32], mut corner: u32) -> u32 {
    while parent[corner as usize] != corner {
        parent[corner as usize] = parent[parent[corner as usize] as usize];
        corner = parent[corner as usize];
    }
    corner
}
