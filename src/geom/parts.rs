//! Clouds that come in parts: those larger than memory, and those that are there already.

use super::{Aabb, Point3, PointCloud, Vector3};
use crate::progress::Cancelled;

/// Some points of a cloud, with what normals and colours it has.
#[derive(Debug, Clone, Copy)]
pub struct CloudPart<'a> {
    /// Where the points are [mm].
    pub points: &'a [Point3],
    /// Unit normals, one per point.
    pub normals: Option<&'a [Vector3]>,
    /// Red, green, blue, one per point.
    pub colors: Option<&'a [[u8; 3]]>,
}

impl CloudPart<'_> {
    /// The points from `begin` on, `n` at most.
    #[must_use]
    pub fn range(&self, begin: usize, n: usize) -> Self {
        let end = self.points.len().min(begin + n);
        Self {
            points: &self.points[begin..end],
            normals: self.normals.map(|normals| &normals[begin..end]),
            colors: self.colors.map(|colors| &colors[begin..end]),
        }
    }
}

/// A cloud that can be gone through again and again, part by part.
pub trait CloudParts {
    /// How many points all parts have together.
    fn n_points(&self) -> u64;

    /// Hands all parts to `take`, in the same order each time.
    fn each_part(
        &mut self,
        take: &mut dyn FnMut(CloudPart<'_>) -> Result<(), PartError>,
    ) -> Result<(), PartError>;
}

/// Why a pass through a cloud ended early.
#[derive(Debug, thiserror::Error)]
pub enum PartError {
    /// The cloud could not be read.
    #[error(transparent)]
    Source(Box<dyn std::error::Error + Send + Sync>),
    /// A coordinate is no number.
    #[error("point {number} of the cloud is ({x}, {y}, {z}): no place; repair or export it again")]
    NotFinite {
        /// Which point, counted from 1.
        number: u64,
        /// Its coordinates.
        x: f64,
        /// Its coordinates.
        y: f64,
        /// Its coordinates.
        z: f64,
    },
    /// The caller asked to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl PointCloud {
    /// The whole cloud as one part.
    pub fn as_part(&self) -> CloudPart<'_> {
        CloudPart {
            points: &self.points,
            normals: self.normals.as_deref(),
            colors: self.colors.as_deref(),
        }
    }
}

/// A cloud in memory is one part.
impl CloudParts for &PointCloud {
    fn n_points(&self) -> u64 {
        self.points.len() as u64
    }

    fn each_part(
        &mut self,
        take: &mut dyn FnMut(CloudPart<'_>) -> Result<(), PartError>,
    ) -> Result<(), PartError> {
        take(self.as_part())
    }
}

/// The box around all points, each of which must be a place.
pub fn box_of_parts(parts: &mut dyn CloudParts) -> Result<Aabb, PartError> {
    let mut aabb = Aabb::around([]);
    let mut n_before = 0;
    parts.each_part(&mut |part| {
        if let Some(i) = part.points.iter().position(|p| !p.iter().all(|x| x.is_finite())) {
            let Point3 { coords } = part.points[i];
            let number = n_before + i as u64 + 1;
            return Err(PartError::NotFinite { number, x: coords.x, y: coords.y, z: coords.z });
        }
        aabb = part.points.iter().fold(aabb, Aabb::with);
        n_before += part.points.len() as u64;
        Ok(())
    })?;
    Ok(aabb)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_box_is_that_of_the_cloud_and_a_point_without_a_place_is_named() {
        let mut cloud = PointCloud {
            points: (0..9).map(|i| Point3::new(f64::from(i), 1.0, -2.0)).collect(),
            ..PointCloud::default()
        };
        assert_eq!(box_of_parts(&mut &cloud).unwrap(), cloud.aabb());
        cloud.points[4].y = f64::NAN;
        let error = box_of_parts(&mut &cloud).unwrap_err().to_string();
        assert!(error.starts_with("point 5 of the cloud is (4, NaN, -2)"), "{error}");
    }
}
