//! Which way a piece of the surface faces.

use super::skin::Skin;
use crate::geom::{KdTree, Nearest, Point3, PointCloud, Vector3};
use crate::represent::gng::NeuronGraph;
use std::borrow::Cow;

/// Below this share of a ball's a piece holds no volume to speak of: it is a sheet.
const SHEET: f64 = 0.02;

/// A normal for each neuron: its own, or the sum of those of the points nearest to it.
pub(super) fn normals<'a>(
    graph: &'a NeuronGraph,
    cloud: Option<&PointCloud>,
) -> Option<Cow<'a, [Vector3]>> {
    if let Some(normals) = &graph.neurons.normals {
        return Some(Cow::Borrowed(normals));
    }
    let cloud = cloud?;
    let given = cloud.normals.as_ref()?;
    let tree = KdTree::build(&graph.neurons.points);
    let mut sums = vec![Vector3::zeros(); graph.neurons.points.len()];
    for (point, normal) in cloud.points.iter().zip(given) {
        if let Some(neuron) = tree.nearest(point, f64::INFINITY) {
            sums[neuron.index as usize] += normal;
        }
    }
    Some(Cow::Owned(sums))
}

/// Turns every piece outwards: where `normals` say, else closed pieces away from the side they have `outside`
/// of them, and open ones bulging; a sheet up.
///
/// The faces come wound as seen from the `false` side.
pub(super) fn faced(
    skin: Skin,
    points: &[Point3],
    normals: Option<&[Vector3]>,
    outside: bool,
) -> Skin {
    let wrong: Vec<u32> = skin
        .pieces(|_, _| true)
        .into_iter()
        .filter(|piece| is_wrong(&skin, piece, points, normals, outside))
        .flatten()
        .collect();
    skin.turned(&wrong)
}

fn is_wrong(
    skin: &Skin,
    piece: &[u32],
    points: &[Point3],
    normals: Option<&[Vector3]>,
    outside: bool,
) -> bool {
    let faces = || piece.iter().map(|&face| &skin.faces[face as usize]);
    let corners = || faces().map(|face| face.corners.map(|i| points[i as usize]));
    let vector = |[a, b, c]: [Point3; 3]| (b - a).cross(&(c - a)) / 2.0;
    if let Some(normals) = normals {
        let says = |face: [u32; 3]| -> Vector3 { face.iter().map(|&i| normals[i as usize]).sum() };
        let votes = faces().zip(corners()).map(|(face, at)| vector(at).dot(&says(face.corners)));
        return votes.sum::<f64>() < 0.0;
    }
    if faces().all(|face| face.beyond.iter().all(Option::is_some)) {
        return outside;
    }
    let area: f64 = corners().map(|at| vector(at).norm()).sum();
    let first = corners().next().map_or_else(Point3::origin, |[a, ..]| a);
    let sum: Vector3 = corners()
        .map(|at| at.iter().map(|p| p - first).sum::<Vector3>() / 3.0 * vector(at).norm())
        .sum();
    let middle = first + sum / area.max(f64::MIN_POSITIVE);
    let volume: f64 = corners().map(|at| (at[0] - middle).dot(&vector(at)) / 3.0).sum();
    let of_ball = (area / std::f64::consts::PI).powf(1.5) * std::f64::consts::PI / 6.0;
    if volume.abs() < SHEET * of_ball {
        return corners().map(|at| vector(at).z).sum::<f64>() < 0.0;
    }
    volume < 0.0
}
