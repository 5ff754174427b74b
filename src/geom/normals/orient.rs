//! Which side of a surface its normals point to.

use crate::geom::{KdTree, Point3, Vector3};
use crate::progress::{Cancelled, Progress};
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Turns every normal to the side on which `eye` lies, as it must be for a surface seen from there.
pub fn orient_towards(points: &[Point3], normals: &mut [Vector3], eye: &Point3) {
    for (point, normal) in points.iter().zip(normals) {
        if normal.dot(&(eye - point)) < 0.0 {
            *normal = -*normal;
        }
    }
}

/// Turns normals to the side of their neighbours', from each piece's highest point outwards, where
/// the normal points up.
///
/// Goes along the `k` nearest neighbours, flattest steps first: a spanning tree that crosses sharp
/// edges last. After Hoppe et al. (1992).
pub fn orient_alike(
    points: &[Point3],
    normals: &mut [Vector3],
    tree: &KdTree,
    k: usize,
    progress: &dyn Progress,
) -> Result<(), Cancelled> {
    let neighbours = tree.map_neighbourhoods(points, k, progress, |_, found| {
        found.iter().map(|neighbour| neighbour.index).collect::<Vec<u32>>()
    })?;
    let mut seeds: Vec<u32> = (0..points.len() as u32).collect();
    seeds.sort_by(|&a, &b| points[b as usize].z.total_cmp(&points[a as usize].z));
    let mut is_done = vec![false; points.len()];
    // How bent the step is, whereto, and from where.
    let mut waiting: BinaryHeap<Reverse<(u64, u32, u32)>> = BinaryHeap::new();
    for seed in seeds {
        if is_done[seed as usize] {
            continue;
        }
        if normals[seed as usize].z < 0.0 {
            normals[seed as usize] *= -1.0;
        }
        waiting.push(Reverse((0, seed, seed)));
        while let Some(Reverse((_, here, before))) = waiting.pop() {
            let (here, before) = (here as usize, before as usize);
            if std::mem::replace(&mut is_done[here], true) {
                continue;
            }
            if normals[here].dot(&normals[before]) < 0.0 {
                normals[here] = -normals[here];
            }
            for &next in &neighbours[here] {
                if !is_done[next as usize] {
                    let bend = 1.0 - normals[here].dot(&normals[next as usize]).abs();
                    // Bits of a number that is not negative are ordered as it is.
                    waiting.push(Reverse((bend.max(0.0).to_bits(), next, here as u32)));
                }
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::normals;
    use crate::progress::Silent;

    #[test]
    fn normals_of_a_closed_body_all_point_out() {
        // Evenly spread over a ball, along a spiral.
        let points: Vec<Point3> = (0..2000)
            .map(|i| {
                let z = 1.0 - (2.0 * f64::from(i) + 1.0) / 2000.0;
                let (r, a) = ((1.0 - z * z).sqrt(), 2.399_963 * f64::from(i));
                Point3::new(40.0 * r * a.cos(), 40.0 * r * a.sin(), 40.0 * z)
            })
            .collect();
        let tree = KdTree::build(&points);
        let found = normals(&points, &tree, 12, &Silent).unwrap();
        let mut found: Vec<Vector3> = found.iter().map(|tangent| tangent.normal).collect();
        orient_alike(&points, &mut found, &tree, 12, &Silent).unwrap();
        for (point, normal) in points.iter().zip(&found) {
            assert!(normal.dot(&point.coords) > 0.0, "{point}");
        }
    }

    #[test]
    fn normals_look_at_the_eye() {
        let points = [Point3::new(0.0, 0.0, 5.0), Point3::new(9.0, 0.0, 5.0)];
        let mut normals = [Vector3::z(), -Vector3::z()];
        orient_towards(&points, &mut normals, &Point3::origin());
        assert_eq!(normals, [-Vector3::z(); 2]);
    }
}
