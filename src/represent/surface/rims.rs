//! Where a mesh ends: its rims, one after the other.

use crate::geom::{Point3, TriMesh};
use serde::Serialize;
use std::collections::{HashMap, HashSet};

/// A closed line along which a mesh ends.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct Rim {
    /// Its edges.
    pub n_edges: usize,
    /// How long it is [mm].
    pub length: f64,
    /// Its middle [mm].
    pub middle: [f64; 3],
}

/// The rims of a mesh that is manifold and wound alike, the longest first.
pub fn rims(mesh: &TriMesh) -> Vec<Rim> {
    let mut next = open_edges(mesh);
    let mut starts: Vec<u32> = next.keys().copied().collect();
    starts.sort_unstable();
    let mut rims: Vec<Rim> = Vec::new();
    for start in starts {
        let mut corners = Vec::new();
        let mut here = start;
        while let Some(there) = next.remove(&here) {
            corners.push(mesh.points[here as usize]);
            here = there;
        }
        if !corners.is_empty() {
            rims.push(rim(&corners));
        }
    }
    rims.sort_by(|a, b| b.length.total_cmp(&a.length));
    rims
}

/// For every corner on a rim the next one.
fn open_edges(mesh: &TriMesh) -> HashMap<u32, u32> {
    let all = mesh.triangles.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]);
    let mut open = HashSet::new();
    for (from, to) in all {
        if !open.remove(&(to, from)) {
            open.insert((from, to));
        }
    }
    open.into_iter().collect()
}

fn rim(corners: &[Point3]) -> Rim {
    let ends = || corners.iter().zip(corners.iter().cycle().skip(1));
    let length: f64 = ends().map(|(a, b)| (a - b).norm()).sum();
    let first = corners[0];
    let moment = |(a, b): (&Point3, &Point3)| ((a - first) + (b - first)) / 2.0 * (a - b).norm();
    let middle =
        first + ends().map(moment).sum::<crate::geom::Vector3>() / length.max(f64::MIN_POSITIVE);
    Rim { n_edges: corners.len(), length, middle: middle.into() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::shapes;

    #[test]
    fn a_closed_mesh_has_no_rim_and_two_missing_triangles_are_two() {
        let mut mesh = shapes::sphere(&Point3::new(5.0, 0.0, 0.0), 10.0, 20);
        assert_eq!(rims(&mesh), []);
        // The first triangle ends in a pole.
        let first = mesh.corners(0);
        mesh.triangles.remove(0);
        mesh.triangles.pop();
        let found = rims(&mesh);
        assert_eq!(found.iter().map(|rim| rim.n_edges).collect::<Vec<_>>(), [3, 3]);
        let length = (0..3).map(|i| (first[i] - first[(i + 1) % 3]).norm()).sum::<f64>();
        assert!(found.iter().any(|rim| (rim.length - length).abs() < 1e-9));
    }

    #[test]
    fn the_middle_of_an_open_tube_s_end_is_on_its_axis() {
        let mut mesh = shapes::stub(24, 5.0, 0.0, 30.0);
        mesh.triangles.retain(|t| t.iter().any(|&i| mesh.points[i as usize].x < 15.0));
        let [rim] = &rims(&mesh)[..] else { panic!("one end is open") };
        assert!((Point3::from(rim.middle) - Point3::new(30.0, 0.0, 0.0)).norm() < 1e-9, "{rim:?}");
        assert_eq!(rim.n_edges, 24);
    }
}
