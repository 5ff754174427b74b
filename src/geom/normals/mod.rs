//! Normals of a cloud: the plane through a point's nearest neighbours.

mod border;
mod eigen;
mod orient;

pub use border::is_border;
pub(crate) use eigen::least_direction;
pub use orient::{orient_alike, orient_towards};

use super::{KdTree, Matrix3, Neighbour, Point3, Vector3};
use crate::progress::{Cancelled, Progress};

/// The plane through the neighbourhood of a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tangent {
    /// Unit normal; which side it points to is open.
    pub normal: Vector3,
    /// How far the neighbours lie off the plane, root mean square [mm].
    pub roughness: f64,
}

/// The planes through the `k` nearest points (themselves among them) of all `points`, over which
/// `tree` was built.
///
/// Where the neighbours lie on a line, any plane through it is as good.
pub fn normals(
    points: &[Point3],
    tree: &KdTree,
    k: usize,
    progress: &dyn Progress,
) -> Result<Vec<Tangent>, Cancelled> {
    tree.map_neighbourhoods(points, k, progress, |i, found| tangent(points, i, found))
}

fn tangent(points: &[Point3], i_point: usize, neighbours: &[Neighbour]) -> Tangent {
    // About the point itself: differences of near points are exact enough to square.
    let here = points[i_point];
    let mut sum = Vector3::zeros();
    let mut squares = Matrix3::zeros();
    for neighbour in neighbours {
        let out = points[neighbour.index as usize] - here;
        sum += out;
        squares += out * out.transpose();
    }
    let n = neighbours.len().max(1) as f64;
    let covariance = squares / n - (sum / n) * (sum / n).transpose();
    let (least, normal) = least_direction(&covariance);
    Tangent { normal, roughness: least.max(0.0).sqrt() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::progress::Silent;

    fn tangents(points: &[Point3], k: usize) -> Vec<Tangent> {
        normals(points, &KdTree::build(points), k, &Silent).unwrap()
    }

    #[test]
    fn normals_of_a_ball_point_along_its_radii() {
        let golden = 2.399_963;
        let points: Vec<Point3> = (0..4000)
            .map(|i| {
                let z = 1.0 - (2.0 * f64::from(i) + 1.0) / 4000.0;
                let (r, a) = ((1.0 - z * z).sqrt(), golden * f64::from(i));
                Point3::new(1e5 + 50.0 * r * a.cos(), 50.0 * r * a.sin(), 50.0 * z)
            })
            .collect();
        for (point, tangent) in points.iter().zip(tangents(&points, 20)) {
            let radius = (point - Point3::new(1e5, 0.0, 0.0)).normalize();
            assert!(radius.dot(&tangent.normal).abs() > 0.999, "{point}");
            // A cap of twenty points, 3.6 mm wide, is 0.2 mm high.
            assert!((0.01..0.2).contains(&tangent.roughness));
        }
    }

    #[test]
    fn points_of_a_plane_have_its_normal_and_no_roughness() {
        let normal = Vector3::new(1.0, 2.0, -2.0) / 3.0;
        let (u, v) = (Vector3::new(2.0, -1.0, 0.0), Vector3::new(2.0, 4.0, 5.0));
        let points: Vec<Point3> = (0..400)
            .map(|i| Point3::origin() + u * f64::from(i % 20) + v * f64::from(i / 20))
            .collect();
        for tangent in tangents(&points, 12) {
            assert!(tangent.normal.dot(&normal).abs() > 1.0 - 1e-12);
            assert!(tangent.roughness < 1e-6);
        }
    }
}
