//! How far a mesh is from the cloud it stands for, both ways.

use crate::geom::{KdTree, Nearest, OnMesh, Point3, PointCloud, TriMesh};
use crate::progress::{Cancelled, Progress};
use rayon::prelude::*;
use serde::Serialize;

/// Points or triangles measured by one thread in a row.
const CHUNK: usize = 1024;
/// The mesh is looked at in places so far apart, in mean edges.
const STEP: f64 = 0.25;
/// Pieces of a side at most.
const MOST_PIECES: f64 = 64.0;

/// How far a mesh is from a cloud, both ways.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct Fit {
    /// From the points to the nearest triangles, exactly.
    pub cloud_to_mesh: Distances,
    /// From places all over the mesh, a quarter of an edge apart, to the nearest points.
    pub mesh_to_cloud: Distances,
}

/// Distances, summed up [mm].
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct Distances {
    /// On average: over the points, or over the area.
    pub mean: f64,
    /// The largest: the one-sided Hausdorff distance.
    pub max: f64,
}

/// Measures `mesh`, with edges of `mean_edge` on average, against `cloud`; neither may be empty.
pub fn fit(
    mesh: &TriMesh,
    cloud: &PointCloud,
    mean_edge: f64,
    progress: &dyn Progress,
) -> Result<Fit, Cancelled> {
    progress.start("measuring", (cloud.points.len() + mesh.triangles.len()) as u64);
    let surface = OnMesh::new(mesh, mesh.triangles.len());
    let to_mesh = |point: &Point3| (1.0, surface.distance(point, f64::INFINITY));
    let cloud_to_mesh = summed(&cloud.points, progress, |points, sum| {
        for point in points {
            sum.add(to_mesh(point));
        }
    })?;
    let tree = KdTree::build(&cloud.points);
    let to_cloud = |place: &Point3| tree.nearest(place, f64::INFINITY).map_or(0.0, |n| n.distance);
    let mesh_to_cloud = summed(&mesh.triangles, progress, |triangles, sum| {
        for corners in triangles.iter().map(|t| t.map(|i| mesh.points[i as usize])) {
            each_place(&corners, STEP * mean_edge, |area, place| sum.add((area, to_cloud(place))));
        }
    })?;
    Ok(Fit { cloud_to_mesh, mesh_to_cloud })
}

/// The middles of equal pieces of a triangle, each with its area, and the corners, which have none.
fn each_place(corners: &[Point3; 3], step: f64, mut take: impl FnMut(f64, &Point3)) {
    let [a, b, c] = corners;
    let (u, v) = (b - a, c - a);
    let longest = u.norm().max(v.norm()).max((u - v).norm());
    let n = (longest / step).ceil().clamp(1.0, MOST_PIECES);
    let area = u.cross(&v).norm() / 2.0 / (n * n);
    for i in 0..n as u32 {
        for j in 0..n as u32 - i {
            let mut at = |x: f64, y: f64| take(area, &(a + u * (x / n) + v * (y / n)));
            let (x, y) = (f64::from(i), f64::from(j));
            at(x + 1.0 / 3.0, y + 1.0 / 3.0);
            if i + j + 1 < n as u32 {
                at(x + 2.0 / 3.0, y + 2.0 / 3.0);
            }
        }
    }
    for corner in corners {
        take(0.0, corner);
    }
}

#[derive(Default)]
struct Sum {
    weight: f64,
    weighted: f64,
    max: f64,
}

impl Sum {
    fn add(&mut self, (weight, distance): (f64, f64)) {
        self.weight += weight;
        self.weighted += weight * distance;
        self.max = self.max.max(distance);
    }
}

/// What `measure` adds up over all `items`, in an order that no number of threads changes.
fn summed<T: Sync>(
    items: &[T],
    progress: &dyn Progress,
    measure: impl Fn(&[T], &mut Sum) + Sync,
) -> Result<Distances, Cancelled> {
    let sums: Result<Vec<Sum>, Cancelled> = items
        .par_chunks(CHUNK)
        .map(|chunk| {
            let mut sum = Sum::default();
            measure(chunk, &mut sum);
            progress.advance(chunk.len() as u64)?;
            Ok(sum)
        })
        .collect();
    let all = sums?.into_iter().fold(Sum::default(), |all, sum| Sum {
        weight: all.weight + sum.weight,
        weighted: all.weighted + sum.weighted,
        max: all.max.max(sum.max),
    });
    Ok(Distances { mean: all.weighted / all.weight.max(f64::MIN_POSITIVE), max: all.max })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::progress::Silent;

    #[test]
    fn a_square_and_points_above_it_are_apart_as_by_hand() {
        let corners = [[0.0, 0.0, 0.0], [8.0, 0.0, 0.0], [8.0, 8.0, 0.0], [0.0, 8.0, 0.0]];
        let square = TriMesh::new(corners.map(Point3::from).to_vec(), vec![[0, 1, 2], [0, 2, 3]]);
        let points = vec![Point3::new(0.0, 0.0, 1.0), Point3::new(0.0, 11.0, 4.0)];
        let cloud = PointCloud { points, ..PointCloud::default() };
        let both = fit(&square, &cloud, 8.0, &Silent).unwrap();
        assert_eq!((both.cloud_to_mesh.max, both.cloud_to_mesh.mean), (5.0, 3.0));
        let alone = PointCloud { points: vec![cloud.points[0]], ..PointCloud::default() };
        let far = fit(&square, &alone, 8.0, &Silent).unwrap().mesh_to_cloud.max;
        assert!((far - 129.0_f64.sqrt()).abs() < 1e-5, "{far}");
    }

    #[test]
    fn a_triangle_is_looked_at_all_over_and_its_area_is_kept() {
        let corners = [[0.0, 0.0, 0.0], [6.0, 0.0, 0.0], [0.0, 4.0, 0.0]].map(Point3::from);
        let (mut area, mut middle, mut n) = (0.0, crate::geom::Vector3::zeros(), 0);
        each_place(&corners, 1.0, |weight, place| {
            area += weight;
            middle += place.coords * weight;
            n += 1;
        });
        assert_eq!(n, 8 * 8 + 3);
        assert!((area - 12.0).abs() < 1e-12);
        assert!((middle / area - crate::geom::Vector3::new(2.0, 4.0 / 3.0, 0.0)).norm() < 1e-12);
    }
}
