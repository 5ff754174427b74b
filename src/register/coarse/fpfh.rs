//! What the surface around a point looks like, wherever it is: fast point feature histograms.
//!
//! Between a point and a neighbour, the normals and the line enclose three angles that no rigid motion
//! changes. Histograms of them (11 bins each) are taken from a point's neighbours, and those of the
//! neighbours added, the nearer ones more. Rusu, Blodow and Beetz (2009).
//!
//! Departures: histograms are compared by their square roots (Hellinger's distance, as Arandjelović and
//! Zisserman 2012 do), so that one full bin does not drown the others; the products of two such
//! features, each of length one, order pairs as their distances do.

use crate::geom::{KdTree, Neighbour, Point3, Vector3};
use crate::progress::{Cancelled, Progress};
use rayon::prelude::*;
use std::f64::consts::PI;

/// Bins of an angle.
const BINS: usize = 11;
/// Three histograms, filled up with zeros so that whole vectors are compared.
pub(super) const WIDTH: usize = 40;
/// Neighbours looked at, at most.
const MOST: usize = 120;
/// Points described by one thread in a row.
const CHUNK: usize = 64;

/// A description of a neighbourhood, of length one.
pub(super) type Feature = [f32; WIDTH];

type Histograms = [[f64; BINS]; 3];

/// The features of all points, from neighbours up to `radius`.
pub(super) fn fpfh(
    points: &[Point3],
    normals: &[Vector3],
    tree: &KdTree,
    radius: f64,
    progress: &dyn Progress,
) -> Result<Vec<Feature>, Cancelled> {
    progress.start("features", points.len() as u64);
    let near: Vec<Vec<Neighbour>> = points
        .par_chunks(CHUNK)
        .enumerate()
        .flat_map_iter(|(i_chunk, chunk)| {
            chunk.iter().enumerate().map(move |(i, point)| {
                let mut found = Vec::new();
                tree.k_nearest(point, MOST, radius, &mut found);
                found.retain(|neighbour| neighbour.index as usize != i_chunk * CHUNK + i);
                found
            })
        })
        .collect();
    let own: Vec<Histograms> = near
        .par_iter()
        .enumerate()
        .map(|(i, near)| {
            let mut own = [[0.0; BINS]; 3];
            for j in near.iter().map(|neighbour| neighbour.index as usize) {
                if let Some(angles) = angles([&points[i], &points[j]], [&normals[i], &normals[j]]) {
                    for (histogram, angle) in own.iter_mut().zip(angles) {
                        histogram[bin(angle)] += 1.0;
                    }
                }
            }
            evened(own)
        })
        .collect();
    let features = near.par_iter().enumerate().map(|(i, near)| {
        let mut all = own[i];
        // The mean distance makes the weights numbers: the unit must not matter.
        let n = near.len().max(1) as f64;
        let mean = near.iter().map(|neighbour| neighbour.distance).sum::<f64>() / n;
        for neighbour in near.iter().filter(|neighbour| neighbour.distance > 0.0) {
            let weight = mean / neighbour.distance / n;
            let other = &own[neighbour.index as usize];
            for (sum, term) in all.as_flattened_mut().iter_mut().zip(other.as_flattened()) {
                *sum += weight * term;
            }
        }
        rooted(&evened(all))
    });
    let features = features.collect();
    progress.advance(points.len() as u64)?;
    Ok(features)
}

/// The feature that the same place has when all normals point to the other side: two of the three
/// angles change their sign.
pub(super) fn flipped(feature: &Feature) -> Feature {
    let mut other = *feature;
    for histogram in 1..3 {
        other[histogram * BINS..][..BINS].reverse();
    }
    other
}

/// The sum of products: the greater, the more alike.
#[inline]
pub(super) fn likeness(a: &Feature, b: &Feature) -> f32 {
    let mut lanes = [0.0_f32; 8];
    for (a, b) in a.as_chunks::<8>().0.iter().zip(b.as_chunks::<8>().0) {
        for lane in 0..8 {
            lanes[lane] += a[lane] * b[lane];
        }
    }
    lanes.iter().sum()
}

/// The three angles between two points with normals, each scaled to -1 to 1; `None` where the line
/// runs along the normal.
fn angles(places: [&Point3; 2], normals: [&Vector3; 2]) -> Option<[f64; 3]> {
    let line = (places[1] - places[0]).try_normalize(1e-12)?;
    let [n, m] = normals;
    // The point whose normal is nearer to the line comes first: the order given must not matter.
    let (n, m, line) =
        if n.dot(&line).abs() < m.dot(&line).abs() { (m, n, -line) } else { (n, m, line) };
    let v = line.cross(n).try_normalize(1e-9)?;
    let w = n.cross(&v);
    Some([v.dot(m), n.dot(&line), w.dot(m).atan2(n.dot(m)) / PI])
}

fn bin(value: f64) -> usize {
    // NaN and what rounding puts outside become the outermost bins.
    (((value + 1.0) * (BINS as f64 / 2.0)).max(0.0) as usize).min(BINS - 1)
}

/// Each histogram with the sum 1; what is empty stays so.
fn evened(mut histograms: Histograms) -> Histograms {
    for histogram in &mut histograms {
        let sum: f64 = histogram.iter().sum();
        if sum > 0.0 {
            for x in histogram {
                *x /= sum;
            }
        }
    }
    histograms
}

fn rooted(histograms: &Histograms) -> Feature {
    let mut feature = [0.0; WIDTH];
    for (x, share) in feature.iter_mut().zip(histograms.as_flattened()) {
        *x = (share / 3.0).sqrt() as f32;
    }
    feature
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Pose;
    use crate::progress::Silent;

    fn features(points: &[Point3], normals: &[Vector3]) -> Vec<Feature> {
        fpfh(points, normals, &KdTree::build(points), 9.0, &Silent).unwrap()
    }

    /// A wavy sheet of 60 by 60 mm, its points in no order.
    fn body() -> (Vec<Point3>, Vec<Vector3>) {
        let place = |i: u32| {
            let (u, v) = ((f64::from(i) * 0.618_034).fract(), (f64::from(i) * 0.754_878).fract());
            let (x, y) = (60.0 * u, 60.0 * v);
            let (a, b) = (0.13 * x + 0.05 * y, 0.2 * y - 0.002 * x * x);
            let slope = [0.78 * a.cos() + 0.016 * x * b.sin(), 0.3 * a.cos() - 0.8 * b.sin()];
            let point = Point3::new(x, y, 6.0 * a.sin() + 4.0 * b.cos());
            (point, Vector3::new(-slope[0], -slope[1], 1.0).normalize())
        };
        (0..1500).map(place).unzip()
    }

    #[test]
    fn features_do_not_change_when_the_body_moves() {
        let (points, normals) = body();
        let pose = Pose::new(Vector3::new(30.0, -20.0, 10.0), Vector3::new(0.7, -1.1, 0.4));
        let moved: Vec<Point3> = points.iter().map(|p| pose * p).collect();
        let turned: Vec<Vector3> = normals.iter().map(|n| pose * n).collect();
        let here = features(&points, &normals);
        for (a, b) in here.iter().zip(&features(&moved, &turned)) {
            // A neighbour on the radius, or an angle on the border of two bins, may change sides.
            assert!(likeness(a, b) > 0.998, "{}", likeness(a, b));
        }
        // They tell places apart: most are less like another place than like themselves.
        let n_alike = here.windows(30).filter(|w| likeness(&w[0], &w[29]) > 0.998).count();
        assert!(n_alike < here.len() / 2, "{n_alike} of {}", here.len());
    }

    #[test]
    fn normals_to_the_other_side_mirror_two_of_three_histograms() {
        let (points, normals) = body();
        let inward: Vec<Vector3> = normals.iter().map(|n| -n).collect();
        let here = features(&points, &normals);
        for (a, b) in here.iter().zip(&features(&points, &inward)) {
            assert!(likeness(&flipped(a), b) > 0.998);
        }
    }

    #[test]
    fn features_have_length_one_and_a_lone_point_has_none() {
        let (mut points, mut normals) = body();
        points.push(Point3::new(1e4, 0.0, 0.0));
        normals.push(Vector3::x());
        let all = features(&points, &normals);
        let (lone, others) = all.split_last().unwrap();
        assert_eq!(likeness(lone, lone), 0.0);
        assert!(others.iter().all(|a| (likeness(a, a) - 1.0).abs() < 1e-5));
    }
}
