//! A cloud made ready: thinned, about its centroid, in the order of its tree, with its normals.

use super::error::{IcpError, Role};
use crate::geom::{
    Aabb, KdTree, Matrix3, Neighbour, Point3, PointCloud, Tangent, Vector3, centroid, is_border,
    least_direction, normals, voxel_grid,
};
use crate::progress::Progress;
use crate::rgbd::Camera;

/// Fewer points fix no pose.
const LEAST: usize = 20;
/// A cloud wider than this share of its length is no line.
const LINE: f64 = 1e-6;

/// A cloud made ready to be registered; it can take part in any number of registrations.
#[derive(Debug, Clone)]
pub struct View {
    /// The centroid of the cloud as it was given; everything here is relative to it [mm].
    pub(in crate::register) center: Point3,
    pub(in crate::register) points: Vec<Point3>,
    pub(in crate::register) tree: KdTree,
    pub(in crate::register) normals: Vec<Vector3>,
    /// True if the normals point to the side that the given ones did.
    pub(in crate::register) is_oriented: bool,
    /// How far neighbours lie off their plane, the median of all points [mm].
    pub(in crate::register) roughness: f64,
    /// The side of the voxels [mm].
    pub(in crate::register) voxel: f64,
    /// Root mean square distance from the centroid [mm].
    pub(in crate::register) radius: f64,
    pub(super) colours: Option<Colours>,
    pub(super) is_border: Option<Vec<bool>>,
    /// What saw it, from the origin of the cloud as it was given.
    pub(super) camera: Option<Camera>,
}

/// How bright a surface is, and how that changes along it.
#[derive(Debug, Clone)]
pub(super) struct Colours {
    /// 0 to 1.
    pub(super) intensity: Vec<f64>,
    /// In the tangent plane [1/mm].
    pub(super) gradient: Vec<Vector3>,
}

/// How a [`View`] is made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ViewOptions {
    /// Side of the cells that become one point each [mm].
    pub voxel: f64,
    /// Neighbours a normal is taken from.
    pub neighbours: usize,
    /// Look at the colours, for [`Metric::Coloured`](super::Metric::Coloured).
    pub with_colours: bool,
    /// Find the borders, for [`IcpOptions::reject_borders`](super::IcpOptions::reject_borders).
    pub with_borders: bool,
    /// The camera that saw the cloud, from its origin, for
    /// [`Pairing::Projective`](super::Pairing::Projective).
    pub camera: Option<Camera>,
}

impl View {
    /// Makes `cloud` ready; `role` is what errors call it.
    pub fn new(
        cloud: &PointCloud,
        role: Role,
        options: ViewOptions,
        progress: &dyn Progress,
    ) -> Result<Self, IcpError> {
        let ViewOptions { voxel, neighbours, .. } = options;
        if let Some(index) = cloud.points.iter().position(|p| !p.iter().all(|x| x.is_finite())) {
            return Err(IcpError::NotFinite { role, index });
        }
        progress.start("normals", cloud.points.len() as u64);
        let center = centroid(&cloud.points);
        let near = cloud.points.iter().map(|point| Point3::from(point - center)).collect();
        let (normals, colors) = (cloud.normals.clone(), cloud.colors.clone());
        let few = voxel_grid(&PointCloud { points: near, normals, colors }, voxel)?;
        let n_points = few.points.len();
        if n_points < LEAST {
            return Err(IcpError::TooFew { role, n_points, voxel, least: LEAST });
        }
        let radius = spread(&few.points).ok_or(IcpError::Collinear { role })?;
        progress.advance((cloud.points.len() - n_points) as u64)?;
        let tree = KdTree::build(&few.points);
        let order = tree.order();
        let (points, tree) = (in_order(&few.points, &order), tree.in_order());
        let tangents = self::normals(&points, &tree, neighbours, progress)?;
        let mut view = Self {
            center,
            tree,
            roughness: median_roughness(&tangents),
            normals: tangents.iter().map(|tangent| tangent.normal).collect(),
            is_oriented: few.normals.is_some(),
            voxel,
            radius,
            colours: None,
            is_border: None,
            camera: options.camera,
            points,
        };
        for (normal, &i) in view.normals.iter_mut().zip(&order) {
            let given = few.normals.as_ref().map(|given| given[i as usize]);
            if given.is_some_and(|given| given.dot(normal) < 0.0) {
                *normal = -*normal;
            }
        }
        if let (true, Some(colors)) = (options.with_colours, &few.colors) {
            let intensity: Vec<f64> =
                order.iter().map(|&i| brightness(colors[i as usize])).collect();
            let of = |i: usize, found: &[Neighbour]| view.gradient(&intensity, i, found);
            let gradient =
                view.tree.map_neighbourhoods(&view.points, neighbours, &Still(progress), of)?;
            view.colours = Some(Colours { intensity, gradient });
        }
        if options.with_borders {
            let of =
                |i: usize, found: &[Neighbour]| is_border(&view.points, i, &view.normals[i], found);
            let found =
                view.tree.map_neighbourhoods(&view.points, neighbours, &Still(progress), of)?;
            view.is_border = Some(found);
        }
        Ok(view)
    }

    /// How many points are left.
    pub fn len(&self) -> usize {
        self.points.len()
    }

    /// True if nothing is left; [`View::new`] refuses that.
    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
    }

    /// The diagonal of the box around it [mm].
    pub(in crate::register) fn diagonal(&self) -> f64 {
        Aabb::around(&self.points).size().norm()
    }

    /// The gradient of the brightness in the tangent plane, by least squares.
    fn gradient(&self, intensity: &[f64], i_point: usize, found: &[Neighbour]) -> Vector3 {
        let normal = self.normals[i_point];
        let mut squares = normal * normal.transpose() * self.voxel.powi(2);
        let mut products = Vector3::zeros();
        for neighbour in found {
            let i = neighbour.index as usize;
            let out = self.points[i] - self.points[i_point];
            let along = out - normal * normal.dot(&out);
            squares += along * along.transpose();
            products += along * (intensity[i] - intensity[i_point]);
        }
        // A trace of damping: neighbours in a row say nothing about the other direction.
        let damping = Matrix3::from_diagonal_element(1e-6 * squares.trace());
        (squares + damping).try_inverse().map_or_else(Vector3::zeros, |inverse| inverse * products)
    }
}

/// Passes only the request to stop on: the work was announced by another measure.
struct Still<'a>(&'a dyn Progress);

impl Progress for Still<'_> {
    fn start(&self, _: &str, _: u64) {}

    fn advance(&self, _: u64) -> Result<(), crate::progress::Cancelled> {
        self.0.advance(0)
    }
}

fn in_order(points: &[Point3], order: &[u32]) -> Vec<Point3> {
    order.iter().map(|&i| points[i as usize]).collect()
}

/// The root mean square distance from the mean; `None` if all points lie on one line.
fn spread(points: &[Point3]) -> Option<f64> {
    let n = points.len() as f64;
    let mean = centroid(points);
    let squares: Matrix3 =
        points.iter().map(|p| (p - mean) * (p - mean).transpose()).sum::<Matrix3>() / n;
    let total = squares.trace();
    // The least eigenvalue of what the trace leaves is the sum of the two smaller ones.
    let (both, _) = least_direction(&(Matrix3::from_diagonal_element(total) - squares));
    (both > total * LINE.powi(2)).then_some(total.sqrt())
}

fn median_roughness(tangents: &[Tangent]) -> f64 {
    let mut all: Vec<f64> = tangents.iter().map(|tangent| tangent.roughness).collect();
    median(&mut all)
}

/// The upper median; 0 of nothing.
pub(super) fn median(values: &mut [f64]) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// ITU-R BT.601.
fn brightness([r, g, b]: [u8; 3]) -> f64 {
    (0.299 * f64::from(r) + 0.587 * f64::from(g) + 0.114 * f64::from(b)) / 255.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::progress::Silent;

    const OPTIONS: ViewOptions = ViewOptions {
        voxel: 0.5,
        neighbours: 12,
        with_colours: true,
        with_borders: false,
        camera: None,
    };

    fn slope() -> PointCloud {
        let points: Vec<Point3> = (0..900)
            .map(|i| Point3::new(1e6 + f64::from(i % 30), f64::from(i / 30), 0.0))
            .collect();
        let colors = points.iter().map(|p| [(5.0 * p.y) as u8; 3]).collect();
        PointCloud { points, normals: None, colors: Some(colors) }
    }

    fn error_of(cloud: &PointCloud) -> String {
        View::new(cloud, Role::Source, OPTIONS, &Silent).unwrap_err().to_string()
    }

    #[test]
    fn brightness_climbs_along_its_gradient() {
        let view = View::new(&slope(), Role::Target, OPTIONS, &Silent).unwrap();
        assert_eq!(view.len(), 900);
        let colours = view.colours.unwrap();
        for gradient in &colours.gradient {
            assert!((gradient - Vector3::y() * 5.0 / 255.0).norm() < 1e-4, "{gradient}");
        }
    }

    #[test]
    fn what_fixes_no_pose_is_refused_with_its_reason() {
        let mut cloud = slope();
        cloud.points[7].y = f64::NAN;
        assert!(error_of(&cloud).starts_with("point 8 of the source is not finite"));
        assert!(error_of(&PointCloud::default()).starts_with("the source has 0 points in voxels"));
        let line = (0..100).map(|i| Point3::new(f64::from(i), 2.0 * f64::from(i), 7.0)).collect();
        let line = PointCloud { points: line, ..PointCloud::default() };
        assert!(error_of(&line).starts_with("all points of the source lie on one line"));
        let same = PointCloud { points: vec![Point3::origin(); 100], ..PointCloud::default() };
        assert!(error_of(&same).starts_with("the source has 1 points in voxels"));
    }

    #[test]
    fn given_normals_say_which_side_is_out() {
        let mut cloud = slope();
        cloud.normals = Some(vec![-Vector3::z(); cloud.points.len()]);
        let view = View::new(&cloud, Role::Source, OPTIONS, &Silent).unwrap();
        assert!(view.is_oriented && view.normals.iter().all(|normal| normal.z < -0.99));
    }
}
