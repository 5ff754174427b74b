//! A frame in few points.

use crate::geom::Point3;
use crate::rgbd::{Camera, NormalOptions, OrganisedCloud, RgbdError, RgbdFrame, halved_depth};

/// A picture is halved until it is no wider [px].
const WIDE: usize = 200;

/// A frame in few points, with normals.
#[derive(Debug, Clone)]
pub struct Sketch {
    /// When its depth was taken, by its own clock [s].
    pub(super) stamp: f64,
    pub(super) camera: Camera,
    pub(super) cloud: OrganisedCloud,
}

impl Sketch {
    /// A sketch of `frame`, which `camera` took; what is deeper than `max_depth` [mm] is left out.
    pub fn new(
        frame: &RgbdFrame,
        camera: &Camera,
        stamp: f64,
        max_depth: f64,
    ) -> Result<Self, RgbdError> {
        frame.check(camera)?;
        frame.check_depth()?;
        let near = |depth: f32| if f64::from(depth) <= max_depth { depth } else { 0.0 };
        let (mut depth, mut camera) = (frame.depth.map(|depth| near(*depth)), *camera);
        while camera.width > WIDE {
            (depth, camera) = (halved_depth(&depth), camera.halved());
        }
        let few = RgbdFrame { stamp, depth, color: None, confidence: None };
        let cloud = few.cloud(&camera)?;
        let cloud = cloud.with_normals(&Point3::origin(), &NormalOptions::default());
        Ok(Self { stamp, camera, cloud })
    }
}
