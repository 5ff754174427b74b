//! A cloud that keeps the rows and columns of the picture it came from.

use super::{Camera, Image, RgbdError};
use crate::geom::{Point3, PointCloud, Pose, Vector3};

/// Where there is no point.
const NOWHERE: Point3 = Point3::new(f64::NAN, f64::NAN, f64::NAN);

/// Points in the rows and columns of a picture, so that neighbours are next to each other.
#[derive(Debug, Clone, PartialEq)]
pub struct OrganisedCloud {
    /// The points [mm]; NaN where there is no reading.
    pub points: Image<Point3>,
    /// Unit normals that look at the camera; NaN where there is none. As large as `points`.
    pub normals: Option<Image<Vector3>>,
    /// Red, green, blue. As large as `points`.
    pub colors: Option<Image<[u8; 3]>>,
}

impl OrganisedCloud {
    /// The points of a depth image that `camera` took, in its frame; sizes agree.
    pub(super) fn of(depth: &Image<f32>, color: Option<&Image<[u8; 3]>>, camera: &Camera) -> Self {
        let points = Image::from_rows(depth.width(), depth.height(), NOWHERE, |y, row| {
            for ((x, point), &depth) in row.iter_mut().enumerate().zip(depth.row(y)) {
                if depth > 0.0 {
                    *point = camera.unproject([x as f64, y as f64], depth.into());
                }
            }
        });
        Self { points, normals: None, colors: color.cloned() }
    }

    /// `cloud` as rows of `width` points: what scanners write as width x height.
    pub fn from_cloud(cloud: PointCloud, width: usize, height: usize) -> Result<Self, RgbdError> {
        let PointCloud { points, normals, colors } = cloud;
        Ok(Self {
            points: Image::new(width, height, points)?,
            normals: normals.map(|normals| Image::new(width, height, normals)).transpose()?,
            colors: colors.map(|colors| Image::new(width, height, colors)).transpose()?,
        })
    }

    /// The point seen at a pixel, if there is one.
    pub fn point(&self, x: usize, y: usize) -> Option<&Point3> {
        self.points.get(x, y).filter(|point| is_there(point))
    }

    /// The normal seen at a pixel, if there is one.
    pub fn normal(&self, x: usize, y: usize) -> Option<&Vector3> {
        self.normals.as_ref()?.get(x, y).filter(|normal| !normal.x.is_nan())
    }

    /// How many pixels have a point.
    pub fn n_points(&self) -> usize {
        self.points.pixels().iter().filter(|point| is_there(point)).count()
    }

    /// The cloud in another frame.
    #[must_use]
    pub fn moved(mut self, to_from_here: &Pose) -> Self {
        for point in self.points.pixels_mut() {
            *point = to_from_here * *point;
        }
        for normal in self.normals.iter_mut().flat_map(Image::pixels_mut) {
            *normal = to_from_here.rotation * *normal;
        }
        self
    }

    /// The points alone, row by row, without the gaps. If there are normals, points without one are
    /// left out too.
    pub fn to_cloud(&self) -> PointCloud {
        self.to_sparse_cloud(1)
    }

    /// The same of every `step`th pixel of every `step`th row.
    pub fn to_sparse_cloud(&self, step: usize) -> PointCloud {
        let step = step.max(1);
        let (width, height) = (self.points.width(), self.points.height());
        let pixels =
            (0..height).step_by(step).flat_map(|y| (0..width).step_by(step).map(move |x| (x, y)));
        let mut cloud = PointCloud {
            points: Vec::new(),
            normals: self.normals.as_ref().map(|_| Vec::new()),
            colors: self.colors.as_ref().map(|_| Vec::new()),
        };
        for (x, y) in pixels {
            let Some(point) = self.point(x, y) else { continue };
            if let Some(normals) = &mut cloud.normals {
                let Some(normal) = self.normal(x, y) else { continue };
                normals.push(*normal);
            }
            cloud.points.push(*point);
            if let (Some(colors), Some(image)) = (&mut cloud.colors, &self.colors) {
                colors.push(image[(x, y)]);
            }
        }
        cloud
    }
}

fn is_there(point: &Point3) -> bool {
    !(point.x.is_nan() || point.y.is_nan() || point.z.is_nan())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A plane at 1000 mm with a hole, coloured by column.
    fn cloud() -> OrganisedCloud {
        let camera = Camera::pinhole([3, 2], [100.0, 100.0], [1.0, 0.5]);
        let depth = Image::new(3, 2, vec![1000.0, 0.0, 1000.0, 1000.0, 1000.0, 1000.0]).unwrap();
        let color = Image::new(3, 2, (0..6).map(|i| [i % 3; 3]).collect()).unwrap();
        OrganisedCloud::of(&depth, Some(&color), &camera)
    }

    #[test]
    fn points_keep_the_place_of_their_pixel_and_holes_stay_holes() {
        let cloud = cloud();
        assert_eq!(cloud.point(0, 0), Some(&Point3::new(-10.0, -5.0, 1000.0)));
        assert_eq!((cloud.point(1, 0), cloud.point(3, 0)), (None, None));
        assert_eq!(cloud.n_points(), 5);
    }

    #[test]
    fn a_plain_cloud_has_no_gaps_and_keeps_what_belongs_together() {
        let plain = cloud().to_cloud();
        assert_eq!(plain.points.len(), 5);
        let colors = plain.colors.unwrap();
        assert_eq!(colors, [[0; 3], [2; 3], [0; 3], [1; 3], [2; 3]]);
        assert_eq!(cloud().to_sparse_cloud(2).points.len(), 2);
        let mut normals = Image::filled(3, 2, -Vector3::z());
        normals[(0, 0)] = Vector3::repeat(f64::NAN);
        let with_normals = OrganisedCloud { normals: Some(normals), ..cloud() }.to_cloud();
        assert_eq!((with_normals.points.len(), with_normals.normals.unwrap().len()), (4, 4));
        assert_eq!(with_normals.colors.unwrap().len(), 4);
    }

    #[test]
    fn a_moved_cloud_is_seen_from_elsewhere() {
        let moved = cloud().moved(&Pose::translation(0.0, 0.0, -1000.0));
        assert_eq!(moved.point(0, 1).unwrap().z, 0.0);
        assert_eq!(moved.n_points(), 5);
    }

    #[test]
    fn a_cloud_of_another_number_of_points_is_no_picture() {
        let plain = cloud().to_cloud();
        assert!(OrganisedCloud::from_cloud(plain.clone(), 3, 2).is_err());
        assert!(OrganisedCloud::from_cloud(plain, 5, 1).is_ok());
    }
}
