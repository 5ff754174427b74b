//! A turntable: how a part turned before a camera that stood still.
//!
//! From view to view the part makes the same turn about the same axis. A [`Turntable`] says which, so
//! that where the camera was, seen from the part, needs no tracking. What it is may be known, or
//! [`calibrate`]d from the views: neighbours are laid over each other, one turn is fitted to all their
//! motions, and all views refine it together, the last ones with the first ones too.

mod calibrate;
mod error;
mod fit;
mod judge;
mod options;
mod pairs;
mod refine;

pub use calibrate::{Calibration, calibrate};
pub use error::TurntableError;
pub use judge::{Looseness, TurntableDoubt};
pub use options::TurntableOptions;

use crate::geom::{Point3, Pose, Vector3};
use crate::rgbd::{CameraTrajectory, RgbdError, StampedPose};
use nalgebra::{Unit, UnitQuaternion};

/// How a part turns from view to view, in the frame of the camera that stands still.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Turntable {
    /// The direction of the axis, a unit vector: the part turns about it as a right-handed screw does.
    pub axis: Vector3,
    /// A point of the axis [mm].
    pub through: Point3,
    /// The turn from view to view [rad].
    pub step: f64,
}

impl Turntable {
    /// The turntable with an axis of any length; an error if a number is none, or the axis has no
    /// direction.
    pub fn new(axis: Vector3, through: Point3, step: f64) -> Result<Self, TurntableError> {
        let is_finite = through.iter().all(|c| c.is_finite());
        match axis.try_normalize(1e-9).filter(|axis| axis.iter().all(|c| c.is_finite())) {
            Some(axis) if is_finite && step.is_finite() => Ok(Self { axis, through, step }),
            _ => Err(TurntableError::Numbers { axis, through, step }),
        }
    }

    /// The motion of the part over `n_steps` steps.
    pub fn turned(&self, n_steps: f64) -> Pose {
        let axis = Unit::new_unchecked(self.axis);
        let rotation = UnitQuaternion::from_axis_angle(&axis, self.step * n_steps);
        let shift = self.through.coords - rotation * self.through.coords;
        Pose::from_parts(shift.into(), rotation)
    }

    /// Where the camera was, seen from the part: one step on at each stamp. The world is the frame of
    /// the camera at the first one.
    pub fn trajectory(&self, stamps: &[f64]) -> Result<CameraTrajectory, RgbdError> {
        let pose = |(i, &stamp): (usize, &f64)| StampedPose {
            stamp,
            world_from_camera: self.turned(-(i as f64)),
        };
        CameraTrajectory::new(stamps.iter().enumerate().map(pose).collect())
    }
}

#[cfg(test)]
mod tests;
